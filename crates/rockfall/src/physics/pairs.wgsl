// requires model/objects.wgsl model/step.wgsl

// Properties of the contacts of two objects, which follow from their materials (docs/physics section 4.10).

// First word of the properties of the pair of objects a and b.
fn pair_at(a: u32, b: u32) -> u32 {
    let one = topology[step.tags_at + a] >> MATERIAL_SHIFT;
    let other = topology[step.tags_at + b] >> MATERIAL_SHIFT;
    return step.pairs_at + PAIR_WORDS * (one * step.materials + other);
}

// Number of the pair of materials of objects a and b.
fn pair_number(a: u32, b: u32) -> u32 {
    return (pair_at(a, b) - step.pairs_at) / PAIR_WORDS;
}

// A property of the pair of objects a and b: the one at `place` in the row of their materials, or `of_scene` where that is not
// given.
fn pair_property(a: u32, b: u32, place: u32, of_scene: f32) -> f32 {
    if !MATERIALS {
        return of_scene;
    }
    let given = float_at(pair_at(a, b) + place);
    return select(given, of_scene, given < 0.0);
}

// Coefficient of restitution.
fn restitution_of(a: u32, b: u32) -> f32 {
    return pair_property(a, b, 0u, step.restitution);
}

// Strength of the friction force of the square-root law.
fn friction_of(a: u32, b: u32) -> f32 {
    return pair_property(a, b, 1u, step.friction);
}

// Coefficient of Coulomb friction in contacts.
fn coulomb_friction_of(a: u32, b: u32) -> f32 {
    return pair_property(a, b, 2u, step.coulomb_friction);
}

// Coefficient of Coulomb friction in collisions.
fn collision_friction_of(a: u32, b: u32) -> f32 {
    return pair_property(a, b, 3u, step.collision_friction);
}

// Constants of a law with history: normal, tangential, damping, friction.
fn law_constants_of(a: u32, b: u32) -> vec4f {
    let at = pair_at(a, b) + 4u;
    return vec4f(float_at(at), float_at(at + 1u), float_at(at + 2u), float_at(at + 3u));
}

// Constants of rolling and twisting resistance: coefficient of rolling friction; damping ratio, negative for the model of constant
// torque; coefficient of twisting friction.
fn resistance_of(a: u32, b: u32) -> vec4f {
    let at = pair_at(a, b) + 8u;
    return vec4f(float_at(at), float_at(at + 1u), float_at(at + 2u), 0.0);
}

// DMT: pull-off force per effective radius. JKR: -(pi gamma / (4 E*))^(1/3).
fn cohesion_of(a: u32, b: u32) -> f32 {
    return float_at(pair_at(a, b) + 11u);
}
