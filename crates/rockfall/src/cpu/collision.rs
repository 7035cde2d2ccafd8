//! Impulses: who shares in them, and how much each of many collisions weighs (physics.md section 3).

use glam::Vec3;

use crate::cpu::contact::{side, smaller_radius};
use crate::cpu::lists::{Entry, Lists};
use crate::cpu::touch::{Touch, touch};
use crate::cpu::view::{Object, TINY, View};
use crate::layout::{ENTRY_COLLIDES, ENTRY_OVERLAPS};

/// Overlaps up to this times the smaller radius are rounding, to the collision phase.
pub(crate) const ROUNDING: f32 = 1e-5;
/// Row sums up to this count as 1: nothing else presses.
const ALONE: f32 = 1.001;

/// The share g of a contact's unit impulse that a sphere receives.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Share {
    pub(crate) sphere: u32,
    pub(crate) g: Vec3,
}

/// A contact as the collision phase sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collision {
    /// Lower id.
    pub(crate) a: u32,
    /// Higher id.
    pub(crate) b: u32,
    pub(crate) feature: u32,
    pub(crate) touch: Touch,
    shares: [Share; 4],
    len: usize,
    /// G_kk = wA + wB: the inverse of the mass that the impulse meets.
    pub(crate) inverse_mass: f32,
    /// Approach velocity u, positive when closing.
    pub(crate) approach: f32,
}

impl Collision {
    /// The contact of two objects, in either order; `None` where they do not overlap.
    pub(crate) fn between(view: &View, one: u32, other: u32, feature: u32) -> Option<Self> {
        let (a, b) = view.ordered(one, other);
        Some(Self::of(view, a, b, feature, touch(view, a, b, feature)?))
    }

    fn of(view: &View, a: u32, b: u32, feature: u32, touch: Touch) -> Self {
        let mut shares = [Share::default(); 4];
        let mut len = 0;
        // A sphere that stands on both sides, such as a chain's end that touches the next rod but one, has one share.
        let mut add = |share: Share| match shares[..len].iter_mut().find(|known| known.sphere == share.sphere) {
            Some(known) => known.g += share.g,
            None => {
                shares[len] = share;
                len += 1;
            }
        };
        side_shares(view, view.object(a), touch.a, -touch.normal, &mut add);
        side_shares(view, view.object(b), touch.b, touch.normal, &mut add);
        let shares_of = &shares[..len];
        let inverse_mass = shares_of.iter().map(|s| view.inverse_mass(s.sphere) * s.g.length_squared()).sum();
        let approach = -shares_of.iter().map(|s| s.g.dot(view.velocity(s.sphere))).sum::<f32>();
        Self { a, b, feature, touch, shares, len, inverse_mass, approach }
    }

    /// The spheres that share in the impulse, those of A first, each once.
    pub(crate) fn shares(&self) -> &[Share] {
        &self.shares[..self.len]
    }

    /// The radius that thresholds refer to.
    fn smaller_radius(&self, view: &View) -> f32 {
        let a = side(view, view.object(self.a), self.touch.a);
        let b = side(view, view.object(self.b), self.touch.b);
        smaller_radius(&a, &b)
    }

    /// Whether it overlaps by more than rounding.
    pub(crate) fn is_pressed(&self, view: &View) -> bool {
        self.touch.overlap > ROUNDING * self.smaller_radius(view)
    }

    /// Whether it is an impulse: closing faster than the threshold.
    pub(crate) fn collides(&self, view: &View) -> bool {
        self.inverse_mass > 0.0 && self.approach > view.step.activation_threshold * self.smaller_radius(view)
    }

    /// What one sphere receives of this contact's unit impulse.
    pub(crate) fn share_of(&self, sphere: u32) -> Vec3 {
        self.shares().iter().find(|share| share.sphere == sphere).map_or(Vec3::ZERO, |share| share.g)
    }

    fn is_same(&self, other: &Self) -> bool {
        (self.a, self.b, self.feature) == (other.a, other.b, other.feature)
    }

    /// G_kl, over the spheres that both share in.
    fn coupling(&self, view: &View, other: &Self) -> f32 {
        self.shares().iter().map(|share| view.inverse_mass(share.sphere) * share.g.dot(other.share_of(share.sphere))).sum()
    }
}

/// How the unit impulse `n` on one side of a contact is shared.
fn side_shares(view: &View, object: Object, parameter: f32, n: Vec3, add: &mut impl FnMut(Share)) {
    match object {
        Object::Sphere(sphere) => sphere_shares(view, sphere, n, add),
        Object::Rod(rod) => {
            let [one, two] = view.rod(rod).ends;
            add(Share { sphere: one, g: (1.0 - parameter) * n });
            add(Share { sphere: two, g: parameter * n });
        }
        Object::Cuboid(_) | Object::Polygon(_) => {}
    }
}

