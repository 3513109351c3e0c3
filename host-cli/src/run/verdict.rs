//! The verdict on a run, and the warnings of its end: signs that the result is wrong, although the run reached its end.

use muslin_core::integrate::Method;
use muslin_core::scene::{SceneDesc, StretchModel};

use super::{masses, remedy};
use crate::device::StepDetector;
use crate::pool::Pool;
use crate::record::Record;
use crate::summary::{ErrorControl, Summary, percent};
use crate::warning::Warning;

/// Ratio of edge length to rest length beyond which cloth is not stretched.
const TOO_LONG: f64 = 1.3;

/// Energy that may appear by errors, relative to the largest energy that moved. Built-in scenes stay below a tenth, their first
/// tenth of a second below a third; where cloth flies apart it is nearly all of it.
const MOST_APPEARED: f64 = 0.5;

/// Way, relative to the size of the cloth, on which the energy that appeared could have taken a vertex: if it is shorter, the
/// energy did no harm.
const HARMLESS_WAY: f64 = 1e-3;

/// Way on which this energy could have taken all vertices together: if it is longer, rounding is no excuse. A light and stiff
/// sheet in f32, off by 1.5 % of its size, could have gone 4 %.
const HARMFUL_WAY: f64 = 1e-2;

/// Energy by rounding, relative to that of a cloth whose edges are all strained by the rounding of a position. Cloth at rest
/// showed up to 11 times this energy.
const BY_ROUNDING: f64 = 16.0;

/// Part of the steps whose solve may end above the tolerance; a single one may in any run.
const MOST_UNCONVERGED: f64 = 0.05;

/// Largest rounding of positions, relative to the mean length of an edge.
const MOST_ROUNDED: f64 = 0.01;

impl Summary {
    /// Adds the warnings and decides the verdict.
    pub fn judge(&mut self, record: &Record, scene: &SceneDesc, pool: &Pool) {
        let audited = record.crossings.is_some_and(|(count, _)| count > 0);
        let appeared = self.appeared(record, scene);
        let stretched = self.stretched(scene, appeared.is_some());
        let doubts = [
            appeared,
            stretched,
            self.unconverged(scene),
            rounded(record),
            self.overlap(record, scene),
            self.taken(record, scene),
        ];
        let reached_the_end = self.divergence.is_none();
        let of_end: Vec<_> = doubts.into_iter().flatten().filter(|_| reached_the_end).collect();
        let doubt = of_end.iter().find(|(is_doubtful, _)| *is_doubtful).map(|(_, warning)| warning.text.clone());
        (self.verdict, self.doubt) = match (reached_the_end, audited, doubt) {
            (false, _, _) => ("diverged", None),
            (true, true, _) => ("intersecting", None),
            (true, false, Some(doubt)) => ("doubtful", Some(doubt)),
            (true, false, None) => ("ok", None),
        };
        self.warnings.extend(of_end.into_iter().map(|(_, warning)| warning));
        self.warnings.extend(self.exceeding());
        self.warnings.extend(self.audit_gap());
        self.warnings.extend(pool.detector().map(StepDetector::warnings).unwrap_or_default());
    }

    /// Energy that came from nowhere.
    fn appeared(&self, record: &Record, scene: &SceneDesc) -> Option<(bool, Warning)> {
        let (appeared, moved) = (record.balance.appeared, record.balance.moved());
        (appeared > MOST_APPEARED * moved && self.is_harmful(appeared, record.rounding, scene)).then(|| {
            let text = format!(
                "{appeared:.2e} J of energy appeared from nowhere, {:.0} % of the largest energy that moved ({moved:.2e} J): {}{}",
                1e2 * appeared / moved,
                remedy::of_steps(scene),
                self.rest(scene)
            );
            (true, Warning::new("energy", text))
        })
    }

