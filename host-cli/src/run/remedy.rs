//! What helps against the errors of the steps of a scene.

use muslin_core::integrate::Method;
use muslin_core::scene::SceneDesc;

/// Advice against errors of the steps, by the settings of the scene that can be improved.
pub fn of_steps(scene: &SceneDesc) -> String {
    let integrator = &scene.integrator;
    let shorter = match integrator.error() {
        Some(_) => "a smaller integrator.error, or a shorter integrator.step beside it",
        None => "a smaller integrator.step",
    };
    if !integrator.method.is_implicit() {
        return format!("take {shorter}, or an implicit method");
    }
    if integrator.method == Method::ImplicitMidpoint {
        return format!("take bdf2, which damps fast modes, or {shorter}");
    }
    match (integrator.newton, &scene.contact) {
        (..=1, None) => format!(
            "one linear solve in each step is inexact where cloth turns far; take integrator.newton = 20, or {shorter}"
        ),
        _ => format!("take {shorter}"),
    }
}

/// Advice against solves that end above their tolerance.
pub fn of_solves(scene: &SceneDesc) -> String {
    match (scene.integrator.newton, &scene.contact) {
        (2.., Some(_)) => {
            "take integrator.newton = 1: Newton's method iterates without the contacts, and they undo its work".into()
        }
        (newton @ 2.., None) => {
            format!(
                "they need more than integrator.newton = {newton} iterations, a smaller integrator.step, or the digits \
                 of --precision f64"
            )
        }
        _ => of_steps(scene),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(sections: &str) -> SceneDesc {
        toml::from_str(&format!(
            "duration = 1.0\ncloth = [{{ grid = {{ size = [1, 1], cells = [1, 1] }}, density = 0.1 }}]\n{sections}"
        ))
        .unwrap()
    }

    #[test]
    fn it_suits_the_settings() {
        let contact = "[contact]\nthickness = 0.01\n";
        for (sections, steps, solves) in [
            ("", "take integrator.newton = 20, or a smaller integrator.error", "integrator.newton = 20"),
            ("[integrator]\nmethod = \"implicit-midpoint\"\nstep = 0.01", "or a smaller integrator.step", "bdf2"),
            ("[integrator]\nmethod = \"rk4\"", "or an implicit method", "or an implicit method"),
            ("[integrator]\nnewton = 5", "take a smaller integrator.error", "more than integrator.newton = 5"),
            (contact, "take a smaller integrator.error", "take a smaller integrator.error"),
            (&format!("{contact}[integrator]\nnewton = 5"), "a smaller", "take integrator.newton = 1"),
        ] {
            let scene = scene(sections);
            let said = [of_steps(&scene), of_solves(&scene)];
            assert!(said[0].contains(steps) && said[1].contains(solves), "{sections}: {said:?}");
        }
    }
}
