//! Marks of joints.

use super::Projection;
use crate::joints::JointPlace;
use crate::mark::Mark;
use crate::palette::Rgb;

const INK: Rgb = [0xe6, 0x9f, 0x00];
const RIM: Rgb = [0x21, 0x29, 0x33];
/// Half the width of the mark of an anchor, and half the length of an axis that is seen from the side, in heights of letters.
const HALF: f32 = 0.3;
const AXIS: f32 = 1.3;
const RIM_WIDTH: f32 = 0.1;

/// Adds a diamond at the anchor of a joint, and a line along its axis. The anchors of a distance joint have a line between
/// them, and those of a slider, or of a joint that gives way, a thin one.
pub(super) fn mark(joint: &JointPlace, projection: &Projection, em: f32, marks: &mut Vec<Mark>) {
    let [start, end] = joint.ends.map(|place| projection.place(place));
    let Some(at) = end else { return };
    let mut line = |ends: [[f32; 2]; 2], width: f32| {
        let rim = Mark::Line { ends, width: width + 2.0 * RIM_WIDTH * em, colour: RIM, opacity: 1.0 };
        marks.extend([rim, Mark::Line { ends, width, colour: INK, opacity: 1.0 }]);
    };
    if let Some(start) = start.filter(|start| (start[0] - at[0]).hypot(start[1] - at[1]) > 1.0) {
        line([start, at], 0.1 * em);
    }
    let reach = AXIS * em / projection.pixels_per_unit_at(joint.ends[1]);
    let tips = [-reach, reach].map(|reach| projection.place(joint.ends[1] + reach * joint.axis));
    if let [Some(from), Some(to)] = tips
        && from != to
    {
        line([from, to], 0.16 * em);
    }
    let diamond = |half: f32, colour: Rgb| {
        let point = |x: f32, y: f32| [at[0] + half * x, at[1] + half * y];
        let half_of = |y: f32| Mark::Triangle { corners: [point(-1.0, 0.0), point(1.0, 0.0), point(0.0, y)], colour };
        [half_of(-1.0), half_of(1.0)]
    };
    marks.extend(diamond((HALF + 1.5 * RIM_WIDTH) * em, RIM).into_iter().chain(diamond(HALF * em, INK)));
}
