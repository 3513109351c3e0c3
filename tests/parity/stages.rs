//! Each stage against its twin in the core, on the same columns: integers and boxes exactly.

use bytemuck::cast_slice;
use glam::DVec3;
use muslin_core::broad_phase::byte_boxes::{ByteBoxes, write_byte_boxes};
use muslin_core::broad_phase::cells::{Home, Lattice, write_cells};
use muslin_core::broad_phase::entries::{Entry, write_entries};
use muslin_core::broad_phase::sort::sort;
use muslin_core::broad_phase::spheres::{Sphere, write_spheres};
use muslin_core::broad_phase::units::{Quantum, UnitBox, write_units};
use muslin_core::broad_phase::{bounds::write_bounds, levels};
use muslin_core::dispatch::Serial;
use muslin_core::geometry::aabb::Aabb;
use muslin_gpu::alone::{Columns, run};
use muslin_gpu::params::{Capacities, PLAN_WORDS, Params, SCAN_BLOCK, fresh_plan, plan};
use muslin_gpu::schedule::{self, Dispatch, Order};
use muslin_gpu::slots::{Sizes, Slot};
use muslin_tests::rng::Rng;

use super::case::Case;
use super::methods::{columns, gpu};

/// Around the sizes of groups and of rows of groups.
const SIZES: [usize; 6] = [0, 1, 255, 256, 257, 65_537];

/// What the core writes for the first level, in words.
fn by_the_core(case: &Case) -> Vec<(Slot, Vec<u32>)> {
    let (boxes, surface) = columns(case);
    let (surface, count) = (surface.view(), case.triangles.len());
    let mut triangle_boxes = vec![Aabb::EMPTY; count];
    let (mut owned, mut own_levels) = (vec![0; count], vec![0; count]);
    write_bounds(&boxes, &surface, &mut triangle_boxes, &mut owned, &Serial);
    let sizes = levels::assign(&triangle_boxes, &mut own_levels);
    let words = |bytes: &[u8]| -> Vec<u32> { bytes.iter().map(|&byte| byte.into()).collect() };
    let mut all = vec![
        (Slot::TriangleBoxes, cast_slice(&triangle_boxes).to_vec()),
        (Slot::Owned, words(&owned)),
        (Slot::Levels, words(&own_levels)),
    ];
    if sizes.graded == 0 {
        return all;
    }
    let quantum = Quantum::new(&sizes.scene, sizes.extents[0]);
    let (mut units, mut spheres) = (vec![UnitBox::EMPTY; boxes.len()], vec![Sphere::ABSENT; count]);
    write_units(&boxes, &quantum, &mut units, &Serial);
    write_spheres(&units, surface.triangles, &own_levels, 0, &mut spheres, &Serial);
    let (lattice, mut homes) = (Lattice::new(&spheres), vec![Home::default(); count]);
    write_cells(&spheres, &lattice, &mut homes, &Serial);
    let mut byte_boxes = vec![ByteBoxes::default(); count];
    write_byte_boxes(&units, surface.triangles, &own_levels, 0, &mut byte_boxes, &Serial);
    let corner = |b: &ByteBoxes, first: usize| (0..3).map(|k| u32::from(b.whole(first + k) as u8) << (8 * k)).sum();
    let [mut entries, mut spare] = [(); 2].map(|()| vec![Entry::default(); 8 * count]);
    let length = write_entries(&homes, &own_levels, 0, &lattice, &mut entries);
    let is_spare = sort(&mut entries[..length], &mut spare[..length], lattice.key_bits());
    let sorted = if is_spare { &spare[..length] } else { &entries[..length] };
    all.extend([
        (Slot::Units, cast_slice(&units).to_vec()),
        (Slot::Spheres, cast_slice(&spheres).to_vec()),
        (Slot::Homes, cast_slice(&homes).to_vec()),
        (Slot::ByteBoxes, byte_boxes.iter().flat_map(|b| [corner(b, 0), corner(b, 3)]).collect()),
        (Slot::Entries, cast_slice(sorted).to_vec()),
    ]);
    all
}

/// All columns that the device has after a detection with one level.
fn on_the_device(case: &Case) -> Option<Columns> {
    let gpu = gpu()?;
    let (boxes, surface) = columns(case);
    let surface = surface.view();
    let (sizes, room) = (Sizes::of(&surface, boxes.len()), 16 * case.triangles.len().max(64));
    let capacities = Capacities { levels: 1, entries: room, pairs: room, vertex_triangle: room, edge_edge: room };
    let room = room as u32;
    let params = Params {
        vertices: sizes.vertices as u32,
        triangles: sizes.triangles as u32,
        first_passive: surface.first_passive,
        own_contact: 1,
        entries: room,
        pairs: room,
        vertex_triangle: room,
        edge_edge: room,
        ..Params::default()
    };
    let dispatches = schedule::of(&Order { params, sizes, capacities, continuous: false });
    let mut all: Columns = Slot::ALL.into_iter().map(|slot| (slot, vec![0; slot.words(&sizes, &capacities)])).collect();
    let mut give = |slot: Slot, words: &[u32]| all.entry(slot).or_default()[..words.len()].copy_from_slice(words);
    give(Slot::Boxes, cast_slice(&boxes));
    give(Slot::Triangles, cast_slice(surface.triangles));
    give(Slot::TriangleEdges, cast_slice(surface.triangle_edges));
    give(Slot::Edges, cast_slice(surface.edges));
    give(Slot::Given, &surface.owned.iter().map(|&owned| owned.into()).collect::<Vec<u32>>());
    give(Slot::Plan, &fresh_plan());
    pollster::block_on(run(gpu, dispatches, &mut all)).unwrap();
    Some(all)
}

