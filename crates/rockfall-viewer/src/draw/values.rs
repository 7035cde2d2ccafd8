//! The values that the colours show, and the range of their scale.

use rockfall::{Result, Scene, Simulation};

use crate::draw::motion::Arrows;
use crate::draw::net_force;
use crate::draw::range::{RecentPercentile, percentile, percentile_in};
use crate::draw::style::{ColourBy, Range, Style};
use crate::draw::{Motion, Renderer, palette};
use crate::plot::Graph;
use crate::survey::Survey;
use crate::tags::colour_of;

/// Distance from the bodies of a scene up to which others count for the scale, divided by the extent of the bodies.
const REGION: f32 = 2.0;

/// The number that the shaders read as a colour; 0 for none.
fn coded(colour: Option<palette::Rgb>) -> f32 {
    colour.map_or(0.0, |[r, g, b]| (1 + (u32::from(r) << 16) + (u32::from(g) << 8) + u32::from(b)) as f32)
}

/// The coded colours of rods, springs, boxes and polygons, each in insertion order.
fn colours(scene: &Scene) -> Vec<f32> {
    let rods = scene.rod_ids().map(|id| colour_of(scene, id));
    let springs = scene.spring_ids().map(|id| colour_of(scene, id));
    let statics = scene.box_ids().map(|id| colour_of(scene, id)).chain(scene.polygon_ids().map(|id| colour_of(scene, id)));
    rods.chain(springs).chain(statics).map(coded).collect()
}

impl Renderer {
    /// Takes what the bodies do over a film. Walls that hide a body in any of its states are then removed in all pictures, bodies
    /// that are far away do not count for the scale, and without static objects the ground is below all places of the bodies.
    pub fn set_survey(&mut self, survey: Survey) {
        self.set_region(&survey);
        if let (Some(summary), Some(extent)) = (&mut self.summary, survey.extent()) {
            summary.lower_ground(extent);
        }
        self.survey = Some(survey);
    }

    /// Gives single spheres a colour of their own, by insertion index. Those without one have that of the scene ([`rockfall::Tag`]),
    /// or else that of their kind, as have all that are not in the list. These colours are shown with [`ColourBy::Kind`] and
    /// [`ColourBy::Body`].
    pub fn set_colours(&mut self, colours: Vec<Option<palette::Rgb>>) {
        self.colours = colours;
        self.colours_due = true;
    }

    /// Takes whether the following states need places of spheres, the vectors that arrows show, and the length of trails in s.
    pub(crate) fn want_motion(&mut self, places: bool, arrows: Option<Arrows>, trails: f64) {
        self.motion.want(places, arrows, trails);
    }

    /// Takes whether all joints of the following states are shown, and not only distance joints.
    pub(crate) fn want_joints(&mut self, all: bool) {
        self.motion.want_joints(all);
    }

    /// What an overlay shows.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Sets the time of the state of the last [`Renderer::update`], in s, which a trajectory knows and its simulation does not.
    pub fn set_time(&mut self, time: f64) {
        self.motion.set_time(time);
    }

    /// Adds the present state of a simulation to the trails of an overlay, without a picture of it.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the device failed.
    pub fn observe(&mut self, simulation: &mut Simulation) -> Result<()> {
        self.motion.set_blend(1.0);
        self.motion.update(simulation)?;
        self.motion.record();
        Ok(())
    }

    /// Adds the state that is shown to the trails of an overlay and to the plots.
    pub fn record(&mut self) {
        self.motion.record();
    }

    /// Takes the plots that are shown of the following states.
    pub fn set_plots(&mut self, graphs: Vec<Graph>) {
        self.motion.set_plots(graphs);
    }

    /// Fixes the axes of the plots of a film from its first to its last time, in s. The values are those of the states recorded
    /// so far, which the plots then forget.
    pub fn fix_plots(&mut self, span: [f64; 2]) {
        self.motion.plots.fix(span);
    }

    pub(super) fn set_region(&mut self, survey: &Survey) {
        self.region = survey.extent().map_or(self.region, |extent| extent.grown(REGION * extent.size()));
    }

    /// Evaluates the quantity that the colours show, and its 99th percentile.
    pub(super) fn update_values(&mut self, simulation: &mut Simulation, style: &Style) -> Result<()> {
        let by = style.colour_by;
        if self.coloured_by != by {
            (self.coloured_by, self.recent) = (by, RecentPercentile::default());
            self.colours_due = true;
            self.chains.clear();
        }
        if by.is_evaluated() {
            let values: Vec<f32> = net_force::diagnostics(simulation)?.iter().map(|found| by.value_of(found)).collect();
            self.recent.record(percentile_in(simulation.scene(), &values, self.region));
            self.buffers.set_values(&self.queue, simulation, values.into_iter());
        } else if by == ColourBy::ContactForce {
            let forces = self.chains.update(&self.device, simulation)?;
            self.recent.record(percentile(forces.into_iter()));
        } else if by == ColourBy::Tension {
            self.update_tensions(simulation)?;
        } else if by == ColourBy::Speed
            && style.range == Range::Auto
            && let Some(state) = self.buffers.state()
        {
            self.recent.record(self.speeds.of(state, self.step.layout.spheres, self.region)?);
        }
        if matches!(by, ColourBy::Kind | ColourBy::Body) {
            self.update_colours(simulation);
        }
        Ok(())
    }

    /// Uploads the tensions of springs and tethers.
    fn update_tensions(&mut self, simulation: &mut Simulation) -> Result<()> {
        let found: Vec<f32> = simulation.tensions()?.iter().map(|tension| tension.force).collect();
        self.recent.record(percentile(found.iter().map(|force| force.abs())));
        let counts = simulation.scene().counts();
        let mut values = vec![0.0; counts.rods];
        values.extend(found);
        self.buffers.set_colours(&self.queue, counts.spheres, &values);
        Ok(())
    }

    /// Uploads the colours that objects were given, if they have changed.
    fn update_colours(&mut self, simulation: &Simulation) {
        let scene = simulation.scene();
        if !self.colours_due && self.tag_changes == scene.tag_changes() {
            return;
        }
        (self.colours_due, self.tag_changes) = (false, scene.tag_changes());
        let own = |index: usize| self.colours.get(index).copied().flatten();
        let spheres = scene.sphere_ids().enumerate().map(|(index, id)| coded(own(index).or_else(|| colour_of(scene, id))));
        let spheres: Vec<f32> = spheres.collect();
        self.buffers.set_colours(&self.queue, spheres.len(), &colours(scene));
        self.buffers.set_values(&self.queue, simulation, spheres.into_iter());
    }

    /// Returns the range of the colour scale of the next picture.
    pub fn range(&self, style: &Style) -> [f32; 2] {
        match style.range {
            Range::Auto => style.colour_by.range_to(self.recent.range()[1]),
            Range::Given(range) => range,
        }
    }
}
