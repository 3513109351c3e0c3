//! Warnings of a scene and of its run: settings that do not suit it, and signs that its result is wrong.
//!
//! A warning is a code and two numbers. Hosts put it into words of their own.

use crate::balance::Balance;
use crate::integrate::Method;
use crate::integrate::stability::{Mode, longest_step};
use crate::scene::SceneDesc;

/// The subject of a warning: the meaning of its value, and of the number beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Code {
    /// The step of the scene, s, does not divide a frame; the step that is taken.
    Step,
    /// The duration of the scene, s, is no whole number of frames; the duration that is taken.
    Duration,
    /// The thickness of contact, m, does not suit the edges; their mean length.
    Thickness,
    /// The largest rigidity of hinges over the one asked for, of all directions; the largest that needs no warning.
    Rigidity,
    /// How far pins or colliders are, within a fixed step, from the straight and even way that it takes them, m; the
    /// distance that needs no warning.
    Motion,
    /// The largest error of error control, m; the one that needs no warning, for the smallest cloth.
    Error,
    /// Step x (step x stiffness + damping) over the mass of a vertex is so large that single precision loses masses;
    /// the largest ratio at which it loses little.
    Masses,
    /// The step, s, is longer than the limit of the explicit method at the start; this limit.
    Unstable,
    /// Energy, J, appeared from nowhere; the largest energy that moved.
    Energy,
    /// The largest ratio of edge length to rest length; the largest that cloth has.
    Stretch,
    /// The number of solves that ended above their tolerance; the number of steps.
    Unconverged,
    /// The largest rounding of a position, relative to an edge; the largest that does not show.
    Rounding,
    /// Energy, J, by moving overlapping surfaces apart; the largest energy that moved.
    Overlap,
    /// Energy, J, that the method itself took from the motion; the largest energy that moved.
    Method,
    /// The number of substeps with too large an error; the number of all substeps.
    Exceeding,
    /// Limit of the iterations of Newton's method in a run with contacts, which they leave out; the limit that needs no
    /// warning.
    Newton,
}

impl Code {
    /// Its name, for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Duration => "duration",
            Self::Thickness => "thickness",
            Self::Rigidity => "rigidity",
            Self::Motion => "motion",
            Self::Error => "error",
            Self::Masses => "masses",
            Self::Unstable => "unstable",
            Self::Energy => "energy",
            Self::Stretch => "stretch",
            Self::Unconverged => "unconverged",
            Self::Rounding => "rounding",
            Self::Overlap => "overlap",
            Self::Method => "method",
            Self::Exceeding => "exceeding",
            Self::Newton => "newton",
        }
    }
}

/// A warning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warning {
    /// Its subject.
    pub code: Code,
    /// The number that is too large or too small.
    pub value: f64,
    /// The number that it is compared with.
    pub beside: f64,
    /// Whether the result of the run is probably wrong.
    pub is_doubtful: bool,
}

impl Warning {
    fn new(code: Code, value: f64, beside: f64) -> Self {
        Self { code, value, beside, is_doubtful: false }
    }
}

/// Smallest and largest ratio of thickness to mean edge length at which contact works as expected.
const THICKNESS: [f64; 2] = [1e-4, 1.0];

/// Largest rigidity of hinges over the one asked for. Alternating diagonals on squares have 1.5 if their vertices are held
/// on a cylinder, and a single row of equilateral triangles too; parallel diagonals have 3.
const MOST_RIGID: f64 = 1.6;

/// Largest deviation of pins and colliders from the way that fixed steps take them, relative to the size of the cloth,
/// and the one beyond which the result is doubtful: cloth does not feel it.
const DEVIATION: [f64; 2] = [0.01, 0.05];

/// Largest error of error control, relative to the size of the smallest cloth. A pendulum of ten times the error loses
/// its swing.
const MOST_ERROR: f64 = 0.01;

/// Rounding of a number in single precision, relative to it.
const ROUNDING: f64 = 1.0 / (1 << 24) as f64;

/// Part of its size that the cloth may lose by the bound of [`masses`]. Of 31 scenes from seeds, nine tenths lost less
/// than the bound, and half of them less than 3 % of it. Among 1,000 scenes no more wrong runs are found at 0.02, and
/// more good ones are warned of.
const MOST_LOST: f64 = 0.03;

/// The bound of [`masses`] on the lost part of its size from which the result is doubtful. Two scenes from seeds with
/// bounds of 1 to 10 both lost less than 1 %.
const LOST: f64 = 10.0;

/// Way of cloth that nothing moves, relative to its size: rounding of the stiffness moves it too. In 16 of 18 scenes
/// from seeds, cloth at rest moved by less than this part of the bound.
const AT_REST: f64 = 1e-4;

