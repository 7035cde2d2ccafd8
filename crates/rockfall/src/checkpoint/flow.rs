//! Inlets and outlets in a checkpoint: the length of what follows in bytes, 0 if there are none; their number, then the properties of each
//! and what it has done. The shapes of inlets are known when it is read.

use glam::DVec3;

use super::Checkpoint;
use super::tags;
use super::words::{Damage, Head, Words};
use crate::scene::{FlowState, GrainKind, GrainMass, Inlet, InletState, Outlet, Passed, Radii, Rate, Scene, ShapeId, Sum};

pub(super) fn bytes(checkpoint: &Checkpoint) -> Vec<u8> {
    let Checkpoint { scene, flow, .. } = checkpoint;
    let mut head = Head::default();
    if scene.inlets().is_empty() && scene.outlets().is_empty() {
        return head.block();
    }
    // A program may have added inlets to the checkpoint.
    let mut flow = flow.clone();
    flow.complete(scene);
    let FlowState { acted, next_reference, inlets, outlets } = flow;
    head.u32(scene.inlets().len() as u32);
    for (inlet, state) in scene.inlets().iter().zip(&inlets) {
        put_inlet(&mut head, scene, inlet);
        let InletState { serial, sum, tries, passed } = state;
        head.u64(*serial);
        head.f64(*sum);
        head.u64(*tries);
        put_passed(&mut head, passed);
    }
    head.u32(scene.outlets().len() as u32);
    for (Outlet { name, corners, every }, passed) in scene.outlets().iter().zip(&outlets) {
        head.text(name);
        put_corners(&mut head, corners);
        put_number(&mut head, *every);
        put_passed(&mut head, passed);
    }
    put_number(&mut head, acted);
    head.u32(next_reference);
    head.block()
}

/// Adds the inlets and outlets to a scene that has all shapes. Returns what they have done.
pub(super) fn put(given: &[u8], scene: &mut Scene) -> Result<FlowState, Damage> {
    let mut flow = FlowState::default();
    if given.is_empty() {
        return Ok(flow);
    }
    let words = &mut Words::new(given);
    for _ in 0..words.u32()? {
        let inlet = read_inlet(words, scene)?;
        scene.add_inlet(inlet)?;
        let (serial, sum, tries) = (words.u64()?, words.f64()?, words.u64()?);
        if !sum.is_finite() {
            return Err(Damage::new(format!("an inlet let in {sum}")));
        }
        flow.inlets.push(InletState { serial, sum, tries, passed: read_passed(words)? });
    }
    for _ in 0..words.u32()? {
        let outlet = Outlet { name: words.text()?, corners: read_corners(words)?, every: read_number(words)? };
        scene.add_outlet(outlet)?;
        flow.outlets.push(read_passed(words)?);
    }
    flow.acted = read_number(words)?;
    flow.next_reference = words.u32()?;
    words.end()?;
    if scene.inlets().is_empty() && scene.outlets().is_empty() {
        return Err(Damage::new("its list of inlets and outlets is empty"));
    }
    Ok(flow)
}

fn put_inlet(head: &mut Head, scene: &Scene, inlet: &Inlet) {
    let Inlet { name, corners, rate, kinds, shares, velocity, from, to, limit, seed, every, after } = inlet;
    head.text(name);
    put_corners(head, corners);
    let (kind, rate) = match *rate {
        Rate::Number(rate) => (0, rate),
        Rate::Mass(rate) => (1, rate),
        Rate::Volume(rate) => (2, rate),
    };
    head.u32(kind);
    head.f64(rate);
    head.text(&shares.to_string());
    head.u32(kinds.len() as u32);
    for (kind, share) in kinds {
        head.f64(*share);
        put_kind(head, scene, kind);
    }
    velocity.to_array().into_iter().for_each(|number| head.f32(number));
    head.f64(*from);
    head.f64(*to);
    put_number(head, *limit);
    head.u64(*seed);
    put_number(head, *every);
    head.u64(*after);
}

fn put_kind(head: &mut Head, scene: &Scene, kind: &GrainKind) {
    let GrainKind { name, shape, radii, by, mass, material, group, tag, .. } = kind;
    head.text(name);
    // Counted from 1, 0 for spheres.
    head.u32(shape.map_or(0, |shape| scene.shapes.index(shape).map_or(0, |index| index as u32 + 1)));
    let (kind, numbers) = match *radii {
        Radii::Equal(radius) => (0, [radius, 0.0]),
        Radii::Uniform(from, to) => (1, [from, to]),
        Radii::LogNormal { median, sigma } => (2, [median, sigma]),
    };
    head.u32(kind);
    numbers.into_iter().for_each(|number| head.f64(number));
    head.text(&by.to_string());
    let (kind, mass) = match *mass {
        GrainMass::OfMaterial => (0, 0.0),
        GrainMass::Mass(mass) => (1, mass),
        GrainMass::Density(density) => (2, density),
    };
    head.u32(kind);
    head.f64(mass);
    // A material that was removed is none.
    head.u32(scene.material_number(*material).unwrap_or(0).into());
    head.u32(u32::from(*group));
    tags::put_tag(head, tag);
}

