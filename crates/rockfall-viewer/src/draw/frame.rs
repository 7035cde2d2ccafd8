//! The uniform block of every shader of the renderer. The WGSL side is `wgsl/frame.wgsl`.

use bytemuck::{Pod, Zeroable};
use rockfall::glam::{Mat4, Vec3, Vec4};
use rockfall::layout::{SPRING_WORDS, Step, TETHER_WORDS};

use crate::camera::{Axes, Camera};
use crate::draw::palette;
use crate::draw::style::{Range, Style};

/// What is the same for a whole frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct Frame {
    view_projection: Mat4,
    light_projection: Mat4,
    eye: Vec3,
    near: f32,
    right: Vec3,
    /// Of half the vertical field of view.
    tangent: f32,
    up: Vec3,
    aspect: f32,
    forward: Vec3,
    blend: f32,
    /// Unit vector to the sun.
    light: Vec3,
    light_texel: f32,
    horizon: [f32; 3],
    /// Height of the ground.
    ground: f32,
    zenith: [f32; 3],
    typical_radius: f32,
    viewport: [f32; 2],
    range: [f32; 2],
    spheres: u32,
    rods: u32,
    springs: u32,
    tethers: u32,
    rods_at: u32,
    springs_at: u32,
    tethers_at: u32,
    boxes_at: u32,
    polygons_at: u32,
    users_at: u32,
    colour_by: u32,
    flags: u32,
    kinds: [Vec4; 8],
    scale: [Vec4; 9],
}

/// Where the sun stands.
const SUN: Vec3 = Vec3::new(-0.45, 0.80, 0.40);

impl Frame {
    pub(crate) fn new(step: &Step, camera: &Camera, style: &Style, size: [u32; 2], blend: f32) -> Self {
        let viewport = size.map(|side| side as f32);
        let aspect = viewport[0] / viewport[1];
        let Axes { right, up, forward } = camera.axes();
        let range = match style.range {
            Range::Auto => [0.0, 1.0],
            Range::Given(range) => range,
        };
        Self {
            view_projection: camera.view_projection(aspect),
            light_projection: Mat4::IDENTITY,
            eye: camera.eye,
            near: camera.near(),
            right,
            tangent: (0.5 * camera.field_of_view).tan(),
            up,
            aspect,
            forward,
            blend,
            light: SUN.normalize(),
            light_texel: 0.0,
            horizon: palette::linear(style.background.horizon),
            ground: 0.0,
            zenith: palette::linear(style.background.zenith),
            typical_radius: 1.0,
            viewport,
            range,
            spheres: step.spheres,
            rods: step.rods,
            springs: (step.tethers_at - step.springs_at) / SPRING_WORDS,
            tethers: (step.forces_at - step.tethers_at) / TETHER_WORDS,
            rods_at: step.rods_at,
            springs_at: step.springs_at,
            tethers_at: step.tethers_at,
            boxes_at: step.boxes_at,
            polygons_at: step.polygons_at,
            users_at: step.users_at,
            colour_by: style.colour_by as u32,
            flags: 0,
            kinds: palette::KINDS.map(|kind| super::opaque(palette::linear(kind.colour))),
            scale: palette::SCALE.map(|stop| super::opaque(palette::linear(stop))),
        }
    }
}
