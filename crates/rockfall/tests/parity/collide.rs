//! The collisions of a state in f64, from docs/physics section 3: which of them are lone, and the effects of lone collisions
//! and of clusters.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::bodies::{Ball, Bodies, Body, Kind};
use crate::decisions::{Contact, Findings};
use crate::narrow::{Touch, face_slack, is_on_face, signed};

/// Largest |n n'| at which two normals count as perpendicular (section 3.5).
const RIGHT_ANGLE: f64 = 0.001;
/// A contact gets no impulse if the projection reduces its inverse mass to less than this fraction (section 3.4).
const RIGID: f64 = 1e-6;
/// Iterations for the time of contact (section 3.6).
const ITERATIONS: usize = 4;
/// Factor of each sweep of a cluster (section 3.7).
const SWEEP_SIZES: [f64; 8] = [1.25098, 1.25098, 2.66852, 2.66852, 1.81611, 1.81611, 1.0, 1.0];

/// Two collisions are at one place if the determinant of their couplings, divided by the product of the two with themselves, is at
/// most this (section 3.7).
const ONE_PLACE: f64 = 1e-3;

/// Share of a sphere in a unit impulse: momentum and angular momentum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Share {
    /// 0 for side A of the contact, 1 for side B.
    side: usize,
    body: Body,
    ball: usize,
    pub(crate) g: DVec3,
    h: DVec3,
}

/// Change of a sphere by collisions: position, velocity and angular momentum.
#[derive(Clone, Copy, Default)]
pub(crate) struct Change {
    pub(crate) x: DVec3,
    pub(crate) v: DVec3,
    pub(crate) l: DVec3,
}

/// Returns the shares of the unit impulse of a contact, and the part of its approach velocity that comes from the surface
/// velocities of fixed spheres.
pub(crate) fn shares(bodies: &Bodies, a: usize, b: usize, touch: &Touch) -> (Vec<Share>, f64) {
    let mut all = Vec::new();
    let mut surface = 0.0;
    for (side, id, parameter, p) in [(0, a, touch.a, -touch.n), (1, b, touch.b, touch.n)] {
        if let Some(bar) = bodies.capsule_with(id) {
            let place = match bodies.kind(id) {
                Kind::Ball(ball) => f64::from(u8::from(bodies.bars[bar].ends[1] == ball)),
                _ => parameter,
            };
            all.extend(capsule_shares(bodies, bar, place, p).map(|(ball, g, h)| Share {
                side,
                body: Body::Capsule(bar),
                ball,
                g,
                h,
            }));
            continue;
        }
        let mut give = |ball: usize, g: DVec3| {
            let body = bodies.body_of[ball];
            all.extend(body.map(|body| Share { side, body, ball, g, h: DVec3::ZERO }));
            body.is_some()
        };
        match bodies.kind(id) {
            Kind::Ball(ball) => {
                if !give(ball, p) {
                    surface -= bodies.balls[ball].v.dot(p);
                }
            }
            Kind::Bar(bar) => {
                let [one, two] = bodies.bars[bar].ends;
                give(one, (1.0 - parameter) * p);
                give(two, parameter * p);
            }
            Kind::Block(_) | Kind::Face(_) => {}
        }
    }
    (all, surface)
}

/// Returns g and h of section 3.3 for both ends of a capsule.
fn capsule_shares(bodies: &Bodies, bar: usize, place: f64, p: DVec3) -> [(usize, DVec3, DVec3); 2] {
    let ends = bodies.bars[bar].ends;
    let [one, two] = ends.map(|end| &bodies.balls[end]);
    let (m1, m2) = (1.0 / one.w, 1.0 / two.w);
    let (mass, mu) = (m1 + m2, m1 * m2 / (m1 + m2));
    let d = two.x - one.x;
    let dd = d.length_squared();
    let it = mu * dd + 1.0 / one.i + 1.0 / two.i;
    let lever = place - m2 / mass;
    let turning = lever * mu * dd / it * (p - p.dot(d) / dd * d);
    let torque = lever / it * d.cross(p);
    [(ends[0], m1 / mass * p - turning, torque / one.i), (ends[1], m2 / mass * p + turning, torque / two.i)]
}

