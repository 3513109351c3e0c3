//! Each stage against its twin in the core, on the same columns: integers and boxes exactly, distances up to
//! rounding.

use bytemuck::cast_slice;
use glam::DVec3;
use harness::rng::Rng;
use muslin_core::broad_phase::brute_force_level::for_each_brute_force_pair;
use muslin_core::broad_phase::byte_boxes::{ByteBoxes, write_byte_boxes};
use muslin_core::broad_phase::cells::{CellGrid, Home, write_cells};
use muslin_core::broad_phase::entries::{Entry, write_entries};
use muslin_core::broad_phase::features::add_features;
use muslin_core::broad_phase::pairs::for_each_pair;
use muslin_core::broad_phase::quantized_boxes::{Quantization, QuantizedBox, write_quantized_boxes};
use muslin_core::broad_phase::sort::sort;
use muslin_core::broad_phase::spheres::{Sphere, write_spheres};
use muslin_core::broad_phase::{Candidates, Counts, Surface, bounds::write_bounds, levels};
use muslin_core::dispatch::Serial;
use muslin_core::geometry::aabb::Aabb;
use muslin_core::narrow_phase::contacts::contacts;
use muslin_core::narrow_phase::time_of_impact::{StoredTime, TimeOfImpact};
use muslin_core::narrow_phase::{EdgeEdge, Pairing, VertexTriangle, proximity};
use muslin_core::real::Vec3;
use muslin_gpu::DetectionQuery;
use muslin_gpu::params::{COUNTER_WORDS, Capacities, Params, SCAN_BLOCK, counters, initial_counters};
use muslin_gpu::schedule::{self, Dispatch, Order};
use muslin_gpu::shaders::{EDGE_EDGE, VERTEX_TRIANGLE};
use muslin_gpu::single_stage::{Columns, run};
use muslin_gpu::slots::{Slot, SurfaceSizes};

use super::methods::{columns, gpu};
use harness::case::Case;

/// Sizes around multiples of the workgroup size.
const SIZES: [usize; 6] = [0, 1, 255, 256, 257, 65_537];

/// The core's results for the first level, in words.
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
    let mut pairs = Vec::new();
    let mut add = |found: &[[u32; 2]]| {
        pairs.extend(found.iter().map(|&[a, b]| [a.min(b), a.max(b)]));
        true
    };
    for_each_brute_force_pair(&triangle_boxes, &own_levels, sizes.graded, &surface, &mut add);
    if sizes.graded == 0 {
        all.push((Slot::Pairs, sorted(pairs, &triangle_boxes)));
        return all;
    }
    let quantization = Quantization::new(&sizes.scene, sizes.extents[0]);
    let (mut quantized_boxes, mut spheres) = (vec![QuantizedBox::EMPTY; boxes.len()], vec![Sphere::ABSENT; count]);
    write_quantized_boxes(&boxes, &quantization, &mut quantized_boxes, &Serial);
    write_spheres(&quantized_boxes, surface.triangles, &own_levels, 0, &mut spheres, &Serial);
    let (grid, mut homes) = (CellGrid::new(&spheres), vec![Home::default(); count]);
    write_cells(&spheres, &grid, &mut homes, &Serial);
    let mut byte_boxes = vec![ByteBoxes::default(); count];
    write_byte_boxes(&quantized_boxes, surface.triangles, &own_levels, 0, &mut byte_boxes, &Serial);
    let corner = |b: &ByteBoxes, first: usize| (0..3).map(|k| u32::from(b.whole(first + k) as u8) << (8 * k)).sum();
    let [mut entries, mut spare] = [(); 2].map(|()| vec![Entry::default(); 8 * count]);
    let length = write_entries(&homes, &own_levels, 0, &grid, &mut entries);
    let is_spare = sort(&mut entries[..length], &mut spare[..length], grid.key_bits());
    let entries = if is_spare { &spare[..length] } else { &entries[..length] };
    for_each_pair(entries, &homes, &byte_boxes, &grid, &surface, &mut add);
    all.extend([
        (Slot::QuantizedBoxes, cast_slice(&quantized_boxes).to_vec()),
        (Slot::Spheres, cast_slice(&spheres).to_vec()),
        (Slot::Homes, cast_slice(&homes).to_vec()),
        (Slot::ByteBoxes, byte_boxes.iter().flat_map(|b| [corner(b, 0), corner(b, 3)]).collect()),
        (Slot::Entries, cast_slice(entries).to_vec()),
        (Slot::Pairs, sorted(pairs, &triangle_boxes)),
    ]);
    all
}

