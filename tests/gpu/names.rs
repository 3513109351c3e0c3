//! Every detection file has its twin: the path differs only in crate and extension.

use std::collections::BTreeSet;
use std::path::Path;

use muslin_gpu::params::Params;
use muslin_gpu::schedule::{self, Dispatch, Order};
use muslin_gpu::single_stage::{Columns, run};
use muslin_gpu::slots::SurfaceSizes;
use muslin_gpu::{DetectionError, DetectionQuery, shaders};

use super::methods::gpu;
use super::stages::evenly;

/// Files without a twin on the device, and the reasons.
const WITHOUT: [(&str, &str); 13] = [
    ("broad_phase/mod", "types"),
    ("broad_phase/grid", "the order of the stages: gpu/src/schedule.rs"),
    ("broad_phase/kept_pairs", "pairs from one step to the next, which the core keeps"),
    ("broad_phase/comoving", "leaves out pairs that the device finds: they touch nothing"),
    ("broad_phase/lean", "a search without columns, for processors with little memory"),
    ("broad_phase/brute_force", "what the core is tested against"),
    ("broad_phase/reference_cell", "what the core is tested against"),
    ("narrow_phase/mod", "types"),
    ("narrow_phase/edge_edge_ccd", "continuous, of edge_edge"),
    ("narrow_phase/vertex_triangle_ccd", "continuous, of vertex_triangle"),
    ("narrow_phase/time_of_impact", "the numbers that stand for no time, constants of continuous"),
    ("narrow_phase/slab", "drops pairs that the device measures: they touch nothing"),
    ("narrow_phase/local_minimum", "of contacts, which the core makes of what is near"),
];

/// Files of the two folders by their stems.
fn stems(of: &str, extension: &str) -> BTreeSet<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(of);
    let folders = ["broad_phase", "narrow_phase"];
    let files = folders.iter().flat_map(|folder| {
        let entries = std::fs::read_dir(root.join(folder)).expect("the folder is there");
        entries.map(move |entry| (folder, entry.expect("an entry").path()))
    });
    let wanted = files.filter(|(_, path)| path.extension().is_some_and(|own| own == extension));
    wanted.map(|(folder, path)| format!("{folder}/{}", path.file_stem().unwrap().to_string_lossy())).collect()
}

#[test]
fn every_dispatch_is_of_a_stage_of_the_table() {
    let capacities = evenly(1000);
    for query in [DetectionQuery::Candidates, DetectionQuery::Contacts, DetectionQuery::Times] {
        let (params, sizes) =
            (Params::default(), SurfaceSizes { triangles: 300, vertices: 200, ..SurfaceSizes::default() });
        for dispatch in schedule::of(&Order { params, sizes, capacities, query }) {
            let found = shaders::find(dispatch.shader, dispatch.entry);
            let [stage, entry] = found.unwrap_or_else(|| panic!("{} has no {}", dispatch.shader, dispatch.entry));
            assert_eq!(
                (shaders::ALL[stage].name, shaders::ALL[stage].entries[entry]),
                (dispatch.shader, dispatch.entry)
            );
        }
    }
}

/// Unknown names, some of which nearly match. They must not be taken for the first stage and entry.
const UNKNOWN: [(&str, &str); 4] = [
    ("broad_phase/bound", "write_bounds"),
    ("", ""),
    ("broad_phase/bounds", "write_bound"),
    ("shared/scan", "scatter"),
];

#[test]
fn what_is_not_in_the_table_is_not_found() {
    for (stage, entry) in UNKNOWN {
        assert_eq!(shaders::find(stage, entry), None, "{stage} {entry}");
    }
}

#[test]
#[ignore = "takes a graphics driver"]
fn what_is_not_in_the_table_is_not_run() {
    let Some(gpu) = gpu() else { return };
    for (shader, entry) in UNKNOWN {
        let dispatch = Dispatch { shader, entry, groups: 1, params: Params::default() };
        let ran = pollster::block_on(run(gpu, vec![dispatch], &mut Columns::new()));
        assert_eq!(ran, Err(DetectionError::Unknown { shader, entry }));
    }
}

#[test]
fn every_stage_has_its_twin() {
    let (core, device) = (stems("core/src", "rs"), stems("gpu/src", "wgsl"));
    let without: BTreeSet<_> = WITHOUT.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert!(core.len() > 20 && device.is_subset(&core), "without a twin in the core: {:?}", device.difference(&core));
    let missing: BTreeSet<_> = core.difference(&device).cloned().collect();
    assert_eq!(missing, without, "what has no twin on the device and what is said to have none");
}
