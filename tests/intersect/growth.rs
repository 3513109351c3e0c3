//! The work of an audit grows no faster than the surface: counts the boxes that are compared. An earlier
//! version compared all boxes that overlap an edge's box along one axis; ten times the triangles took thirty
//! times the work.

harness::both_precisions! {
    use muslin::audit::tree::{Boxed, Tree, nodes};
    use muslin::geometry::aabb::Aabb;
    use muslin::real::{Vec3, vec3};
    use harness::crumpled;

    /// Number of boxes compared with the boxes of the triangles' sides, per triangle of a crumpled sheet.
    fn compared(cells: usize) -> f64 {
        let mesh = crumpled::sheet(cells);
        let positions: Vec<Vec3> = mesh.positions.iter().map(|x| vec3(x.to_array())).collect();
        let around = |vertices: &[u32]| {
            let points = vertices.iter().map(|&v| positions[v as usize]);
            points.fold(Aabb::EMPTY, |all, x| all.union(&Aabb { min: x, max: x }))
        };
        let boxes = (0..).zip(&mesh.triangles).map(|(t, corners)| Boxed::new(t, around(corners)));
        let (mut boxes, mut bounds) = (boxes.collect::<Vec<_>>(), vec![Aabb::EMPTY; nodes(mesh.triangles.len())]);
        let tree = Tree::build(&mut boxes, &mut bounds);
        let sides = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let compared: usize = sides.map(|side| tree.overlapping(&around(&side), &mut |_| ())).sum();
        compared as f64 / mesh.triangles.len() as f64
    }

    #[test]
    fn ten_times_the_triangles_take_little_more_than_ten_times_the_work() {
        let [small, large] = [71, 224].map(compared);
        println!("{small:.0} boxes for each of 10,082 triangles, {large:.0} for each of 100,352");
        assert!(large < 1.5 * small && large < 600.0, "{small}, {large}");
    }
}
