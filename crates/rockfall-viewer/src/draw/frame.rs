//! The uniform block of all shaders of the renderer. Its WGSL declaration is in `wgsl/frame.wgsl`; a test compares the two.

use bytemuck::{Pod, Zeroable};
use rockfall::glam::{Mat4, Vec3, Vec4};
use rockfall::model::layout::{SPRING_WORDS, TETHER_WORDS};
use rockfall::model::step::Step;

use crate::camera::{Axes, Camera};
use crate::draw::coil::Resolution;
use crate::draw::style::Style;
use crate::draw::summary::SceneSummary;
use crate::draw::targets::SHADOW_SIZE;
use crate::palette;

/// Values that are constant during a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct Frame {
    view_projection: Mat4,
    light_projection: Mat4,
    eye: Vec3,
    near: f32,
    right: Vec3,
    /// Tangent of half the vertical field of view.
    tangent: f32,
    up: Vec3,
    aspect: f32,
    forward: Vec3,
    pub(crate) blend: f32,
    /// Unit vector towards the sun.
    light: Vec3,
    /// Width of a pixel of the shadow map, in units.
    light_texel: f32,
    light_right: Vec3,
    /// Increase of the depth in the shadow map per unit of distance from the sun.
    light_depth: f32,
    light_up: Vec3,
    /// Cell size of the fine grid on the ground, in units.
    cell: f32,
    /// Target of the camera.
    centre: Vec3,
    centre_distance: f32,
    horizon: [f32; 3],
    /// Height of the ground.
    ground: f32,
    zenith: [f32; 3],
    typical_radius: f32,
    viewport: [f32; 2],
    pub(crate) range: [f32; 2],
    /// How much the fine grid has faded, from 0 to 1.
    cell_fade: f32,
    coil_segments: u32,
    coil_sides: u32,
    flags: u32,
    spheres: u32,
    rods: u32,
    springs: u32,
    tethers: u32,
    rods_at: u32,
    springs_at: u32,
    tethers_at: u32,
    boxes_at: u32,
    polygons_at: u32,
    insertion_indices_at: u32,
    colour_by: u32,
    /// Pixels along a side of the shadow map.
    light_size: f32,
    /// Period along each axis, 0 where the scene is not periodic.
    period: Vec3,
    /// First word of the table of parts of boxes of rigid bodies; 0 without any.
    rigid_parts_at: u32,
    /// Least corner of the box of a periodic scene.
    least: Vec3,
    /// Half the edge of the squares that stand for planes, in units.
    stage_size: f32,
    /// The point near which planes are shown.
    stage: Vec3,
    unused_too: f32,
    /// Unit vector upwards.
    vertical: Vec3,
    unused_three: f32,
    /// Unit vector along the ground, to the right as seen from the front.
    across: Vec3,
    unused_four: f32,
    kinds: [Vec4; 8],
    scale: [Vec4; 9],
}

const SHADOWS: u32 = 1;
const OCCLUSION: u32 = 2;
const CULL_HIDDEN: u32 = 4;
const LOOKS: u32 = 8;

/// Direction towards the sun by default, in level coordinates.
const LIGHT: Vec3 = Vec3::new(-0.45, 0.80, 0.40);

/// Extent of the shadow map around the target of the camera, divided by that of the picture.
const SHADOW_REACH: f32 = 1.5;
/// Extent of the shadow map along the direction of the sun, divided by its extent across.
const SHADOW_DEPTH: f32 = 4.0;
/// Distance of the camera, in cells of the fine grid, at which these begin to fade.
const CELLS_AWAY: f32 = 8.0;

/// Number of spheres from which on hidden spheres are culled. Culling needs a second pass and does not pay in small scenes.
const CULL_HIDDEN_FROM: u32 = 20_000;

/// Whether spheres that are hidden behind others are culled.
pub(crate) fn culls_hidden(step: &Step) -> bool {
    step.layout.spheres >= CULL_HIDDEN_FROM
}

/// Number of springs.
pub(crate) fn springs(step: &Step) -> u32 {
    (step.layout.tethers_at - step.layout.springs_at) / SPRING_WORDS
}

/// Number of tethers.
pub(crate) fn tethers(step: &Step) -> u32 {
    (step.layout.forces_at - step.layout.tethers_at) / TETHER_WORDS
}

/// The sun, and the part of the world that the shadow map shows.
struct Light {
    towards: Vec3,
    right: Vec3,
    up: Vec3,
    projection: Mat4,
    texel: f32,
    depth: f32,
}

impl Light {
    fn new(camera: &Camera, aspect: f32, towards: Option<Vec3>) -> Self {
        let vertical = camera.up.vector();
        let towards = towards.unwrap_or_else(|| camera.up.to_scene(LIGHT)).try_normalize().unwrap_or(vertical);
        // For a sun straight above, any horizontal direction is suitable.
        let right = vertical.cross(towards).try_normalize().unwrap_or_else(|| camera.up.to_scene(Vec3::X));
        let up = towards.cross(right);
        let picture = camera.eye.distance(camera.target) * (0.5 * camera.field_of_view).tan() * aspect.max(1.0);
        let reach = (SHADOW_REACH * picture).max(f32::MIN_POSITIVE);
        let texel = 2.0 * reach / SHADOW_SIZE as f32;
        let depth = 0.5 / (SHADOW_DEPTH * reach);
        // Rounded to whole pixels of the map, so that the edges of shadows do not flicker when the camera moves.
        let snapped = |axis: Vec3| (camera.target.dot(axis) / texel).round() * texel;
        let row = |axis: Vec3, scale: f32, middle: f32| (scale * axis).extend(-scale * middle);
        let rows = [
            row(right, 1.0 / reach, snapped(right)),
            row(up, 1.0 / reach, snapped(up)),
            row(towards, -depth, camera.target.dot(towards)) + Vec4::new(0.0, 0.0, 0.0, 0.5),
            Vec4::W,
        ];
        let projection = Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
        Self { towards, right, up, projection, texel, depth }
    }
}