/// Returns the inverse mass without the projection onto networks.
pub(crate) fn inverse_mass(bodies: &Bodies, shares: &[Share]) -> f64 {
    shares
        .iter()
        .map(|share| {
            bodies.balls[share.ball].w * share.g.length_squared() + bodies.balls[share.ball].i * share.h.length_squared()
        })
        .sum()
}

/// Returns the approach velocity.
pub(crate) fn approach(bodies: &Bodies, shares: &[Share], surface: f64) -> f64 {
    let of = |share: &Share| {
        let ball = &bodies.balls[share.ball];
        ball.v.dot(share.g) + ball.i * ball.l.dot(share.h)
    };
    surface - shares.iter().map(of).sum::<f64>()
}

/// Whether a contact touches a body (section 1.4).
fn touches_body(bodies: &Bodies, contact: &Contact, body: Body) -> bool {
    let balls = [contact.a, contact.b].into_iter().flat_map(|id| bodies.spheres_of(id));
    balls.into_iter().any(|ball| bodies.body_of[ball] == Some(body))
}

/// Returns the bodies of a contact, each with its side. A body with both sides occurs twice.
fn bodies_of(contact: &Contact) -> Vec<(usize, Body)> {
    let mut all: Vec<_> = contact.shares.iter().map(|share| (share.side, share.body)).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Whether a collision is lone (section 3.5). `pressed` holds all pressed contacts.
pub(crate) fn is_lone(bodies: &Bodies, k: &Contact, pressed: &[Contact], findings: &mut Findings) -> bool {
    let mut is_lone = true;
    for (_, body) in bodies_of(k) {
        is_lone &= !matches!(body, Body::Network(_));
        for l in pressed.iter().filter(|l| !std::ptr::eq(*l, k) && touches_body(bodies, l, body)) {
            let is_static = matches!(bodies.kind(l.b), Kind::Block(_) | Kind::Face(_));
            let is_own = bodies.kind(l.a)
                == match body {
                    Body::Ball(ball) => Kind::Ball(ball),
                    _ => Kind::Face(usize::MAX),
                };
            if is_static && is_own {
                let along = k.touch.n.dot(l.touch.n).abs();
                findings.decide("at a right angle", k.a, along - RIGHT_ANGLE);
                is_lone &= along <= RIGHT_ANGLE;
                if l.collides && (1e-6..=RIGHT_ANGLE).contains(&along) {
                    // In clusters, only the GPU counts the impulses of such lone collisions (docs/physics section 3.5).
                    findings.decide("at nearly a right angle", k.a, 0.0);
                }
                if along <= RIGHT_ANGLE {
                    findings.count("at a right angle".to_owned());
                }
            } else {
                is_lone = false;
            }
        }
    }
    is_lone
}

/// Returns d and q of a capsule after a time on their circle (equation 3).
fn turned(d: DVec3, q: DVec3, time: f64) -> (DVec3, DVec3) {
    let rate = q.length() / d.length();
    if rate == 0.0 {
        return (d, q);
    }
    let (sin, cos) = (time * rate).sin_cos();
    (cos * d + sin / rate * q, cos * q - sin * rate * d)
}

/// Motion of a capsule: its centre of mass, and the difference of its ends.
struct Axle {
    centre: DVec3,
    velocity: DVec3,
    acceleration: DVec3,
    d: DVec3,
    q: DVec3,
    /// m2/M.
    place: f64,
}

impl Axle {
    fn of(bodies: &Bodies, bar: usize) -> Self {
        let [one, two] = bodies.bars[bar].ends.map(|end| &bodies.balls[end]);
        let place = one.w / (one.w + two.w);
        let mean = |one: DVec3, two: DVec3| one.lerp(two, place);
        Self {
            centre: mean(one.x, two.x),
            velocity: mean(one.v, two.v),
            acceleration: mean(one.acceleration, two.acceleration),
            d: two.x - one.x,
            q: two.v - one.v,
            place,
        }
    }

    fn levers(&self) -> [f64; 2] {
        [-self.place, 1.0 - self.place]
    }
}

/// Returns the bodies with those of a contact moved back in time by `tau`.
fn moved_back(now: &Bodies, contact: &Contact, tau: f64, with_acceleration: bool) -> Bodies {
    let mut back = now.clone();
    let square = if with_acceleration { 0.5 * tau * tau } else { 0.0 };
    for (_, body) in bodies_of(contact) {
        match body {
            Body::Capsule(bar) => {
                let axle = Axle::of(now, bar);
                let centre = axle.centre - tau * axle.velocity + square * axle.acceleration;
                let (d, q) = turned(axle.d, axle.q, -tau);
                for (end, lever) in now.bars[bar].ends.into_iter().zip(axle.levers()) {
                    back.balls[end].x = centre + lever * d;
                    back.balls[end].v = axle.velocity - tau * axle.acceleration + lever * q;
                }
            }
            Body::Ball(ball) | Body::Network(ball) => {
                let Ball { x, v, acceleration, .. } = now.balls[ball];
                back.balls[ball].x = x - tau * v + square * acceleration;
                back.balls[ball].v = v - tau * acceleration;
            }
        }
    }
    back
}

/// Returns a contact at a time `tau` before the present: its touch, shares and approach velocity, and the bodies. Returns
/// `None` when it has no contact line or does not close.
fn closing(
    now: &Bodies,
    k: &Contact,
    tau: f64,
    with_acceleration: bool,
    findings: &mut Findings,
) -> Option<(Touch, Vec<Share>, f64, Bodies)> {
    let back = moved_back(now, k, tau, with_acceleration);
    findings.decide("over a face", k.a, face_slack(now, k.a, k.b));
    let touch = if is_on_face(&k.touch) {
        let moved = back.balls[k.a].x - now.balls[k.a].x;
        Touch { overlap: k.touch.overlap + moved.dot(k.touch.n), line: f64::INFINITY, sure: f64::INFINITY, ..k.touch }
    } else {
        signed(&back, k.a, k.b, &k.touch)
    };
    findings.decide("a contact line", k.a, touch.line);
    if touch.line < 0.0 {
        findings.count("without a contact line before".to_owned());
        return None;
    }
    findings.decide("the line before", k.a, touch.sure);
    let (shares, surface) = shares(&back, k.a, k.b, &touch);
    let u = approach(&back, &shares, surface);
    findings.decide("closing before", k.a, u);
    (u > 0.0).then_some((touch, shares, u, back))
}

/// Adds the changes by a lone collision (section 3.6).
pub(crate) fn hit(now: &Bodies, k: &Contact, changes: &mut BTreeMap<usize, Change>, findings: &mut Findings) {
    let mut tau: f64 = 0.0;
    for _ in 0..ITERATIONS {
        let Some((touch, _, u, _)) = closing(now, k, tau, true, findings) else { break };
        tau = (tau + touch.overlap / u).clamp(0.0, now.dt);
    }
    findings.count(if tau == now.dt { "longer than the step" } else { "at its time" }.to_owned());
    let (tau, shares, u, met) = match closing(now, k, tau, false, findings) {
        Some((_, shares, u, met)) => (tau, shares, u, met),
        None => (0.0, k.shares.clone(), k.u, now.clone()),
    };
    let loose = inverse_mass(&met, &shares);
    let yielding = (loose + tau * tau * curvature(now, &shares)).max(0.5 * loose);
    let j = (1.0 + now.restitution) * u / yielding;
    for share in &shares {
        let dv = j * now.balls[share.ball].w * share.g;
        let change = changes.entry(share.ball).or_default();
        change.v += dv;
        change.l += j * share.h;
        if !matches!(share.body, Body::Capsule(_)) {
            change.x += tau * dv;
        }
    }
    for (_, body) in bodies_of(k) {
        let Body::Capsule(bar) = body else { continue };
        findings.count("capsule hit".to_owned());
        let ends = now.bars[bar].ends;
        let (before, there) = (Axle::of(now, bar), Axle::of(&met, bar));
        let of = |ball: usize| -> (DVec3, DVec3) {
            let all = shares.iter().filter(|share| share.ball == ball);
            all.fold((DVec3::ZERO, DVec3::ZERO), |(g, h), share| (g + j * share.g, h + j * share.h))
        };
        let dv = (of(ends[0]).0 + of(ends[1]).0) / (1.0 / now.balls[ends[0]].w + 1.0 / now.balls[ends[1]].w);
        let spin = of(ends[0]).1 * now.balls[ends[0]].i;
        let (d, q) = turned(there.d, there.q + spin.cross(there.d), tau);
        for (end, lever) in ends.into_iter().zip(before.levers()) {
            let change = changes.entry(end).or_default();
            change.x = tau * dv + lever * (d - before.d);
            change.v = dv + lever * (q - before.q);
        }
    }
}

/// Returns the second derivative of the energy of springs and tethers along the displacements that a unit impulse causes in a
/// unit of time (section 3.6). The impulse accounts for the energy that the displacement stores in springs.
fn curvature(now: &Bodies, shares: &[Share]) -> f64 {
    let displacement = |ball: Option<usize>| -> DVec3 {
        let own = shares.iter().filter(|share| Some(share.ball) == ball);
        own.map(|share| now.balls[share.ball].w * share.g).sum()
    };
    let of = |(ends, d, stiffness, length): &([Option<usize>; 2], DVec3, f64, f64)| {
        let stretch = displacement(ends[1]) - displacement(ends[0]);
        let along = stretch.dot(d.normalize());
        let slack = length / d.length();
        stiffness * ((1.0 - slack) * stretch.length_squared() + slack * along * along)
    };
    now.springs.iter().map(of).sum()
}

/// Returns W P applied to impulses on the spheres of networks: the velocities that change the length of no rod (section 3.4).
fn project(bodies: &Bodies, impulses: &BTreeMap<usize, DVec3>) -> BTreeMap<usize, DVec3> {
    let is_network = |end: &usize| matches!(bodies.body_of[*end], Some(Body::Network(_)));
    let touched: Vec<Body> = impulses.keys().filter_map(|ball| bodies.body_of[*ball]).collect();
    let lines: Vec<([usize; 2], DVec3)> = bodies
        .bars
        .iter()
        .filter(|bar| bar.length > 0.0)
        .filter(|bar| {
            bar.ends.iter().any(|end| is_network(end) && bodies.body_of[*end].is_some_and(|body| touched.contains(&body)))
        })
        .map(|bar| (bar.ends, (bodies.balls[bar.ends[1]].x - bodies.balls[bar.ends[0]].x).normalize()))
        .collect();
    let parting = |momenta: &BTreeMap<usize, DVec3>| -> Vec<f64> {
        let v = |ball: usize| bodies.balls[ball].w * momenta.get(&ball).copied().unwrap_or_default();
        lines.iter().map(|([one, two], n)| n.dot(v(*two) - v(*one))).collect()
    };
    let pulls = |tensions: &[f64]| {
        let mut momenta = BTreeMap::new();
        for (([one, two], n), tension) in lines.iter().zip(tensions) {
            *momenta.entry(*one).or_insert(DVec3::ZERO) -= tension * *n;
            *momenta.entry(*two).or_insert(DVec3::ZERO) += tension * *n;
        }
        momenta
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut residual = parting(impulses);
    let (mut tensions, mut way) = (vec![0.0; residual.len()], residual.clone());
    let first = dot(&residual, &residual);
    let mut size = first;
    for _ in 0..10 * lines.len() {
        if size <= 1e-24 * first {
            break;
        }
        let image = parting(&pulls(&way));
        let along = size / dot(&way, &image);
        for k in 0..lines.len() {
            tensions[k] += along * way[k];
            residual[k] -= along * image[k];
        }
        let next = dot(&residual, &residual);
        for k in 0..lines.len() {
            way[k] = residual[k] + next / size * way[k];
        }
        size = next;
    }
    let pulls = pulls(&tensions);
    let balls = impulses.keys().chain(pulls.keys());
    let left = |ball: &usize| impulses.get(ball).copied().unwrap_or_default() - pulls.get(ball).copied().unwrap_or_default();
    balls.map(|ball| (*ball, bodies.balls[*ball].w * left(ball))).collect()
}

/// Returns the changes of spheres by the impulses of clusters.
fn changes_by(bodies: &Bodies, all: &[&Contact], impulses: &[f64]) -> BTreeMap<usize, Change> {
    let mut changes: BTreeMap<usize, Change> = BTreeMap::new();
    let mut on_networks = BTreeMap::new();
    for (share, j) in all.iter().zip(impulses).flat_map(|(k, j)| k.shares.iter().map(move |share| (share, j))) {
        if matches!(share.body, Body::Network(_)) {
            *on_networks.entry(share.ball).or_insert(DVec3::ZERO) += *j * share.g;
        } else {
            let change = changes.entry(share.ball).or_default();
            change.v += *j * bodies.balls[share.ball].w * share.g;
            change.l += *j * share.h;
        }
    }
    for (ball, v) in project(bodies, &on_networks) {
        changes.entry(ball).or_default().v = v;
    }
    changes
}

/// Adds the changes by all collisions that are not lone (section 3.7). `all` holds these, and `colliding` also the lone ones.
pub(crate) fn sweep(
    bodies: &Bodies,
    all: &[&Contact],
    colliding: &[&Contact],
    changes: &mut BTreeMap<usize, Change>,
    findings: &mut Findings,
) {
    let weights: Vec<f64> = all.iter().map(|k| weight(bodies, k, colliding, findings)).collect();
    let mut impulses = vec![0.0_f64; all.len()];
    let is_only: Vec<bool> = all.iter().map(|k| is_only(k, colliding)).collect();
    for size in SWEEP_SIZES {
        let so_far = changes_by(bodies, all, &impulses);
        let next = all.iter().zip(&weights).zip(&is_only).zip(&impulses).map(|(((k, weight), is_only), j)| {
            let of = |share: &Share| {
                let change = so_far.get(&share.ball).copied().unwrap_or_default();
                change.v.dot(share.g) + bodies.balls[share.ball].i * change.l.dot(share.h)
            };
            let now = k.u - k.shares.iter().map(of).sum::<f64>();
            let size = if *is_only { 1.0 } else { size };
            let wanted = j + size * (now + bodies.restitution * k.u) / weight;
            if wanted < 0.0 {
                findings.count("clamped at 0".to_owned());
            }
            wanted.max(0.0)
        });
        impulses = next.collect();
    }
    for members in couples(all, colliding) {
        findings.count("two collisions".to_owned());
        let couplings = couplings(bodies, all, members);
        let [[own, by], [back, their]] = couplings;
        let apart = 1.0 - by * back / (own * their);
        findings.decide("at one place", all[members[0]].a, apart - ONE_PLACE);
        if apart > ONE_PLACE {
            let wanted = members.map(|k| (1.0 + bodies.restitution) * all[k].u);
            let solved = couple_impulses(couplings, wanted);
            members.into_iter().zip(solved).for_each(|(k, j)| impulses[k] = j);
        }
    }
    for (ball, change) in changes_by(bodies, all, &impulses) {
        let sum = changes.entry(ball).or_default();
        sum.v += change.v;
        sum.l += change.l;
    }
}

/// Clusters of two collisions (section 3.7): no other collision touches a body of theirs, and none of these is a network.
fn couples(all: &[&Contact], colliding: &[&Contact]) -> Vec<[usize; 2]> {
    let meets = |k: &Contact, l: &Contact| {
        let pairs =
            bodies_of(k).into_iter().flat_map(|(_, body)| bodies_of(l).into_iter().map(move |(_, other)| body == other));
        pairs.filter(|is_same| *is_same).count()
    };
    let has_one_neighbour = |k: &Contact| {
        let others: usize = colliding.iter().filter(|l| !std::ptr::eq(**l, k)).map(|l| meets(k, l)).sum();
        others == 1 && !bodies_of(k).iter().any(|(_, body)| matches!(body, Body::Network(_)))
    };
    let mut found = Vec::new();
    for (one, k) in all.iter().enumerate().filter(|(_, k)| has_one_neighbour(k)) {
        let others = all.iter().enumerate().skip(one + 1).filter(|(_, l)| has_one_neighbour(l) && meets(k, l) == 1);
        found.extend(others.map(|(other, _)| [one, other]));
    }
    found
}

/// What unit impulses of two collisions take from the approach velocities of both: the row is the collision that is slowed.
fn couplings(bodies: &Bodies, all: &[&Contact], members: [usize; 2]) -> [[f64; 2]; 2] {
    let units = members.map(|k| {
        let mut impulses = vec![0.0; all.len()];
        impulses[k] = 1.0;
        changes_by(bodies, all, &impulses)
    });
    members.map(|k| {
        units.each_ref().map(|changes| {
            let of = |share: &Share| {
                let change = changes.get(&share.ball).copied().unwrap_or_default();
                change.v.dot(share.g) + bodies.balls[share.ball].i * change.l.dot(share.h)
            };
            all[k].shares.iter().map(of).sum()
        })
    })
}

/// The impulses that are not negative and leave no approach velocity above the wanted one, and exactly that where they are positive.
fn couple_impulses([[own, by], [back, their]]: [[f64; 2]; 2], [one, two]: [f64; 2]) -> [f64; 2] {
    let determinant = own * their - by * back;
    let both = [(their * one - by * two) / determinant, (own * two - back * one) / determinant];
    match both {
        [j, _] if j < 0.0 => [0.0, two / their],
        [_, j] if j < 0.0 => [one / own, 0.0],
        _ => both,
    }
}

/// Whether no other collision touches the bodies of this one, and it touches each of them with one side only.
fn is_only(k: &Contact, colliding: &[&Contact]) -> bool {
    let own = bodies_of(k);
    let touching = |body: &Body| colliding.iter().flat_map(|l| bodies_of(l)).filter(|(_, other)| other == body).count();
    own.iter().all(|(_, body)| touching(body) == 1)
}

/// Returns the scale G~ of a collision (section 3.7). It is infinite when rods keep the contact from moving.
fn weight(bodies: &Bodies, k: &Contact, all: &[&Contact], findings: &mut Findings) -> f64 {
    let (mut weight, mut projected) = (0.0, 0.0);
    for (side, body) in bodies_of(k) {
        let own: Vec<&Share> = k.shares.iter().filter(|share| (share.side, share.body) == (side, body)).collect();
        let on_body = |l: &Contact| bodies_of(l).iter().filter(|(_, other)| *other == body).count() as f64;
        let count: f64 = all.iter().map(|l| on_body(l)).sum();
        let loose: f64 = own
            .iter()
            .map(|s| bodies.balls[s.ball].w * s.g.length_squared() + bodies.balls[s.ball].i * s.h.length_squared())
            .sum();
        let (inverse_mass, sum) = match body {
            Body::Ball(_) => {
                let along = |l: &&Contact| on_body(l) * k.touch.n.dot(l.touch.n).abs();
                (loose, loose * all.iter().map(along).sum::<f64>())
            }
            Body::Capsule(_) => (loose, loose * count),
            Body::Network(_) => {
                findings.count("on a network".to_owned());
                let mut impulses = BTreeMap::new();
                own.iter().for_each(|share| *impulses.entry(share.ball).or_insert(DVec3::ZERO) += share.g);
                let moved = project(bodies, &impulses);
                let along = |l: &Contact, side: usize| -> f64 {
                    let own = l.shares.iter().filter(|share| (share.side, share.body) == (side, body));
                    own.map(|share| share.g.dot(moved.get(&share.ball).copied().unwrap_or_default())).sum()
                };
                let couplings = all.iter().flat_map(|l| [along(l, 0), along(l, 1)]);
                (along(k, side), couplings.map(f64::abs).sum())
            }
        };
        projected += inverse_mass;
        weight += sum;
    }
    let part = projected / k.w;
    if part < RIGID {
        findings.count("held by rods".to_owned());
    }
    // A part below 1e-9 is a rounded 0, which is not ambiguous.
    findings.decide("gives way", k.a, if part < 1e-9 { -1.0 } else { part - RIGID });
    if part < RIGID { f64::INFINITY } else { weight }
}

/// Whether a collision shares a body with another one by the rule of the GPU, where a collision on a network always does.
pub(crate) fn is_shared(k: &Contact, all: &[&Contact]) -> bool {
    let own = bodies_of(k);
    own.iter().any(|(_, body)| matches!(body, Body::Network(_)))
        || all
            .iter()
            .any(|l| !std::ptr::eq(*l, k) && bodies_of(l).iter().any(|(_, body)| own.iter().any(|(_, one)| one == body)))
}
