//! Joints in a checkpoint: the length of what follows in bytes, 0 if there are none; the number of joints, each with its kind, its name, its
//! ends, and what acts on it.

use std::collections::HashSet;

use glam::{DVec3, Quat};

use super::words::{Damage, Head, Words};
use crate::scene::{Anchor, Joint, JointFrame, JointKind, Scene, name_is_taken};

pub(super) fn bytes(scene: &Scene) -> Vec<u8> {
    let mut head = Head::default();
    if !scene.joints().is_empty() {
        head.u32(scene.joints().len() as u32);
        scene.joints().iter().for_each(|joint| put_joint(&mut head, scene, joint));
    }
    head.block()
}

/// Adds the joints to a scene that has all other objects.
pub(super) fn put(given: &[u8], scene: &mut Scene) -> Result<(), Damage> {
    if given.is_empty() {
        return Ok(());
    }
    let (mut words, mut names) = (Words::new(given), HashSet::new());
    for _ in 0..words.u32()? {
        let joint = read_joint(&mut words, scene)?;
        if let Some(name) = joint.name.clone()
            && !names.insert(name.clone())
        {
            return Err(name_is_taken(&name).into());
        }
        scene.keep_joint(joint)?;
    }
    words.end()
}

fn put_joint(head: &mut Head, scene: &Scene, joint: &Joint) {
    let Joint {
        kind,
        a,
        b,
        name,
        limits,
        cone,
        speed,
        max_force,
        target,
        stiffness,
        damping,
        effort,
        drag,
        armature,
        friction,
        break_force,
        break_torque,
        collides,
        length,
        laid: _,
    } = joint;
    head.u32(JointKind::ALL.into_iter().position(|known| known == *kind).unwrap_or_default() as u32);
    head.text(name.as_deref().unwrap_or_default());
    for (anchor, JointFrame { place, turn: q }) in [a, b].into_iter().zip(joint.ends().into_iter().flatten()) {
        // The scene contains the ends of all its joints.
        let (kind, index) = match anchor {
            Anchor::World => (0, Ok(0)),
            Anchor::Body(id) => (1, scene.bodies.index(*id)),
            Anchor::Sphere(id) => (2, scene.spheres.index(*id)),
        };
        head.u32(kind);
        head.u32(index.unwrap_or_default() as u32);
        place.to_array().into_iter().chain([q.x, q.y, q.z, q.w]).for_each(|number| head.f32(number));
    }
    let [least, greatest] = limits.map_or([None; 2], |limits| limits.map(Some));
    [least, greatest, *cone, *speed, *target, *length].into_iter().for_each(|number| head.known(number));
    let numbers = [max_force, stiffness, damping, effort, drag, armature, friction, break_force, break_torque];
    numbers.into_iter().for_each(|number| head.f32(*number));
    head.u32(u32::from(*collides));
}

fn read_joint(words: &mut Words, scene: &Scene) -> Result<Joint, Damage> {
    let number = words.u32()?;
    let kinds = JointKind::ALL;
    let kind = kinds.get(number as usize);
    let kind = *kind.ok_or_else(|| Damage::new(format!("a joint has the kind {number}, expected 0 to {}", kinds.len() - 1)))?;
    let name = Some(words.text()?).filter(|name| !name.is_empty());
    let ((a, one), (b, other)) = (read_end(words, scene)?, read_end(words, scene)?);
    let (least, greatest) = (words.known()?, words.known()?);
    if least.is_some() != greatest.is_some() {
        return Err(Damage::new("a joint has one of two limits"));
    }
    let mut joint = Joint { kind, name, ..Joint::ball(a, b, DVec3::ZERO) }.frames([one, other]);
    joint.limits = least.zip(greatest).map(|(least, greatest)| [least, greatest]);
    (joint.cone, joint.speed, joint.target, joint.length) = (words.known()?, words.known()?, words.known()?, words.known()?);
    if joint.length.is_some() != (kind == JointKind::Distance) {
        return Err(Damage::new(format!("a joint of the kind {kind} has a length, or a distance joint has none")));
    }
    (joint.max_force, joint.stiffness, joint.damping) = (words.f32()?, words.f32()?, words.f32()?);
    (joint.effort, joint.drag, joint.armature) = (words.f32()?, words.f32()?, words.f32()?);
    (joint.friction, joint.break_force, joint.break_torque) = (words.f32()?, words.f32()?, words.f32()?);
    joint.collides = words.bool()?;
    Ok(joint)
}

fn read_end(words: &mut Words, scene: &Scene) -> Result<(Anchor, JointFrame), Damage> {
    let (kind, index) = (words.u32()?, words.u32()? as usize);
    let anchor = match kind {
        0 if index == 0 => Anchor::World,
        1 if index < scene.bodies().len() => Anchor::Body(scene.bodies.handle_at(index)),
        2 if index < scene.spheres().len() => Anchor::Sphere(scene.spheres.handle_at(index)),
        _ => return Err(Damage::new(format!("a joint ends in object {index} of kind {kind}, which is not in it"))),
    };
    let place = words.vec3()?;
    let turn = Quat::from_xyzw(words.f32()?, words.f32()?, words.f32()?, words.f32()?);
    Ok((anchor, JointFrame { place, turn }))
}