fn read_inlet(words: &mut Words, scene: &Scene) -> Result<Inlet, Damage> {
    let (name, corners) = (words.text()?, read_corners(words)?);
    let rate = match (words.u32()?, words.f64()?) {
        (0, rate) => Rate::Number(rate),
        (1, rate) => Rate::Mass(rate),
        (2, rate) => Rate::Volume(rate),
        (kind, _) => return Err(Damage::new(format!("an inlet has a rate of kind {kind}, expected 0 to 2"))),
    };
    let shares = words.text()?.parse()?;
    let count = words.u32()?;
    let kinds = (0..count).map(|_| {
        let share = words.f64()?;
        Ok((read_kind(words, scene)?, share))
    });
    let kinds = kinds.collect::<Result<Vec<_>, Damage>>()?;
    let mut inlet = Inlet::new(name, corners.map(|corner| corner.to_array()), rate, 1.0).mix(kinds, shares);
    inlet.velocity = words.vec3()?;
    (inlet.from, inlet.to) = (words.f64()?, words.f64()?);
    inlet.limit = read_number(words)?;
    inlet.seed = words.u64()?;
    inlet.every = read_number(words)?;
    inlet.after = words.u64()?;
    Ok(inlet)
}

fn read_kind(words: &mut Words, scene: &Scene) -> Result<GrainKind, Damage> {
    let mut kind = GrainKind::spheres(1.0).name(words.text()?);
    kind.shape = read_shape(words, scene)?;
    kind.radii = match (words.u32()?, words.f64()?, words.f64()?) {
        (0, radius, rest) if rest.to_bits() == 0 => Radii::Equal(radius),
        (1, from, to) => Radii::Uniform(from, to),
        (2, median, sigma) => Radii::LogNormal { median, sigma },
        (kind, ..) => return Err(Damage::new(format!("an inlet has radii of kind {kind} that cannot be read"))),
    };
    kind.by = words.text()?.parse()?;
    kind.mass = match (words.u32()?, words.f64()?) {
        (0, rest) if rest.to_bits() == 0 => GrainMass::OfMaterial,
        (1, mass) => GrainMass::Mass(mass),
        (2, density) => GrainMass::Density(density),
        (kind, _) => return Err(Damage::new(format!("an inlet has a mass of kind {kind} that cannot be read"))),
    };
    let material = words.u32()?;
    if material as usize > scene.materials().len() {
        return Err(Damage::new(format!("an inlet has the material {material} of {}", scene.materials().len())));
    }
    kind.material = scene.material_of_number(material as u16);
    let group = words.u32()?;
    kind.group = group.try_into().map_err(|_| Damage::new(format!("an inlet has the group {group}")))?;
    kind.tag = tags::read(words)?;
    Ok(kind)
}

fn read_shape(words: &mut Words, scene: &Scene) -> Result<Option<ShapeId>, Damage> {
    let Some(index) = (words.u32()? as usize).checked_sub(1) else { return Ok(None) };
    let missing = || Damage::new(format!("an inlet has the shape {index}, which is missing"));
    scene.shape_ids().nth(index).map(Some).ok_or_else(missing)
}

pub(super) fn put_corners(head: &mut Head, corners: &[DVec3; 2]) {
    corners.iter().flat_map(|corner| corner.to_array()).for_each(|number| head.f64(number));
}

pub(super) fn read_corners(words: &mut Words) -> Result<[DVec3; 2], Damage> {
    let mut corner = || -> Result<DVec3, Damage> { Ok(DVec3::new(words.f64()?, words.f64()?, words.f64()?)) };
    Ok([corner()?, corner()?])
}

/// A number that may be missing: a flag and the number, or 0.
fn put_number(head: &mut Head, number: Option<u64>) {
    head.u32(u32::from(number.is_some()));
    head.u64(number.unwrap_or(0));
}

fn read_number(words: &mut Words) -> Result<Option<u64>, Damage> {
    match (words.bool()?, words.u64()?) {
        (true, number) => Ok(Some(number)),
        (false, 0) => Ok(None),
        (false, number) => Err(Damage::new(format!("a missing number is {number}, expected 0"))),
    }
}

fn put_passed(head: &mut Head, passed: &Passed) {
    let Passed { spheres, mass: Sum { high, low } } = passed;
    head.u64(*spheres);
    head.f64(*high);
    head.f64(*low);
}

fn read_passed(words: &mut Words) -> Result<Passed, Damage> {
    let passed = Passed { spheres: words.u64()?, mass: Sum { high: words.f64()?, low: words.f64()? } };
    let Sum { high, low } = passed.mass;
    if !(high.is_finite() && low.is_finite()) {
        return Err(Damage::new(format!("an inlet or an outlet has passed a mass of {high} and {low}")));
    }
    Ok(passed)
}