/// The pairs whose boxes overlap, in ascending order, in words.
fn sorted(mut pairs: Vec<[u32; 2]>, triangle_boxes: &[Aabb]) -> Vec<u32> {
    pairs.retain(|&[a, b]| triangle_boxes[a as usize].overlaps(&triangle_boxes[b as usize]));
    pairs.sort_unstable();
    pairs.into_flattened()
}

/// The counted pairs at the beginning of a column.
fn pairs_of(device: &Columns, slot: Slot, place: usize) -> &[[u32; 2]] {
    &cast_slice(&device[&slot])[..device[&Slot::Counters][place] as usize]
}

/// The same capacity for everything, with one level.
pub fn evenly(room: usize) -> Capacities {
    Capacities {
        levels: 1,
        entries: room,
        tiles: room,
        rounds: 1,
        pairs: room,
        vertex_triangle: room,
        edge_edge: room,
        contacts: room,
    }
}

/// All columns of the device after a detection with sufficient capacity.
fn on_the_device(case: &Case) -> Option<Columns> {
    detected(case, evenly(16 * case.triangles.len().max(64)))
}

/// All columns of the device after a detection with the given capacities.
fn detected(case: &Case, capacities: Capacities) -> Option<Columns> {
    let gpu = gpu()?;
    let (boxes, surface) = columns(case);
    let surface = surface.view();
    let sizes = SurfaceSizes::of(&surface, boxes.len());
    let params = Params {
        vertices: sizes.vertices as u32,
        triangles: sizes.triangles as u32,
        first_passive: surface.first_passive,
        own_contact: 1,
        reach: REACH,
        ..Params::default()
    };
    let dispatches = schedule::of(&Order { params, sizes, capacities, query: DetectionQuery::Contacts });
    let mut all: Columns = Slot::ALL.into_iter().map(|slot| (slot, vec![0; slot.words(&sizes, &capacities)])).collect();
    let mut give = |slot: Slot, words: &[u32]| all.entry(slot).or_default()[..words.len()].copy_from_slice(words);
    give(Slot::Boxes, cast_slice(&boxes));
    give(Slot::Triangles, cast_slice(surface.triangles));
    give(Slot::TriangleEdges, cast_slice(surface.triangle_edges));
    give(Slot::Edges, cast_slice(surface.edges));
    give(Slot::Given, &surface.owned.iter().map(|&owned| owned.into()).collect::<Vec<u32>>());
    give(Slot::Start, cast_slice(&centers(&boxes)));
    give(Slot::Counters, &initial_counters());
    pollster::block_on(run(gpu, dispatches, &mut all)).unwrap();
    Some(all)
}

/// Search distance, m.
const REACH: f32 = 0.1;

fn centers(boxes: &[Aabb]) -> Vec<Vec3> {
    boxes.iter().map(|b| 0.5 * (b.min + b.max)).collect()
}

/// Triangles of about the same size, so that there is one level with cells; if there are more than a hundred, a
/// few larger ones are on the last level, which has no cells.
fn alike(count: usize) -> Vec<[DVec3; 3]> {
    let (rng, half) = (&mut Rng::new(count as u64), 0.5 * (count as f64).cbrt());
    let triangle = |_| {
        let corner = rng.cube(half);
        [corner, corner + 0.6 * DVec3::X + rng.cube(0.1), corner + 0.6 * DVec3::Y + rng.cube(0.1)]
    };
    let mut all: Vec<_> = (0..count).map(triangle).collect();
    if count > 100 {
        all.iter_mut().step_by(count / 4).for_each(|t| t[1] = t[0] + 12.0 * DVec3::X);
    }
    all
}

