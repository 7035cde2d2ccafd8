//! Every joined kernel is valid, stays within the limits of every browser, and has the same layout as the Rust side.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, Module, StorageAccess, TypeInner};
use rockfall::ContactLaw;
use rockfall::model::dispatch::Threads;
use rockfall::model::layout;
use rockfall::model::status::{Counters, Status};
use rockfall::model::step::{Aabb, Layout, Pass, Step};
use rockfall::step::catalog::{ALL, OUTSIDE};
use rockfall::step::prune::prune;
use rockfall::step::stage::{Access, Stage};
use rockfall::step::wgsl::{Variant, WorldBatch, WorldSizes};

/// Limits that WebGPU guarantees.
const MAX_STORAGE_BUFFERS: usize = 8;
const MAX_WORKGROUP_BYTES: u32 = 16 * 1024;
const MAX_INVOCATIONS: u32 = 256;

fn source(stage: &Stage) -> String {
    stage.parts().iter().map(|part| part.text).collect()
}

fn module(stage: &Stage) -> Module {
    module_for(stage, [true; 3])
}

/// The module for scenes with or without rods, large spheres and muscles.
fn module_for(stage: &Stage, [rods, large, muscles]: [bool; 3]) -> Module {
    // Each contact law occurs in one of the variants that are checked.
    let laws: Vec<u32> = (0..).zip(ContactLaw::ALL).filter(|(_, law)| law.has_history()).map(|(number, _)| number).collect();
    assert!(laws.len() <= 4, "not all laws are checked");
    let law = if large { 0 } else { laws[(usize::from(rods) + 2 * usize::from(muscles)) % laws.len()] };
    let text = Variant {
        rods,
        large,
        muscles,
        walls: large || rods,
        rigid: muscles,
        passages: large || rods,
        triangles: large || rods,
        smooth: large || rods,
        sheared: large || rods,
        rod_polygons: large || rods,
        periodic: large || rods,
        materials: true,
        resistance: rods,
        cohesion: rods,
        verlet: muscles,
        half_step: large,
        free_table: rods,
        double: rods != muscles,
        residues: rods == muscles,
        continuous: large,
        law,
        many: false,
        worlds: None,
    }
    .apply(&source(stage));
    let text = prune(&text);
    naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}: {}", stage.name, e.emit_to_string(&text)))
}

#[test]
fn every_kernel_is_valid() {
    let scenes = (0..8).map(|bits| [1, 2, 4].map(|bit| bits & bit != 0));
    for (stage, scene) in ALL.into_iter().flat_map(|stage| scenes.clone().map(move |scene| (stage, scene))) {
        let module = module_for(stage, scene);
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}: {}", stage.name, e.emit_to_string(&source(stage))));
        assert!(module.entry_points.iter().any(|entry| entry.name == stage.name), "no entry point {}", stage.name);
    }
}

/// WebGPU guarantees 16 KiB of workgroup memory. The kernel takes far less, because a device runs the more worlds at a time.
#[test]
fn the_kernel_of_worlds_is_valid_and_fits_workgroup_memory() {
    let of_one = bytes_of_worlds(WorldBatch { sizes: WorldSizes::MOST, shared: false });
    assert!((4 * 1024..=5 * 1024).contains(&of_one), "{of_one} bytes");
    let of_three = bytes_of_worlds(WorldBatch { sizes: WorldSizes::BODIES, shared: true });
    // With the alignment of its variables.
    assert!((7 * 1024..=8 * 1024 + 256).contains(&of_three), "{of_three} bytes");
}

