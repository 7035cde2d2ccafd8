//! Bodies that are dropped come to rest, for all sizes, gravities and time steps for which theory allows it.

use std::fmt::Write as _;

use rockfall::glam::Vec3;
use rockfall::{Capsule, Cuboid, Integrator, Polygon, Rod, Scene, Sphere, SphereState};

use crate::measure::{on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// Adds bodies of radius `r` at a gap above their support. The arguments are the scene, `r` and the gap.
type Build = fn(&mut Scene, f32, f32) -> Result<()>;

/// A kind of body on a kind of support.
struct Kind {
    name: &'static str,
    build: Build,
    /// Load on the most loaded contact, in units of the weight for which its overlap is G / Cc.
    load: f64,
    /// mu_c of Coulomb's friction, for bodies that would slide without it.
    coulomb: f32,
}

const KINDS: &[Kind] = &[
    Kind { name: "sphere on a box", build: sphere_on_box, load: 1.0, coulomb: 0.0 },
    Kind { name: "sphere on a polygon", build: sphere_on_polygon, load: 1.0, coulomb: 0.0 },
    Kind { name: "sphere in the pocket of three fixed spheres", build: sphere_in_pocket, load: 1.0, coulomb: 0.0 },
    Kind { name: "sphere on a sphere on a box", build: sphere_on_sphere, load: 2.0, coulomb: 0.0 },
    Kind { name: "sphere in a groove of two boxes, 45 degrees", build: sphere_in_groove, load: 1.0, coulomb: 0.0 },
    Kind {
        name: "sphere in a groove of two polygons, 30 degrees",
        build: sphere_in_valley,
        load: 1.0,
        coulomb: 0.0,
    },
    Kind {
        name: "three spheres in a groove of two boxes, touching",
        build: spheres_in_groove,
        load: 1.0,
        coulomb: 0.0,
    },
    Kind { name: "capsule on a box, one end first", build: capsule_on_box, load: 1.0, coulomb: 0.0 },
    Kind { name: "capsule on a polygon, one end first", build: capsule_on_polygon, load: 1.0, coulomb: 0.0 },
    Kind { name: "capsule in a groove of two boxes", build: capsule_in_groove, load: 1.0, coulomb: 0.0 },
    Kind { name: "capsule across two fixed rods, mu_c = 0.5", build: capsule_on_rods, load: 1.0, coulomb: 0.5 },
    Kind {
        name: "two capsules across two capsules on a box, mu_c = 0.5",
        build: capsules_crosswise,
        load: 2.0,
        coulomb: 0.5,
    },
    Kind {
        name: "capsule along a slope of 10 degrees, mu_c = 0.5",
        build: capsule_on_slope,
        load: 1.0,
        coulomb: 0.5,
    },
    Kind { name: "rod across a narrow box, mu_c = 0.5", build: rod_on_box, load: 1.0, coulomb: 0.5 },
    Kind {
        name: "tetrahedron of rods on a box, one vertex first, mu_c = 0.5",
        build: tetrahedron_on_box,
        load: 1.5,
        coulomb: 0.5,
    },
    Kind {
        name: "tetrahedron of rods on a polygon, mu_c = 0.5",
        build: tetrahedron_on_polygon,
        load: 1.5,
        coulomb: 0.5,
    },
    Kind { name: "pyramid of rods over a narrow box, mu_c = 0.5", build: pyramid_on_box, load: 1.0, coulomb: 0.5 },
];

fn floor(scene: &mut Scene, r: f32) -> Result<()> {
    scene.add_box(Cuboid::between([-40.0 * r, -10.0 * r, -40.0 * r], [40.0 * r, 0.0, 40.0 * r]))?;
    Ok(())
}

fn face(scene: &mut Scene, r: f32) -> Result<()> {
    scene.add_polygon(Polygon::new([-40.0 * r, 0.0, -40.0 * r], [0.0, 0.0, 80.0 * r], [80.0 * r, 0.0, 0.0]))?;
    Ok(())
}

/// Two boxes that form a groove along z with its bottom at the origin. Each face has a slope of `degrees`.
fn groove(scene: &mut Scene, r: f32, degrees: f32) -> Result<()> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    for side in [-1.0, 1.0] {
        let up = Vec3::new(side * cos, sin, 0.0) * 10.0 * r;
        let into = Vec3::new(side * sin, -cos, 0.0) * 10.0 * r;
        scene.add_box(Cuboid::new([0.0, 0.0, -10.0 * r], up, into, [0.0, 0.0, 20.0 * r]))?;
    }
    Ok(())
}

