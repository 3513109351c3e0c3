//! The reason why a simulation cannot go on, and advice.

use muslin_core::scene::SceneDesc;

use crate::engine::Engine;
use crate::run::remedy;

/// The reason why a step cannot be taken.
#[derive(Clone, Debug)]
pub struct Divergence {
    /// What went wrong, in which step and where.
    pub what: String,
    /// Advice to the user; `None` if it depends on the settings of the scene.
    pub advice: Option<&'static str>,
    /// Whether a more stable method may help.
    pub is_instability: bool,
}

impl Divergence {
    /// The divergence of cloth that flew apart, after so many steps. `first` is the largest ratio of edge length to rest
    /// length in the first frame.
    pub fn of_stretch(engine: &dyn Engine, steps: u64, first: f64) -> Option<Self> {
        flown_apart(engine.largest_stretch(), first).map(|how| Self {
            what: format!("diverged in step {steps}: {how}"),
            advice: None,
            is_instability: false,
        })
    }

    /// What went wrong, and advice.
    pub fn in_words(&self, scene: &SceneDesc) -> String {
        let method = self.is_instability && !scene.integrator.method.is_implicit();
        let advice = self.advice.map_or_else(|| against_flying_apart(scene), str::to_owned);
        format!("{}; {advice}{}", self.what, if method { ", or an implicit method" } else { "" })
    }
}

/// Ratio of edge length to rest length beyond which the cloth has flown apart, unless it starts with a larger
/// ratio. Rubber and elastane, the most extensible materials, break at six to nine times their length.
const FLOWN_APART: f64 = 10.0;

/// Describes the stretch of cloth that has flown apart, even if all numbers are still finite; otherwise `None`.
/// `stretch` is the largest ratio now, `first` the largest ratio in the first frame.
pub fn flown_apart(stretch: f64, first: f64) -> Option<String> {
    (stretch > FLOWN_APART * first.max(1.0)).then(|| match stretch {
        endless if endless.is_infinite() => "the length of an edge is not a finite number".to_owned(),
        few if few < 1e4 => format!("an edge is {few:.0} times as long as at rest"),
        many => format!("an edge is {many:.1e} times as long as at rest"),
    })
}

/// Advice for cloth that flew apart.
fn against_flying_apart(scene: &SceneDesc) -> String {
    let loads = match scene.cloth.iter().any(|cloth| !cloth.load.is_empty()) {
        true => "; a load on a light edge also needs a shorter step, or mass there",
        false => "; cloth that its own weight stretches must be stiffer",
    };
    remedy::of_steps(scene) + loads
}