#[test]
#[ignore = "takes a graphics driver"]
fn every_column_is_the_core_s() {
    for count in SIZES {
        let case = Case::soup("alike", &alike(count), 0.01);
        let Some(device) = on_the_device(&case) else { return };
        assert_eq!(device[&Slot::Counters][counters::STATUS], 0, "{count} triangles have room");
        for (slot, core) in by_the_core(&case) {
            if slot == Slot::Pairs {
                let pairs = pairs_of(&device, Slot::Pairs, counters::PAIRS).iter().map(|&[a, b]| [a.min(b), a.max(b)]);
                let mut pairs: Vec<_> = pairs.collect();
                pairs.sort_unstable();
                assert!(pairs.as_flattened() == core, "{count} triangles: pairs {} of {}", pairs.len(), core.len() / 2);
                continue;
            }
            let differs = core.iter().zip(&device[&slot]).position(|(a, b)| a != b);
            assert_eq!(differs, None, "{count} triangles: the first word of {slot:?} that differs");
            if slot == Slot::Entries {
                assert_eq!(
                    core.len(),
                    2 * device[&Slot::Counters][counters::ENTRIES] as usize,
                    "{count} triangles: entries"
                );
            }
        }
    }
}

/// A stage behind one with insufficient capacity does nothing and counts zero.
#[test]
#[ignore = "takes a graphics driver"]
fn stages_behind_too_little_room_do_nothing() {
    let (case, all) = (Case::soup("alike", &alike(3000), 0.3), evenly(200_000));
    let counts = |capacities| {
        let told = &detected(&case, capacities)?[&Slot::Counters];
        Some([counters::STATUS, counters::MOST_TILES, counters::PAIRS, counters::EDGE_EDGE].map(|place| told[place]))
    };
    let Some([fits, tiles, pairs, edges]) = counts(all) else { return };
    assert!(fits == 0 && tiles.min(pairs).min(edges) > 4, "{tiles} tiles, {pairs} pairs, {edges} of edges");
    let few = 4;
    for (short, expected) in [
        (Capacities { levels: 0, ..all }, [0, 0, 0]),
        (Capacities { entries: 1000, ..all }, [0, 0, 0]),
        (Capacities { tiles: few, ..all }, [tiles, 0, 0]),
        (Capacities { rounds: 0, ..all }, [tiles, 0, 0]),
        (Capacities { pairs: few, ..all }, [tiles, pairs, 0]),
        (Capacities { edge_edge: few, ..all }, [tiles, pairs, edges]),
        (Capacities { contacts: few, ..all }, [tiles, pairs, edges]),
    ] {
        let [status, found @ ..] = counts(short).unwrap();
        assert!(status != 0 && found == expected, "{found:?}, expected {expected:?}: {short:?}");
    }
}

#[test]
#[ignore = "takes a graphics driver"]
fn room_is_for_the_level_with_the_most_tiles() {
    let mut triangles = alike(3000);
    // These triangles form a level of their own, in which few overlap.
    triangles.extend(alike(300).iter().map(|t| t.map(|x| 40.0 * x + 1000.0)));
    let case = Case::soup("two levels", &triangles, 0.3);
    let told = |capacities| detected(&case, capacities)?.remove(&Slot::Counters);
    let all = Capacities { levels: 2, rounds: 10, ..evenly(200_000) };
    let Some(enough) = told(all) else { return };
    let [most, last] = [counters::MOST_TILES, counters::TILES].map(|place| enough[place]);
    assert_eq!([enough[counters::STATUS], enough[counters::GRADED]], [0, 2]);
    assert!(last < most, "{last} tiles in the last level, at most {most}");
    let short = told(Capacities { tiles: most as usize - 1, ..all }).unwrap();
    assert!(short[counters::STATUS] != 0 && short[counters::MOST_TILES] == most, "room for one too few: {short:?}");
}