fn opaque(colour: palette::Rgb) -> Vec4 {
    Vec3::from_array(palette::linear(colour)).extend(1.0)
}

impl Frame {
    pub(crate) fn new(step: &Step, camera: &Camera, style: &Style, summary: &SceneSummary, size: [u32; 2]) -> Self {
        let viewport = size.map(|side| side as f32);
        let aspect = viewport[0] / viewport[1];
        let Axes { right, up, forward } = camera.axes();
        let light = Light::new(camera, aspect, style.light);
        let distance = camera.eye.distance(camera.target);
        let level = (distance / CELLS_AWAY).max(1e-30).log10();
        let coil = Resolution::of(springs(step) + tethers(step));
        let flag = |on: bool, flag: u32| if on { flag } else { 0 };
        Self {
            view_projection: camera.view_projection(aspect),
            light_projection: light.projection,
            eye: camera.eye,
            near: camera.near(),
            right,
            tangent: (0.5 * camera.field_of_view).tan(),
            up,
            aspect,
            forward,
            blend: 1.0,
            light: light.towards,
            light_texel: light.texel,
            light_right: light.right,
            light_depth: light.depth,
            light_up: light.up,
            cell: 10_f32.powf(level.floor()),
            centre: camera.target,
            centre_distance: distance,
            horizon: palette::linear(style.background.horizon),
            ground: summary.ground(camera.up),
            zenith: palette::linear(style.background.zenith),
            typical_radius: summary.typical_radius,
            viewport,
            range: [0.0, 1.0],
            cell_fade: level - level.floor(),
            coil_segments: coil.segments,
            coil_sides: coil.sides,
            flags: flag(style.shadows, SHADOWS) | flag(style.occlusion, OCCLUSION) | flag(culls_hidden(step), CULL_HIDDEN),
            spheres: step.layout.spheres,
            rods: step.layout.rods,
            springs: springs(step),
            tethers: tethers(step),
            rods_at: step.layout.rods_at,
            springs_at: step.layout.springs_at,
            tethers_at: step.layout.tethers_at,
            boxes_at: step.layout.boxes_at,
            polygons_at: step.layout.polygons_at,
            insertion_indices_at: step.layout.insertion_indices_at,
            colour_by: style.colour_by as u32,
            light_size: SHADOW_SIZE as f32,
            period: Vec3::new(step.layout.period_x, step.layout.period_y, step.layout.period_z),
            rigid_parts_at: step.layout.rigid_parts_at,
            least: Vec3::new(step.layout.from_x, step.layout.from_y, step.layout.from_z),
            stage_size: summary.stage.1,
            stage: summary.stage.0,
            unused_too: 0.0,
            vertical: camera.up.vector(),
            unused_three: 0.0,
            across: camera.up.to_scene(Vec3::X),
            unused_four: 0.0,
            kinds: style.kinds.map(opaque),
            scale: style.colour_by.scale().map(opaque),
        }
    }
}

impl Frame {
    /// Whether the looks of objects follow the bits of the capsules.
    pub(crate) fn set_looks(&mut self, looks: bool) {
        self.flags |= if looks { LOOKS } else { 0 };
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use naga::{Module, TypeInner};

    use super::*;
    use crate::draw::pipelines::{BODIES, CULL, FINISH, OCCLUSION};

    fn module(text: &str) -> Module {
        let module = naga::front::wgsl::parse_str(text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
        let mut validator =
            naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::default());
        validator.validate(&module).unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
        module
    }

    macro_rules! offsets {
        ($($name:ident),* $(,)?) => { [$((stringify!($name), offset_of!(Frame, $name))),*] };
    }

    #[test]
    fn the_uniform_block_has_the_layout_of_the_shaders() {
        let expected = offsets![
            view_projection,
            light_projection,
            eye,
            near,
            right,
            tangent,
            up,
            aspect,
            forward,
            blend,
            light,
            light_texel,
            light_right,
            light_depth,
            light_up,
            cell,
            centre,
            centre_distance,
            horizon,
            ground,
            zenith,
            typical_radius,
            viewport,
            range,
            cell_fade,
            coil_segments,
            coil_sides,
            flags,
            spheres,
            rods,
            springs,
            tethers,
            rods_at,
            springs_at,
            tethers_at,
            boxes_at,
            polygons_at,
            insertion_indices_at,
            colour_by,
            light_size,
            period,
            rigid_parts_at,
            least,
            stage_size,
            stage,
            vertical,
            across,
            kinds,
            scale,
        ];
        for text in [BODIES, CULL, OCCLUSION, FINISH] {
            let module = module(text);
            let mut types = module.types.iter().map(|(_, found)| found);
            let found = types.find(|found| found.name.as_deref() == Some("Frame")).unwrap();
            let TypeInner::Struct { members, span } = &found.inner else { panic!("Frame is no struct") };
            assert_eq!(*span as usize, size_of::<Frame>());
            let members: Vec<_> =
                members.iter().map(|member| (member.name.as_deref().unwrap(), member.offset as usize)).collect();
            assert_eq!(members, expected);
        }
    }
}
