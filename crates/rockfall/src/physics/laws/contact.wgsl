// requires model/step.wgsl laws/chosen.wgsl physics/contact.wgsl physics/round_pair.wgsl physics/laws/before.wgsl
// requires physics/laws/history.wgsl physics/laws/jkr.wgsl physics/laws/resistance.wgsl physics/laws/stiffness.wgsl
// requires physics/pairs.wgsl physics/wall_damping.wgsl physics/walls.wgsl

// Forces of a contact by a law with history, and its tangential spring (docs/physics section 4.11).

struct LawForce {
    contact: ContactForce,
    // Torque on A against rolling and twisting. B gets the opposite.
    moment: vec3f,
    spring: Spring,
}

// The displacement of the last step, turned into the present tangent plane. It keeps its length, but shrinks when the contact
// unloads.
fn carried(before: Spring, n: vec3f, unloading: f32) -> vec3f {
    let turned = before.shift - dot(before.shift, n) * n;
    let left = length(turned);
    if left == 0.0 {
        return vec3f(0.0);
    }
    return length(before.shift) / left * unloading * turned;
}

// The contact of objects a and b, of which a was added first. Its spring is advanced by a time step. `start` is what it begins with.
fn law_force(a_side: Side, b_side: Side, touch: Touch, a: u32, b: u32, start: Before) -> LawForce {
    let b_moves = b < step.spheres + step.rods;
    var before = start.spring;
    if WALLS & !b_moves {
        // The spring turns with the wall.
        let angle = spring_time() * b_side.spin;
        before.shift = turned_by(before.shift, angle);
        before.moment = turned_by(before.moment, angle);
    }
    let n = touch.n;
    let overlap = touch.overlap;
    let arms = arms_of(a_side, b_side, overlap, b_moves);
    let relative = a_side.velocity - b_side.velocity;
    let approach = dot(relative, n);
    let no_force = ContactForce(vec3f(0.0), vec3f(0.0), arms.x, arms.y);
    var result = LawForce(no_force, vec3f(0.0), Spring(vec3f(0.0), overlap, vec3f(0.0)));
    if before.overlap < 0.0 {
        // The sphere passes a polygon from behind.
        result.spring.overlap = before.overlap;
        return result;
    }
    if !has_force(overlap, approach, smaller_radius(a_side.radius, b_side.radius, b_moves), a, b) {
        return result;
    }
    let mass = 1.0 / (a_side.inverse_mass + b_side.inverse_mass);
    let radius = select(a_side.radius, a_side.radius * b_side.radius / (a_side.radius + b_side.radius), b_moves);
    var constants = law_constants_of(a, b);
    constants.z *= shared_damping(a, b, overlap, n, vec2f(a_side.inverse_mass, b_side.inverse_mass));
    var cohesion = 0.0;
    if COHESION {
        cohesion = cohesion_of(a, b);
    }
    let bond = bond_at(cohesion, radius, overlap);
    let answer = law_answer(LawContact(a, b, constants, radius, mass, bond.depth, approach, before.overlap));
    let stiff = answer.stiff;
    let push = answer.press;
    let elastic = stiff.share * stiff.normal * bond.depth;
    // What limits friction: the push, or with JKR the whole force and twice the pull-off force.
    let press = max(0.0, push - bond.pull * elastic * (1.0 - 0.5 * bond.pull));

    let moving = relative + cross(arms.x * a_side.spin + arms.y * b_side.spin, n);
    let slip = moving - dot(moving, n) * n;
    var shift = spring_time() * slip;
    if (before.overlap > 0.0) | start.share.is_shared {
        shift += carried(before, n, select(stiff.unloading, start.share.unloading, start.share.is_shared));
    }
    let stiffness = start.share.stiffness * stiff.tangential;
    let dashpot = sqrt(start.share.stiffness) * answer.dashpot * slip;
    var rub = -stiffness * shift - dashpot;
    let size = length(rub);
    let limit = constants.w * press;
    if size > limit {
        // The spring is set so that the force is at Coulomb's limit. It is released where the dashpot alone exceeds the limit,
        // because it would push the contact along its slip.
        rub *= limit / size;
        shift = select(vec3f(0.0), -(rub + dashpot) / stiffness, dot(rub + dashpot, rub) > 0.0);
    }
    let normal = push - radius * max(0.0, cohesion) - bond.pull * elastic;
    result.contact = ContactForce(rub - normal * n, cross(n, rub), arms.x, arms.y);
    result.spring.shift = shift;
    result.spring.overlap = bond.depth;
    if RESISTANCE {
        let turning = Turning(n, bond.depth, radius, press, answer.dashpot);
        let found = resistance(a_side, b_side, turning, stiff, resistance_of(a, b), before.moment, before.overlap);
        result.moment = found.torque;
        result.spring.moment = found.kept;
    }
    let kept = result.spring;
    if !(finite(kept.shift) & finite(vec3f(kept.overlap)) & finite(kept.moment)) {
        // As for a new contact.
        result.spring = Spring(vec3f(0.0), 0.0, vec3f(0.0));
    }
    return result;
}
