//! Implied bodies in a checkpoint (docs/physics section 1.6): the length of what follows in bytes, 0 if there are none; the number of
//! forms, each with its mass, moments, principal axes and places; the number of bodies, each with its form, its spheres, its rods and its
//! state.

use std::sync::Arc;

use glam::{DQuat, DVec3, Quat};

use super::words::{Damage, Head, Words};
use crate::fine::Fine;
use crate::scene::{BodyState, Form, ImpliedBody, Kinetics, Scene};

pub(super) fn bytes(scene: &Scene) -> Vec<u8> {
    let mut head = Head::default();
    let bodies = scene.implied.objects();
    if bodies.is_empty() {
        return head.block();
    }
    let mut forms: Vec<&Arc<Form>> = Vec::new();
    let mut number_of = std::collections::HashMap::new();
    for body in bodies {
        number_of.entry(Arc::as_ptr(&body.form)).or_insert_with(|| {
            forms.push(&body.form);
            forms.len() as u32 - 1
        });
    }
    head.u32(forms.len() as u32);
    forms.iter().for_each(|form| put_form(&mut head, form));
    head.u64(bodies.len() as u64);
    for ImpliedBody { spheres, rods, form, state } in bodies {
        head.u32(number_of[&Arc::as_ptr(form)]);
        head.u32(spheres.len() as u32);
        spheres.iter().for_each(|id| head.u32(scene.spheres.index(*id).unwrap_or_default() as u32));
        head.u32(rods.len() as u32);
        rods.iter().for_each(|id| head.u32(scene.rods.index(*id).unwrap_or_default() as u32));
        let BodyState { position: Fine { high, low }, velocity, momentum, orientation: q } = state;
        let vectors = [high, low, velocity, momentum].into_iter().flat_map(|vector| vector.to_array());
        vectors.chain([q.x, q.y, q.z, q.w]).for_each(|number| head.f32(number));
    }
    head.block()
}

/// Adds the implied bodies to a scene that has all other objects.
pub(super) fn put(given: &[u8], scene: &mut Scene) -> Result<(), Damage> {
    if given.is_empty() {
        return Ok(());
    }
    let mut words = Words::new(given);
    let mut forms = Vec::new();
    for _ in 0..words.u32()? {
        forms.push(Arc::new(read_form(&mut words)?));
    }
    for _ in 0..words.u64()? {
        let body = read_body(&mut words, scene, &forms)?;
        scene.keep_implied(body);
    }
    words.end()
}

fn put_form(head: &mut Head, Form { places, kinetics: Kinetics { mass, moments, axes, .. } }: &Form) {
    let numbers = [*mass].into_iter().chain(moments.to_array()).chain(axes.to_array());
    numbers.for_each(|number| head.f64(number));
    head.u32(places.len() as u32);
    places.iter().flat_map(|place| place.to_array()).for_each(|number| head.f64(number));
}

fn read_form(words: &mut Words) -> Result<Form, Damage> {
    let mut numbers = [0.0; 8];
    for number in &mut numbers {
        *number = words.f64()?;
    }
    let [mass, x, y, z, axes @ ..] = numbers;
    let (moments, axes) = (DVec3::new(x, y, z), DQuat::from_array(axes));
    let is_usable = |number: f64| number.is_finite() && number > 0.0;
    if ![mass, x, y, z].into_iter().all(is_usable) || !axes.is_normalized() {
        return Err(Damage::new(format!("a form has the mass {mass}, the moments {moments} and the axes {axes}")));
    }
    let mut places = Vec::new();
    for _ in 0..words.u32()? {
        places.push(DVec3::new(words.f64()?, words.f64()?, words.f64()?));
    }
    if !places.iter().all(|place| place.is_finite()) {
        return Err(Damage::new("a place of a form is not finite"));
    }
    Ok(Form { places, kinetics: Kinetics { mass, centre: DVec3::ZERO, moments, axes } })
}

fn read_body(words: &mut Words, scene: &Scene, forms: &[Arc<Form>]) -> Result<ImpliedBody, Damage> {
    let number = words.u32()? as usize;
    let form = forms.get(number).ok_or_else(|| Damage::new(format!("a body has the form {number}, which is missing")))?.clone();
    let spheres = read_indices(words, scene.spheres().len(), "sphere")?.map(|index| scene.spheres.handle_at(index)).collect();
    let rods = read_indices(words, scene.rods().len(), "rod")?.map(|index| scene.rods.handle_at(index)).collect();
    let [high, low, velocity, momentum] = [words.vec3()?, words.vec3()?, words.vec3()?, words.vec3()?];
    let orientation = Quat::from_xyzw(words.f32()?, words.f32()?, words.f32()?, words.f32()?);
    if ![high, low, velocity, momentum].iter().all(|vector| vector.is_finite()) {
        return Err(Damage::new("the state of an implied body is not finite"));
    }
    let body =
        ImpliedBody { spheres, rods, form, state: BodyState { position: Fine { high, low }, velocity, momentum, orientation } };
    let is_shared = body.spheres.iter().any(|id| scene.moves_with_body(*id));
    if is_shared || body.spheres.len() != body.form.places.len() || !orientation.is_normalized() {
        return Err(Damage::new("an implied body has other spheres than its form, shares one, or has no orientation"));
    }
    Ok(body)
}

/// Reads a number of indices, which must be less than `count`.
fn read_indices(words: &mut Words, count: usize, kind: &str) -> Result<impl Iterator<Item = usize> + use<>, Damage> {
    let mut indices = Vec::new();
    for _ in 0..words.u32()? {
        let index = words.u32()? as usize;
        if index >= count {
            return Err(Damage::new(format!("an implied body has the {kind} {index} of {count}")));
        }
        indices.push(index);
    }
    Ok(indices.into_iter())
}
