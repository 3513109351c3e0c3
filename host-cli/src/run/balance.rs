//! The balance of energy over the frames of a run. Energy that neither was there nor was given from outside comes from errors.

/// What the frames so far have shown, J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Work done on the cloth: by pins, colliders, wind, and gravity that changes, and the amounts of all steps together.
    pub work: [f64; 5],
    /// Least energy without the work.
    least: f64,
    /// Largest growth of this difference from its least value.
    pub appeared: f64,
    /// Largest sum of the energies without gravity.
    active: f64,
    /// Least and largest energy of gravity, without the work of gravity that changes: by how much the cloth fell, wherever
    /// heights count from.
    gravity: [f64; 2],
}

/// Number of words in an encoded balance.
pub const WORDS: usize = 10;

impl Default for Balance {
    fn default() -> Self {
        Self {
            work: [0.0; 5],
            least: f64::INFINITY,
            appeared: 0.0,
            active: 0.0,
            gravity: [f64::INFINITY, f64::NEG_INFINITY],
        }
    }
}

impl Balance {
    /// Observes a frame: its energies (kinetic, stretch, shear, bend, seam, gravity) and the work done up to now.
    pub fn see(&mut self, energy: &[f64; 6], [pins, colliders, wind, changes, exchanged]: [f64; 5]) {
        let [kinetic, stretch, shear, bend, seam, gravity] = *energy;
        let gravity = gravity - changes;
        let active = kinetic + stretch + shear + bend + seam;
        let without_work = active + gravity - (pins + colliders + wind);
        self.work = [pins, colliders, wind, changes, exchanged];
        self.least = self.least.min(without_work);
        self.appeared = self.appeared.max(without_work - self.least);
        self.active = self.active.max(active);
        self.gravity = [self.gravity[0].min(gravity), self.gravity[1].max(gravity)];
    }

    /// The largest energy that moved, by which the energy that appeared is measured.
    pub fn moved(&self) -> f64 {
        self.active.max(self.gravity[1] - self.gravity[0]).max(self.work[4])
    }

    /// Encodes the balance as words.
    pub fn encode(&self) -> [u64; WORDS] {
        let Self { work: [a, b, c, d, e], least, appeared, active, gravity: [low, high] } = *self;
        [a, b, c, d, e, least, appeared, active, low, high].map(f64::to_bits)
    }

    /// Decodes a balance.
    pub fn decode(words: [u64; WORDS]) -> Self {
        let [a, b, c, d, e, least, appeared, active, low, high] = words.map(f64::from_bits);
        Self { work: [a, b, c, d, e], least, appeared, active, gravity: [low, high] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_appears_where_it_grows_without_work() {
        let mut balance = Balance::default();
        balance.see(&[0.0, 0.0, 0.0, 0.0, 0.0, 5.0], [0.0; 5]);
        // It falls, and loses 1 J.
        balance.see(&[2.0, 1.0, 0.0, 0.0, 0.0, 1.0], [0.0; 5]);
        assert_eq!((balance.appeared, balance.moved()), (0.0, 4.0));
        // A pin gives 3 J.
        balance.see(&[2.0, 4.0, 0.0, 0.0, 0.0, 1.0], [3.0, 0.0, 0.0, 0.0, 3.0]);
        assert_eq!(balance.appeared, 0.0);
        // 2 J appear, and are lost again.
        balance.see(&[4.0, 4.0, 0.0, 0.0, 0.0, 1.0], [3.0, 0.0, 0.0, 0.0, 3.0]);
        balance.see(&[1.0, 4.0, 0.0, 0.0, 0.0, 1.0], [3.0, 0.0, 0.0, 0.0, 3.0]);
        assert_eq!(balance.appeared, 2.0);
        assert_eq!(Balance::decode(balance.encode()), balance);
    }

    #[test]
    fn gravity_that_changes_neither_makes_energy_appear_nor_counts_as_a_fall() {
        let mut balance = Balance::default();
        balance.see(&[0.0, 0.0, 0.0, 0.0, 0.0, 5.0], [0.0; 5]);
        // At a height where gravity turns round, it gives 10 J of potential energy, of which 1 J becomes motion.
        balance.see(&[1.0, 0.0, 0.0, 0.0, 0.0, -6.0], [0.0, 0.0, 0.0, -10.0, 0.0]);
        assert_eq!((balance.appeared, balance.moved()), (0.0, 1.0));
        // 3 J appear.
        balance.see(&[4.0, 0.0, 0.0, 0.0, 0.0, 4.0], [0.0; 5]);
        assert_eq!((balance.appeared, balance.moved()), (3.0, 4.0));
    }
}