/// Compares the distances of candidates with the core's, and the contacts with the core's selection from the
/// same distances.
fn compare_distances<P: Pairing>(
    surface: &Surface<'_>,
    x: &[Vec3],
    candidates: &[[u32; 2]],
    (told, bound): (&[u32], f32),
    contacts_told: &[[u32; 2]],
) {
    let mut distances = vec![0.0; candidates.len()];
    proximity::distances::<P>(candidates, surface, x, &vec![0.0; x.len()], REACH, &mut distances, &Serial);
    let told: &[f32] = &cast_slice(told)[..candidates.len()];
    let rounding = bound * x.iter().map(|x| x.abs().max_element()).fold(1.0, f32::max);
    for ((core, device), candidate) in distances.iter().zip(told).zip(candidates) {
        let agree = (core - device).abs() <= rounding || core.min(*device) > REACH - rounding;
        assert!(agree, "{device} m, in the core {core}: {candidate:?}");
    }
    let mut near = vec![[0; 2]; candidates.len()];
    let count = contacts(candidates, told, REACH, &mut near);
    assert!(near[..count] == *contacts_told, "{count} are near, the device says {}", contacts_told.len());
}

#[test]
#[ignore = "takes a graphics driver"]
fn what_becomes_of_pairs_is_the_core_s() {
    let mut near = 0;
    for count in SIZES {
        let case = Case::soup("alike", &alike(count), 0.01);
        let Some(device) = on_the_device(&case) else { return };
        let (boxes, surface) = columns(&case);
        let surface = surface.view();
        let (mut triangle_boxes, mut owned) = (vec![Aabb::EMPTY; count], vec![0; count]);
        write_bounds(&boxes, &surface, &mut triangle_boxes, &mut owned, &Serial);
        let pairs = pairs_of(&device, Slot::Pairs, counters::PAIRS);
        let [mut vertices, mut edges] = [counters::VERTEX_TRIANGLE, counters::EDGE_EDGE]
            .map(|place| vec![[0; 2]; device[&Slot::Counters][place] as usize]);
        let mut out = Candidates { vertex_triangle: &mut vertices, edge_edge: &mut edges };
        let mut counts = Counts::default();
        add_features(&boxes, &surface, &triangle_boxes, &owned, None, pairs, None, &mut out, &mut counts);
        assert_eq!([counts.vertex_triangle, counts.edge_edge], [vertices.len(), edges.len()], "{count} triangles");
        assert!(vertices == pairs_of(&device, Slot::VertexTriangle, counters::VERTEX_TRIANGLE), "{count} triangles");
        assert!(edges == pairs_of(&device, Slot::EdgeEdge, counters::EDGE_EDGE), "{count} triangles");

        let told = &device[&Slot::Counters];
        let [faces, both] = [told[counters::CONTACTS], told[counters::CONTACTS] + told[counters::CONTACTS + 1]];
        let (x, all) = (centers(&boxes), &cast_slice(&device[&Slot::Contacts])[..both as usize]);
        let (on_faces, on_edges) = all.split_at(faces as usize);
        let told = (&device[&Slot::VertexTriangleDistances][..], VERTEX_TRIANGLE.bound);
        compare_distances::<VertexTriangle>(&surface, &x, &vertices, told, on_faces);
        let told = (&device[&Slot::EdgeEdgeDistances][..], EDGE_EDGE.bound);
        compare_distances::<EdgeEdge>(&surface, &x, &edges, told, on_edges);
        near += all.len();
    }
    assert!(near > 1000, "only {near} are near");
}

#[test]
#[ignore = "takes a graphics driver"]
fn sums_before_each_are_exact() {
    for length in SIZES.into_iter().chain([2047, 2048, 2049, 600_000]) {
        let rng = &mut Rng::new(length as u64);
        let numbers: Vec<u32> = (0..length).map(|_| (rng.bits() % 1000) as u32).collect();
        let mut sum = 0;
        let expected: Vec<u32> = numbers.iter().map(|n| (sum, sum += n).0).collect();
        let Some((sums, all)) = scanned(numbers) else { return };
        assert!(sums == expected, "the sums of {length} numbers");
        assert_eq!(all, sum, "the sum of {length} numbers");
    }
}