/// Ratio of edge length to rest length beyond which cloth is not stretched.
const TOO_LONG: f64 = 1.3;

/// Energy that may appear by errors, relative to the largest energy that moved. Built-in scenes stay below a tenth,
/// their first 50 ms below a fifth; where cloth flies apart it is nearly all of it.
const MOST_APPEARED: f64 = 0.2;

/// Energy that the method may take, relative to the largest energy that moved.
const MOST_TAKEN: f64 = 0.5;

/// Energy that the method may take from rotations, relative to the largest energy that moved.
const MOST_UNTURNED: f64 = 0.1;

/// Energy that may appear where there is contact, relative to that of lifting the cloth by the thickness: cloth that
/// comes to rest settles within the thickness. Sheets that stuck at once on a slope showed up to 0.25 of it.
const SETTLING: f64 = 0.5;

/// Energy by moving overlapping surfaces apart, relative to the largest energy that moved. A sleeve that starts inside
/// the thickness is stretched once: all of the energy that moves is from this. A belt that stayed rough had nine times
/// the energy that moved.
const MOST_SEPARATED: f64 = 2.0;

/// Way, relative to the size of the cloth, on which the energy that appeared could have taken a vertex: if it is
/// shorter, the energy did no harm.
const HARMLESS_WAY: f64 = 1e-3;

/// Way on which this energy could have taken all vertices together: if it is longer, rounding is no excuse. A light and
/// stiff sheet in f32, off by 1.5 % of its size, could have gone 4 %.
const HARMFUL_WAY: f64 = 1e-2;

/// Energy by rounding, relative to that of a cloth whose edges are all strained by the rounding of a position. Cloth at
/// rest showed up to 11 times this energy.
const BY_ROUNDING: f64 = 16.0;

/// Part of the steps whose solve may end above the tolerance; a single one may in any run.
const MOST_UNCONVERGED: f64 = 0.05;

/// Largest rounding of positions, relative to the mean length of an edge.
const MOST_ROUNDED: f64 = 0.01;

/// A scene before its first step.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// [Harmonic mean](crate::scene::BuiltScene::mean_edge) of the rest lengths of all edges, m.
    pub mean_edge: f64,
    /// Largest side of the box around the cloth, m.
    pub size: f64,
    /// The same of the smallest cloth, m.
    pub smallest: f64,
    /// Total mass, kg.
    pub mass: f64,
    /// Largest rigidity of hinges over the one asked for; 0 without hinges.
    pub rigidity: f64,
    /// Largest deviation of pins and colliders in a step from their straight and even way, m
    /// ([`BuiltScene::largest_deviation`](crate::scene::BuiltScene::largest_deviation)).
    pub deviation: f64,
    /// Whether steps are taken in single precision.
    pub is_single: bool,
}

/// The warnings of settings that do not suit the scene. `modes` gives the fastest modes of the start state to about one
/// per cent; it is called only where they matter.
#[cfg_attr(small, optimize(size))]
pub fn of_settings(scene: &SceneDesc, start: &Start, modes: impl FnOnce() -> [Mode; 2]) -> [Option<Warning>; 7] {
    let (method, timing) = (scene.integrator.method, scene.timing());
    // Nobody asked for a default.
    let asked = scene.integrator.step.unwrap_or(timing.step);
    let is_changed = asked > 1.001 / scene.frame_rate || timing.step < 0.9 * asked;
    let taken = timing.frames as f64 / scene.frame_rate;
    let is_cut = (taken - scene.duration).abs() > 1e-6 * scene.duration;
    let thickness = scene.contact.as_ref().map(|contact| contact.thickness);
    let [low, high] = THICKNESS.map(|ratio| ratio * start.mean_edge);
    let unsuited = thickness.filter(|&thickness| thickness > high || thickness < low);
    let error = scene.integrator.error().filter(|&error| error > 1.001 * MOST_ERROR * start.smallest);
    let of_step = match (method.is_implicit(), start.is_single) {
        (true, false) => None,
        // Error control takes shorter steps: it is judged by their number at the end.
        (true, true) if scene.integrator.error().is_some() => None,
        (true, true) => masses(&modes(), scene, start.size, start.mass, timing.step),
        (false, _) => {
            let limit = longest_step(&modes(), method).filter(|&longest| timing.step > longest);
            limit.map(|longest| Warning::new(Code::Unstable, timing.step, longest))
        }
    };
    [
        is_changed.then(|| Warning::new(Code::Step, asked, timing.step)),
        is_cut.then(|| Warning::new(Code::Duration, scene.duration, taken)),
        unsuited.map(|thickness| Warning::new(Code::Thickness, thickness, start.mean_edge)),
        (start.rigidity > MOST_RIGID).then(|| Warning::new(Code::Rigidity, start.rigidity, MOST_RIGID)),
        motion(scene, start),
        error.map(|error| Warning::new(Code::Error, error, MOST_ERROR * start.smallest)),
        of_step,
    ]
}

