//! Bodies of the scene: merged links, and light bodies between the joints of a link.

use crate::error::Result;
use crate::mass::{Mass, Pose};
use crate::model::{Geom, Model};
use crate::notes::Notes;
use crate::xml::Element;

use super::Builder;
use super::merge::{Merged, turned};

/// Part of the mass of a link that each body between its joints takes over.
/// With 0.1, a hopper comes to rest 30 mm higher than in MuJoCo; with 0.01, 5 mm.
const SHARE: f64 = 0.01;

/// A body. The first one is the world.
pub(super) struct Body {
    pub(super) name: String,
    pub(super) element: Element,
    /// In the world.
    pub(super) pose: Pose,
    /// In coordinates of the body.
    pub(super) mass: Mass,
    /// With poses in coordinates of the body.
    pub(super) geoms: Vec<Geom>,
    /// The joints between it and others.
    pub(super) joints: Vec<Edge>,
    /// The body and the one above it have other bodies between them. They do not touch.
    pub(super) apart_from: Option<usize>,
    /// Whether it is a light body between the joints of a link.
    pub(super) is_between: bool,
}

/// A joint above a body.
pub(super) struct Edge {
    /// The body above.
    pub(super) above: usize,
    /// The link and the number of its joint.
    pub(super) link: usize,
    pub(super) joint: usize,
    /// Pose of the coordinates of the link, in the world, after the joints above this one.
    pub(super) frame: Pose,
    /// Position of the joint in the place of the scene.
    pub(super) start: f64,
}

/// The bodies of the scene.
pub(super) fn of(model: &Model, merged: &Merged, builder: &mut Builder<'_>) -> Result<Vec<Body>> {
    let mut bodies = vec![world(model, merged)];
    let mut numbers = vec![0; model.links.len()];
    for (top, link) in model.links.iter().enumerate().skip(1) {
        if merged.tops[top] != top {
            numbers[top] = numbers[merged.tops[top]];
            continue;
        }
        let (mass, geoms) = (merged.mass(model, top), geoms(model, merged, top));
        let mass = sound(&link.element, mass, &geoms, &mut builder.notes)?;
        let parent = numbers[link.parent.unwrap_or(0)];
        let name = builder.bodies.word(&link.name, &link.element, &mut builder.notes);
        let between = link.joints.len().saturating_sub(1);
        let own = 1.0 - SHARE.min(0.5 / between.max(1) as f64) * between as f64;
        let light = mass.scaled((1.0 - own) / between.max(1) as f64);
        let mut frame = merged.poses[link.parent.unwrap_or(0)].then(&link.pose);
        let mut above = parent;
        for (joint, start) in merged.starts[top].iter().enumerate() {
            let edge = Edge { above, link: top, joint, frame, start: *start };
            frame = frame.then(&turned(&link.joints[joint], *start));
            let is_last = joint == between;
            let body = Body {
                name: if is_last { name.clone() } else { between_name(builder, link, joint) },
                element: link.element.clone(),
                pose: merged.poses[top],
                mass: if is_last { mass.scaled(own) } else { light },
                geoms: if is_last { geoms.clone() } else { Vec::new() },
                joints: vec![edge],
                apart_from: (is_last && between > 0 && parent != 0).then_some(parent),
                is_between: !is_last,
            };
            above = bodies.len();
            bodies.push(body);
        }
        if link.joints.is_empty() {
            let (element, pose) = (link.element.clone(), merged.poses[top]);
            bodies.push(Body { name, element, pose, mass, geoms, joints: Vec::new(), apart_from: None, is_between: false });
        } else if between > 0 {
            let text = format!(
                "it has {} joints, so {between} light {} between it and its parent, with {:.0} % of its mass each",
                link.joints.len(),
                if between == 1 { "body lies" } else { "bodies lie" },
                100.0 * light.mass / mass.mass
            );
            builder.notes.add(&link.element, text);
        }
        numbers[top] = bodies.len() - 1;
    }
    builder.contacts.numbers = numbers;
    Ok(bodies)
}

fn between_name(builder: &mut Builder<'_>, link: &crate::model::Link, joint: usize) -> String {
    let joint = &link.joints[joint];
    let mut none = Notes::default();
    builder.bodies.word(&format!("{}_{}", link.name, joint.name), &joint.element, &mut none)
}

fn world(model: &Model, merged: &Merged) -> Body {
    let element = model.links[0].element.clone();
    let name = "world".to_owned();
    let geoms = geoms(model, merged, 0);
    Body { name, element, pose: Pose::NONE, mass: Mass::NONE, geoms, joints: Vec::new(), apart_from: None, is_between: false }
}

fn geoms(model: &Model, merged: &Merged, top: usize) -> Vec<Geom> {
    let of_part = |(part, pose): (usize, Pose)| {
        model.links[part].geoms.iter().map(move |geom| Geom { pose: pose.then(&geom.pose), ..geom.clone() })
    };
    merged.parts(top).flat_map(of_part).collect()
}

/// Mass properties that a body can have.
fn sound(element: &Element, mass: Mass, geoms: &[Geom], notes: &mut Notes) -> Result<Mass> {
    if mass.mass <= 0.0 {
        return Err(element.wrong("it moves and has no mass, expected a mass greater than 0 or a fixed joint"));
    }
    let mut mass = mass;
    if mass.inertia.to_cols_array().iter().all(|element| *element == 0.0) {
        let solids = geoms.iter().map(|geom| geom.solid.mass(1.0).moved(&geom.pose));
        let solid = solids.fold(Mass::NONE, |sum, solid| sum.and(&solid));
        if solid.mass <= 0.0 {
            return Err(element.wrong("it moves and has no inertia and no collision geometry, expected an inertia"));
        }
        mass.inertia = solid.inertia * (mass.mass / solid.mass);
        notes.add(element, "its inertia is 0, so it has that of its collision geometry");
    }
    let (sound, differs) = mass.repaired();
    if differs {
        let [xx, yy, zz, ..] = sound.elements();
        let text = "no body has its inertia, in which a moment is 0 or greater than the sum of the others. It was replaced by";
        notes.add(element, format!("{text} the nearest one, with xx={xx:.3e}, yy={yy:.3e}, zz={zz:.3e}"));
    }
    Ok(sound)
}
