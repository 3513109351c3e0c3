//! Observations of a run up to now. A checkpoint stores them, so that a resumed run reports on the whole run.

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
    /// Deepest penetration into a collider, m.
    pub penetration: Option<f64>,
    /// Crossings of the worst frame, and the number of that frame; `None` without an audit.
    pub crossings: Option<(u64, u64)>,
}

/// Number of words in an encoded record.
pub const WORDS: usize = 14;

impl Record {
    /// Encodes the record as words.
    pub fn encode(&self) -> [u64; WORDS] {
        let Self { start, size: [x, y, z], stretch, first_stretch, penetration, crossings } = *self;
        let known = |value: Option<u64>| [u64::from(value.is_some()), value.unwrap_or(0)];
        let ([a, b], [c, d]) = (known(start.crossings), known(start.untangled));
        let [e, f] = known(penetration.map(f64::to_bits));
        let [g, h] = known(crossings.map(|(count, _)| count));
        let frame = crossings.map_or(0, |(_, frame)| frame);
        let [stretch, first] = [stretch, first_stretch].map(f64::to_bits);
        [a, b, c, d, x.to_bits(), y.to_bits(), z.to_bits(), stretch, first, e, f, g, h, frame]
    }

    /// Decodes a record.
    pub fn decode([a, b, c, d, x, y, z, stretch, first, e, f, g, h, frame]: [u64; WORDS]) -> Self {
        let known = |is: u64, value: u64| (is != 0).then_some(value);
        Self {
            start: Start { crossings: known(a, b), untangled: known(c, d) },
            size: [x, y, z].map(f64::from_bits),
            stretch: f64::from_bits(stretch),
            first_stretch: f64::from_bits(first),
            penetration: known(e, f).map(f64::from_bits),
            crossings: known(g, h).map(|count| (count, frame)),
        }
    }
}

/// Size of the box around positions along each axis, m.
pub fn extent(positions: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
    }
    [0, 1, 2].map(|axis| high[axis] - low[axis])
}
