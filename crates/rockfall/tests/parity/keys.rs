//! Keys of verdicts on broken kernels (`common/verdicts.rs`): hashes of kernels, of worlds, and of the code that compares.

use std::mem::take;

use bytemuck::{bytes_of, cast_slice};
use rockfall::exec::gpu::join;
use rockfall::model::world::World;
use rockfall::step::schedule::Run;
use rockfall::step::wgsl::Variant;

use crate::broken::Mistake;
use crate::compare::{Tolerance, add_expected};
use crate::verdicts::Key;

/// The key of a file that compares, and of the files that it uses for that.
pub(crate) fn code(own: &str) -> Key {
    Key::of_code(&[
        own,
        include_str!("keys.rs"),
        include_str!("device.rs"),
        include_str!("compare.rs"),
        include_str!("order.rs"),
        include_str!("decisions.rs"),
    ])
}

/// Adds everything in a world.
pub(crate) fn add_world(key: &mut Key, world: &World) {
    let mut rest = world.clone();
    for vectors in rest.states.iter_mut().chain([&mut rest.extents, &mut rest.wrenches, &mut rest.orientations]) {
        key.add(cast_slice(&take(vectors)));
    }
    for words in [&mut rest.topology, &mut rest.cells, &mut rest.lists, &mut rest.histories] {
        key.add(cast_slice(&take(words)));
    }
    key.add(cast_slice(&take(&mut rest.aabbs)));
    key.add(cast_slice(&take(&mut rest.rates)));
    key.add(bytes_of(&take(&mut rest.status)));
    // What is left is small.
    key.add(format!("{rest:?}"));
}

/// Adds the kernels of stages, as the device compiles them for a world, and how they are run.
fn add_kernels(key: &mut Key, runs: &[Run], world: &World) {
    for Run { stage, pass, when, every } in runs {
        key.add(Variant::of(&world.step).apply(&join(&stage.parts())));
        key.add(format!("{} {:?} {:?} {pass} {when:?} {every}", stage.name, stage.bindings, stage.threads));
    }
}

/// The key of the input and of the expected result of stages.
pub(crate) fn of_input(mut key: Key, runs: &[Run], before: &World, tolerance: Tolerance) -> Key {
    add_world(&mut key, before);
    add_expected(&mut key, runs, before, tolerance);
    key
}

/// The key of stages one of which has a mistake. `key` is that of their input.
pub(crate) fn of_kernels(mut key: Key, broken: &[Run], before: &World, mistake: &Mistake) -> u64 {
    add_kernels(&mut key, broken, before);
    key.add(format!("{:?}", mistake.5));
    key.value()
}
