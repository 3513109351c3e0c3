//! Watches a run as `muslin run` does, so that it gives the same warnings.

use std::cell::OnceCell;

use muslin_core::balance::Balance;
use muslin_core::diagnostics::extent;
use muslin_core::integrate::stability::Mode;
use muslin_core::scene::SceneDesc;
use muslin_core::simulation::Simulation;
use muslin_core::spectrum::fastest_modes;
use muslin_core::warning::{self, Run, Start, Warning};
use muslin_core::work_done::WorkDone;

use crate::clock::Clock;

/// Iterations that give the frequency of the fastest mode to about one per cent.
const ITERATIONS: u32 = 100;

/// Observations of the frames of a run.
pub struct Watch {
    /// Warnings from before the first step.
    of_settings: [Option<Warning>; 7],
    steps_per_frame: u64,
    /// Length of a frame, s.
    frame: f64,
    /// Largest side of the box around the cloth at the start, m.
    size: f64,
    balance: Balance,
    /// Worst values of all frames.
    stretch: f64,
    rounding: f64,
    /// The fastest modes of the run, which judge the steps of error control.
    modes: OnceCell<[Mode; 2]>,
}

impl Watch {
    /// Begins at the current state, as the first frame.
    #[cfg_attr(small, optimize(size))]
    pub fn begin(cloth: &mut Simulation, scene: &SceneDesc, clock: &Clock) -> Self {
        cloth.measure_work(WorkDone::default());
        let size = extent(cloth.places_in_world()).into_iter().fold(0.0, f64::max);
        let (mean_edge, rigidity) = (cloth.scene().mean_edge(), cloth.scene().largest_rigidity);
        let smallest = cloth.scene().smallest_size();
        let deviation = cloth.scene().largest_deviation(scene.timing().step, scene.duration);
        let start = Start { mean_edge, size, smallest, mass: mass(cloth), rigidity, deviation, is_single: true };
        let mut watch = Self {
            of_settings: warning::of_settings(scene, &start, || modes(cloth, clock)),
            steps_per_frame: scene.timing().steps_per_frame,
            frame: scene.timing().step * scene.timing().steps_per_frame as f64,
            size,
            balance: Balance::default(),
            stretch: 0.0,
            rounding: 0.0,
            modes: OnceCell::new(),
        };
        watch.frame(cloth);
        watch
    }

    /// Observes a step.
    pub fn step(&mut self, cloth: &Simulation) {
        if cloth.state().steps.is_multiple_of(self.steps_per_frame) {
            self.frame(cloth);
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn frame(&mut self, cloth: &Simulation) {
        self.stretch = self.stretch.max(cloth.stretch().max);
        self.rounding = self.rounding.max(cloth.rounding());
        self.balance.see(&energy(cloth), cloth.work_done());
        let [rotation, power] = cloth.rotation();
        self.balance.see_rotation(rotation, power * self.frame);
    }

    /// The warnings up to now. Under error control the first call finds the fastest modes.
    #[cfg_attr(small, optimize(size))]
    pub fn warnings(&self, cloth: &Simulation, scene: &SceneDesc, clock: &Clock) -> Vec<Warning> {
        let (work, contact, time) = (cloth.statistics(), cloth.contact_statistics(), cloth.time());
        let is_method_known = warning::is_method_known(scene, cloth.model().dissipates(), false);
        let mut balance = self.balance;
        balance.work = cloth.work_done();
        let of_run = warning::of_run(
            scene,
            &Run {
                balance: &balance,
                by_method: is_method_known.then(|| balance.by_method(&energy(cloth))),
                contacts: [contact.proximity, contact.impacts],
                mass: mass(cloth),
                vertices: cloth.positions().len(),
                size: self.size,
                time,
                steps: cloth.state().steps,
                stretch: self.stretch,
                rounding: self.rounding,
                unconverged: work.unconverged,
                substeps: [work.committed, work.exceeding],
            },
        );
        let masses = scene.integrator.error().filter(|_| time > 0.0).and_then(|_| {
            let modes = self.modes.get_or_init(|| modes(cloth, clock));
            warning::masses(modes, scene, self.size, mass(cloth), time / work.committed.max(1) as f64)
        });
        let mut all = Vec::new();
        all.extend(self.of_settings.into_iter().flatten());
        all.extend(of_run.into_iter().flatten());
        all.extend(masses);
        all
    }
}

fn modes(cloth: &Simulation, clock: &Clock) -> [Mode; 2] {
    fastest_modes(cloth.scene(), 0.0, ITERATIONS, clock)
}

fn energy(cloth: &Simulation) -> [f64; 6] {
    let e = cloth.energy();
    [e.kinetic, e.stretch, e.shear, e.bend, e.seam, e.gravity]
}

/// Total mass, kg.
#[cfg_attr(small, optimize(size))]
fn mass(cloth: &Simulation) -> f64 {
    cloth.scene().particles.masses.iter().map(|&mass| f64::from(mass)).sum()
}