/// Workgroup memory of the kernel of worlds, which must be valid.
fn bytes_of_worlds(worlds: WorldBatch) -> u32 {
    let [stage] = OUTSIDE;
    let worlds = Some(worlds);
    let (rods, large, muscles, materials, resistance, many, walls) = (false, false, false, false, false, false, false);
    let (cohesion, verlet, half_step, free_table, double, continuous) = (false, false, false, false, false, false);
    let kinds = Variant {
        rods,
        large,
        muscles,
        walls,
        rigid: false,
        passages: false,
        triangles: false,
        smooth: false,
        sheared: false,
        rod_polygons: false,
        periodic: false,
        law: 0,
        materials,
        resistance,
        cohesion,
        verlet,
        half_step,
        free_table,
        double,
        residues: false,
        continuous,
        many,
        worlds,
    };
    let variant = kinds;
    let text = variant.apply(&source(stage));
    assert!(text.contains("world_steps[own_world].dt") && !text.contains("var<uniform> step"));
    // Compile errors name line numbers.
    assert_eq!(text.lines().count(), source(stage).lines().count());
    let module = naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator.validate(&module).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
    let mut layouts = naga::proc::Layouter::default();
    layouts.update(module.to_ctx()).expect("layouts of all types");
    let shared = module.global_variables.iter().filter(|(_, variable)| variable.space == AddressSpace::WorkGroup);
    shared.map(|(_, variable)| layouts[variable.ty].size.next_multiple_of(16)).sum()
}

/// Kernels whose arrays exceed one binding: each array alone, and all of them.
#[cfg(feature = "gpu")]
#[test]
fn every_kernel_is_valid_with_its_arrays_in_chunks() {
    use rockfall::exec::gpu::{Split, split};
    use rockfall::model::buffer::Buffer;
    for stage in ALL {
        let count = stage.bindings.len();
        let alone = (0..count).map(|split| (0..count).map(|binding| if binding == split { 3 } else { 1 }).collect());
        let text = source(stage);
        for mut chunks in alone.chain([vec![2; count]]) {
            for (chunks, binding) in chunks.iter_mut().zip(stage.bindings) {
                if binding.slot.buffer(0) == Buffer::Status {
                    *chunks = 1;
                }
            }
            let split = split(&text, &Split::of(stage, &chunks, 1 << 20));
            let message = |error: &dyn std::fmt::Display| format!("{} in chunks {chunks:?}: {error}", stage.name);
            let module =
                naga::front::wgsl::parse_str(&split).unwrap_or_else(|e| panic!("{}", message(&e.emit_to_string(&split))));
            let valid = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
            valid.unwrap_or_else(|e| panic!("{}", message(&e.emit_to_string(&split))));
            let bound = module.global_variables.iter().filter(|(_, variable)| variable.binding.is_some()).count();
            assert_eq!(bound, 2 + chunks.iter().sum::<u32>() as usize, "{}", message(&"bindings"));
            // Compile errors name line numbers.
            assert_eq!(split.lines().zip(text.lines()).count(), text.lines().count());
            let moved = text.lines().zip(split.lines()).any(|(one, other)| one.is_empty() != other.is_empty());
            assert!(!moved, "{}", message(&"line numbers must not change"));
        }
    }
}

/// The first element of a chunk follows from the element size that the kernels declare.
#[cfg(feature = "gpu")]
#[test]
fn chunks_begin_at_element_boundaries() {
    use rockfall::exec::gpu::{Split, split};
    for stage in ALL {
        let module = module(stage);
        for binding in stage.bindings {
            let named = |variable: &&naga::GlobalVariable| variable.name.as_deref() == Some(binding.name);
            let variable = module.global_variables.iter().map(|(_, variable)| variable).find(named).expect("a binding");
            let TypeInner::Array { stride, .. } = module.types[variable.ty].inner else { continue };
            let chunks: Vec<u32> = stage.bindings.iter().map(|one| if one.name == binding.name { 2 } else { 1 }).collect();
            let text = split(&source(stage), &Split::of(stage, &chunks, 1 << 20));
            let second = format!("{}_1[i - {}u]", binding.name, (1 << 20) / stride);
            assert!(text.contains(&second), "{}: no {second}", stage.name);
        }
    }
}

