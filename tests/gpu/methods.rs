//! The grid of the core and the grid on a device, as functions from a case to its candidates.

#[path = "../broad_phase/methods.rs"]
#[expect(dead_code, reason = "of the core only the grid in single precision is compared with")]
mod core_methods;

use std::sync::OnceLock;

use muslin_core::real::Vec3;
use muslin_gpu::device::Ask;
use muslin_gpu::{DetectionQuery, DetectionResult as OnDevice, Detector, Gpu};

pub use core_methods::single::columns;
pub use core_methods::{Found, Method};

use harness::case::Case;

pub const METHODS: [(&str, Method); 2] = [("grid in f32", core_methods::single::grid), ("grid on a device", on_device)];

/// A device with the limits of every browser, shared by all tests. Without an adapter, prints a note and
/// returns `None`, or panics if `MUSLIN_REQUIRE_GPU` is 1.
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Result<Gpu, String>> = OnceLock::new();
    let open = || pollster::block_on(Gpu::open(Ask::Web)).map_err(|why| why.to_string());
    match GPU.get_or_init(open) {
        Ok(gpu) => Some(gpu),
        Err(why) if std::env::var("MUSLIN_REQUIRE_GPU").as_deref() == Ok("1") => panic!("{why}"),
        Err(why) => {
            eprintln!("skipped: {why}: detection on the GPU is not tested (Mesa's drivers will do)");
            None
        }
    }
}

/// All candidates of a method; the device allocates its capacity itself.
pub fn all(method: Method, case: &Case) -> Found {
    match std::ptr::fn_addr_eq(method, on_device as Method) {
        true => on_device(case, [usize::MAX; 2]),
        false => core_methods::all(method, case),
    }
}

/// The grid on the device; without a device, the result of the core's grid, which then agrees trivially.
fn on_device(case: &Case, room: [usize; 2]) -> Found {
    let Some(gpu) = gpu() else { return core_methods::all(core_methods::single::grid, case) };
    let (boxes, surface) = columns(case);
    let start = vec![Vec3::ZERO; boxes.len()];
    let mut found = OnDevice::default();
    let mut detector =
        Detector::new(gpu, &surface.view(), &vec![0.0; boxes.len()], DetectionQuery::Candidates).unwrap();
    pollster::block_on(detector.detect(gpu, &boxes, &start, &start, &mut found)).unwrap();
    let counts = [found.vertex_triangle.len(), found.edge_edge.len()];
    let (mut vertex_triangle, mut edge_edge) = (found.vertex_triangle, found.edge_edge);
    vertex_triangle.truncate(room[0]);
    edge_edge.truncate(room[1]);
    Found { vertex_triangle, edge_edge, counts }
}
