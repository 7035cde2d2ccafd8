//! Bodies that are held, dragged and thrown with a pointer: the part that the window and other front ends share.

use rockfall::glam::Vec3;
use rockfall::{Body, MaterialId, RayHit, Result, RodId, Scene, Simulation, Sphere, SphereId, Tether};

/// Angular frequency of the tether that holds a body, in rad/s.
const ANGULAR_FREQUENCY: f32 = 10.0;
/// Damping ratio of that tether.
const DAMPING_RATIO: f32 = 1.0;
/// Rate at which connected bodies lose velocity relative to the held one, in 1/s, so that they do not swing without end.
const SWING_RATE: f32 = 4.5;
/// Greatest acceleration of the held bodies together by the tether, divided by the gravity.
const GREATEST_GRAVITIES: f32 = 4.0;
/// Greatest length of the tether of a body alone, and of one that others are connected to, in radii; gravity makes it longer.
const GREATEST_RADII: [f32; 2] = [20.0, 1.0];
/// Number of connected bodies above which their velocities are not damped, because that takes too long.
const MOST_DAMPED: usize = 1000;
/// Greatest mass that the tether is designed for, divided by the mass of the held sphere. More would need a shorter time step.
const GREATEST_MASS_RATIO: f32 = 40.0;
/// Greatest number of connected bodies that are counted.
const MOST_CONNECTED: usize = 10_000;
/// Number of places along the way of a thrown sphere that are tried.
const MOST_PLACES: u16 = 12;
/// Distance of a thrown sphere from other bodies, divided by the sum of the radii.
const GAP: f32 = 1.05;
/// Number of walls that a line of sight goes through.
const MOST_WALLS: usize = 8;

/// Returns where a line of sight enters the first body that is visible. A wall in front of all spheres is drawn without its
/// faces, so the line goes through it if there is anything behind.
///
/// # Errors
/// Those of [`Simulation::cast_ray`].
pub fn first_visible(simulation: &mut Simulation, origin: Vec3, direction: Vec3) -> Result<Option<RayHit>> {
    let (Some(first), Some(direction)) = (simulation.cast_ray(origin, direction)?, direction.try_normalize()) else {
        return Ok(None);
    };
    let depth = |point: Vec3| (point - origin).dot(direction);
    let spheres = simulation.scene().spheres().iter();
    let nearest = spheres.map(|sphere| depth(sphere.position) - sphere.radius).fold(f32::INFINITY, f32::min);
    let mut hit = first;
    for _ in 0..MOST_WALLS {
        if !matches!(hit.body, Body::Box(_) | Body::Polygon(_)) || depth(hit.point) >= nearest {
            return Ok(Some(hit));
        }
        // From within a box the ray does not enter it again.
        let step = (1e-4 * depth(hit.point)).max(1e-6 * hit.point.length());
        let Some(next) = simulation.cast_ray(hit.point + step * direction, direction)? else {
            return Ok(Some(first));
        };
        hit = next;
    }
    Ok(Some(first))
}

/// Returns the end of a rod that is nearer to a point, or the other one if the nearer one is fixed: a fixed end cannot be dragged.
///
/// # Errors
/// [`rockfall::Error::StaleHandle`] when the rod is not in the scene.
pub fn nearer_end(scene: &Scene, rod: RodId, point: Vec3) -> Result<SphereId> {
    let rod = scene.rod(rod)?;
    let (one, two) = (scene.sphere(rod.end1)?, scene.sphere(rod.end2)?);
    let far = |end: &Sphere| end.position.distance_squared(point);
    let first = !one.fixed && (two.fixed || far(one) <= far(two));
    Ok(if first { rod.end1 } else { rod.end2 })
}

/// Returns the tether that holds a sphere where it is, for steps of `time_step` s.
pub fn holding_tether(scene: &Scene, id: SphereId, sphere: &Sphere, time_step: f32) -> Tether {
    let of = |id: SphereId| scene.sphere(id).map_or(0.0, |sphere| sphere.mass);
    let mass = connected(scene, id).into_iter().map(of).sum::<f32>().min(GREATEST_MASS_RATIO * sphere.mass);
    // Damping above sphere.mass / dt would be unstable.
    let damping = (2.0 * DAMPING_RATIO * ANGULAR_FREQUENCY * mass).min(sphere.mass / time_step);
    Tether::new(id, sphere.position, mass * ANGULAR_FREQUENCY * ANGULAR_FREQUENCY).damping(damping)
}

/// Returns the greatest distance of the point of the tether from the held sphere. It limits the force, so that a pull beyond what
/// rods and springs allow does not overload them. `connected`: number of bodies that are held together.
pub fn reach(scene: &Scene, sphere: &Sphere, connected: usize) -> f32 {
    let gravity = GREATEST_GRAVITIES * scene.settings.gravity.abs() / (ANGULAR_FREQUENCY * ANGULAR_FREQUENCY);
    gravity + GREATEST_RADII[usize::from(connected > 1)] * sphere.radius
}

/// Returns the point of the tether for a held sphere that is dragged towards `goal`.
pub fn anchor(sphere: &Sphere, goal: Vec3, reach: f32) -> Vec3 {
    sphere.position + (goal - sphere.position).clamp_length_max(reach)
}

