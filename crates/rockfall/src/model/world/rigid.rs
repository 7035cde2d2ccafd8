//! Packs rigid bodies: their records, shapes and members in the topology, and their state.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DQuat, DVec3, Quat, Vec3, Vec4};

use crate::error::Result;
use crate::model::layout::{HULL_PART, NO_RIGID, RIGID_ROWS, RIGID_WORDS, SHAPE_BOX_WORDS, SHAPE_WORDS};
use crate::model::rigid::{Moments, Pose};
use crate::model::step::Layout;
use crate::model::view::View;
use crate::model::world::World;
use crate::scene::{AnyForm, BodyHandles, Core, Form, Kinetics, Scene, Shape, ShapeHull, ShapeId, WholeBody};

/// The moments as kernels use them.
fn moments_of(kinetics: &Kinetics) -> Moments {
    let inverse = DVec3::ONE / kinetics.moments;
    let mut sorted = inverse.to_array();
    sorted.sort_by(f64::total_cmp);
    Moments { middle: sorted[1] as f32, excess: (inverse - DVec3::splat(sorted[1])).as_vec3(), axes: narrow(kinetics.axes) }
}

fn narrow(q: DQuat) -> Quat {
    q.normalize().as_quat()
}

/// The places of the spheres of a body from its centre of mass.
fn places(body: &WholeBody) -> Vec<DVec3> {
    match body.form {
        AnyForm::Shape(_, shape) => {
            shape.all_spheres().iter().map(|sphere| sphere.centre.as_dvec3() - body.kinetics.centre).collect()
        }
        AnyForm::Implied(form) => form.places.clone(),
    }
}

/// The words of a form: its moments, the rotation of its principal axes, the places of its spheres from its centre of mass, its boxes, and
/// the triangles of its hulls.
fn form_words(body: &WholeBody) -> Vec<u32> {
    let Moments { middle, excess, axes } = moments_of(body.kinetics);
    let mut words = vec![middle];
    words.extend(excess.to_array());
    words.extend(axes.to_array());
    words.extend(places(body).into_iter().flat_map(|place| place.as_vec3().to_array()));
    if let AnyForm::Shape(_, shape) = body.form {
        for part in &shape.boxes {
            let Core { turn, half, .. } = part.core();
            words.extend(half.as_vec3().to_array());
            words.extend(turn.as_quat().to_array());
        }
    }
    let mut words: Vec<u32> = words.into_iter().map(f32::to_bits).collect();
    if let AnyForm::Shape(_, shape) = body.form {
        shape.hulls.iter().for_each(|hull| put_triangles(hull, &mut words));
    }
    words
}

/// Appends the triangles of a hull: their number, then their corners from the centre of the hull.
fn put_triangles(hull: &ShapeHull, words: &mut Vec<u32>) {
    let number_at = words.len();
    words.push(0);
    for corner in hull.hull.triangles().flatten() {
        words.extend(corner.to_array().map(f32::to_bits));
    }
    words[number_at] = ((words.len() - number_at - 1) / 9) as u32;
}

/// What bodies with the same words have in common.
#[derive(PartialEq, Eq, Hash)]
enum FormKey {
    Shape(ShapeId),
    Implied(*const Form),
}

impl FormKey {
    fn of(form: AnyForm) -> Self {
        match form {
            AnyForm::Shape(id, _) => Self::Shape(id),
            AnyForm::Implied(form) => Self::Implied(Arc::as_ptr(form)),
        }
    }
}

/// Appends the rigid bodies of a scene: records, bodies of spheres, forms, members. Of its members, each body has the insertion indices, then
/// the radii.
pub(super) fn pack_bodies(scene: &Scene, layout: &mut Layout, topology: &mut Vec<u32>) -> Result<()> {
    let count = scene.whole_bodies().count();
    (layout.rigid_bodies, layout.rigid_at, layout.rigid_of_at) = (count as u32, 0, 0);
    layout.rigid_parts_at = 0;
    if count == 0 {
        return Ok(());
    }
    layout.rigid_at = topology.len() as u32;
    topology.resize(topology.len() + count * RIGID_WORDS as usize, 0);
    layout.rigid_of_at = topology.len() as u32;
    topology.resize(topology.len() + scene.spheres().len(), NO_RIGID);
    if scene
        .bodies()
        .iter()
        .any(|body| scene.shape(body.shape).is_ok_and(|shape| !(shape.boxes.is_empty() && shape.hulls.is_empty())))
    {
        layout.rigid_parts_at = topology.len() as u32;
        topology.resize(topology.len() + scene.spheres().len(), 0);
    }
    let mut forms: HashMap<FormKey, u32> = HashMap::new();
    for (number, body) in scene.whole_bodies().enumerate() {
        let form = *forms.entry(FormKey::of(body.form)).or_insert_with(|| {
            let at = topology.len() as u32;
            topology.extend(form_words(&body));
            at
        });
        let members = topology.len() as u32;
        for sphere in body.spheres {
            let index = scene.spheres.index(*sphere)?;
            topology[layout.rigid_of_at as usize + index] = number as u32;
            topology.push(index as u32);
        }
        for sphere in body.spheres {
            topology.push(scene.sphere(*sphere)?.radius.to_bits());
        }
        if let AnyForm::Shape(_, shape) = body.form {
            put_parts(scene, &body, shape, form, layout, topology)?;
        }
        let mut record = [0; RIGID_WORDS as usize];
        let mut put = |at: usize, numbers: &[f32]| {
            record[at..at + numbers.len()].iter_mut().zip(numbers).for_each(|(word, x)| *word = x.to_bits());
        };
        // `set_bodies` writes the centre, the tensor and the orientation.
        put(3, &[(1.0 / body.kinetics.mass) as f32]);
        put(10, &[(1.0 / body.kinetics.moments.min_element()) as f32]);
        put(18, &[reach(scene, &body, &topology[form as usize + SHAPE_WORDS as usize..])?]);
        record[11..14].copy_from_slice(&[form, members, body.spheres.len() as u32]);
        topology[layout.rigid_at as usize + number * RIGID_WORDS as usize..][..record.len()].copy_from_slice(&record);
    }
    Ok(())
}