/// Triangles of about one size, so that there is one level.
fn alike(count: usize) -> Vec<[DVec3; 3]> {
    let (rng, half) = (&mut Rng::new(count as u64), 0.5 * (count as f64).cbrt());
    let triangle = |_| {
        let corner = rng.cube(half);
        [corner, corner + 0.6 * DVec3::X + rng.cube(0.1), corner + 0.6 * DVec3::Y + rng.cube(0.1)]
    };
    (0..count).map(triangle).collect()
}

#[test]
fn every_column_is_the_core_s() {
    for count in SIZES {
        let case = Case::soup("alike", &alike(count), 0.01);
        let Some(device) = on_the_device(&case) else { return };
        assert_eq!(device[&Slot::Plan][plan::STATUS], 0, "{count} triangles have room");
        for (slot, core) in by_the_core(&case) {
            let differs = core.iter().zip(&device[&slot]).position(|(a, b)| a != b);
            assert_eq!(differs, None, "{count} triangles: the first word of {slot:?} that differs");
            if slot == Slot::Entries {
                assert_eq!(core.len(), 2 * device[&Slot::Plan][plan::ENTRIES] as usize, "{count} triangles: entries");
            }
        }
    }
}

#[test]
fn sums_before_each_are_exact() {
    let Some(gpu) = gpu() else { return };
    for length in SIZES.into_iter().chain([2047, 2048, 2049, 600_000]) {
        let rng = &mut Rng::new(length as u64);
        let numbers: Vec<u32> = (0..length).map(|_| (rng.bits() % 1000) as u32).collect();
        let mut sum = 0;
        let expected: Vec<u32> = numbers.iter().map(|n| (sum, sum += n).0).collect();
        let params = Params { length: length as u32, ..Params::default() };
        let groups = length.div_ceil(SCAN_BLOCK);
        let dispatch = |entry, groups| Dispatch { stage: "shared/scan", entry, groups, params };
        let scan = vec![dispatch("sum_blocks", groups), dispatch("scan_blocks", 1), dispatch("spread", groups)];
        let mut all = Columns::from([(Slot::Counts, numbers), (Slot::Blocks, vec![0; groups + 1])]);
        pollster::block_on(run(gpu, scan, &mut all)).unwrap();
        assert!(all[&Slot::Counts] == expected, "the sums of {length} numbers");
        assert_eq!(all[&Slot::Blocks][groups], sum, "the sum of {length} numbers");
    }
}

#[test]
fn the_sort_is_stable() {
    let Some(gpu) = gpu() else { return };
    for count in SIZES {
        let rng = &mut Rng::new(count as u64);
        let mut expected: Vec<[u32; 2]> = (0..count as u32).map(|i| [(rng.bits() % 200) as u32, i]).collect();
        let entries = cast_slice(&expected).to_vec();
        expected.sort_by_key(|entry| entry[0]);
        let (blocks, params) = (count.div_ceil(SCAN_BLOCK), Params { entries: count as u32, ..Params::default() });
        let mut dispatches = Vec::new();
        for (shift, stage) in [(0, "broad_phase/sort"), (4, "broad_phase/sort, back")] {
            let length = 16 * blocks;
            let mut add = |stage, entry, groups, params| dispatches.push(Dispatch { stage, entry, groups, params });
            let (own, scan) = (Params { shift, ..params }, Params { length: length as u32, ..params });
            add(stage, "count_digits", blocks, own);
            add("shared/scan", "sum_blocks", length.div_ceil(SCAN_BLOCK), scan);
            add("shared/scan", "scan_blocks", 1, scan);
            add("shared/scan", "spread", length.div_ceil(SCAN_BLOCK), scan);
            add(stage, "scatter", blocks, own);
        }
        let mut told = vec![0; PLAN_WORDS];
        told[plan::ENTRIES] = count as u32;
        let numbers = vec![0; 16 * blocks];
        let sums = vec![0; (16 * blocks).div_ceil(SCAN_BLOCK) + 1];
        let mut all = Columns::from([
            (Slot::Entries, entries),
            (Slot::Spare, vec![0; 2 * count]),
            (Slot::Counts, numbers),
            (Slot::Blocks, sums),
            (Slot::Plan, told),
        ]);
        pollster::block_on(run(gpu, dispatches, &mut all)).unwrap();
        assert!(all[&Slot::Entries] == cast_slice::<_, u32>(&expected), "{count} entries, sorted");
    }
}