fn sphere_on_box(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    floor(scene, r)?;
    scene.add_sphere(Sphere::new([0.3 * r, r + gap, 0.2 * r], r))?;
    Ok(())
}

fn sphere_on_polygon(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    face(scene, r)?;
    scene.add_sphere(Sphere::new([0.3 * r, r + gap, 0.2 * r], r))?;
    Ok(())
}

fn sphere_in_pocket(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    // Three fixed spheres touch each other. The fourth forms a tetrahedron with them.
    let out = 2.0 / 3.0_f32.sqrt();
    for turn in [0.0_f32, 120.0, 240.0] {
        let (sin, cos) = turn.to_radians().sin_cos();
        scene.add_sphere(Sphere::new([out * cos * r, 0.0, out * sin * r], r).fixed())?;
    }
    let height = (4.0 - out * out).sqrt();
    scene.add_sphere(Sphere::new([0.0, height * r + gap, 0.0], r))?;
    Ok(())
}

fn sphere_on_sphere(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    floor(scene, r)?;
    scene.add_sphere(Sphere::new([0.0, r + gap, 0.0], r))?;
    scene.add_sphere(Sphere::new([0.0, 3.0 * r + 2.0 * gap, 0.0], r))?;
    Ok(())
}

fn sphere_in_groove(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    groove(scene, r, 45.0)?;
    scene.add_sphere(Sphere::new([0.2 * gap, 2.0_f32.sqrt() * r + gap, 0.0], r))?;
    Ok(())
}

fn sphere_in_valley(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    let (sin, cos) = 30_f32.to_radians().sin_cos();
    let reach = 10.0 * r;
    scene.add_polygon(Polygon::new([0.0, 0.0, -reach], [0.0, 0.0, 2.0 * reach], [reach * cos, reach * sin, 0.0]))?;
    scene.add_polygon(Polygon::new([0.0, 0.0, reach], [0.0, 0.0, -2.0 * reach], [-reach * cos, reach * sin, 0.0]))?;
    scene.add_sphere(Sphere::new([0.2 * gap, r / cos + gap, 0.0], r))?;
    Ok(())
}

fn spheres_in_groove(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    groove(scene, r, 45.0)?;
    for place in [-2.0, 0.0, 2.0] {
        scene.add_sphere(Sphere::new([0.0, 2.0_f32.sqrt() * r + gap, place * r], r))?;
    }
    Ok(())
}

/// A capsule with one end higher than the other by the gap.
fn tilted_capsule(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    scene.add_capsule(Capsule::new([-1.5 * r, r + gap, 0.1 * r], [1.5 * r, r + 2.0 * gap, 0.3 * r], r))?;
    Ok(())
}

fn capsule_on_box(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    floor(scene, r)?;
    tilted_capsule(scene, r, gap)
}

fn capsule_on_polygon(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    face(scene, r)?;
    tilted_capsule(scene, r, gap)
}

fn capsule_in_groove(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    groove(scene, r, 45.0)?;
    let height = 2.0_f32.sqrt() * r + gap;
    scene.add_capsule(Capsule::new([0.0, height, -1.5 * r], [0.0, height + gap, 1.5 * r], r))?;
    Ok(())
}

