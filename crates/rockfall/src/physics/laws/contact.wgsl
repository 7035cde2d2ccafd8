// requires model/step.wgsl physics/contact.wgsl physics/geometry.wgsl physics/laws/hertz_mindlin.wgsl
// requires physics/laws/history.wgsl physics/laws/linear.wgsl physics/laws/resistance.wgsl physics/laws/stiffness.wgsl
// requires physics/pairs.wgsl

// Forces of a contact by a law with history, and its tangential spring (docs/physics.md section 4.11).

fn law_stiffness(constants: vec4f, radius: f32, mass: f32, overlap: f32) -> Stiffness {
    if LAW == LAW_HERTZ_MINDLIN {
        return hertz_mindlin_stiffness(constants, radius, overlap);
    }
    return linear_stiffness(constants, radius, mass);
}

struct LawForce {
    contact: ContactForce,
    // Torque on A against rolling and twisting. B gets the opposite.
    moment: vec3f,
    spring: Spring,
}

// The displacement of the last step, turned into the present tangent plane. It keeps its length, but shrinks when the contact
// of a law that rescales unloads.
fn carried(before: Spring, n: vec3f, overlap: f32, rescales: bool) -> vec3f {
    let turned = before.shift - dot(before.shift, n) * n;
    let left = length(turned);
    if left == 0.0 {
        return vec3f(0.0);
    }
    var scale = length(before.shift) / left;
    if rescales & (overlap < before.overlap) {
        scale *= sqrt(overlap / before.overlap);
    }
    return scale * turned;
}

// The contact of objects a and b, of which a was added first. Its spring is advanced by a time step.
fn law_force(a_side: Side, b_side: Side, touch: Touch, a: u32, b: u32, before: Spring) -> LawForce {
    let b_moves = b < step.spheres + step.rods;
    let n = touch.n;
    let overlap = touch.overlap;
    let arms = arms_of(a_side, b_side, overlap, b_moves);
    let relative = a_side.velocity - b_side.velocity;
    let approach = dot(relative, n);
    let no_force = ContactForce(vec3f(0.0), vec3f(0.0), arms.x, arms.y);
    var result = LawForce(no_force, vec3f(0.0), Spring(vec3f(0.0), overlap, vec3f(0.0)));
    if !has_force(overlap, approach, smaller_radius(a_side.radius, b_side.radius, b_moves)) {
        return result;
    }
    let mass = 1.0 / (a_side.inverse_mass + b_side.inverse_mass);
    let radius = select(a_side.radius, a_side.radius * b_side.radius / (a_side.radius + b_side.radius), b_moves);
    let constants = law_constants_of(a, b);
    let stiff = law_stiffness(constants, radius, mass, overlap);
    let press = max(0.0, stiff.share * stiff.normal * overlap + constants.z * sqrt(stiff.normal * mass) * approach);

    let moving = relative + cross(arms.x * a_side.spin + arms.y * b_side.spin, n);
    let slip = moving - dot(moving, n) * n;
    var shift = step.dt * slip;
    if before.overlap > 0.0 {
        shift += carried(before, n, overlap, stiff.rescales);
    }
    let dashpot = constants.z * sqrt(stiff.tangential * mass) * slip;
    var rub = -stiff.tangential * shift - dashpot;
    let size = length(rub);
    let limit = constants.w * press;
    if size > limit {
        // The spring is set so that the force is at Coulomb's limit. It is released where the dashpot alone exceeds the limit,
        // because it would push the contact along its slip.
        rub *= limit / size;
        shift = select(vec3f(0.0), -(rub + dashpot) / stiff.tangential, dot(rub + dashpot, rub) > 0.0);
    }
    var normal = press;
    if COHESION {
        normal -= radius * cohesion_of(a, b);
    }
    result.contact = ContactForce(rub - normal * n, cross(n, rub), arms.x, arms.y);
    result.spring.shift = shift;
    if RESISTANCE {
        let turning = Turning(n, overlap, radius, press, constants.z * sqrt(stiff.tangential * mass));
        let found = resistance(a_side, b_side, turning, stiff, resistance_of(a, b), before.moment, before.overlap);
        result.moment = found.torque;
        result.spring.moment = found.kept;
    }
    return result;
}
