// requires model/objects.wgsl model/step.wgsl physics/fine.wgsl physics/forces/muscle.wgsl

// Forces of springs and tethers, and external forces (docs/physics sections 4.1 and 4.2).

// Force of a spring on the end at `position`. `constants` are stiffness, rest length and damping.
fn spring_force(position: vec3f, velocity: vec3f, other: vec3f, other_velocity: vec3f, constants: vec3f) -> vec3f {
    return spring_force_along(other - position, velocity, other_velocity, constants);
}

// The same, from the vector to the other end.
fn spring_force_along(distance: vec3f, velocity: vec3f, other_velocity: vec3f, constants: vec3f) -> vec3f {
    let squared = dot(distance, distance);
    if squared <= TINY {
        return vec3f(0.0);
    }
    let d = sqrt(squared);
    let n = distance / d;
    return (constants.x * (d - constants.y) + constants.z * dot(other_velocity - velocity, n)) * n;
}

// Force of a spring, a tether or an external force on sphere `i`.
fn attached_force(i: u32, kind: u32, index: u32) -> vec3f {
    // Where springs are stored field by field, `run_worlds` evaluates them itself.
    if !BY_FIELD & (kind == KIND_SPRING) {
        let spring = step.springs_at + index * SPRING_WORDS;
        let other = select(topology[spring], topology[spring + 1u], topology[spring] == i);
        let constants = vector_at(spring + 2u);
        if DOUBLE {
            let resting = vec3f(constants.x, rest_length(index, constants.y), constants.z);
            let distance = fine_apart(i, other);
            return spring_force_along(distance.high, state[velocity_at(i)].xyz, state[velocity_at(other)].xyz, resting);
        }
        return spring_force(
            state[position_at(i)].xyz,
            state[velocity_at(i)].xyz,
            state[position_at(other)].xyz,
            state[velocity_at(other)].xyz,
            vec3f(constants.x, rest_length(index, constants.y), constants.z),
        );
    }
    if kind == KIND_TETHER {
        let tether = step.tethers_at + index * TETHER_WORDS;
        if DOUBLE {
            let from_point = fine_from(vector_at(tether + 1u), i);
            let distance = -(from_point.high + from_point.low);
            return spring_force_along(distance, state[velocity_at(i)].xyz, vec3f(0.0), vector_at(tether + 4u));
        }
        return spring_force(
            state[position_at(i)].xyz,
            state[velocity_at(i)].xyz,
            vector_at(tether + 1u),
            vec3f(0.0),
            vector_at(tether + 4u),
        );
    }
    return vector_at(step.forces_at + index * FORCE_WORDS);
}

// Second derivative of a spring's energy when its distance vector changes along `stretch`, in energy per square of the
// displacement.
fn spring_curvature(distance: vec3f, stretch: vec3f, stiffness: f32, rest_length: f32) -> f32 {
    let squared = dot(distance, distance);
    if squared <= TINY {
        return 0.0;
    }
    let along = dot(stretch, distance);
    let slack = rest_length / sqrt(squared);
    return stiffness * ((1.0 - slack) * dot(stretch, stretch) + slack * along * along / squared);
}
