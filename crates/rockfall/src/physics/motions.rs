//! Where spheres are and how they move, in the present state or in another one, and the contacts of spheres with each other and with boxes and
//! polygons (docs/physics sections 2.6 to 2.8).

use glam::{DVec3, Vec3};

use crate::fine::Fine;
use crate::model::period::Periods;
use crate::model::view::{BoxRecord, PolygonRecord, RodRecord, TINY, View};
use crate::physics::fine_geometry::{fine_box, fine_polygon, fine_spheres};
use crate::physics::geometry::{point_box, point_polygon};

/// Positions and velocities of spheres, in the present state or in a state moved back in time.
pub(crate) trait Motions {
    fn position(&self, sphere: u32) -> Vec3;
    fn velocity(&self, sphere: u32) -> Vec3;

    /// The position with its low part, where positions have one.
    fn fine_position(&self, _sphere: u32) -> Option<Fine> {
        None
    }

    /// The periods of the scene.
    fn periods(&self) -> Option<Periods>;

    /// The position, with its low part where positions have one.
    fn place(&self, sphere: u32) -> Fine {
        self.fine_position(sphere).unwrap_or_else(|| Fine { high: self.position(sphere), low: Vec3::ZERO })
    }

    /// The image of a position that is nearest to a place.
    fn near(&self, place: DVec3, position: Fine) -> Fine {
        self.periods().map_or(position, |periods| periods.near(place, position))
    }

    /// The vector from the centre of one sphere to the nearest image of that of another.
    fn between(&self, from: u32, to: u32) -> Vec3 {
        match (self.fine_position(from), self.periods()) {
            (None, None) => self.position(to) - self.position(from),
            _ => self.near(self.place(from).wide(), self.place(to)).minus(self.place(from)),
        }
    }

    /// The position of a sphere as seen from an origin. With double precision the difference keeps its digits.
    fn seen_from(&self, origin: Fine, sphere: u32) -> Vec3 {
        self.fine_position(sphere).map_or_else(|| self.position(sphere), |place| self.near(origin.wide(), place).minus(origin))
    }

    /// The contact of two spheres with these radii.
    fn spheres(&self, [a, b]: [u32; 2], radii: [f32; 2]) -> Touch {
        if let (Some(a), Some(b)) = (self.fine_position(a), self.fine_position(b)) {
            let (normal, overlap) = fine_spheres(a, self.near(a.wide(), b), radii);
            return Touch { normal, overlap, a: 0.0, b: 0.0 };
        }
        round(self.between(a, b), radii[0] + radii[1], Vec3::Y, 0.0, 0.0)
    }

    /// The contact of a sphere of this radius with a box.
    fn on_box(&self, sphere: u32, radius: f32, cuboid: &BoxRecord) -> Touch {
        let centre = self.near(cuboid.middle().as_dvec3(), self.place(sphere));
        if self.fine_position(sphere).is_some() {
            let (normal, overlap) = fine_box(cuboid, centre, radius);
            return Touch { normal, overlap, a: 0.0, b: 0.0 };
        }
        let (normal, distance) = point_box(cuboid, centre.high, radius);
        Touch { normal, overlap: radius - distance, a: 0.0, b: 0.0 }
    }

    /// The contact of a sphere of this radius with a polygon. `None` behind the plane of a parallelogram.
    fn on_polygon(&self, sphere: u32, radius: f32, polygon: &PolygonRecord) -> Option<Touch> {
        let centre = self.near(polygon.middle().as_dvec3(), self.place(sphere));
        let (normal, overlap) = match self.fine_position(sphere) {
            Some(_) => fine_polygon(polygon, centre, radius)?,
            None => {
                let (normal, distance) = point_polygon(polygon, centre.high, radius)?;
                (normal, radius - distance)
            }
        };
        Some(Touch { normal, overlap, a: 0.0, b: 0.0 })
    }
}

impl Motions for View<'_> {
    fn position(&self, sphere: u32) -> Vec3 {
        View::position(self, sphere)
    }

    fn velocity(&self, sphere: u32) -> Vec3 {
        View::velocity(self, sphere)
    }

    fn fine_position(&self, sphere: u32) -> Option<Fine> {
        self.step.is_double().then(|| self.fine(sphere))
    }

    fn periods(&self) -> Option<Periods> {
        Periods::of(self.step)
    }
}

/// The origin of the coordinates in which a rod is compared with other objects: its end 1 with double precision, where differences
/// of positions keep their digits, and otherwise the origin of the scene.
pub(crate) fn origin_of(at: &impl Motions, rod: RodRecord) -> Fine {
    at.fine_position(rod.ends[0]).unwrap_or_default()
}

/// A box as seen from an origin.
pub(crate) fn box_from(at: &impl Motions, cuboid: &BoxRecord, origin: Fine) -> BoxRecord {
    let origin = at.near(cuboid.middle().as_dvec3(), origin);
    BoxRecord { corner: Fine { high: cuboid.corner, low: Vec3::ZERO }.minus(origin), ..*cuboid }
}

pub(crate) fn ends(at: &impl Motions, rod: RodRecord, origin: Fine) -> [Vec3; 2] {
    rod.ends.map(|end| at.seen_from(origin, end))
}

/// The contact of objects A and B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Touch {
    /// Unit normal from A to B.
    pub(crate) normal: Vec3,
    /// Depth of the overlap. Negative when the objects are apart, with their distance as the absolute value.
    pub(crate) overlap: f32,
    /// Parameter of the contact on A, if A is a rod.
    pub(crate) a: f32,
    /// Parameter of the contact on B, if B is a rod.
    pub(crate) b: f32,
}

/// Returns the contact of two round objects. `d` is the vector between their closest points, `reach` the sum of their radii,
/// and `zero_normal` the normal where `d` is 0.
pub(super) fn round(d: Vec3, reach: f32, zero_normal: Vec3, a: f32, b: f32) -> Touch {
    let dd = d.length_squared();
    let (normal, distance) = if dd <= TINY { (zero_normal, 0.0) } else { (d / dd.sqrt(), dd.sqrt()) };
    Touch { normal, overlap: reach - distance, a, b }
}
