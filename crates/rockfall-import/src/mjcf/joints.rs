//! `<joint>` and `<freejoint>`.

use rockfall::glam::DVec3;

use super::Mjcf;
use super::defaults::Attributes;
use crate::error::Result;
use crate::mass::Pose;
use crate::model::{LinkJoint, Motion, Spring};
use crate::urdf::not_negative;
use crate::xml::{Element, quoted};

impl Mjcf<'_> {
    pub(super) fn joint(&mut self, element: &Element, link: usize, frame: Pose, class: usize) -> Result<()> {
        let of = self.defaults.attributes(element, class)?;
        let kind = if element.name == "freejoint" { "free" } else { of.get("type").unwrap_or("hinge") };
        let motion = match kind {
            "hinge" => Motion::Hinge,
            "slide" => Motion::Slide,
            "ball" => Motion::Ball,
            "free" => {
                self.links[link].is_free = true;
                if of.number("armature")?.is_some_and(|armature| armature != 0.0) {
                    self.notes.ignored_attribute(element, "armature");
                }
                return Ok(());
            }
            _ => return Err(element.wrong(format!("type={} is unknown, expected hinge, slide, ball or free", quoted(kind)))),
        };
        let axis = of.vector("axis")?.unwrap_or(DVec3::Z);
        let Some(axis) = axis.try_normalize() else {
            return Err(element.wrong("the axis is 0, expected a direction"));
        };
        let unit = if motion == Motion::Slide { 1.0 } else { self.compiler.radians };
        let start = of.number("ref")?.unwrap_or(0.0) * unit;
        let range = of.range("range")?;
        let is_limited = of.is_limited("limited", range.is_some(), self.compiler.autolimits);
        let limits = range.filter(|_| is_limited).map(|range| range.map(|bound| bound * unit - start));
        let springs = passive(&of, unit, start)?;
        let friction = not_negative(element, "frictionloss", of.first("frictionloss")?.unwrap_or(0.0))?;
        let armature = not_negative(element, "armature", of.number("armature")?.unwrap_or(0.0))?;
        let bounds = of.range("actuatorfrcrange")?;
        let is_bounded = of.is_limited("actuatorfrclimited", bounds.is_some(), self.compiler.autolimits);
        let effort = bounds.filter(|_| is_bounded).map(greatest);
        if of.list("springdamper")?.is_some_and(|values| values.iter().any(|value| *value != 0.0)) {
            self.notes.ignored_attribute(element, "springdamper");
        }
        if motion == Motion::Ball && springs.iter().any(|spring| spring.stiffness > 0.0) {
            self.notes.add(element, "the stiffness of the ball joint acts on its twist about one axis");
        }
        let (at, axis) = (frame.point(of.vector("pos")?.unwrap_or(DVec3::ZERO)), frame.turn * axis);
        let number = self.links[link].joints.len();
        let name = match element.attribute("name") {
            Some(name) => name.to_owned(),
            None => format!("{}_joint{}", self.links[link].name, if number > 0 { number.to_string() } else { String::new() }),
        };
        if let Some(name) = element.attribute("name")
            && self.joints.insert(name.to_owned(), (link, number)).is_some()
        {
            return Err(element.wrong("another joint has this name, expected names that differ"));
        }
        let element = element.alone();
        self.links[link].joints.push(LinkJoint {
            name,
            element,
            motion,
            at,
            axis,
            reference: start,
            limits,
            springs,
            motors: Vec::new(),
            effort,
            armature,
            friction,
        });
        Ok(())
    }
}

/// The greater size of both bounds of a force, not 0.
pub(super) fn greatest([least, greatest]: [f64; 2]) -> f64 {
    least.abs().max(greatest.abs()).max(f64::MIN_POSITIVE)
}

/// The spring and the damper of a joint.
fn passive(of: &Attributes<'_>, unit: f64, start: f64) -> Result<Vec<Spring>> {
    let stiffness = not_negative(of.element, "stiffness", of.first("stiffness")?.unwrap_or(0.0))?;
    let damping = not_negative(of.element, "damping", of.first("damping")?.unwrap_or(0.0))?;
    let target = of.number("springref")?.unwrap_or(0.0) * unit - start;
    Ok(vec![Spring { stiffness, damping, target, most: None }])
}