/// Returns the first place along the way of a sphere where it touches no sphere and no rod.
pub fn free_place(scene: &Scene, sphere: &Sphere) -> Option<Vec3> {
    let way = sphere.velocity.normalize_or_zero() * (2.0 * sphere.radius * GAP);
    let touches = |place: Vec3| {
        let near = |other: Vec3, radius: f32| other.distance(place) < GAP * (radius + sphere.radius);
        scene.spheres().iter().any(|other| near(other.position, other.radius))
            || scene.rods().iter().any(|rod| {
                let ends = [rod.end1, rod.end2].map(|end| scene.sphere(end).map(|sphere| sphere.position));
                let [Ok(one), Ok(two)] = ends else { return false };
                let along = (place - one).dot(two - one) / one.distance_squared(two).max(f32::MIN_POSITIVE);
                near(one.lerp(two, along.clamp(0.0, 1.0)), rod.radius)
            })
    };
    (0..MOST_PLACES).map(|number| sphere.position + number as f32 * way).find(|place| !touches(*place))
}

/// Damps a held body, and the bodies connected to it, for the last `seconds`. A tether damps only along itself, so a body would
/// circle around the anchor without end, and a capsule would swing below it.
///
/// # Errors
/// Those of [`Simulation::sync`] and [`Simulation::set_velocity`].
pub fn settle(simulation: &mut Simulation, connected: &[SphereId], anchor: Vec3, seconds: f32) -> Result<()> {
    if connected.len() > MOST_DAMPED {
        return Ok(());
    }
    let lost = |rate: f32| 1.0 - (-rate * seconds).exp();
    let (critical, swing) = (lost(2.0 * DAMPING_RATIO * ANGULAR_FREQUENCY), lost(SWING_RATE));
    let scene = simulation.sync()?;
    let Some(held) = connected.first().and_then(|id| scene.sphere(*id).ok()) else { return Ok(()) };
    // The damping of the tether is enough along it for a body alone.
    let way = if connected.len() == 1 { (anchor - held.position).normalize_or_zero() } else { Vec3::ZERO };
    let across = held.velocity - held.velocity.dot(way) * way;
    let velocity = held.velocity;
    let spheres = connected.iter().filter_map(|id| scene.sphere(*id).ok().map(|sphere| (*id, sphere)));
    let damped = spheres.map(|(id, sphere)| {
        // A translation and a shrinking of the velocities relative to each other: no rod is stretched.
        (id, sphere.velocity - critical * across - swing * (sphere.velocity - velocity))
    });
    let damped: Vec<(SphereId, Vec3)> = damped.collect();
    damped.into_iter().try_for_each(|(id, velocity)| simulation.set_velocity(id, velocity))
}

/// Returns all moving spheres that rods and springs connect to a sphere, with itself as the first.
pub fn connected(scene: &Scene, start: SphereId) -> Vec<SphereId> {
    let rods = scene.rods().iter().map(|rod| (rod.end1, rod.end2));
    let springs = scene.springs().iter().map(|spring| (spring.a, spring.b));
    let mut next = std::collections::HashMap::<SphereId, Vec<SphereId>>::new();
    for (a, b) in rods.chain(springs) {
        next.entry(a).or_default().push(b);
        next.entry(b).or_default().push(a);
    }
    let (mut seen, mut left) = (std::collections::HashSet::from([start]), vec![start]);
    let mut moving = Vec::new();
    while let Some(id) = left.pop() {
        if scene.sphere(id).is_ok_and(|sphere| sphere.fixed) {
            continue;
        }
        moving.push(id);
        let new = next.get(&id).into_iter().flatten().filter(|id| seen.len() < MOST_CONNECTED && seen.insert(**id));
        left.extend(new.copied().collect::<Vec<_>>());
    }
    moving
}

/// The material of a body that is added: that of the first moving sphere with one, or else of the first other object.
fn material(scene: &Scene) -> Option<MaterialId> {
    let spheres =
        |fixed: bool| scene.spheres().iter().filter(move |sphere| sphere.fixed == fixed).map(|sphere| sphere.material);
    let others = scene.rods().iter().map(|rod| rod.material).chain(scene.boxes().iter().map(|cuboid| cuboid.material));
    let mut all = spheres(false).chain(spheres(true)).chain(others).chain(scene.polygons().iter().map(|face| face.material));
    all.find_map(|material| material)
}

/// Returns a sphere with the mean radius and density of the moving spheres, and a material of the scene if it has any.
pub fn thrown(scene: &Scene, origin: Vec3, velocity: Vec3) -> Sphere {
    let moving = || scene.spheres().iter().filter(|sphere| !sphere.fixed);
    let count = moving().count();
    let sum = |value: fn(&Sphere) -> f32| moving().map(|sphere| f64::from(value(sphere))).sum::<f64>();
    let cubes = sum(|sphere| sphere.radius.powi(3));
    let (radius, mass) = if count > 0 {
        let radius = sum(|sphere| sphere.radius) / count as f64;
        (radius, sum(|sphere| sphere.mass) / cubes * radius.powi(3))
    } else {
        (0.5, 1.0)
    };
    let mut sphere = Sphere::new(origin, radius as f32).mass(mass as f32).velocity(velocity);
    sphere.material = material(scene);
    sphere
}