/// The warning that pins or colliders do not move straight in fixed steps. Error control shortens such steps.
fn motion(scene: &SceneDesc, start: &Start) -> Option<Warning> {
    let [most, wrong] = DEVIATION.map(|part| part * start.size);
    let is_curved = scene.integrator.error().is_none() && start.deviation > most;
    let is_doubtful = start.deviation > wrong;
    is_curved.then(|| Warning { is_doubtful, ..Warning::new(Code::Motion, start.deviation, most) })
}

/// The warning that single precision loses masses beside the stiffness in steps of this length, s; `size` is that of
/// the cloth, m, and `mass` its mass, kg.
///
/// The matrix of an implicit step is `M + h^2 K + h D`. Single precision rounds it by 2^-24 of its largest part, which
/// is `(h^2 lambda + h delta) M`, where lambda and delta are the largest eigenvalues of `M^-1 K` and `M^-1 D`. So up to
/// 2^-24 of this factor is lost of the masses, and as large a part of the [way](SceneDesc::way) of the cloth. Cloth
/// that goes no way loses little, however stiff it is. Where ten times the way may be lost, the result is doubtful, unless
/// pins hold the cloth.
#[cfg_attr(small, optimize(size))]
pub fn masses(modes: &[Mode; 2], scene: &SceneDesc, size: f64, mass: f64, step: f64) -> Option<Warning> {
    let ratio = modes.iter().map(|mode| step * (step * mode.stiffness + mode.damping)).fold(0.0, f64::max);
    let way = scene.way(size, mass) / size;
    let most = MOST_LOST / (ROUNDING * (way.min(1.0) + AT_REST));
    // Cloth that pins hold cannot go the way of a free one.
    let is_held = scene.cloth.iter().any(|cloth| !cloth.pin.is_empty());
    let is_doubtful = ROUNDING * ratio * way > LOST && !is_held;
    (ratio > most).then(|| Warning { is_doubtful, ..Warning::new(Code::Masses, ratio, most) })
}

/// A run up to now.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// The balance of energy over its frames.
    pub balance: &'a Balance,
    /// Energy that the method added, or took if it is negative, J, if it is [known](Balance::by_method).
    pub by_method: Option<f64>,
    /// Contacts within the thickness, and impacts.
    pub contacts: [u64; 2],
    /// Total mass, kg.
    pub mass: f64,
    /// Number of vertices.
    pub vertices: usize,
    /// Largest side of the box around the cloth at the start, m.
    pub size: f64,
    /// Simulated time, s.
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Largest ratio of edge length to rest length in any frame.
    pub stretch: f64,
    /// Largest rounding of a position in any frame, relative to the mean length of an edge.
    pub rounding: f64,
    /// Solves that ended above their tolerance.
    pub unconverged: u64,
    /// Substeps, and those among them with too large an error.
    pub substeps: [u64; 2],
}

/// The signs that the result of a run is wrong, those of a doubtful result first.
#[cfg_attr(small, optimize(size))]
pub fn of_run(scene: &SceneDesc, run: &Run<'_>) -> [Option<Warning>; 8] {
    let Run { balance, stretch, rounding, unconverged, substeps: [substeps, exceeding], .. } = *run;
    let appeared = run.appeared(scene);
    let most = (MOST_APPEARED * balance.moved()).max(SETTLING * run.lift(scene));
    let appeared = (appeared > most && run.is_harmful(appeared, scene))
        .then(|| Warning { is_doubtful: true, ..Warning::new(Code::Energy, appeared, balance.moved()) });
    // The loads have stretched cloth without energy that appeared, so a large stretch is no reason for doubt.
    let stretched = (stretch > TOO_LONG).then(|| Warning::new(Code::Stretch, stretch, TOO_LONG));
    let unconverged = (unconverged > 0).then(|| {
        let [count, steps] = [unconverged, run.steps].map(|count| count as f64);
        // Newton's method iterates without the contacts: under tension all of its steps with contacts are wrong.
        let is_contact_left_out = scene.contact.is_some() && scene.integrator.newton > 1;
        let is_doubtful = unconverged > 1 && (is_contact_left_out || count > MOST_UNCONVERGED * steps);
        Warning { is_doubtful, ..Warning::new(Code::Unconverged, count, steps) }
    });
    let rounded = (rounding > MOST_ROUNDED)
        .then(|| Warning { is_doubtful: true, ..Warning::new(Code::Rounding, rounding, MOST_ROUNDED) });
    let exceeds = (exceeding > 0).then(|| Warning::new(Code::Exceeding, exceeding as f64, substeps as f64));
    [appeared, stretched, unconverged, rounded, run.overlap(scene), run.taken(scene), exceeds, run.newton(scene)]
}