#[test]
fn every_kernel_stays_within_the_limits_of_webgpu() {
    for stage in ALL {
        assert!(stage.bindings.len() <= MAX_STORAGE_BUFFERS, "{}: {} storage buffers", stage.name, stage.bindings.len());
        let module = module(stage);
        let shared: u32 = module
            .global_variables
            .iter()
            .filter(|(_, variable)| variable.space == AddressSpace::WorkGroup)
            .map(|(_, variable)| module.types[variable.ty].inner.size(module.to_ctx()).next_multiple_of(16))
            .sum();
        assert!(shared <= MAX_WORKGROUP_BYTES, "{}: {shared} bytes of workgroup memory", stage.name);
        for entry in module.entry_points.iter().filter(|entry| entry.name == stage.name) {
            let invocations: u32 = entry.workgroup_size.iter().product();
            assert!(invocations <= MAX_INVOCATIONS, "{}: {invocations} invocations", stage.name);
            // These stages have one workgroup, not one thread, per item.
            let groups = matches!(stage.threads, Threads::One | Threads::Blocks | Threads::LongMovers | Threads::Motions);
            let wide = matches!(stage.threads, Threads::WideObjects | Threads::WideSpheres);
            let expected = if wide { layout::WIDE_WORKGROUP } else { layout::WORKGROUP };
            assert!(groups || invocations == expected, "{}: {invocations} invocations", stage.name);
        }
    }
}

#[test]
fn the_bindings_equal_those_of_the_stage() {
    for stage in ALL {
        let module = module(stage);
        let mut found: Vec<(u32, String, Option<Access>)> = module
            .global_variables
            .iter()
            .filter_map(|(_, variable)| {
                let binding = variable.binding?;
                assert_eq!(binding.group, 0, "{}", stage.name);
                let access = match variable.space {
                    AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => Some(Access::Write),
                    AddressSpace::Storage { .. } => Some(Access::Read),
                    _ => None,
                };
                Some((binding.binding, variable.name.clone().unwrap_or_default(), access))
            })
            .collect();
        found.sort_by_key(|(number, ..)| *number);
        let mut expected = vec![(0, "step".to_owned(), None), (1, "pass_".to_owned(), None)];
        expected.extend(
            stage.bindings.iter().zip(2..).map(|(binding, number)| (number, binding.name.to_owned(), Some(binding.access))),
        );
        assert_eq!(found, expected, "{}", stage.name);
    }
}

/// The binding tables of docs/buffers.md equal the bindings of the stages.
#[test]
fn the_documentation_lists_the_bindings() {
    let text = include_str!("../../../../docs/buffers.md");
    for stage in ALL {
        let name = |binding: &rockfall::step::stage::Binding| match binding.access {
            Access::Read => binding.name.to_owned(),
            Access::Write => format!("**{}**", binding.name),
        };
        let names: Vec<String> = stage.bindings.iter().map(name).collect();
        let row = format!("| `{}` | {} |", stage.name, names.join(", "));
        assert!(text.contains(&row), "docs/buffers.md lacks the row {row}");
    }
}

/// A writable buffer must not be bound twice in one dispatch.
#[test]
fn no_stage_writes_a_buffer_that_it_binds_twice() {
    use rockfall::step::schedule::Phase;
    use rockfall::{BroadPhase, Integrator};
    let methods = [(Integrator::Rk4, BroadPhase::BruteForce), (Integrator::SymplecticEuler, BroadPhase::Grid)];
    for (integrator, broad_phase) in methods {
        for run in Phase::STEP.iter().flat_map(|phase| phase.stages(integrator, broad_phase)) {
            for (k, one) in run.stage.bindings.iter().enumerate() {
                for other in &run.stage.bindings[k + 1..] {
                    let same = one.slot.buffer(run.pass) == other.slot.buffer(run.pass);
                    let written = one.access == Access::Write || other.access == Access::Write;
                    assert!(!(same && written), "{} pass {}", run.stage.name, run.pass);
                }
            }
        }
    }
}

