//! Every shader parses, is valid within the limits that browsers guarantee, and matches the table.

#[path = "../../gpu/minify.rs"]
mod minify;

use muslin_gpu::shaders::{self, Shader};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, Module, StorageAccess};

/// Limits that every browser guarantees [WebGPU, 3.6.2].
const STORAGE_BUFFERS: usize = 8;
const INVOCATIONS: u32 = 256;
const WORKGROUP_BYTES: u32 = 16 * 1024;

fn parse(shader: &Shader) -> Module {
    let source = shader.source();
    naga::front::wgsl::parse_str(&source)
        .unwrap_or_else(|error| panic!("{}: {}", shader.name, error.emit_to_string(&source)))
}

#[test]
fn all_are_valid_without_extensions() {
    for shader in shaders::ALL {
        let module = parse(shader);
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        if let Err(error) = validator.validate(&module) {
            panic!("{}: {}", shader.name, error.emit_to_string(&shader.source()));
        }
    }
}

/// The module as text, without the places in its source.
fn without_places(source: &str, name: &str) -> String {
    let module =
        naga::front::wgsl::parse_str(source).unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
    let text = format!("{module:?}");
    let mut parts = text.split("Span {");
    let first = parts.next().unwrap_or_default();
    let rest = parts.map(|part| part.split_once('}').map_or(part, |(_, after)| after));
    [first].into_iter().chain(rest).collect()
}

#[test]
fn minified_text_is_the_same_shader() {
    for shader in shaders::ALL {
        let source = shader.source();
        let small = minify::minify(&source);
        assert!(small.len() < source.len(), "{}: nothing was left out", shader.name);
        let [full, short] = [&source, &small].map(|text| without_places(text, shader.name));
        assert!(full == short, "{}: without spaces it is another shader", shader.name);
    }
}

#[test]
fn entries_and_columns_are_those_of_the_table() {
    for shader in shaders::ALL {
        let module = parse(shader);
        let entries: Vec<_> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(entries, shader.entries, "{}", shader.name);
        let mut columns: Vec<_> = module
            .global_variables
            .iter()
            .filter_map(|(_, variable)| {
                let AddressSpace::Storage { access } = variable.space else { return None };
                Some((variable.binding.as_ref()?.binding, access.contains(StorageAccess::STORE)))
            })
            .collect();
        columns.sort_unstable();
        let table: Vec<_> = (1..).zip(shader.bindings).map(|(binding, &(_, writes))| (binding, writes)).collect();
        assert_eq!(columns, table, "{}: binding and whether it is written", shader.name);
        assert!(columns.len() <= STORAGE_BUFFERS, "{}: {} columns", shader.name, columns.len());
    }
}

#[test]
fn groups_are_as_small_as_browsers_ask() {
    for shader in shaders::ALL {
        let module = parse(shader);
        for entry in &module.entry_points {
            assert!(entry.workgroup_size.iter().product::<u32>() <= INVOCATIONS, "{} {}", shader.name, entry.name);
        }
        let shared = module.global_variables.iter().filter(|(_, variable)| variable.space == AddressSpace::WorkGroup);
        let bytes: u32 = shared.map(|(_, variable)| module.types[variable.ty].inner.size(module.to_ctx())).sum();
        assert!(bytes <= WORKGROUP_BYTES, "{}: {bytes} bytes", shader.name);
    }
}
