//! Tangential springs that overlapping spheres of a rigid body share (docs/physics section 4.11).

use glam::Vec3;

use crate::laws::{Constants, of_file};
use crate::model::view::View;
use crate::physics::chain;
use crate::physics::laws::contact::{Share, Spring};
use crate::physics::laws::history::Histories;
use crate::physics::touch::Touch;

/// Two spheres of a rigid body are neighbours if their centres are nearer than this part of the sum of their radii.
const NEIGHBOURS_WITHIN: f32 = 0.99;

/// The contact of a neighbour with the same object: its displacement, and its elastic force in the last step and now, up to a common factor.
struct Neighbour {
    shift: Vec3,
    before: f32,
    now: f32,
}

/// The displacement that a contact begins a step with, and its share, or `None` if it shares its spring with no other contact.
pub(crate) fn shared(
    view: &View,
    histories: &Histories,
    ids: [u32; 2],
    feature: u32,
    touch: &Touch,
    own: Option<Spring>,
) -> Option<(Vec3, Share)> {
    let layout = view.step.layout;
    let force = |overlap: f32| of_file(layout.law, |law| law.relative_force(overlap));
    if layout.rigid_bodies == 0 || force(1.0) == 0.0 || Constants::of(view, ids[0], ids[1]).cohesion != 0.0 {
        return None;
    }
    let others: Vec<_> = neighbours(view, histories, ids, feature, force).collect();
    if others.is_empty() {
        return None;
    }
    let Spring { shift, overlap, .. } = own.unwrap_or_default();
    let own = Neighbour { shift, before: force(overlap), now: force(touch.overlap) };
    let before = own.before + others.iter().map(|other| other.before).sum::<f32>();
    let now = own.now + others.iter().map(|other| other.now).sum::<f32>();
    let part = own.now / now;
    let gain = part - own.before / before;
    let lost = |other: &Neighbour| (other.before / before - other.now / now).max(0.0);
    let brought: Vec3 = others.iter().map(|other| lost(other) * other.shift).sum();
    let all: f32 = others.iter().map(lost).sum();
    let is_fed = gain > 0.0 && all > 0.0;
    let shift = if is_fed { ((part - gain) * own.shift + gain / all * brought) / part } else { own.shift };
    let stiffness = |force: f32| of_file(layout.law, |law| law.stiffness_by_force(force));
    let share = Share { stiffness: part / stiffness(part), unloading: stiffness((now / before).min(1.0)) };
    Some((shift, share))
}

/// The contacts of neighbours with the same object, or with neighbours of it, that had a spring in the last step.
fn neighbours(
    view: &View,
    histories: &Histories,
    [a, b]: [u32; 2],
    feature: u32,
    force: impl Fn(f32) -> f32,
) -> impl Iterator<Item = Neighbour> {
    let [of_a, of_b] = [a, b].map(|id| std::iter::once(id).chain(overlapped(view, id)).collect::<Vec<_>>());
    let pairs = of_a.into_iter().flat_map(move |k| of_b.clone().into_iter().map(move |l| [k, l]));
    pairs.filter(move |pair| *pair != [a, b]).filter_map(move |[k, l]| {
        let (first, second) = view.ordered(k, l);
        let spring = histories.spring(view, first, second, feature).filter(|spring| spring.overlap > 0.0)?;
        let now = chain::touch(view, first, second, feature).map_or(0.0, |touch| touch.overlap);
        let shift = if first == k { spring.shift } else { -spring.shift };
        Some(Neighbour { shift, before: force(spring.overlap), now: force(now) })
    })
}

/// The spheres of the same rigid body that overlap a sphere.
fn overlapped<'a>(view: &'a View, id: u32) -> impl Iterator<Item = u32> + use<'a> {
    let is_sphere = id < view.step.layout.spheres;
    let body = is_sphere.then(|| view.body_of_sphere(id)).flatten().map(|body| view.rigid_body(body));
    body.into_iter().flat_map(move |body| {
        let members = move || view.members(body).map(|(index, place)| (view.slot_of(index), place));
        let own = members().find(|(sphere, _)| *sphere == id).map_or(Vec3::ZERO, |(_, place)| place);
        members().map(move |(sphere, place)| (sphere, place - own)).filter_map(move |(sphere, apart)| {
            let most = NEIGHBOURS_WITHIN * (view.radius(sphere) + view.radius(id));
            (sphere != id && apart.length_squared() < most * most).then_some(sphere)
        })
    })
}
