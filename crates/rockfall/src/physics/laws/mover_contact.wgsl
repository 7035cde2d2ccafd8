// requires model/entries.wgsl model/order.wgsl model/step.wgsl physics/contact.wgsl physics/forces/net_force.wgsl
// requires physics/chain.wgsl physics/round_pair.wgsl physics/laws/before.wgsl physics/laws/contact.wgsl physics/laws/history.wgsl physics/laws/jkr.wgsl physics/rigid_side.wgsl

// A contact of a mover by a law with history.
struct MoverContact {
    // On the mover.
    push: Push,
    // Parameter on the mover, if it is a rod.
    at: f32,
    // The objects touch, or a neck connects them. If not, all other values are 0.
    touches: bool,
    // The mover is side A.
    is_a: bool,
    // The mover keeps the spring after the step.
    owns: bool,
    spring: Spring,
}

fn no_mover_contact() -> MoverContact {
    return MoverContact(no_push(), 0.0, false, false, false, Spring(vec3f(0.0), 0.0, vec3f(0.0)));
}

// The contact of a mover with the object of a list entry.
fn mover_contact(mover: u32, entry: u32) -> MoverContact {
    let feature = entry_feature(entry);
    let pair = ordered(mover, entry_id(entry));
    var found = touch(pair.x, pair.y, feature);
    if found.overlap <= 0.0 {
        if COHESION {
            found = neck(pair.x, pair.y, feature, found);
        }
        if !COHESION | (found.overlap == NO_CONTACT_LINE) {
            return no_mover_contact();
        }
    }
    let a_side = in_body(side_of(pair.x, found.a), pair.x, found.a, found);
    let b_side = in_body(second_side(pair.x, pair.y, found), pair.y, found.b, found);
    if a_side.inverse_mass + b_side.inverse_mass <= 0.0 {
        return no_mover_contact();
    }
    let before = spring_before(pair.x, pair.y, feature, found);
    let law = law_force(a_side, b_side, found, pair.x, pair.y, before);
    let is_a = mover == pair.x;
    var push = Push(select(-law.contact.force, law.contact.force, is_a), law.contact.torque_per_arm, 0.0, found.overlap);
    push.arm = select(law.contact.arm_b, law.contact.arm_a, is_a);
    if RESISTANCE {
        push.torque_per_arm = fma(push.torque_per_arm, vec3f(push.arm), select(-law.moment, law.moment, is_a));
        push.arm = 1.0;
    }
    let owns = (first_owns(pair.x, pair.y) == is_a) & advances_springs();
    return MoverContact(push, select(found.b, found.a, is_a), true, is_a, owns, law.spring);
}
