//! Crossings in real meshes: a dress, alone or on its body, has crossings only between the two sides of its
//! seams; the body has some; the cloth on a ball has many.

harness::both_precisions! {
    use std::time::Instant;

    use muslin::audit;
    use muslin::dispatch::Serial;
    use muslin::real::{NAME, Vec3, vec3};
    use harness::data;

    use crate::surface::{Columns, surface};

    /// Counts the crossings and the pairs of triangles that intersect.
    fn count(what: &str, columns: &Columns, positions: &[[f64; 3]]) -> [usize; 2] {
        let positions: Vec<Vec3> = positions.iter().map(|&x| vec3(x)).collect();
        let (surface, started) = (surface!(muslin, columns), Instant::now());
        let crossings = audit::crossings(&surface, &positions, &Serial);
        let took = started.elapsed().as_secs_f64();
        let pairs = audit::triangle_pairs(&surface, &crossings).len();
        println!("{what}, {NAME}: {} crossings, {pairs} pairs of triangles; {took:.3} s", crossings.len());
        [crossings.len(), pairs]
    }

    #[test]
    fn the_dress() {
        let Some(dress) = data::obj("garment/dress.obj") else { return };
        let Some(draped) = data::obj("garment/dress_draped.obj") else { return };
        let Some(body) = data::obj("garment/body.obj") else { return };
        let plain = Columns::new(&dress.triangles);
        assert_eq!(count("pattern of the dress", &plain, &dress.positions), [0, 0]);
        assert!(count("draped dress, seams apart", &plain, &draped.positions)[0] > 0);

        let shift = draped.positions.len() as u32;
        let of_body = body.triangles.iter().map(|corners| corners.map(|v| v + shift));
        let triangles: Vec<_> = draped.triangles.iter().copied().chain(of_body).collect();
        let positions = [draped.positions, body.positions].concat();
        let sewn: Vec<_> = dress.stitches.iter().flat_map(|s| s.edge.map(|b| [s.a, b])).collect();
        let mut together = Columns::new(&triangles).sewn(&sewn, positions.len());
        together.first_passive = draped.triangles.len() as u32;
        assert_eq!(count("draped dress, sewn, on the body", &together, &positions), [0, 0]);
    }

    #[test]
    fn the_body() {
        let Some(body) = data::obj("garment/body.obj") else { return };
        let mut columns = Columns::new(&body.triangles);
        let found = count("body", &columns, &body.positions);
        assert_eq!(found, [499, 496]);
        for frame in [0, 60, 120] {
            let Some(positions) = data::pc2("garment/body_kick.pc2", frame) else { return };
            assert!(count(&format!("body, frame {frame} of the kick"), &columns, &positions)[0] > 0);
        }
        columns.first_passive = 0;
        assert_eq!(count("passive body", &columns, &body.positions), [0, 0]);
        let turned: Vec<_> = body.triangles.iter().rev().map(|&[a, b, c]| [c, a, b]).collect();
        assert_eq!(count("body in another order", &Columns::new(&turned), &body.positions), found);
    }

    /// The vertices are exact in f32.
    #[test]
    fn the_cloth_on_a_ball() {
        let frames = [("cloth_ball92.ply", [62_655, 63_602]), ("cloth_ball93.ply", [98_728, 99_872])];
        for (name, crossings) in frames {
            let Some(cloth) = data::ply(&format!("cloth-ball/{name}")) else { return };
            assert_eq!(count(name, &Columns::new(&cloth.triangles), &cloth.positions), crossings);
        }
    }
}
