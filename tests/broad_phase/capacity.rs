//! Insufficient capacity is always reported: the counts stay complete, and the pairs that fit are the first
//! ones of the full list. Equal input gives equal output, in the same order, with any number of threads.

use harness::crumpled;

use super::methods::{METHODS, all, double, single};
use harness::case::Case;

fn case() -> Case {
    let mesh = crumpled::sheet(10);
    Case::new("crumpled sheet", &mesh.positions, &mesh.triangles, 0.25)
}

#[test]
fn too_little_room_is_counted() {
    let case = case();
    for (name, method) in METHODS {
        let whole = all(method, &case);
        let [vertex_triangle, edge_edge] = whole.counts;
        assert!(vertex_triangle > 100 && edge_edge > 100, "{name}: {:?}", whole.counts);
        for room in [[0, 0], [1, edge_edge], [vertex_triangle, 7], [vertex_triangle - 1, edge_edge - 1]] {
            let part = method(&case, room);
            assert_eq!(part.counts, whole.counts, "{name} with room for {room:?}");
            assert_eq!(part.vertex_triangle, whole.vertex_triangle[..room[0]], "{name}");
            assert_eq!(part.edge_edge, whole.edge_edge[..room[1]], "{name}");
        }
    }
}

#[test]
fn repeats_to_the_order() {
    let case = case();
    for (name, method) in METHODS {
        assert_eq!(all(method, &case), all(method, &case), "{name}");
    }
    for threads in [1, 2, 3, 7] {
        assert_eq!(single::on_threads(&case, threads), all(single::grid, &case), "f32 on {threads} threads");
        assert_eq!(double::on_threads(&case, threads), all(double::grid, &case), "f64 on {threads} threads");
    }
}

/// The same columns are used for successive states, as in a simulation.
#[test]
fn columns_can_be_used_again() {
    let first = case();
    let mut second = first.clone();
    second.boxes.reverse();
    second.boxes[5][0].x = f64::NAN;
    let cases = [&first, &second, &first];
    assert_eq!(single::in_turn(&cases), cases.map(|case| single::grid(case, [0, 0]).counts));
    assert_eq!(double::in_turn(&cases), cases.map(|case| double::grid(case, [0, 0]).counts));
}