/// Name, offset and size of every field, in order.
type Fields = Vec<(String, u32, u32)>;

fn wgsl_fields(module: &Module, name: &str) -> (Fields, u32) {
    let (_, found) =
        module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap_or_else(|| panic!("no struct {name}"));
    let TypeInner::Struct { members, span } = &found.inner else {
        panic!("{name} is not a struct");
    };
    let fields = members
        .iter()
        .map(|member| {
            let size = module.types[member.ty].inner.size(module.to_ctx());
            (member.name.clone().unwrap_or_default(), member.offset, size)
        })
        .collect();
    (fields, *span)
}

/// The rules of alignment differ in Rust and in WGSL.
#[test]
fn the_structs_are_laid_out_as_in_rust() {
    let named = |(name, at, size): (&str, usize, usize)| (name.to_owned(), at as u32, size as u32);
    let own = |fields: &[(&'static str, usize, usize)]| -> Fields { fields.iter().copied().map(named).collect() };
    // The size of a uniform block is rounded up to the alignment of vec3f.
    let step = (Step::fields().map(named).collect::<Fields>(), (size_of::<Step>() as u32).next_multiple_of(16));
    let pass = (own(Pass::FIELDS), size_of::<Pass>() as u32);
    let aabb = (own(Aabb::FIELDS), size_of::<Aabb>() as u32);
    for stage in ALL {
        let module = module(stage);
        assert_eq!(wgsl_fields(&module, "Step"), step, "{}", stage.name);
        assert_eq!(wgsl_fields(&module, "Pass"), pass, "{}", stage.name);
        assert_eq!(wgsl_fields(&module, "Aabb"), aabb, "{}", stage.name);
        for suffix in ["", "Atomic"] {
            let (counters, size) = wgsl_fields(&module, &format!("Counters{suffix}"));
            let expected = own(Counters::FIELDS);
            assert_eq!((&counters[..expected.len()], size), (&expected[..], size_of::<Counters>() as u32), "{}", stage.name);
            let (status, size) = wgsl_fields(&module, &format!("Status{suffix}"));
            assert_eq!((&status[1..], size), (&own(Status::FIELDS)[..], size_of::<Status>() as u32), "{}", stage.name);
        }
    }
}

/// The bits of a list entry depend on whether the scene has rods.
#[test]
fn the_bits_of_a_list_entry_equal_those_of_layout() {
    for rods in [false, true] {
        let layout = Layout { rods: u32::from(rods), ..Layout::default() };
        let step = Step { layout, ..Step::default() };
        let feature_bits = layout::ENTRY_BITS - step.entry_id_bits();
        for (name, expected) in [
            ("ENTRY_ID_BITS", step.entry_id_bits()),
            ("ENTRY_ID_MASK", step.entry_id_mask()),
            ("FEATURE_BITS", feature_bits),
            ("FEATURE_MASK", (1 << feature_bits) - 1),
        ] {
            let found: Vec<u32> = ALL.into_iter().filter_map(|stage| constant_with(stage, rods, name)).collect();
            assert!(!found.is_empty() && found.iter().all(|value| *value == expected), "{name}: {found:?}, not {expected}");
        }
    }
}

/// Value of a constant that depends on whether the scene has rods, if the stage uses it.
fn constant_with(stage: &Stage, rods: bool, name: &str) -> Option<u32> {
    let module = module_for(stage, [rods, true, true]);
    let mut constants = module.constants.iter().map(|(_, constant)| constant);
    let init = constants.find(|constant| constant.name.as_deref() == Some(name))?.init;
    match module.global_expressions[init] {
        naga::Expression::Literal(naga::Literal::U32(value)) => Some(value),
        ref other => panic!("{name} is {other:?}"),
    }
}
