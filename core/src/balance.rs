//! The balance of energy over the frames of a run. Energy that neither was there nor was given from outside comes from
//! errors.

use crate::work_done::WorkDone;

/// The balance over the frames so far, J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Work done on the cloth.
    pub work: WorkDone,
    /// Energy of the start state.
    start: Option<f64>,
    /// Least energy without the work.
    least: f64,
    /// Largest growth of this difference from its least value.
    pub appeared: f64,
    /// Energy of stretch, shear, bending and seams of the start state.
    strained: f64,
    /// Largest kinetic energy plus the change of this energy since the start: cloth under tension stores energy that does
    /// not move.
    active: f64,
    /// Least and largest energy of gravity, without the work of gravity that changes: by how much the cloth fell,
    /// wherever heights count from.
    gravity: [f64; 2],
    /// Energy of the rotations of all cloths in the last frame.
    rotation: f64,
    /// Energy that the method took from rotations.
    pub unturned: f64,
}

/// Number of words in an encoded balance.
pub const WORDS: usize = 18;

impl Default for Balance {
    fn default() -> Self {
        Self {
            work: WorkDone::default(),
            start: None,
            strained: 0.0,
            least: f64::INFINITY,
            appeared: 0.0,
            active: 0.0,
            gravity: [f64::INFINITY, f64::NEG_INFINITY],
            rotation: 0.0,
            unturned: 0.0,
        }
    }
}

impl Balance {
    /// Observes a frame: its energies (kinetic, stretch, shear, bend, seam, gravity) and the work done up to now.
    pub fn see(&mut self, energy: &[f64; 6], work: WorkDone) {
        let [kinetic, stretch, shear, bend, seam, gravity] = *energy;
        let strained = stretch + shear + bend + seam;
        let total = kinetic + strained + gravity;
        if self.start.is_none() {
            (self.start, self.strained) = (Some(total), strained);
        }
        let without_work = total - work.from_outside() - work.contacts;
        let gravity = gravity - work.gravity;
        self.work = work;
        self.least = self.least.min(without_work);
        self.appeared = self.appeared.max(without_work - self.least);
        self.active = self.active.max(kinetic + (strained - self.strained).abs());
        self.gravity = [self.gravity[0].min(gravity), self.gravity[1].max(gravity)];
    }

    /// Observes the energy of the rotations in a frame, and the energy that the method took from them since the frame
    /// before. Not more is taken than is lost: where pins or friction hold a rotation, they replace it.
    pub fn see_rotation(&mut self, energy: f64, taken: f64) {
        self.unturned += (self.rotation - energy).min(taken).max(0.0);
        self.rotation = energy;
    }

    /// The largest energy that moved, by which the energy that appeared is measured.
    pub fn moved(&self) -> f64 {
        self.active.max(self.gravity[1] - self.gravity[0]).max(self.work.exchanged)
    }

    /// The energy that the method added up to a state with these energies, or took if it is negative. It is complete if
    /// the work of damping is [measured](crate::reactions), or if there is no damping.
    pub fn by_method(&self, energy: &[f64; 6]) -> f64 {
        let now = energy.iter().sum::<f64>();
        let work = self.work;
        now - self.start.unwrap_or(now) - (work.from_outside() + work.contacts + work.damping)
    }

    /// Encodes the balance as words.
    pub fn encode(&self) -> [u64; WORDS] {
        let WorkDone { pins, colliders, wind, gravity, separation, contacts, damping, exchanged } = self.work;
        let [low, high] = self.gravity;
        let all: [&[f64]; 2] = [
            &[pins, colliders, wind, gravity, separation, contacts, damping, exchanged],
            &[
                self.start.unwrap_or(0.0),
                self.strained,
                self.least,
                self.appeared,
                self.active,
                low,
                high,
                self.rotation,
                self.unturned,
            ],
        ];
        let mut words = [u64::from(self.start.is_some()); WORDS];
        words[1..].iter_mut().zip(all.into_iter().flatten()).for_each(|(word, value)| *word = value.to_bits());
        words
    }