fn capsule_on_rods(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    for x in [-1.5, 1.5] {
        let ends = [-3.0, 3.0].map(|z| Sphere::new([x * r, 0.0, z * r], r).fixed());
        let [one, two] = [scene.add_sphere(ends[0])?, scene.add_sphere(ends[1])?];
        scene.add_rod(Rod::new(one, two, r))?;
    }
    scene.add_capsule(Capsule::new([-3.0 * r, 2.0 * r + gap, 0.0], [3.0 * r, 2.0 * r + 1.5 * gap, 0.0], r))?;
    Ok(())
}

fn capsules_crosswise(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    floor(scene, r)?;
    for x in [-2.0, 2.0] {
        scene.add_capsule(Capsule::new([x * r, r + gap, -3.0 * r], [x * r, r + gap, 3.0 * r], r))?;
    }
    for z in [-2.0, 2.0] {
        let height = 3.0 * r + 2.0 * gap;
        scene.add_capsule(Capsule::new([-3.0 * r, height, z * r], [3.0 * r, height, z * r], r))?;
    }
    Ok(())
}

/// A box whose upper face contains the origin and slopes down by 10 degrees towards +x. Returns the directions down the slope
/// and normal to it.
fn slope(scene: &mut Scene, r: f32) -> Result<[Vec3; 2]> {
    let (sin, cos) = 10_f32.to_radians().sin_cos();
    let [down, off] = [Vec3::new(cos, -sin, 0.0), Vec3::new(sin, cos, 0.0)];
    let corner = -40.0 * r * down - 10.0 * r * off - Vec3::Z * 40.0 * r;
    scene.add_box(Cuboid::new(corner, 80.0 * r * down, 10.0 * r * off, [0.0, 0.0, 80.0 * r]))?;
    Ok([down, off])
}

fn capsule_on_slope(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    let [down, off] = slope(scene, r)?;
    let ends = [-1.5 * r, 1.5 * r].map(|along| along * down + (r + gap) * off);
    scene.add_capsule(Capsule::new(ends[0], ends[1], r))?;
    Ok(())
}

fn rod_on_box(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    scene.add_box(Cuboid::between([-2.0 * r, -10.0 * r, -10.0 * r], [2.0 * r, 0.0, 10.0 * r]))?;
    // The ends are beyond the box, so that its edges touch only the rod.
    let ends = [-5.0, 5.0].map(|x| Sphere::new([x * r, r + gap, 0.0], r));
    let [one, two] = [scene.add_sphere(ends[0])?, scene.add_sphere(ends[1])?];
    scene.add_rod(Rod::new(one, two, r).length(10.0 * r))?;
    Ok(())
}

/// A frame of spheres of radius r, with rods of fixed length between all pairs but one.
fn frame(scene: &mut Scene, r: f32, places: &[Vec3], without: Option<[usize; 2]>) -> Result<()> {
    let mut ids = Vec::new();
    for place in places {
        ids.push(scene.add_sphere(Sphere::new(*place, r))?);
    }
    for two in 1..places.len() {
        for one in (0..two).filter(|one| without != Some([*one, two])) {
            let length = places[one].distance(places[two]);
            scene.add_rod(Rod::new(ids[one], ids[two], 0.5 * r).length(length))?;
        }
    }
    Ok(())
}

fn tetrahedron(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    let base = r + gap;
    let places = [
        Vec3::new(3.0 * r, base, 0.0),
        Vec3::new(-1.5 * r, base + gap, 2.6 * r),
        Vec3::new(-1.5 * r, base + 0.5 * gap, -2.6 * r),
        Vec3::new(0.0, base + 4.2 * r, 0.0),
    ];
    frame(scene, r, &places, None)
}

fn tetrahedron_on_box(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    floor(scene, r)?;
    tetrahedron(scene, r, gap)
}

fn tetrahedron_on_polygon(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    face(scene, r)?;
    tetrahedron(scene, r, gap)
}

