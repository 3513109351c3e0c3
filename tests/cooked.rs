//! Cooked scenes: the cloth that lies in a block of bytes takes the steps of the owned one, bit for bit, and a bad block
//! is refused.
//!
//! Run: `cargo test --release -p muslin-tests --test cooked`.

use harness::both_precisions;

both_precisions! {
    use harness::steps::Steps;
    use muslin::cooked::{self, ALIGNMENT, Cloth, Room, cook};
    use muslin::dispatch::Serial;
    use muslin::scene::{BUILT_IN, SceneDesc};
    use muslin::simulation::Simulation;

    /// Bytes that begin at a multiple of the alignment.
    struct Aligned {
        bytes: Vec<u8>,
        start: usize,
    }

    impl Aligned {
        fn new(bytes: &[u8]) -> Self {
            let mut own = vec![0; bytes.len() + ALIGNMENT];
            let start = own.as_ptr().align_offset(ALIGNMENT);
            own[start..start + bytes.len()].copy_from_slice(bytes);
            Self { bytes: own, start }
        }

        fn all(&mut self) -> &mut [u8] {
            let end = self.bytes.len() - ALIGNMENT + self.start;
            &mut self.bytes[self.start..end]
        }
    }

    const ROOM: Room = Room { pairs: 20_000, contacts: 4_000, hands: 2 };

    fn coarse(name: &str, change: impl FnOnce(&mut SceneDesc)) -> Simulation {
        let (_, text) = BUILT_IN.iter().find(|(known, _)| *known == name).expect("it is built in");
        let mut scene = kit::scene(text);
        for cloth in &mut scene.cloth {
            for grid in &mut cloth.grid {
                grid.cells = grid.cells.map(|cells| (cells / 4).max(2));
            }
        }
        change(&mut scene);
        Simulation::new(&scene, &[]).expect("it builds")
    }

    fn compare(what: &str, mut owned: Simulation, steps: u32) {
        let mut block = Aligned::new(&cook(&owned, ROOM));
        let needed = cooked::required_bytes(block.all()).expect("it is cooked");
        let mut memory = Aligned::new(&vec![0xA5; needed]);
        let mut cloth = Cloth::open(block.all(), memory.all()).unwrap_or_else(|error| panic!("{what}: {error}"));
        for n in 0..steps {
            let taken = [owned.take_step(), cloth.step(&Serial)];
            assert!(taken.iter().all(Result::is_ok), "{} {what}, step {n}: {taken:?}", muslin::real::NAME);
            assert_eq!(owned.positions(), cloth.positions(), "{} {what}, step {n}", muslin::real::NAME);
            assert_eq!(owned.velocities(), cloth.velocities(), "{} {what}, step {n}", muslin::real::NAME);
        }
        assert_eq!(owned.statistics(), cloth.statistics(), "{what}");
        assert_eq!(owned.contact_statistics(), cloth.contact_statistics(), "{what}");
    }

    #[test]
    fn a_cooked_cloth_takes_the_steps_of_the_owned_one() {
        for (name, steps) in [("flag", 30), ("ball", 40), ("twist", 30), ("stack", 20), ("skirt", 10), ("swing", 30)] {
            compare(name, coarse(name, |_| ()), steps);
        }
    }
}