    /// Decodes a balance.
    pub fn decode(words: [u64; WORDS]) -> Self {
        let [has_start, words @ ..] = words;
        let [pins, colliders, wind, gravity, separation, contacts, damping, exchanged, rest @ ..] =
            words.map(f64::from_bits);
        let [start, strained, least, appeared, active, low, high, rotation, unturned] = rest;
        Self {
            work: WorkDone { pins, colliders, wind, gravity, separation, contacts, damping, exchanged },
            start: (has_start != 0).then_some(start),
            strained,
            least,
            appeared,
            active,
            gravity: [low, high],
            rotation,
            unturned,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn work(pins: f64, separation: f64) -> WorkDone {
        WorkDone { pins, separation, exchanged: pins, ..WorkDone::default() }
    }

    #[test]
    fn energy_appears_where_it_grows_without_work() {
        let mut balance = Balance::default();
        balance.see(&[0.0, 0.0, 0.0, 0.0, 0.0, 5.0], work(0.0, 0.0));
        // It falls, and loses 1 J.
        balance.see(&[2.0, 1.0, 0.0, 0.0, 0.0, 1.0], work(0.0, 0.0));
        assert_eq!((balance.appeared, balance.moved()), (0.0, 4.0));
        // A pin gives 2 J, and the separation of surfaces 1 J.
        let energy = [2.0, 4.0, 0.0, 0.0, 0.0, 1.0];
        balance.see(&energy, work(2.0, 1.0));
        assert_eq!((balance.appeared, balance.by_method(&energy)), (0.0, -1.0));
        // 2 J appear, and are lost again.
        balance.see(&[4.0, 4.0, 0.0, 0.0, 0.0, 1.0], work(2.0, 1.0));
        balance.see(&[1.0, 4.0, 0.0, 0.0, 0.0, 1.0], work(2.0, 1.0));
        assert_eq!(balance.appeared, 2.0);
        // Of 4 J of rotation, 2 J are lost, of which the method took 0.5 J; then 3 J are held by a motor.
        for (energy, taken) in [(4.0, 0.5), (2.0, 0.5), (2.0, 3.0)] {
            balance.see_rotation(energy, taken);
        }
        assert_eq!(balance.unturned, 0.5);
        assert_eq!(Balance::decode(balance.encode()), balance);
    }

    #[test]
    fn energy_stored_in_the_start_state_did_not_move() {
        let mut balance = Balance::default();
        for kinetic in [0.0, 0.25, 0.5] {
            balance.see(&[kinetic, 1e3, 0.0, 0.0, 0.0, 0.0], work(0.0, 0.0));
        }
        assert_eq!((balance.appeared, balance.moved()), (0.5, 0.5));
        // Half of the stored energy becomes motion.
        balance.see(&[500.5, 500.0, 0.0, 0.0, 0.0, 0.0], work(0.0, 0.0));
        assert_eq!((balance.appeared, balance.moved()), (0.5, 1000.5));
    }

    #[test]
    fn gravity_that_changes_neither_makes_energy_appear_nor_counts_as_a_fall() {
        let mut balance = Balance::default();
        balance.see(&[0.0, 0.0, 0.0, 0.0, 0.0, 5.0], work(0.0, 0.0));
        // At a height where gravity turns round, it gives 10 J of potential energy, of which 1 J becomes motion.
        balance.see(&[1.0, 0.0, 0.0, 0.0, 0.0, -6.0], WorkDone { gravity: -10.0, ..WorkDone::default() });
        assert_eq!((balance.appeared, balance.moved()), (0.0, 1.0));
        // 3 J appear.
        balance.see(&[4.0, 0.0, 0.0, 0.0, 0.0, 4.0], work(0.0, 0.0));
        assert_eq!((balance.appeared, balance.moved()), (3.0, 4.0));
    }
}
