//! Random bodies with joints (docs/physics section 11.14).

use rockfall::glam::{DVec3, Vec3};
use rockfall::{Anchor, Joint, JointKind};

use super::scenes::Draw;

/// A chain of boxes, from the world on or free.
fn chain(draw: &mut Draw, joint: impl Fn(&mut Draw, Joint) -> Joint) {
    let count = 1 + draw.number(4);
    let mut from = draw.chance(0.7).then_some(Anchor::World);
    let mut place = Vec3::new(0.0, 3.0, 0.0);
    for _ in 0..count {
        let (half, turn, way) = (draw.half(), draw.turn(), draw.vector(1.0).normalize());
        let at = place + 0.5 * way;
        let body = Anchor::Body(draw.cuboid(half, at, turn, 1.0, 2.0));
        if let Some(from) = from {
            let (anchor, axis) = (place.as_dvec3(), draw.vector(1.0).normalize().as_dvec3());
            let to = anchor + 0.3 * draw.vector(1.0).as_dvec3() + DVec3::splat(0.2);
            let made = match draw.number(5) {
                0 => Joint::ball(from, body, anchor).axis(axis),
                1 => Joint::hinge(from, body, anchor, axis),
                2 => Joint::slider(from, body, anchor, axis),
                3 => Joint::fixed(from, body, anchor),
                _ => Joint::distance(from, body, anchor, to),
            };
            let made = joint(draw, made);
            draw.scene.add_joint(made).expect("a valid joint");
        }
        from = Some(body);
        place += way;
    }
}

/// Groups that do not meet keep the bodies of a chain apart.
pub(crate) fn plain(seed: u64) -> Draw {
    let mut draw = Draw::new(seed);
    chain(&mut draw, |_, joint| joint);
    draw
}

/// With limits, motors, springs and friction.
pub(crate) fn driven(seed: u64) -> Draw {
    let mut draw = Draw::new(seed);
    chain(&mut draw, |draw, joint| {
        let kind = joint.kind;
        if kind == JointKind::Fixed {
            return joint;
        }
        let joint = if draw.chance(0.3) { joint.armature(draw.pick(&[0.05, 1.0])) } else { joint };
        // An effort could pull the anchors of a distance joint to one place, where it has no direction.
        let joint = if kind != JointKind::Distance && draw.chance(0.3) {
            joint.drag(draw.pick(&[0.1, 10.0])).effort(draw.between(-3.0, 3.0))
        } else {
            joint
        };
        match draw.number(5) {
            0 if kind == JointKind::Distance => joint.limits(0.0, draw.between(0.9, 1.5)),
            0 => joint.limits(-draw.between(0.0, 0.2), draw.between(0.0, 0.2)),
            1 => {
                let joint = joint.motor(draw.between(-4.0, 4.0));
                if draw.chance(0.5) { joint.max_force(draw.between(0.1, 5.0)) } else { joint }
            }
            2 => {
                let joint = joint.spring(draw.pick(&[0.0, 5.0, 50.0, 1e4]), draw.pick(&[0.1, 1.0]));
                if draw.chance(0.3) { joint.max_force(draw.between(0.1, 5.0)) } else { joint }
            }
            3 => joint.friction(draw.between(0.1, 3.0)),
            _ if kind == JointKind::Ball => joint.cone(draw.between(0.05, 0.4)),
            _ => joint,
        }
    });
    draw
}
