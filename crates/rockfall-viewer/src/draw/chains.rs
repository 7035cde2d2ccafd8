//! Force chains: lines between the centres of touching bodies.

use std::collections::HashMap;

use bytemuck::{Pod, Zeroable};
use rockfall::glam::Vec3;
use rockfall::{Body, Contact, ContactAction, Result, Simulation, wgpu};
use wgpu::util::{BufferInitDescriptor, DeviceExt as _};

/// Slot of an end that is not the centre of a sphere; as in `wgsl/chain.wgsl`.
const NO_SLOT: u32 = u32::MAX;

/// A line between the two bodies of a contact.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct Chain {
    /// Memory slots of the spheres, or [`NO_SLOT`].
    slots: [u32; 2],
    /// The ends that are not the centres of spheres.
    points: [[f32; 3]; 2],
    /// Normal force, in mass units/s².
    force: f32,
}

/// Vertex buffer with one [`Chain`] per instance.
pub(crate) const CHAINS: wgpu::VertexBufferLayout<'_> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Chain>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Uint32x2, 1 => Float32x3, 2 => Float32x3, 3 => Float32],
};

/// The lines of the present state.
#[derive(Debug, Default)]
pub(crate) struct Chains {
    buffer: Option<wgpu::Buffer>,
    count: u32,
}

impl Chains {
    /// Computes the contacts of the present state, and returns the normal force of each.
    pub(crate) fn update(&mut self, device: &wgpu::Device, simulation: &mut Simulation) -> Result<Vec<f32>> {
        let contacts = simulation.contacts()?;
        let dt = simulation.time_step();
        let indices: HashMap<_, _> = simulation.scene().sphere_ids().zip(0..).collect();
        let mut chains: Vec<Chain> = contacts
            .iter()
            .map(|contact| {
                let ends = [contact.a, contact.b].map(|body| end(simulation, &indices, body, contact.point));
                let force = normal_force(contact, dt);
                Chain { slots: ends.map(|(slot, _)| slot), points: ends.map(|(_, point)| point.to_array()), force }
            })
            .collect();
        // The strongest are drawn last, over the others.
        chains.sort_by(|one, two| one.force.total_cmp(&two.force));
        self.count = chains.len() as u32;
        self.buffer = (!chains.is_empty()).then(|| {
            let contents = bytemuck::cast_slice(&chains);
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some("chains"),
                contents,
                usage: wgpu::BufferUsages::VERTEX,
            })
        });
        Ok(chains.into_iter().map(|chain| chain.force).collect())
    }

    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// The buffer of the lines and their number, if there are any.
    pub(crate) fn drawn(&self) -> Option<(&wgpu::Buffer, u32)> {
        self.buffer.as_ref().map(|buffer| (buffer, self.count))
    }
}

/// The normal force of a contact; for a collision, the mean force during the next step.
fn normal_force(contact: &Contact, dt: f32) -> f32 {
    let along = |vector: Vec3| vector.dot(contact.normal).abs();
    match contact.action {
        ContactAction::Force(force) => along(force),
        ContactAction::Impulse(impulse) if dt > 0.0 => along(impulse) / dt,
        _ => 0.0,
    }
}

/// The end of a line in a body: the slot of a sphere, or the point of a rod's axis nearest to the contact, or the contact.
fn end(simulation: &Simulation, indices: &HashMap<rockfall::SphereId, usize>, body: Body, contact: Vec3) -> (u32, Vec3) {
    let scene = simulation.scene();
    match body {
        Body::Sphere(sphere) => {
            let slot = indices.get(&sphere).map_or(NO_SLOT, |index| simulation.slot(*index) as u32);
            (slot, contact)
        }
        Body::Rod(rod) => {
            let ends = scene.rod(rod).and_then(|rod| Ok((scene.sphere(rod.end1)?.position, scene.sphere(rod.end2)?.position)));
            let Ok((from, to)) = ends else { return (NO_SLOT, contact) };
            let line = to - from;
            let part = (contact - from).dot(line) / line.length_squared().max(f32::MIN_POSITIVE);
            (NO_SLOT, from + part.clamp(0.0, 1.0) * line)
        }
        _ => (NO_SLOT, contact),
    }
}
