//! The rule of the control bits in isolation: two or more boxes touch at their corners, so that their centres
//! are as far apart as those of overlapping spheres can be, and lie around the corners of cells. Every
//! overlapping pair must be found exactly once.

use glam::DVec3;
use harness::rng::Rng;

const CASES: usize = 40_000;

/// A few boxes, each with a corner in a common small neighbourhood.
fn boxes(rng: &mut Rng) -> Vec<[DVec3; 2]> {
    let meeting = rng.cube(40.0).round();
    let count = rng.pick(&[2, 2, 3, 6]);
    let one = |rng: &mut Rng| {
        let full = rng.pick(&[1.0, 1.0, 0.9, 0.5, 0.1, 0.0]);
        let flat: [f64; 3] = std::array::from_fn(|_| rng.pick(&[1.0, 1.0, 0.0, 0.3]));
        let size = (DVec3::from_array(flat) * full * 8.0).round();
        let corner = meeting + rng.cube(0.7).round();
        let other = corner + size * DVec3::from_array(std::array::from_fn(|_| rng.pick(&[-1.0, 1.0])));
        [corner.min(other), corner.max(other)]
    };
    // The extra box fixes the origin of the cells and their size.
    let mut boxes: Vec<_> = (0..count).map(|_| one(rng)).collect();
    boxes.push([DVec3::splat(-100.0), DVec3::splat(-92.0)]);
    boxes
}

harness::both_precisions! {
    use super::{CASES, boxes};
    use muslin::broad_phase::byte_boxes::{self, ByteBoxes};
    use muslin::broad_phase::cells::{self, Home, CellGrid};
    use muslin::broad_phase::entries::{self, Entry};
    use muslin::broad_phase::spheres::{self, Sphere};
    use muslin::broad_phase::quantized_boxes::{self, Quantization, QuantizedBox};
    use muslin::broad_phase::{pairs, sort};
    use muslin::dispatch::Serial;
    use muslin::geometry::aabb::Aabb;
    use muslin::mesh::SurfaceColumns;
    use harness::rng::Rng;

    /// The pairs of overlapping boxes at one level.
    fn pairs_in_cells(boxes: &[Aabb], levels: &[u8], level: u8) -> Vec<[u32; 2]> {
        let scene = boxes.iter().fold(Aabb::EMPTY, |scene, b| scene.union(b));
        let mut quantized_boxes = vec![QuantizedBox::EMPTY; boxes.len()];
        quantized_boxes::write_quantized_boxes(boxes, &Quantization::new(&scene, 8.0), &mut quantized_boxes, &Serial);
        let points: Vec<_> = (0..boxes.len() as u32).map(|v| [v; 3]).collect();
        let surface = SurfaceColumns::build(boxes.len(), &points, &[]);
        let mut columns = vec![Sphere::default(); boxes.len()];
        spheres::write_spheres(&quantized_boxes, &points, levels, level, &mut columns, &Serial);
        let mut bytes = vec![ByteBoxes::default(); boxes.len()];
        byte_boxes::write_byte_boxes(&quantized_boxes, &points, levels, level, &mut bytes, &Serial);
        let grid = CellGrid::new(&columns);
        let mut homes = vec![Home::default(); boxes.len()];
        cells::write_cells(&columns, &grid, &mut homes, &Serial);
        let [mut entries, mut spare] = [(); 2].map(|()| vec![Entry::default(); 8 * boxes.len()]);
        let count = entries::write_entries(&homes, levels, level, &grid, &mut entries);
        let in_spare = sort::sort(&mut entries[..count], &mut spare[..count], grid.key_bits());
        let sorted = &(if in_spare { spare } else { entries })[..count];
        let mut found = Vec::new();
        let near = |&&[a, b]: &&[u32; 2]| boxes[a as usize].overlaps(&boxes[b as usize]);
        pairs::for_each_pair(sorted, &homes, &bytes, &grid, &surface.view(), |batch| {
            found.extend(batch.iter().filter(near).map(|&[a, b]| [a.min(b), a.max(b)]));
            true
        });
        found.sort_unstable();
        found
    }

    #[test]
    fn every_overlapping_pair_once() {
        let rng = &mut Rng::new(21);
        let mut overlapping = 0;
        for case in 0..CASES {
            let boxes: Vec<_> = boxes(rng).iter().map(kit::narrow).map(|[min, max]| Aabb { min, max }).collect();
            let levels: Vec<u8> = boxes.iter().map(|_| u8::from(case % 4 != 0 || rng.pick(&[true, false]))).collect();
            let mut expected = Vec::new();
            for a in 0..boxes.len() {
                for b in a + 1..boxes.len() {
                    if boxes[a].overlaps(&boxes[b]) && (levels[a] == 1 || levels[b] == 1) {
                        expected.push([a as u32, b as u32]);
                    }
                }
            }
            overlapping += expected.len();
            assert_eq!(pairs_in_cells(&boxes, &levels, 1), expected, "case {case}: {boxes:?}, levels {levels:?}");
        }
        assert!(overlapping > CASES, "only {overlapping} pairs overlap");
    }

    /// Keys of one digit and of several digits; entries with equal keys must keep their order.
    #[test]
    fn the_sort_is_stable() {
        let rng = &mut Rng::new(22);
        for bits in 1..=30 {
            for count in [0, 1, 2, 2500] {
                let entry = |object| Entry { key: (rng.bits() as u32 & ((1 << bits) - 1)) >> (object % 7), object };
                let mut entries: Vec<Entry> = (0..count).map(entry).collect();
                let mut spare = vec![Entry::default(); entries.len()];
                let mut expected = entries.clone();
                expected.sort_by_key(|entry| entry.key);
                let in_spare = sort::sort(&mut entries, &mut spare, bits);
                assert_eq!(if in_spare { spare } else { entries }, expected, "{bits} bits");
            }
        }
    }
}
