// requires model/step.wgsl physics/contact.wgsl physics/laws/history.wgsl physics/laws/stiffness.wgsl

// Resistance to rolling and twisting of a contact (docs/physics section 4.12).

// A torque on A, with the part that the contact keeps for the next step.
struct Moment {
    torque: vec3f,
    kept: vec3f,
}

// What both resistances need of a contact.
struct Turning {
    n: vec3f,
    overlap: f32,
    // R*.
    radius: f32,
    // Normal force N.
    press: f32,
    // Tangential force per tangential velocity.
    dashpot: f32,
}

// 1 / (I + m r^2), which is 0 for what is fixed.
fn about_contact(side: Side) -> f32 {
    let below = side.inverse_mass + side.inverse_inertia * side.radius * side.radius;
    return select(0.0, side.inverse_mass * side.inverse_inertia / below, side.inverse_mass > 0.0);
}

// Rolling resistance with the coefficient `mu` and the damping ratio `eta`, which is negative for the model of constant torque.
// `old` is the moment of the spring before the step.
fn rolling(a: Side, b: Side, contact: Turning, stiff: Stiffness, mu: f32, eta: f32, spin: vec3f, old: vec3f) -> Moment {
    let most = mu * contact.radius * contact.press;
    if eta < 0.0 {
        let rate = length(spin);
        if rate == 0.0 {
            return Moment(vec3f(0.0), vec3f(0.0));
        }
        let stopping = 0.5 * rate / (step.dt * (a.inverse_inertia + b.inverse_inertia));
        return Moment(-min(most, stopping) / rate * spin, vec3f(0.0));
    }
    let reach = mu * contact.radius;
    let k = 2.25 * stiff.normal * reach * reach;
    let moment = old - spring_time() * k * spin;
    let size = length(moment);
    if size > most {
        return Moment(most / size * moment, most / size * moment);
    }
    let c = 2.0 * eta * sqrt(k / (about_contact(a) + about_contact(b)));
    return Moment(moment - c * spin, moment);
}

// Twisting resistance: torque and kept moment along the normal.
fn twisting(contact: Turning, stiff: Stiffness, mu: f32, spin: f32, old: f32) -> vec2f {
    let a2 = contact.radius * contact.overlap;
    let most = 2.0 * mu * contact.press * sqrt(a2) / 3.0;
    let moment = old - 0.5 * a2 * stiff.tangential * spring_time() * spin;
    if abs(moment) > most {
        return vec2f(sign(moment) * most);
    }
    return vec2f(moment - 0.5 * a2 * contact.dashpot * spin, moment);
}

// Both resistances of a contact. `constants` are mu_r, the damping ratio and mu_q of the pair. `before` is the moment after the
// last step, in which the overlap was `old_overlap`.
fn resistance(
    a: Side,
    b: Side,
    contact: Turning,
    stiff: Stiffness,
    constants: vec4f,
    before: vec3f,
    old_overlap: f32,
) -> Moment {
    var roll_scale = 1.0;
    var twist_scale = 1.0;
    if contact.overlap < old_overlap {
        twist_scale = contact.overlap / old_overlap;
        roll_scale = stiff.unloading;
        twist_scale *= roll_scale;
    }
    let w = a.spin - b.spin;
    let along = dot(w, contact.n);
    let old_along = dot(before, contact.n);
    var sum = Moment(vec3f(0.0), vec3f(0.0));
    if constants.x > 0.0 {
        let old = roll_scale * (before - old_along * contact.n);
        sum = rolling(a, b, contact, stiff, constants.x, constants.y, w - along * contact.n, old);
    }
    if constants.z > 0.0 {
        let found = twisting(contact, stiff, constants.z, along, twist_scale * old_along);
        sum.torque += found.x * contact.n;
        sum.kept += found.y * contact.n;
    }
    return sum;
}