/// Positions of the spheres of a pyramid, in radii. Without its top the frame would be flat and not rigid: its corners could
/// leave the plane without a change of any length to first order.
const PYRAMID: [[f32; 3]; 5] = [[-3.0, 0.0, -3.0], [3.0, 0.0, -3.0], [3.0, 0.0, 3.0], [-3.0, 0.0, 3.0], [0.0, 4.0, 0.0]];

fn pyramid_on_box(scene: &mut Scene, r: f32, gap: f32) -> Result<()> {
    scene.add_box(Cuboid::between([-1.5 * r, -10.0 * r, -10.0 * r], [1.5 * r, 0.0, 10.0 * r]))?;
    let places = PYRAMID.map(|[x, y, z]| Vec3::new(x * r, (0.5 + y) * r + gap, z * r));
    // Rods along both diagonals of the base would pass through each other, and their contact would push them apart for ever.
    frame(scene, r, &places, Some([0, 2]))
}

/// Conditions of one run.
#[derive(Clone, Copy, Debug)]
struct Case {
    radius: f64,
    gravity: f64,
    dt: f64,
    integrator: Integrator,
}

/// Contact force and damping of a case; `None` if theory allows no rest.
fn contact_law(case: Case, load: f64) -> Option<[f64; 2]> {
    let weight = load * case.gravity / case.radius;
    // The overlap is at most 5 % of the radius. With a short step, the contact is stiffer, so that bodies come to rest in few
    // steps, but not so stiff that the overlap is lost in the rounding of f32.
    let stiffness = (20.0 * weight).max((3000.0 * weight).min(0.02 / case.dt.powi(2)));
    // The damping ratio of the default constants is 0.2.
    let ratio = if case.dt * stiffness.sqrt() < 0.1 { 1.0 } else { 0.2 };
    let damping = 2.0 * ratio * stiffness.sqrt();
    let is_stable = match case.integrator {
        Integrator::Rk4 => case.dt.powi(2) * stiffness <= 0.5 && 4.0 * case.dt * damping <= 2.78,
        _ => case.dt.powi(2) * stiffness + 2.0 * case.dt * damping <= 1.0,
    };
    is_stable.then_some([stiffness, damping])
}

/// Limit of the root mean square velocity below which a body counts as being at rest.
fn rest_speed(kind: &Kind, case: Case) -> f64 {
    // A thousandth of the speed of a fall through the radius.
    let slow = 1e-3 * (2.0 * case.gravity * case.radius).sqrt();
    // The velocity that moves a coordinate of twice the radius by its rounding error in a step.
    let rounding = 2.0 * case.radius * f64::from(f32::EPSILON) / case.dt;
    // Friction impulses act once per step, while gravity acts during the step.
    let creep = if kind.coulomb > 0.0 { 1.5 * case.gravity * case.dt * 10_f64.to_radians().sin() } else { 0.0 };
    slow.max(rounding).max(creep)
}

/// Final state of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fate {
    Rests,
    /// Speed over the limit for rest.
    Moves(f64),
    /// Number of collisions in the last second.
    Collides(u64),
    Lost,
    NotPossible,
}

/// Largest number of steps in the observed last second.
const LAST_STEPS: f64 = 1000.0;

