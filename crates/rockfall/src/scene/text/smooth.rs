//! Lines of smooth walls: `@plane`, `@cylinder`, `@cone` and `@ball`.

use glam::Vec3;

use super::Reader;
use super::line::{BALL, CONE, CYLINDER, Kind, Line, PLANE};
use super::values::Values;
use crate::error::quoted;
use crate::scene::{ConeAxis, Polygon, Surface, shared};

impl Reader<'_> {
    pub(super) fn smooth(&mut self, kind: &Kind, line: &str, number: usize) -> Line<()> {
        if !line.contains('=') {
            return self.not_understood(number, kind.wrong("at", format!("missing, expected {}", kind.form())));
        }
        let keys: Vec<&str> = kind.keys().into_iter().chain(["edge", "out"]).collect();
        let values = Values::read(kind, &keys, line.split_ascii_whitespace().skip(1))?;
        let at = (values.needed("at", values.vector("at")?)? + self.offset()).as_vec3();
        let edges = [values.vector("edge")?, values.vector("out")?];
        let wall = match kind.word {
            _ if edges.iter().any(Option::is_some) => {
                let [edge, out] = [values.needed("edge", edges[0])?, values.needed("out", edges[1])?];
                Polygon { surface: surface_of(kind), ..Polygon::new(at, edge.as_vec3(), out.as_vec3()) }
            }
            "@plane" => Polygon::plane(at, direction(&values, "normal")?),
            "@ball" => Polygon::ball(at, length(&values, "radius")?),
            _ => {
                let axis = direction(&values, "axis")?;
                let radii = if kind.word == "@cone" { radii(&values)? } else { [length(&values, "radius")?; 2] };
                Polygon::cone(at, axis, radii, length(&values, "length")?)
            }
        };
        let inside = match values.of("inside") {
            None | Some("no") => false,
            Some("yes") => true,
            Some(other) => return Err(kind.wrong("inside", format!("{} is not allowed, expected yes or no", quoted(other)))),
        };
        let (group, material, motion, surface_velocity) = (self.group, self.material, self.motion, self.surface);
        let tag = shared(self.tag_with_name(kind, &values)?);
        let wall = Polygon { group, material, motion, surface_velocity, ..wall.inside(inside) };
        let id = self.scene.add_polygon(wall).map_err(|error| kind.refused(&error))?;
        self.scene.share_tag(id.into(), &tag).map_err(|error| kind.refused(&error))
    }
}

/// The surface of a kind of line, touched from outside.
fn surface_of(kind: &Kind) -> Surface {
    match kind.word {
        "@plane" => Surface::Plane,
        "@ball" => Surface::Ball { inside: false },
        _ => Surface::Cone { inside: false },
    }
}

/// A vector that is not 0.
fn direction(values: &Values, key: &str) -> Line<Vec3> {
    let vector = values.needed(key, values.vector(key)?)?.as_vec3();
    let is_usable = vector.is_finite() && vector.as_dvec3().try_normalize().is_some();
    is_usable.then_some(vector).ok_or_else(|| values.kind.wrong(key, "a direction that is 0 or not finite, expected x,y,z"))
}

/// A number greater than 0, finite in f32.
fn length(values: &Values, key: &str) -> Line<f32> {
    let number = values.needed(key, values.number(key)?)? as f32;
    let is_usable = number.is_finite() && number > 0.0;
    is_usable.then_some(number).ok_or_else(|| values.kind.wrong(key, "not allowed, expected a finite number greater than 0"))
}

/// The radii at both ends, a..b, of which one may be 0.
fn radii(values: &Values) -> Line<[f32; 2]> {
    let value = values.needed("radius", values.of("radius"))?;
    let number = |word: &str| word.parse().ok().filter(|number: &f32| number.is_finite() && *number >= 0.0);
    let both = value.split_once("..").and_then(|(near, far)| Some([number(near)?, number(far)?]));
    let usable = both.filter(|radii| radii.iter().any(|radius| *radius > 0.0));
    let wrong = || {
        let expected = "expected two radii a..b, not negative, of which at most one is 0";
        values.kind.wrong("radius", format!("{} is not allowed, {expected}", quoted(value)))
    };
    usable.ok_or_else(wrong)
}

/// The line of a smooth wall, which reads back with the same bits; `None` for other polygons. Where the words of the user would not do that, the
/// edges are given.
pub(in crate::scene) fn line_of(wall: &Polygon) -> Option<String> {
    let point = |vector: Vec3| format!("{},{},{}", vector.x, vector.y, vector.z);
    let axis = ConeAxis::of(wall.left, wall.right);
    let [near, far] = axis.radii.map(|radius| radius.max(0.0) as f32);
    let length = axis.along.length() as f32;
    let normal = wall.left.cross(wall.right);
    let radius = wall.left.length();
    let along = || format!("axis={} length={length}", point(axis.along.as_vec3()));
    let (kind, made, words) = match wall.surface {
        Surface::Plane => (PLANE, Polygon::plane(wall.corner, normal), format!("normal={}", point(normal))),
        Surface::Ball { .. } => (BALL, Polygon::ball(wall.corner, radius), format!("radius={radius}")),
        Surface::Cone { .. } => {
            let made = Polygon::cone(wall.corner, axis.along.as_vec3(), [near, far], length);
            let is_cylinder = near == far;
            let radius = if is_cylinder { near.to_string() } else { format!("{near}..{far}") };
            (if is_cylinder { CYLINDER } else { CONE }, made, format!("radius={radius} {}", along()))
        }
        Surface::Parallelogram | Surface::Triangle => return None,
    };
    let bits = |wall: &Polygon| [wall.corner, wall.left, wall.right].map(|vector| vector.to_array().map(f32::to_bits));
    let is_same = bits(&made) == bits(wall);
    let edges = || format!("edge={} out={}", point(wall.left), point(wall.right));
    let inside = if wall.surface.is_inside() { " inside=yes" } else { "" };
    Some(format!("{} at={} {}{inside}", kind.word, point(wall.corner), if is_same { words } else { edges() }))
}

#[cfg(test)]
#[path = "smooth_tests.rs"]
mod tests;