#[test]
#[ignore = "takes a graphics driver"]
fn groups_beyond_a_row_are_folded() {
    let Some(gpu) = gpu() else { return };
    let (group, row) = (64, 65_535);
    let count = group * (row + 1000) - 7;
    let params = Params { vertex_triangle: count as u32, separation: 1.0, ..Params::default() };
    let mut words = vec![0; COUNTER_WORDS];
    words[counters::VERTEX_TRIANGLE] = count as u32;
    let mut all = Columns::from([
        (Slot::VertexTriangle, vec![0; 2 * count]),
        (Slot::VertexTriangleDistances, vec![0; count]),
        (Slot::VertexTriangleTimes, vec![0; count]),
        (Slot::Counters, words),
    ]);
    let (shader, entry, groups) = ("narrow_phase/continuous, vertex_triangle", "write_times", count.div_ceil(group));
    pollster::block_on(run(gpu, vec![Dispatch { shader, entry, groups, params }], &mut all)).unwrap();
    let times: &[StoredTime] = cast_slice(&all[&Slot::VertexTriangleTimes]);
    let missed = times.iter().position(|&time| TimeOfImpact::from(time) != TimeOfImpact::Touching);
    assert_eq!(missed, None, "the first of {count} that touch and were not told so");
}

/// Scans a column of numbers: returns the exclusive prefix sums and the total.
fn scanned(numbers: Vec<u32>) -> Option<(Vec<u32>, u32)> {
    let params = Params { length: numbers.len() as u32, ..Params::default() };
    let groups = numbers.len().div_ceil(SCAN_BLOCK);
    let dispatch = |entry, groups| Dispatch { shader: "shared/scan", entry, groups, params };
    let scan = vec![dispatch("sum_blocks", groups), dispatch("scan_blocks", 1), dispatch("spread", groups)];
    let mut all = Columns::from([(Slot::Counts, numbers), (Slot::Blocks, vec![0; groups + 1])]);
    pollster::block_on(run(gpu()?, scan, &mut all)).unwrap();
    Some((all.remove(&Slot::Counts)?, all[&Slot::Blocks][groups]))
}

#[test]
#[ignore = "takes a graphics driver"]
fn sums_too_large_for_a_word_do_not_wrap() {
    for length in [3, 2048, 5000] {
        for place in [0, length / 2, length - 2] {
            let mut numbers = vec![1; length];
            numbers[place..place + 2].fill(1 << 31);
            let Some((_, sum)) = scanned(numbers) else { return };
            assert_eq!(sum, u32::MAX, "{length} numbers, two from {place} on too large together");
        }
    }
}

#[test]
#[ignore = "takes a graphics driver"]
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
            let mut add = |shader, entry, groups, params| dispatches.push(Dispatch { shader, entry, groups, params });
            let (own, scan) = (Params { shift, ..params }, Params { length: length as u32, ..params });
            add(stage, "count_digits", blocks, own);
            add("shared/scan", "sum_blocks", length.div_ceil(SCAN_BLOCK), scan);
            add("shared/scan", "scan_blocks", 1, scan);
            add("shared/scan", "spread", length.div_ceil(SCAN_BLOCK), scan);
            add(stage, "scatter", blocks, own);
        }
        let mut told = vec![0; COUNTER_WORDS];
        told[counters::ENTRIES] = count as u32;
        let numbers = vec![0; 16 * blocks];
        let sums = vec![0; (16 * blocks).div_ceil(SCAN_BLOCK) + 1];
        let mut all = Columns::from([
            (Slot::Entries, entries),
            (Slot::Spare, vec![0; 2 * count]),
            (Slot::Counts, numbers),
            (Slot::Blocks, sums),
            (Slot::Counters, told),
        ]);
        pollster::block_on(run(gpu, dispatches, &mut all)).unwrap();
        assert!(all[&Slot::Entries] == cast_slice::<_, u32>(&expected), "{count} entries, sorted");
    }
}
