//! The passes of a frame: culling, the shadow map, the bodies, ambient occlusion, the picture.

use std::ops::Range;

use rockfall::wgpu;

use crate::draw::Renderer;
use crate::draw::cull::List;
use crate::draw::frame::{culls_hidden, springs, tethers};
use crate::draw::pipelines::{Kind, Pipelines};
use crate::draw::style::Style;
use crate::draw::targets::{Bodies, Targets, fill};
use crate::draw::timing::Pass;

/// Facets of a cone or ball, as in `flat.wgsl`: 64 around the axis times 24 along it.
const FACETS: u32 = 64 * 24;

/// Opacity of a face that hides bodies.
const PANE: f64 = 0.08;

/// Vertices that a kind of object is drawn with.
#[derive(Clone, Copy)]
enum Shape {
    /// A quad, as a strip.
    Quad,
    /// A box around the object, as a strip.
    Around,
    /// Triangles with this number of vertices.
    Triangles(u32),
    /// The mesh of a coil.
    Coil,
}

impl Renderer {
    /// Returns the pipelines, the shape and the number of every kind of object except spheres.
    fn kinds(&self) -> [(&Kind, Shape, u32); 7] {
        let Pipelines { capsules, boxes, blocks, polygons, springs: spring, tethers: tether, anchors, .. } = &self.pipelines;
        let step = &self.step;
        [
            (boxes, Shape::Triangles(36), step.layout.boxes),
            (blocks, Shape::Triangles(self.buffers.block_corners), self.spheres_for_boxes()),
            (polygons, Shape::Triangles(6), step.layout.polygons),
            (capsules, Shape::Around, step.layout.rods),
            (spring, Shape::Coil, springs(step)),
            (tether, Shape::Coil, tethers(step)),
            (anchors, Shape::Quad, tethers(step)),
        ]
    }

    /// The spheres, if some of them stand for boxes or hulls of rigid bodies.
    fn spheres_for_boxes(&self) -> u32 {
        let layout = &self.step.layout;
        if layout.rigid_parts_at > 0 { layout.spheres } else { 0 }
    }

    fn draw_kinds(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: impl Fn(&Kind) -> &wgpu::RenderPipeline) {
        pass.set_index_buffer(self.coil.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (kind, shape, count) in self.kinds() {
            if count == 0 {
                continue;
            }
            pass.set_pipeline(pipeline(kind));
            let vertices: Range<u32> = match shape {
                Shape::Quad => 0..4,
                Shape::Around => 0..14,
                Shape::Triangles(corners) => 0..corners,
                Shape::Coil => {
                    pass.draw_indexed(0..self.coil.resolution.indices(), 0, 0..count);
                    continue;
                }
            };
            pass.draw(vertices, 0..count);
            if std::ptr::eq(kind, &self.pipelines.polygons) {
                self.draw_round_walls(pass);
            }
        }
    }

    /// Draws the facets of cones and balls, except the first one of each, with the pipeline of polygons that is set.
    fn draw_round_walls(&self, pass: &mut wgpu::RenderPass<'_>) {
        for number in self.walls.round() {
            pass.draw(6..6 * FACETS, number..number + 1);
        }
    }

    fn stamps(&self, pass: Pass) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.timer.as_ref().map(|timer| timer.render(pass))
    }

