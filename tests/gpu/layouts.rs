//! The data that the host writes has the layout that shaders read.

use std::mem::{offset_of, size_of};

use muslin_core::narrow_phase::time_of_impact::{StoredTime, TimeOfImpact};
use muslin_gpu::params::{COUNTER_WORDS, Params, counters};
use muslin_gpu::shaders;
use naga::{Expression, Literal, Module, TypeInner};

macro_rules! offsets {
    ($($field:ident),*) => { [$((stringify!($field), offset_of!(Params, $field))),*] };
}

fn any_stage() -> Module {
    naga::front::wgsl::parse_str(&shaders::BOUNDS.source()).expect("the stage parses")
}

#[test]
fn params_are_those_of_the_host() {
    let host = offsets!(
        vertices,
        triangles,
        first_passive,
        own_contact,
        sewn,
        level,
        shift,
        length,
        entries,
        tiles,
        pairs,
        vertex_triangle,
        edge_edge,
        reach,
        separation,
        contacts
    );
    let module = any_stage();
    let (_, params) =
        module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Params")).expect("the shader has params");
    let TypeInner::Struct { members, span } = &params.inner else { panic!("params are a struct") };
    let shader: Vec<_> = members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
    assert_eq!(shader, host);
    assert_eq!(*span as usize, size_of::<Params>());
}

#[test]
fn words_of_the_plan_are_those_of_the_host() {
    let host = [
        ("STATUS", counters::STATUS),
        ("GRADED", counters::GRADED),
        ("SINGLE", counters::SINGLE),
        ("SCENE", counters::SCENE),
        ("ENTRIES", counters::ENTRIES),
        ("PAIRS", counters::PAIRS),
        ("VERTEX_TRIANGLE", counters::VERTEX_TRIANGLE),
        ("EDGE_EDGE", counters::EDGE_EDGE),
        ("MOST_ENTRIES", counters::MOST_ENTRIES),
        ("CONTACTS", counters::CONTACTS),
        ("TILES", counters::TILES),
        ("MOST_TILES", counters::MOST_TILES),
    ];
    let module = any_stage();
    for (name, place) in host {
        let constant = module.constants.iter().find(|(_, constant)| constant.name.as_deref() == Some(name));
        let (_, constant) = constant.unwrap_or_else(|| panic!("{name} is not in the shader"));
        let value = &module.global_expressions[constant.init];
        assert!(
            matches!(value, Expression::Literal(Literal::U32(word)) if *word as usize == place),
            "{name}: {value:?}"
        );
        assert!(place < COUNTER_WORDS);
    }
}

#[test]
fn what_stands_for_no_time_is_that_of_the_core() {
    let core = [("NEVER", TimeOfImpact::Never), ("TOUCHING", TimeOfImpact::Touching)];
    for stage in [&shaders::VERTEX_TRIANGLE_CCD, &shaders::EDGE_EDGE_CCD] {
        let module = naga::front::wgsl::parse_str(&stage.source()).expect("the stage parses");
        for (name, time) in core {
            let stored: f32 = bytemuck::cast(StoredTime::from(time));
            let constant = module.constants.iter().find(|(_, constant)| constant.name.as_deref() == Some(name));
            let (_, constant) = constant.unwrap_or_else(|| panic!("{name} is not in {}", stage.name));
            let value = &module.global_expressions[constant.init];
            assert!(matches!(value, Expression::Literal(Literal::F32(x)) if *x == stored), "{name}: {value:?}");
        }
    }
}