    /// A sentence on the equilibrium of a run that ended at rest. With friction it depends on the motion before it.
    fn rest(&self, scene: &SceneDesc) -> &'static str {
        match (self.at_rest, &scene.contact) {
            (Some(true), None) => {
                ". The run ended at rest, where the forces balance: the motion before it is doubtful, and this state is \
                 an equilibrium"
            }
            _ => "",
        }
    }

    /// Energy by moving overlapping surfaces apart. It is a reason for doubt if it is more than lifting the whole cloth by the
    /// thickness takes.
    fn overlap(&self, record: &Record, scene: &SceneDesc) -> Option<(bool, Warning)> {
        let (appeared, moved) = (record.balance.appeared_with_separation, record.balance.moved());
        let separation = self.energy_balance.separation;
        let is_much = separation.min(appeared) > MOST_APPEARED * moved;
        (is_much && self.is_harmful(separation, record.rounding, scene)).then(|| {
            let text = format!(
                "moving overlapping surfaces apart gave {separation:.2e} J, {:.0} % of the largest energy that moved: let \
                 surfaces start farther apart than contact.thickness",
                1e2 * separation / moved
            );
            let thickness = scene.contact.as_ref().map_or(0.0, |contact| contact.thickness);
            let lift = self.mass_kg * masses::largest_gravity(scene) * thickness;
            (separation > lift, Warning::new("overlap", text))
        })
    }

    /// Energy that the method took from a motion that nothing damps. A run to rest is meant to lose it.
    fn taken(&self, record: &Record, scene: &SceneDesc) -> Option<(bool, Warning)> {
        let (taken, moved) = (-self.energy_balance.method?, record.balance.moved());
        (self.is_conservative && self.at_rest.is_none() && taken > MOST_APPEARED * moved).then(|| {
            let text = format!(
                "{} took {taken:.2e} J, {:.0} % of the largest energy that moved, and the scene has no damping: take {} \
                 with integrator.error = 0 and a short integrator.step",
                scene.integrator.method.name(),
                1e2 * taken / moved,
                if scene.integrator.method == Method::Bdf2 { "bdf2" } else { "bdf2 or implicit-midpoint" }
            );
            (false, Warning::new("method", text))
        })
    }

    /// Whether an energy would take one vertex farther than [`HARMLESS_WAY`], and is either more than rounding gives or would
    /// take all vertices farther than [`HARMFUL_WAY`], each from the start.
    fn is_harmful(&self, energy: f64, rounding: f64, scene: &SceneDesc) -> bool {
        // Squares of the speed of sound in the cloth, m^2/s^2.
        let squares = scene.cloth.iter().filter_map(|cloth| {
            let stretch = cloth.stretch.as_ref()?;
            Some(stretch.stiffness.max(stretch.weft.unwrap_or(0.0)) / cloth.density)
        });
        let rounded = 0.5 * self.mass_kg * squares.fold(0.0, f64::max) * rounding * rounding;
        let speed = (2.0 * energy * self.vertices as f64 / self.mass_kg).sqrt();
        let size = self.size_m.into_iter().fold(0.0, f64::max);
        let way = speed * self.simulated_s / size;
        let of_all = way / (self.vertices as f64).sqrt();
        way > HARMLESS_WAY && (energy > BY_ROUNDING * rounded || of_all > HARMFUL_WAY)
    }

    /// Cloth that is stretched too far. It is no reason for doubt: without energy that appeared, the loads have stretched it.
    fn stretched(&self, scene: &SceneDesc, has_appeared: bool) -> Option<(bool, Warning)> {
        let most = self.stretch.max_of_all_frames;
        (most > TOO_LONG).then(|| {
            let shearless = scene.cloth.iter().position(|cloth| {
                cloth.shear.is_none() && cloth.stretch.as_ref().is_some_and(|s| s.model == StretchModel::Membrane)
            });
            let cause = match shearless {
                _ if has_appeared => "energy appeared, so errors of the steps did it".into(),
                Some(cloth) => format!("nothing resists the shear of cloth {cloth}: add [cloth.shear]"),
                None => format!(
                    "check density (kg/m^2), stiffness (N/m), the mesh's size (m), the loads and how far pins and \
                     colliders pull it; if all are right, {}",
                    remedy::of_steps(scene)
                ),
            };
            let text = format!("an edge became {} longer than at rest, more than cloth does: {cause}", percent(most));
            (false, Warning::new("stretch", text))
        })
    }

    /// Solves that ended above their tolerance.
    fn unconverged(&self, scene: &SceneDesc) -> Option<(bool, Warning)> {
        let count = self.work.unconverged;
        (count > 0).then(|| {
            let solves = if count == 1 { "solve" } else { "solves" };
            let text = format!("{count} {solves} ended above the tolerance: {}", remedy::of_solves(scene));
            let is_often = count > 1 && count as f64 > MOST_UNCONVERGED * self.steps as f64;
            (is_often, Warning::new("unconverged", text))
        })
    }

    /// Substeps with too large an error.
    fn exceeding(&self) -> Option<Warning> {
        let control = self.error_control.as_ref().filter(|control| control.exceeding > 0)?;
        let ErrorControl { exceeding, accepted, error_m, .. } = control;
        let text = format!(
            "{exceeding} of {accepted} substeps exceed integrator.error ({} mm): a substep is at least 1/64 of a step; \
             take a shorter integrator.step, or a larger integrator.error",
            (1e3 * error_m) as f32
        );
        Some(Warning::new("exceeding", text))
    }

    /// An audit that did not see all frames; `None` if it saw all of them, or none was to be audited.
    fn audit_gap(&self) -> Option<Warning> {
        let Self { frames, frames_audited: audited, intersections_frame: worst, .. } = self;
        let found = worst.map_or_else(
            || "without intersections".into(),
            |worst| format!("with intersections, most of them in frame {worst}"),
        );
        let text = format!(
            "{audited} of {frames} frames were audited, {found}: nothing is known about the others; run the scene from \
             its start with --audit"
        );
        (1..*frames).contains(audited).then(|| Warning::new("audit-gap", text))
    }
}

/// Cloth that moved so far that its precision rounds its positions.
fn rounded(record: &Record) -> Option<(bool, Warning)> {
    (record.rounding > MOST_ROUNDED).then(|| {
        let text = format!(
            "the cloth moved so far away that its positions are rounded to {:.1} % of an edge: use --precision f64, or \
             begin nearer to where it goes",
            1e2 * record.rounding
        );
        (true, Warning::new("rounding", text))
    })
}
