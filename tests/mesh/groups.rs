//! What acts on selected vertices: how loads and masses are shared among them.

use glam::DVec3;

use super::cloth;

const GRID: &str = "grid = { size = [2.0, 2.0], cells = [2, 2], pattern = \"diagonal\" }";

/// The loaded vertices and their forces along y; the total is 8 N.
fn loaded(keys: &str) -> (Vec<u32>, Vec<f64>) {
    let built = cloth(&format!("{GRID}\nload = [{{ force = [0.0, 8.0, 0.0], {keys} }}]"));
    let loads = built.model.loads.expect("there is a load");
    let forces: Vec<_> = loads.view().forces().map(|(_, force)| force).collect();
    assert!(forces.iter().all(|force| force.x == 0.0 && force.z == 0.0));
    (loads.vertices, forces.iter().map(|force| force.y).collect())
}

#[test]
fn loads_are_shared_as_asked() {
    let back = "select = { edge = \"back\" }";
    assert_eq!(loaded(&format!("{back}, share = \"length\"")), (vec![0, 1, 2], vec![2.0, 4.0, 2.0]), "by length");
    let third = 8.0 / 3.0;
    assert_eq!(loaded(back), (vec![0, 1, 2], vec![third; 3]), "equally");
    // Corner 0 has two triangles, corner 2 has one, the middle has six.
    let (_, forces) = loaded("select = { vertices = [0, 2, 4] }, share = \"area\"");
    for (got, want) in forces.iter().zip([16.0 / 9.0, 8.0 / 9.0, 48.0 / 9.0]) {
        assert!((got - want).abs() < 1e-14, "by area: {forces:?}");
    }
}

#[test]
fn masses_and_densities_are_added() {
    let masses = |keys: &str| {
        let particles = cloth(&format!("{GRID}\n{keys}")).particles;
        let inverse = particles.masses.iter().map(|mass| 1.0 / mass).collect::<Vec<_>>();
        assert_eq!(particles.inverse_masses, inverse);
        particles.masses
    };
    let bare = masses("");
    let added = |keys: &str| -> Vec<f64> { masses(keys).iter().zip(&bare).map(|(mass, bare)| mass - bare).collect() };
    let back = added("mass = [{ select = { edge = \"back\" }, mass = 2.0, share = \"length\" }]");
    for (got, want) in back.iter().zip([0.5, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]) {
        assert!((got - want).abs() < 1e-14, "along a side: {back:?}");
    }
    // The cloth has 1 kg/m^2, so three times as much in all is two more.
    let denser = added("mass = [{ select = { vertices = [4, 8] }, density = 2.0 }]");
    for (vertex, (got, bare)) in denser.iter().zip(&bare).enumerate() {
        let want = if [4, 8].contains(&vertex) { 2.0 * bare } else { 0.0 };
        assert!((got - want).abs() < 1e-14, "vertex {vertex}: {got}, expected {want}");
    }
}

#[test]
fn some_vertices_start_with_their_own_velocity() {
    let built = cloth(&format!(
        "{GRID}\nvelocity = [1, 0, 0]\nspin = {{ axis = [0, 0, 1], rate = 2, center = [-1, 0, 0] }}\n\
         start = [{{ select = {{ vertices = [4] }}, velocity = [0, 0, 7] }}]"
    ));
    let v = &built.particles.velocities;
    assert_eq!([v[0], v[1], v[2]].map(|v| v.to_array()), [[1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [1.0, 4.0, 0.0]]);
    assert_eq!(v[4].to_array(), [0.0, 0.0, 7.0]);
}

#[test]
fn loads_of_one_vertex_add_up() {
    let built = cloth(&format!(
        "{GRID}\nposition = [0.0, 3.0, 0.0]\nload = [{{ select = {{ vertices = [4] }}, force = [1, 2, 3] }}, \
         {{ select = {{ vertices = [4] }}, force = [1, 0, 0] }}]"
    ));
    let mut forces = [DVec3::ZERO; 9];
    let model = built.model.view();
    let x = harness::kit::double::positions(&built);
    forces.copy_from_slice(&harness::kit::double::forces(&model, &built.particles.masses, &x, &[DVec3::ZERO; 9]));
    assert_eq!(forces[4], DVec3::new(2.0, 2.0, 3.0));
    assert_eq!(forces.iter().sum::<DVec3>(), forces[4]);
    assert_eq!(harness::kit::double::energies(&model, &built.particles.masses, &x).gravity, 0.0, "zero at the start");
}