    fn compute<'a>(&self, encoder: &'a mut wgpu::CommandEncoder, pass: Pass) -> wgpu::ComputePass<'a> {
        let timestamp_writes = self.timer.as_ref().map(|timer| timer.compute(pass));
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(pass.name()), timestamp_writes })
    }

    fn most_workgroups(&self) -> u32 {
        self.device.limits().max_compute_workgroups_per_dimension
    }

    pub(super) fn cull_spheres(&self, encoder: &mut wgpu::CommandEncoder) {
        self.cull.begin(&self.queue);
        self.cull.select(&mut self.compute(encoder, Pass::Cull), self.most_workgroups());
    }

    fn uncover_spheres(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets) {
        let mut pass = self.compute(encoder, Pass::Uncover);
        targets.pyramid.build(&mut pass, &self.pyramid);
        self.cull.uncover(&mut pass, self.most_workgroups(), &targets.pyramid.group);
    }

    pub(super) fn draw_shadows(&self, encoder: &mut wgpu::CommandEncoder, bodies: &wgpu::BindGroup) {
        let mut pass = self.shadows.pass(encoder, self.stamps(Pass::Shadows));
        pass.set_bind_group(0, bodies, &[]);
        pass.set_pipeline(&self.pipelines.spheres.shadow);
        self.cull.draw(&mut pass, List::Shadow);
        self.draw_kinds(&mut pass, |kind| &kind.shadow);
        self.strings.draw(&mut pass, &self.pipelines.strings.shadow);
    }

    /// Draws all bodies. In large scenes it draws the spheres that were visible in the last frame first, and then those that
    /// these do not hide.
    pub(super) fn draw_bodies(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        bodies: &wgpu::BindGroup,
        style: &Style,
    ) {
        let culls_hidden = culls_hidden(&self.step);
        let which = if culls_hidden { Bodies::First } else { Bodies::All };
        let mut pass = targets.bodies(encoder, which, self.stamps(Pass::Bodies));
        self.bind(&mut pass, bodies);
        pass.set_pipeline(&self.pipelines.sky);
        pass.draw(0..3, 0..1);
        self.draw_kinds(&mut pass, |kind| &kind.lit);
        self.strings.draw(&mut pass, &self.pipelines.strings.lit);
        self.draw_spheres(&mut pass, [List::Near, List::Far]);
        if culls_hidden {
            drop(pass);
            self.uncover_spheres(encoder, targets);
            pass = targets.bodies(encoder, Bodies::Second, self.stamps(Pass::Uncovered));
            self.bind(&mut pass, bodies);
            self.draw_spheres(&mut pass, [List::SecondNear, List::SecondFar]);
        }
        if style.ground {
            pass.set_pipeline(&self.pipelines.ground);
            pass.draw(0..3, 0..1);
        }
        self.draw_glass(&mut pass, culls_hidden);
        self.draw_hiding(&mut pass);
        if let Some((chains, count)) = self.chains.drawn() {
            pass.set_pipeline(&self.pipelines.chains);
            pass.set_vertex_buffer(0, chains.slice(..));
            pass.draw(0..4, 0..count);
        }
    }

    fn bind(&self, pass: &mut wgpu::RenderPass<'_>, bodies: &wgpu::BindGroup) {
        pass.set_bind_group(0, bodies, &[]);
        pass.set_bind_group(1, &self.shadows.group, &[]);
    }

    fn draw_spheres(&self, pass: &mut wgpu::RenderPass<'_>, [near, far]: [List; 2]) {
        for (pipeline, list) in [(&self.pipelines.spheres.lit, near), (&self.pipelines.far, far)] {
            pass.set_pipeline(pipeline);
            self.cull.draw(pass, list);
        }
    }

    /// Draws all bodies of glass, which let what lies behind show through. They are not sorted: opacities are so low that the
    /// order hardly shows.
    fn draw_glass(&self, pass: &mut wgpu::RenderPass<'_>, culls_hidden: bool) {
        if !self.buffers.has_glass {
            return;
        }
        let layout = &self.step.layout;
        let blocks = (self.buffers.block_corners, self.spheres_for_boxes());
        let counts = [(14, layout.rods), (36, layout.boxes), (6, layout.polygons), blocks];
        for (pipeline, (vertices, count)) in self.pipelines.glass.iter().zip(counts).filter(|(_, (_, count))| *count > 0) {
            pass.set_pipeline(pipeline);
            pass.draw(0..vertices, 0..count);
            if vertices == 6 {
                self.draw_round_walls(pass);
            }
        }
        pass.set_pipeline(&self.pipelines.glass_spheres);
        self.cull.draw(pass, List::Near);
        if culls_hidden {
            self.cull.draw(pass, List::SecondNear);
        }
    }

    /// Draws the boxes and polygons that hide bodies: translucent faces, then edges.
    fn draw_hiding(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_blend_constant(wgpu::Color { r: PANE, g: PANE, b: PANE, a: PANE });
        let Pipelines { hiding_boxes, hiding_polygons, .. } = &self.pipelines;
        for (pipelines, vertices, count) in
            [(hiding_boxes, 36, self.step.layout.boxes), (hiding_polygons, 6, self.step.layout.polygons)]
        {
            for pipeline in pipelines.iter().filter(|_| count > 0) {
                pass.set_pipeline(pipeline);
                pass.draw(0..vertices, 0..count);
                if vertices == 6 {
                    self.draw_round_walls(pass);
                }
            }
        }
    }

    pub(super) fn draw_occlusion(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets, bodies: &wgpu::BindGroup) {
        let mut pass = fill(encoder, "occlusion", &targets.openness, self.stamps(Pass::Occlusion));
        pass.set_bind_group(0, bodies, &[]);
        pass.set_bind_group(1, &targets.occlusion, &[]);
        pass.set_pipeline(&self.pipelines.occlusion);
        pass.draw(0..3, 0..1);
    }

    pub(super) fn finish(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        bodies: &wgpu::BindGroup,
        target: &wgpu::TextureView,
    ) {
        let mut pass = fill(encoder, "finish", target, self.stamps(Pass::Finish));
        pass.set_bind_group(0, bodies, &[]);
        pass.set_bind_group(1, &targets.finish, &[]);
        pass.set_pipeline(&self.pipelines.finish);
        pass.draw(0..3, 0..1);
    }
}