/// A capsule is rigid along its axis: the axial part of an impulse on an end is shared by mass over both.
fn sphere_shares(view: &View, sphere: u32, n: Vec3, add: &mut impl FnMut(Share)) {
    let whole = Share { sphere, g: n };
    let Some(partner) = view.capsule_partner(sphere) else {
        return add(whole);
    };
    let d = view.position(partner) - view.position(sphere);
    let dd = d.length_squared();
    if dd <= TINY {
        return add(whole);
    }
    let axis = d / dd.sqrt();
    let axial = n.dot(axis) * axis;
    let (own, other) = (view.inverse_mass(sphere), view.inverse_mass(partner));
    // m1 / (m1 + m2), also where a mass is infinite.
    let fraction = if own == 0.0 { 1.0 } else { other / (own + other) };
    add(Share { sphere, g: (n - axial) + fraction * axial });
    add(Share { sphere: partner, g: (1.0 - fraction) * axial });
}

/// The objects whose contacts may give a sphere a share: itself, its rods, and ends of capsules whose other end it is.
pub(crate) fn rows<'a>(view: &View<'a>, sphere: u32) -> impl Iterator<Item = u32> + use<'a> {
    let view = *view;
    let rods = view.rods_of(sphere).map(move |rod| view.step.spheres + rod);
    let partners = view.rods_of(sphere).filter_map(move |rod| {
        let [one, two] = view.rod(rod).ends;
        let other = if one == sphere { two } else { one };
        (view.capsule_partner(other) == Some(sphere)).then_some(other)
    });
    std::iter::once(sphere).chain(rods).chain(partners)
}

/// Whether a sphere has a share in some collision: only then its state changes.
pub(crate) fn takes_part(view: &View, lists: &Lists, sphere: u32) -> bool {
    // Nearly all are told by their own list.
    lists.collides(sphere) || (view.step.rods > 0 && rows(view, sphere).any(|row| lists.collides(row)))
}

/// The contacts that may give a sphere a share, each once, with the row that it is taken in and its entry there.
pub(crate) struct Incident {
    sphere: u32,
    contacts: Vec<(Collision, u32, Entry)>,
}

impl Incident {
    /// Those whose entry has a bit of `mask`.
    pub(crate) fn of(view: &View, lists: &Lists, sphere: u32, mask: u32) -> Self {
        // Room for as many as most spheres have: threads that need more of the same memory wait for each other.
        let mut contacts = Vec::with_capacity(16);
        each_incident(view, lists, sphere, mask, |collision, row, entry| contacts.push((*collision, row, entry)));
        Self { sphere, contacts }
    }

    pub(crate) fn each(&self, mut take: impl FnMut(&Collision, u32, Entry)) {
        self.contacts.iter().for_each(|(collision, row, entry)| take(collision, *row, *entry));
    }
}

/// The contacts of [`Incident::of`], one after the other.
fn each_incident(view: &View, lists: &Lists, sphere: u32, mask: u32, mut take: impl FnMut(&Collision, u32, Entry)) {
    for row in rows(view, sphere) {
        for entry in lists.row(row).filter(|entry| entry.word & mask != 0) {
            let other = entry.id();
            // Met from both rows: taken in the one of the lower id.
            if view.user(other) < view.user(row) && rows(view, sphere).any(|own| own == other) {
                continue;
            }
            if let Some(collision) = Collision::between(view, row, other, entry.feature()) {
                take(&collision, row, entry);
            }
        }
    }
}

/// Row sums of the normalised |G| of a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowSums {
    /// Over all colliding contacts: 1 / s_k.
    pub(crate) colliding: f32,
    /// Over all overlapping contacts: 1 where nothing else presses.
    overlapping: f32,
}

impl RowSums {
    /// As one number: that of the colliding ones, negative where nothing else presses, so that the overlap is removed too.
    pub(crate) fn told(self) -> f32 {
        if self.overlapping <= ALONE { -self.colliding } else { self.colliding }
    }
}

/// The row sums of a colliding contact, itself included. Where the overlapping contacts of one sphere are known, as of many collisions
/// of that sphere, they need not be found for each.
pub(crate) fn row_sums(view: &View, lists: &Lists, k: &Collision, known: Option<&Incident>) -> RowSums {
    let mut sums = RowSums { colliding: 1.0, overlapping: 1.0 };
    for (place, share) in k.shares().iter().enumerate() {
        let sphere = share.sphere;
        let before = &k.shares()[..place];
        if view.is_fixed(sphere) {
            continue;
        }
        let add = |l: &Collision, _row: u32, entry: Entry| {
            // Counted at the first sphere that both share in.
            let met = |earlier: &Share| !view.is_fixed(earlier.sphere) && l.shares().iter().any(|s| s.sphere == earlier.sphere);
            if l.is_same(k) || l.inverse_mass <= 0.0 || before.iter().any(met) {
                return;
            }
            let coupling = k.coupling(view, l).abs() / (k.inverse_mass * l.inverse_mass).sqrt();
            sums.overlapping += coupling;
            if entry.word & ENTRY_COLLIDES != 0 {
                sums.colliding += coupling;
            }
        };
        match known {
            Some(known) if known.sphere == sphere => known.each(add),
            _ => each_incident(view, lists, sphere, ENTRY_OVERLAPS, add),
        }
    }
    sums
}