fn fate(kind: &Kind, case: Case) -> Result<Fate> {
    let Some([stiffness, damping]) = contact_law(case, kind.load) else { return Ok(Fate::NotPossible) };
    let mut scene = with(|settings| {
        settings.gravity = case.gravity as f32;
        settings.contact_force = stiffness as f32;
        settings.contact_damping = damping as f32;
        settings.coulomb_friction = kind.coulomb;
    });
    // The gap is the fall of 50 steps, at most a quarter of the radius.
    let gap = (0.25 * case.radius).min(0.5 * case.gravity * (50.0 * case.dt).powi(2));
    (kind.build)(&mut scene, case.radius as f32, gap as f32)?;
    let mut simulation = on_cpu(scene, case.integrator)?;
    let before = simulation.spheres()?;
    // Time for the bounces and then for the damped oscillation of the contacts.
    let fall = (2.0 * gap / case.gravity).sqrt();
    let settling = 25.0 * fall + 30.0 / damping + 50.0 * case.dt;
    simulation.run((settling / case.dt) as u64, case.dt as f32)?;
    let collided = simulation.report().total_collisions;
    simulation.run((1.0 / case.dt).min(LAST_STEPS) as u64, case.dt as f32)?;
    let late = simulation.report().total_collisions - collided;
    let after = simulation.spheres()?;
    let far = before.iter().zip(&after).any(|(old, new)| {
        let moved = new.position - old.position;
        !new.position.is_finite() || f64::from(moved.length()) > 20.0 * case.radius
    });
    if far || simulation.report().non_finite > 0 {
        return Ok(Fate::Lost);
    }
    if late > 0 {
        return Ok(Fate::Collides(late));
    }
    // Of the velocities themselves: with symplectic Euler the reported energy is that of half a step later, without the contacts.
    let movers = || after.iter().filter(|sphere| !sphere.fixed);
    let kinetic = |sphere: &SphereState| {
        let [mass, radius] = [sphere.mass, sphere.radius].map(f64::from);
        let spin = sphere.angular_momentum.as_dvec3() / (0.4 * mass * radius * radius);
        0.5 * mass * (sphere.velocity.as_dvec3().length_squared() + 0.4 * (radius * spin).length_squared())
    };
    let [mass, kinetic] = [movers().map(|sphere| f64::from(sphere.mass)).sum::<f64>(), movers().map(kinetic).sum()];
    let left = (2.0 * kinetic / mass).sqrt() / rest_speed(kind, case);
    Ok(if left < 1.0 { Fate::Rests } else { Fate::Moves(left) })
}

fn cases(effort: Effort) -> Vec<Case> {
    let radii = [0.001, 0.1, 10.0];
    let gravities = effort.pick(&[0.1, 10.0][..], &[0.1, 10.0, 100.0]);
    let steps = effort.pick(&[0.001, 0.02][..], &[0.0001, 0.001, 0.005, 0.02]);
    let mut all = Vec::new();
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        for radius in radii {
            for gravity in gravities {
                all.extend(steps.iter().map(|dt| Case { radius, gravity: *gravity, dt: *dt, integrator }));
            }
        }
    }
    all
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(move || {
        let mut outcome = Outcome::default();
        let mut table = "| body | at rest | not at rest | not possible |\n|---|---|---|---|\n".to_owned();
        let mut sums = [0_u32; 5];
        for kind in KINDS {
            let mut counts = [0_u32; 5];
            for case in cases(effort) {
                let fate = fate(kind, case)?;
                let place = match fate {
                    Fate::Rests => 0,
                    Fate::Moves(_) => 1,
                    Fate::Collides(_) => 2,
                    Fate::Lost => 3,
                    Fate::NotPossible => 4,
                };
                counts[place] += 1;
                if (1..=3).contains(&place) {
                    let Case { radius, gravity, dt, integrator } = case;
                    eprintln!("{}, r = {radius}, G = {gravity}, h = {dt}, {integrator}: {fate:?}", kind.name);
                }
            }
            let [rests, moves, collides, lost, impossible] = counts;
            let _ = writeln!(table, "| {} | {rests} | {} | {impossible} |", kind.name, moves + collides + lost);
            for (sum, count) in sums.iter_mut().zip(counts) {
                *sum += count;
            }
        }
        outcome.facts.push(("table", table.trim_end().to_owned()));
        outcome.check(
            "fraction of the possible cases at rest",
            1.0,
            f64::from(sums[0]) / f64::from(sums[..4].iter().sum::<u32>()),
            0.0,
        );
        outcome.check("cases still colliding", 0.0, f64::from(sums[2]), 0.0);
        outcome.check("cases lost", 0.0, f64::from(sums[3]), 0.0);
        Ok(outcome)
    })
}
