// requires model/objects.wgsl model/step.wgsl physics/forces/attached.wgsl physics/forces/muscle.wgsl physics/forces/net_force.wgsl
// requires step/fused/world_memory.wgsl

// Forces of springs, tethers and external forces in `run_worlds`. Each spring is evaluated once, for both ends.

// A word has the names of four springs. A name is the index of a spring, and a bit that is set at its end B.
const SPRING_NAMES: u32 = 4u;
const END_B: u32 = 128u;
// The springs of the sphere: the first word of their names, and their number.
var<private> own_springs: vec2u;
// First word of what else is attached to the sphere, and one past the last.
var<private> attached: vec2u;

// Evaluates each spring. `has_new_time` tells whether the rest lengths of muscles change.
fn evaluate_springs(local: u32, has_new_time: bool) {
    let count = spring_count();
    for (var first = 0u; first < count; first += WORLD_THREADS) {
        let spring = first + local;
        if spring < count {
            let word = word_of_record(step.springs_at, spring, SPRING_WORDS);
            let a = topology[word];
            let b = topology[word + count];
            var constants = spread_vector_at(word + 2u * count, count);
            if step.muscles_at != 0u {
                if has_new_time {
                    lengths[first_spring + spring] = muscle_length(spring, constants.y);
                }
                constants.y = lengths[first_spring + spring];
            }
            let force = spring_force(
                state[position_at(a)].xyz,
                state[velocity_at(a)].xyz,
                state[position_at(b)].xyz,
                state[velocity_at(b)].xyz,
                constants,
            );
            spring_forces[first_spring + spring] = vec4f(force, 0.0);
        }
    }
}

// Adds the force of a spring, given by its name. On end B it is computed from negated vectors in the stages, so it is the same with
// the other sign.
fn add_spring(name: u32, force: vec4f, net: ptr<function, Net>) {
    (*net).force += select(force.xyz, -force.xyz, (name & END_B) != 0u);
}

// Adds the forces of springs in the order of the adjacency. It reads four at once, so that their memory requests overlap. Names past
// the end are 0, so that the first spring of the world is read and not added.
fn add_springs(net: ptr<function, Net>) {
    for (var k = 0u; k < own_springs.y; k += SPRING_NAMES) {
        let names = vec4u(topology[own_springs.x + k / SPRING_NAMES]) >> vec4u(0u, 8u, 16u, 24u);
        let springs = vec4u(first_spring) + (names & vec4u(END_B - 1u));
        let force_x = spring_forces[springs.x];
        let force_y = spring_forces[springs.y];
        let force_z = spring_forces[springs.z];
        let force_w = spring_forces[springs.w];
        add_spring(names.x, force_x, net);
        if k + 1u < own_springs.y {
            add_spring(names.y, force_y, net);
        }
        if k + 2u < own_springs.y {
            add_spring(names.z, force_z, net);
        }
        if k + 3u < own_springs.y {
            add_spring(names.w, force_w, net);
        }
    }
}

// Adds the forces of springs, tethers and external forces in the order of the adjacency words.
fn add_attached(i: u32, net: ptr<function, Net>) {
    add_springs(net);
    for (var at = attached.x; at < attached.y; at++) {
        let word = topology[at];
        (*net).force += attached_force(i, kind_of(word), index_of(word));
    }
}
