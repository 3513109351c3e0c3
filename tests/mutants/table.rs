//! Small faults, one at a time, and the suites that should find each.

/// A small fault.
pub struct Mutant {
    /// Description.
    pub what: &'static str,
    /// The file that is changed.
    pub file: &'static str,
    /// The original text, which occurs once.
    pub old: &'static str,
    /// The text that replaces it.
    pub new: &'static str,
    /// Suites that should find it in the everyday level.
    pub everyday: &'static [&'static str],
    /// Suites that find it with all their tests, if the everyday ones do not.
    pub all: &'static [&'static str],
}

/// In the order of the data flow.
pub const MUTANTS: &[Mutant] = &[
    Mutant {
        what: "Springs damp by one per cent too much",
        file: "core/src/forces/spring.rs",
        old: "d * (spring.damping * w.dot(d) / square)",
        new: "d * (spring.damping * 1.01 * w.dot(d) / square)",
        everyday: &["forces"],
        all: &[],
    },
    Mutant {
        what: "The projection of a membrane loses the sign of its twist",
        file: "core/src/forces/membrane.rs",
        old: "blocks[1] += rest * sign;",
        new: "blocks[1] += rest;",
        everyday: &["forces"],
        all: &[],
    },
    Mutant {
        what: "A hinge mixes up the reach of its two triangles",
        file: "core/src/forces/hinge.rs",
        old: "[length - reach[0], length - reach[1]],",
        new: "[length - reach[1], length - reach[0]],",
        everyday: &["forces"],
        all: &[],
    },
    Mutant {
        what: "BDF2 looks back by the wrong part",
        file: "core/src/integrate/bdf2.rs",
        old: "*vh = v.at(i) + dvp.at(i) * part;",
        new: "*vh = v.at(i) + dvp.at(i) * (0.9 * part);",
        everyday: &["integrate"],
        all: &[],
    },
    Mutant {
        what: "Conjugate gradients stop ten times too early",
        file: "core/src/integrate/stopping.rs",
        old: "cloth.target * tolerance * tolerance,",
        new: "cloth.target * tolerance * tolerance * 100.0,",
        everyday: &["solver", "response"],
        all: &[],
    },
    Mutant {
        what: "An indefinite block of the preconditioner is inverted as it is",
        file: "core/src/integrate/conjugate_gradient.rs",
        old: "block.x_axis.x > 0.0 && minor > 0.0 && block.determinant() > 0.0",
        new: "block.x_axis.x > 0.0 && minor > 0.0 && block.determinant() != 0.0",
        everyday: &["solver", "stability", "forces"],
        all: &["matrix"],
    },
    Mutant {
        what: "A cell of the lowest common type leaves its pair to another",
        file: "core/src/broad_phase/control_bits.rs",
        old: "((1 << cell) - 1) != 0",
        new: "((2 << cell) - 1) != 0",
        everyday: &["broad_phase"],
        all: &[],
    },
    Mutant {
        what: "Coordinates are rounded to the nearest unit, not down",
        file: "core/src/broad_phase/quantized_boxes.rs",
        old: "v.clamp(0.0, MOST) as i32",
        new: "(v.clamp(0.0, MOST) + 0.5) as i32",
        everyday: &["broad_phase"],
        all: &["gpu"],
    },
    Mutant {
        what: "Nearest points of edges are not clamped to the first edge",
        file: "core/src/geometry/edge_edge.rs",
        old: "clamp_to_unit((b * t - r).dot(a) / a_squared)",
        new: "(b * t - r).dot(a) / a_squared",
        everyday: &["narrow_phase"],
        all: &[],
    },
    Mutant {
        what: "What cannot have met is passed over without a reserve for rounding",
        file: "core/src/narrow_phase/continuous.rs",
        old: "const RESERVE: Real = 2.0 * ROUNDING;",
        new: "const RESERVE: Real = 0.0 * ROUNDING;",
        everyday: &["narrow_phase"],
        all: &[],
    },
    Mutant {
        what: "What slides is held by the static coefficient",
        file: "core/src/response/friction.rs",
        old: "return needed * ((self.kinetic * normal).min(size) / size);",
        new: "return needed * ((self.at_rest * normal).min(size) / size);",
        everyday: &["response"],
        all: &[],
    },
    Mutant {
        what: "The last resort moves held axes too",
        file: "core/src/response/hold.rs",
        old: "motion.displacements.set(vertex, Vec3::select(free, displacements, before));",
        new: "motion.displacements.set(vertex, displacements);",
        everyday: &["response"],
        all: &[],
    },
    Mutant {
        what: "Meetings count only in the first half of a step",
        file: "core/src/response/impact.rs",
        old: "TimeOfImpact::Never => continue,",
        new: "TimeOfImpact::Never | TimeOfImpact::At(0.5..) => continue,",
        everyday: &["response", "torture"],
        all: &["torture"],
    },
    Mutant {
        what: "The audit takes a step for free whose end has a new crossing where an old one is",
        file: "core/src/audit/mod.rs",
        old: "if !crosses(surface, before, crossing) {",
        new: "if !crosses(surface, after, crossing) {",
        everyday: &["response"],
        all: &[],
    },
    Mutant {
        what: "What is let go stays immovable to contact",
        file: "core/src/live/pins.rs",
        old: "pins.write_held(solids.held);",
        new: "pins.write_held(&mut solids.held.to_vec());",
        everyday: &["response"],
        all: &[],
    },
    Mutant {
        what: "A negative index of an OBJ file counts from one vertex too far",
        file: "host-cli/src/mesh_io/obj.rs",
        old: "if index < 0 { index.checked_add(count as i64) }",
        new: "if index < 0 { index.checked_add(count as i64 - 1) }",
        everyday: &["unit"],
        all: &[],
    },
    Mutant {
        what: "A damaged checkpoint is taken as it is",
        file: "host-cli/src/checkpoint.rs",
        old: "if crc32fast::hash(body) != u32::from_le_bytes(*crc) {",
        new: "if crc32fast::hash(body) ^ u32::from_le_bytes(*crc) == 1 {",
        everyday: &["cli"],
        all: &[],
    },
    Mutant {
        what: "A study's slopes are a tenth too small",
        file: "host-cli/src/study/work_precision/ladder.rs",
        old: "Some(0.5 * (first / last).log2())",
        new: "Some(0.45 * (first / last).log2())",
        everyday: &["cli"],
        all: &[],
    },
    Mutant {
        what: "Kept pairs outlive their boxes",
        file: "core/src/broad_phase/kept_pairs.rs",
        old: "wide.contains(narrow)",
        new: "wide.overlaps(narrow)",
        everyday: &["narrow_phase"],
        all: &[],
    },
    Mutant {
        what: "Each of two triangles moves in a frame of its own",
        file: "core/src/broad_phase/comoving.rs",
        old: "other.swept(frame)",
        new: "other.swept(other.displacement)",
        everyday: &["narrow_phase"],
        all: &[],
    },
    Mutant {
        what: "A slab ignores that a vertex may end elsewhere in its box",
        file: "core/src/narrow_phase/slab.rs",
        old: "end - uncertain *",
        new: "end - 0.0 * uncertain *",
        everyday: &["narrow_phase"],
        all: &[],
    },
    Mutant {
        what: "A step allocates",
        file: "core/src/simulation/substeps.rs",
        old: "        let mut particles = built.particles.view();",
        new: "        core::hint::black_box(alloc::boxed::Box::new(0u8));\n        let mut particles = built.particles.view();",
        everyday: &["allocation"],
        all: &[],
    },
    Mutant {
        what: "A collider that the host moves jumps to its end",
        file: "core/src/kinematic.rs",
        old: "position: from.position + self.during.linear * since",
        new: "position: to.position",
        everyday: &["live"],
        all: &[],
    },
    Mutant {
        what: "The indices of a cooked scene are not checked",
        file: "core/src/cooked/check.rs",
        old: "indices.iter().all(|&index| (index as usize) < end)",
        new: "indices.iter().all(|&index| (index as usize) < end || true)",
        everyday: &["cooked"],
        all: &[],
    },
    Mutant {
        what: "The device leaves out a triangle and the next",
        file: "gpu/src/broad_phase/pairs.wgsl",
        old: "if triangles_overlap(a, b) && may_pair(a, b)",
        new: "if a != b + 1u && triangles_overlap(a, b) && may_pair(a, b)",
        everyday: &[],
        all: &["gpu"],
    },
];

#[cfg(test)]
mod tests {
    #[test]
    fn every_place_occurs_once() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        for super::Mutant { what, file, old, .. } in super::MUTANTS {
            let text = std::fs::read_to_string(root.join(file)).unwrap_or_default();
            assert_eq!(text.matches(old).count(), 1, "{what:?}: {file} must contain {old:?} exactly once");
        }
    }
}