/// The greatest distance of a point of a sphere of a body from the centre of mass. `places` are those in its form.
fn reach(scene: &Scene, body: &WholeBody, places: &[u32]) -> Result<f32> {
    let mut reach = 0.0_f32;
    for (sphere, place) in body.spheres.iter().zip(places.chunks_exact(3)) {
        let place = Vec3::from_array([0, 1, 2].map(|axis| f32::from_bits(place[axis])));
        reach = reach.max(place.length() + scene.sphere(*sphere)?.radius);
    }
    Ok(reach)
}

/// Writes which spheres of a body stand for boxes and hulls. `at` is the first word of its form.
fn put_parts(scene: &Scene, body: &WholeBody, shape: &Shape, at: u32, layout: &Layout, topology: &mut [u32]) -> Result<()> {
    let table = layout.rigid_parts_at as usize;
    let mut box_at = at + SHAPE_WORDS + 3 * shape.sphere_count() as u32;
    for sphere in &body.spheres[shape.spheres.len()..shape.first_hull()] {
        topology[table + scene.spheres.index(*sphere)?] = box_at;
        box_at += SHAPE_BOX_WORDS;
    }
    let mut hull_at = box_at;
    for sphere in body.spheres.iter().skip(shape.first_hull()) {
        topology[table + scene.spheres.index(*sphere)?] = hull_at | HULL_PART;
        hull_at += 1 + 9 * topology[hull_at as usize];
    }
    Ok(())
}

impl World {
    /// Number of boxes of rigid bodies.
    #[cfg(feature = "gpu")]
    pub(crate) fn boxes_of_bodies(&self) -> u32 {
        let layout = &self.step.layout;
        let (at, spheres) = (layout.rigid_parts_at as usize, layout.spheres as usize);
        let parts = if at > 0 { &self.topology[at..at + spheres] } else { &[] };
        parts.iter().filter(|part| **part != 0 && **part & HULL_PART == 0).count() as u32
    }

    /// Packs the state of the rigid bodies, and places their spheres.
    pub(super) fn set_bodies(&mut self, scene: &Scene) {
        let poses: Vec<Pose> = scene.whole_bodies().map(|body| body.state).collect();
        self.rigid_bodies = vec![Vec4::ZERO; poses.len() * RIGID_ROWS as usize];
        for (rows, pose) in self.rigid_bodies.chunks_exact_mut(RIGID_ROWS as usize).zip(&poses) {
            rows[..Pose::ROWS].copy_from_slice(&pose.rows());
        }
        for (number, pose) in (0..).zip(&poses) {
            self.put_record(number, pose);
        }
        let view = View::new(&self.step, &self.topology, &self.states[0]);
        let placed: Vec<(u32, [Vec4; 4], Quat)> = (0..)
            .zip(&poses)
            .flat_map(|(number, pose)| view.placed(number, *pose).map(move |(slot, rows)| (slot, rows, pose.orientation)))
            .collect();
        let n = self.step.layout.spheres as usize;
        for (slot, rows, orientation) in placed {
            for (region, row) in rows.into_iter().enumerate() {
                self.states[0][region * n + slot as usize] = row;
            }
            self.orientations[slot as usize] = orientation.into();
        }
    }

    /// Writes the centre, the tensor and the orientation of a body that contacts read.
    pub(crate) fn put_record(&mut self, body: u32, pose: &Pose) {
        let view = View::new(&self.step, &self.topology, &self.states[0]);
        let tensor = view.moments(&view.rigid_body(body)).inverse_inertia(pose.orientation);
        let at = (self.step.layout.rigid_at + body * RIGID_WORDS) as usize;
        let mut put = |place: usize, numbers: &[f32]| {
            let words = &mut self.topology[at + place..at + place + numbers.len()];
            words.iter_mut().zip(numbers).for_each(|(word, x)| *word = x.to_bits());
        };
        put(0, &pose.position.high.to_array());
        put(4, &tensor);
        put(14, &pose.orientation.to_array());
    }

    /// Writes the state of the rigid bodies back to the scene that it was packed from. `packed` are the handles of the bodies at that time.
    pub(crate) fn read_bodies(&self, scene: &mut Scene, packed: &BodyHandles) {
        let mut poses = self.rigid_bodies.chunks_exact(RIGID_ROWS as usize).map(Pose::of);
        // Skips bodies that have been removed since.
        for (id, pose) in packed.declared.iter().zip(poses.by_ref()) {
            if let Ok(body) = scene.bodies.get_mut(*id) {
                body.set_state(pose);
            }
        }
        for (id, pose) in packed.implied.iter().zip(poses) {
            if let Ok(body) = scene.implied.get_mut(*id) {
                body.state = pose;
            }
        }
    }
}
