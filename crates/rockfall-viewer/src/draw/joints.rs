//! Where joints are, for marks over pictures, and the strings of distance joints.

use rockfall::glam::Vec3;
use rockfall::{Anchor, Joint, JointId, JointKind, Result, Scene, Simulation, wgpu};

/// Vertex buffer with the ends of a string per instance.
pub(crate) const STRINGS: wgpu::VertexBufferLayout<'_> = wgpu::VertexBufferLayout {
    array_stride: 24,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
};

/// Where a joint is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointPlace {
    /// The anchors on both bodies.
    pub(crate) ends: [Vec3; 2],
    /// The direction of the axis of a hinge or slider; 0 for others.
    pub(crate) axis: Vec3,
    /// Whether it is a distance joint.
    pub(crate) is_string: bool,
}

impl JointPlace {
    fn of(scene: &Scene, id: JointId, joint: &Joint) -> Result<Self> {
        let has_axis = matches!(joint.kind, JointKind::Hinge | JointKind::Slider);
        let axis = if has_axis { scene.joint_axis(id)? } else { Vec3::ZERO };
        Ok(Self { ends: scene.joint_anchors(id)?, axis, is_string: joint.kind == JointKind::Distance })
    }

    /// The place at a part of the way to another one, from 0 to 1.
    pub(crate) fn towards(&self, other: &Self, part: f32) -> Self {
        let [start, end] = [0, 1].map(|end| self.ends[end].lerp(other.ends[end], part));
        Self { ends: [start, end], axis: self.axis.lerp(other.axis, part), ..*self }
    }
}

/// Whether a scene has joints that are drawn in any case.
fn has_strings(scene: &Scene) -> bool {
    scene.joints().iter().any(|joint| joint.kind == JointKind::Distance)
}

/// Points of the world that distance joints are attached to.
pub(crate) fn fixed_ends(scene: &Scene) -> impl Iterator<Item = Vec3> {
    let strings = scene.joint_ids().zip(scene.joints()).filter(|(_, joint)| joint.kind == JointKind::Distance);
    strings.flat_map(|(id, joint)| {
        let ends = scene.joint_anchors(id).unwrap_or([Vec3::NAN; 2]);
        let fixed = joint.anchors().into_iter().zip(ends).filter(|(anchor, _)| *anchor == Anchor::World);
        fixed.map(|(_, end)| end).collect::<Vec<_>>()
    })
}

/// Where the joints of a simulation are that are not broken: all of them, or only distance joints.
pub(crate) fn places(simulation: &mut Simulation, all: bool) -> Result<Vec<JointPlace>> {
    if !(all || has_strings(simulation.scene())) {
        return Ok(Vec::new());
    }
    let readings = simulation.joints()?;
    let scene = simulation.sync()?;
    let joints = scene.joint_ids().zip(scene.joints()).enumerate();
    let is_broken = |number: usize| readings.get(number).is_some_and(|reading| reading.broken);
    let shown = joints.filter(|(number, (_, joint))| (all || joint.kind == JointKind::Distance) && !is_broken(*number));
    shown.map(|(_, (id, joint))| JointPlace::of(scene, id, joint)).collect()
}

/// The strings of a picture in a vertex buffer.
#[derive(Debug, Default)]
pub(crate) struct Strings {
    buffer: Option<wgpu::Buffer>,
    count: u32,
}

impl Strings {
    /// Uploads the ends.
    pub(crate) fn set(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, ends: &[[Vec3; 2]]) {
        self.count = ends.len() as u32;
        let numbers: Vec<f32> = ends.iter().flatten().flat_map(|end| end.to_array()).collect();
        let size = size_of_val(numbers.as_slice()) as u64;
        if size == 0 {
            return;
        }
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: Some("strings"), size, usage, mapped_at_creation: false };
        let kept = self.buffer.take().filter(|buffer| buffer.size() >= size);
        let buffer = kept.unwrap_or_else(|| device.create_buffer(&descriptor));
        queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&numbers));
        self.buffer = Some(buffer);
    }

    /// Draws them with a pipeline.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline) {
        if let Some(buffer) = self.buffer.as_ref().filter(|_| self.count > 0) {
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..4, 0..self.count);
        }
    }
}