/// Whether the energy [by the method](Balance::by_method) is known: nothing damps, or the work of damping is measured.
/// With reactions it is measured always, else only by implicit midpoint without contact. That method damps in the middle of
/// a step, where the work is measured; the other implicit methods damp at its end.
pub fn is_method_known(scene: &SceneDesc, dissipates: bool, has_reactions: bool) -> bool {
    let measures_damping = scene.contact.is_none() && scene.integrator.method == Method::ImplicitMidpoint;
    !dissipates || has_reactions || measures_damping
}

impl Run<'_> {
    /// Energy that appeared. Damping may have taken it already: then it is in the work of the method. Methods that damp at
    /// the end of a step take less than is [measured](crate::work_done) in its middle, so theirs does not count.
    fn appeared(&self, scene: &SceneDesc) -> f64 {
        let damps_at_end = matches!(scene.integrator.method, Method::BackwardEuler | Method::Bdf2);
        let damped = if damps_at_end { self.balance.work.damping } else { 0.0 };
        self.balance.appeared.max(self.by_method.unwrap_or(0.0) + damped)
    }

    /// Energy of lifting the whole cloth by the thickness of contact.
    fn lift(&self, scene: &SceneDesc) -> f64 {
        let thickness = scene.contact.as_ref().map_or(0.0, |contact| contact.thickness);
        self.mass * scene.largest_gravity() * thickness
    }

    /// Energy by moving overlapping surfaces apart. It is a reason for doubt if it is more than lifting the whole cloth
    /// by the thickness takes: then surfaces overlap again and again, and friction acts as by chance.
    fn overlap(&self, scene: &SceneDesc) -> Option<Warning> {
        let (separation, moved) = (self.balance.work.separation, self.balance.moved());
        let is_much = separation > MOST_SEPARATED * moved;
        (is_much && self.is_harmful(separation, scene)).then(|| {
            let is_doubtful = separation > self.lift(scene);
            Warning { is_doubtful, ..Warning::new(Code::Overlap, separation, moved) }
        })
    }

    /// Energy that the method itself took from the motion, or where that is not known or little, from rotations. A run
    /// to rest is meant to lose it.
    fn taken(&self, scene: &SceneDesc) -> Option<Warning> {
        let moved = self.balance.moved();
        // In a perfectly plastic impact, the method takes the energy that contacts leave.
        let by_method = self.by_method.filter(|_| self.contacts == [0, 0]);
        let of_all = by_method.map_or(0.0, |by_method| -by_method);
        let found = [(of_all, MOST_TAKEN), (self.balance.unturned, MOST_UNTURNED)].into_iter();
        let taken = found.filter(|&(taken, most)| taken > most * moved).map(|(taken, _)| taken).reduce(f64::max)?;
        (scene.until_rest.is_none() && self.is_harmful(taken, scene)).then(|| Warning::new(Code::Method, taken, moved))
    }

    /// Newton's method in a run with contacts.
    fn newton(&self, scene: &SceneDesc) -> Option<Warning> {
        let iterations = if scene.integrator.method.is_implicit() { scene.integrator.newton } else { 1 };
        (iterations > 1 && self.contacts != [0, 0]).then(|| Warning::new(Code::Newton, iterations.into(), 1.0))
    }

    /// Whether an energy would take one vertex farther than [`HARMLESS_WAY`], and is either more than rounding gives or
    /// would take all vertices farther than [`HARMFUL_WAY`], each from the start.
    fn is_harmful(&self, energy: f64, scene: &SceneDesc) -> bool {
        // Squares of the speed of sound in the cloth, m^2/s^2.
        let squares = scene.cloth.iter().filter_map(|cloth| {
            let stretch = cloth.stretch.as_ref()?;
            Some(stretch.stiffness.max(stretch.weft.unwrap_or(0.0)) / cloth.density)
        });
        let rounded = 0.5 * self.mass * squares.fold(0.0, f64::max) * self.rounding * self.rounding;
        let vertices = self.vertices as f64;
        let way = libm::sqrt(2.0 * energy * vertices / self.mass) * self.time / self.size;
        let of_all = way / libm::sqrt(vertices);
        way > HARMLESS_WAY && (energy > BY_ROUNDING * rounded || of_all > HARMFUL_WAY)
    }
}
