//! Observations of a run up to now. A checkpoint stores them, so that a resumed run reports on the whole run.

use muslin_core::balance::{self, Balance};

/// Observations of the start state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Crossings of the state that the scene describes; `None` if they were not counted.
    pub crossings: Option<u64>,
    /// Number of these crossings that were untangled; `None` without contact.
    pub untangled: Option<u64>,
}

/// Observations of the start state, and the worst values of all frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Record {
    /// The start state.
    pub start: Start,
    /// Extent of the first frame, m.
    pub size: [f64; 3],
    /// Largest stretch of all frames.
    pub stretch: f64,
    /// Largest stretch of the first frame.
    pub first_stretch: f64,
    /// The balance of energy.
    pub balance: Balance,
    /// Whether reactions are measured, and the work of contacts and damping.
    pub measures_reactions: bool,
    /// Largest rounding of a position, relative to the mean length of an edge.
    pub rounding: f64,
    /// Largest speed in the present frame, m/s, where a run ends at rest.
    pub fastest: f64,
    /// Deepest penetration into a collider, m.
    pub penetration: Option<f64>,
    /// Frames that the audit tested for crossings.
    pub audited: u64,
    /// Crossings of the worst of these frames, and the number of that frame; `None` without an audit.
    pub crossings: Option<(u64, u64)>,
    /// Whether the audit of the last frame was interrupted.
    pub awaits_audit: bool,
}

/// Number of words in an encoded record.
pub const WORDS: usize = 19 + balance::WORDS;

impl Record {
    /// Encodes the record as words.
    pub fn encode(&self) -> [u64; WORDS] {
        let Self { start, size: [x, y, z], stretch, first_stretch, balance, rounding, fastest, .. } = *self;
        let Self { penetration, audited, crossings, awaits_audit, measures_reactions, .. } = *self;
        let known = |value: Option<u64>| [u64::from(value.is_some()), value.unwrap_or(0)];
        let ([a, b], [c, d]) = (known(start.crossings), known(start.untangled));
        let [e, f] = known(penetration.map(f64::to_bits));
        let [g, h] = known(crossings.map(|(count, _)| count));
        let frame = crossings.map_or(0, |(_, frame)| frame);
        let [stretch, first, rounding, fastest] = [stretch, first_stretch, rounding, fastest].map(f64::to_bits);
        let [x, y, z] = [x, y, z].map(f64::to_bits);
        let own = [a, b, c, d, x, y, z, stretch, first, e, f, audited, g, h, frame, rounding, fastest];
        let all = own.into_iter().chain([awaits_audit, measures_reactions].map(u64::from)).chain(balance.encode());
        let mut words = [0; WORDS];
        words.iter_mut().zip(all).for_each(|(word, value)| *word = value);
        words
    }

    /// Decodes a record.
    pub fn decode(words: [u64; WORDS]) -> Self {
        let [a, b, c, d, x, y, z, stretch, first, e, f, audited, g, h, frame, rounding, fastest, rest @ ..] = words;
        let [awaits_audit, measures_reactions, balance @ ..] = rest;
        let known = |is: u64, value: u64| (is != 0).then_some(value);
        Self {
            start: Start { crossings: known(a, b), untangled: known(c, d) },
            size: [x, y, z].map(f64::from_bits),
            stretch: f64::from_bits(stretch),
            first_stretch: f64::from_bits(first),
            balance: Balance::decode(balance),
            measures_reactions: measures_reactions != 0,
            rounding: f64::from_bits(rounding),
            fastest: f64::from_bits(fastest),
            penetration: known(e, f).map(f64::from_bits),
            audited,
            crossings: known(g, h).map(|count| (count, frame)),
            awaits_audit: awaits_audit != 0,
        }
    }
}
