//! The target `motion`: random scenes that run for some steps and change in between.

use rockfall::glam::{Quat, Vec3};
use rockfall::step::schedule::Phase;
use rockfall::{
    Capsule, Cuboid, MaterialId, Muscle, Options, Polygon, Rod, Scene, Settings, Simulation, Sphere, SphereId, Spring, Tether,
};

use super::case::{Action, Add, Ball, Case, Change, Kind, Later};
use super::hard::{self, HardAction};
use super::laws;
use super::number::{Size, vector};
use super::twins::Twins;

/// Number of objects above which no more are added, so that a case stays short.
pub(crate) const OBJECTS: usize = 48;
/// Maximum number of steps in a case.
const STEPS: u64 = 96;

/// Runs a scene that the bytes describe in two simulations, with brute force on one thread and with the grid on three. Their
/// answers must be bitwise identical, states must stay finite, every step must end, and memory must stay small.
///
/// # Panics
/// When a simulation breaks one of these promises.
pub fn motion(bytes: &[u8]) {
    let Ok(case) = Case::decode(bytes) else { return };
    let mut options = Options::new().keep_going(case.keep_going).integrator(case.integrator);
    if let Some(slices) = case.capacity {
        options = options.pair_capacity(32 * u32::from(slices));
    }
    let prepared = match &case.laws {
        Some(laws) => laws::prepare(laws, options, case.hard.as_ref()),
        None => Ok((Scene::new(), options, Vec::new())),
    };
    let Ok((scene, options, materials)) = prepared else { return };
    let Ok(mut twins) = Twins::new(&scene, &options) else { return };
    let (mut left, mut used) = (STEPS, materials.first().copied());
    for action in &case.actions {
        match action {
            HardAction::Later(Later::First(action)) => act(&mut twins, action, used, &mut left),
            HardAction::Later(Later::Use(which)) => used = materials.get(usize::from(*which) % (materials.len() + 1)).copied(),
            HardAction::Later(later) => act_on_laws(&mut twins, later, &materials, &mut left),
            action => hard::act(&mut twins, action, used, &mut left),
        }
    }
    if case.hard.is_some() {
        twins.advance(8, |simulation| simulation.run(8, 1.0 / 60.0).map(drop));
    }
    twins.compare();
}

/// An action on materials, laws and checkpoints.
fn act_on_laws(twins: &mut Twins, action: &Later, materials: &[MaterialId], left: &mut u64) {
    let material = |which: u8| materials[usize::from(which) % materials.len()];
    match *action {
        Later::First(_) | Later::Use(_) => {}
        Later::Material(which, ref solid) => {
            twins.both(|simulation| simulation.update_material(material(which), |material| laws::put_solid(material, solid)));
        }
        Later::Pair([one, other], ref properties) => {
            twins.both(|simulation| simulation.set_pair(material(one), material(other), laws::pair(properties)));
        }
        Later::Force(which) => {
            twins.both(|simulation| match laws::force(which) {
                Some(law) => simulation.add_force_law(law),
                None => simulation.remove_force_law("pull"),
            });
        }
        Later::Parameter(number) => {
            twins.both(|simulation| simulation.set_force_law_parameter("pull", "k", number.0));
            twins.both(|simulation| simulation.set_contact_law_parameter("k", number.0));
        }
        Later::Resume { steps, dt } => {
            let steps = u64::from(steps % 8).min(*left);
            *left -= steps;
            twins.resume(steps, dt.0);
        }
        Later::Save => twins.save(),
        Later::Restore => twins.restore(),
    }
}

fn act(twins: &mut Twins, action: &Action, used: Option<MaterialId>, left: &mut u64) {
    match *action {
        Action::Add(ref what) => add(twins, what, used),
        Action::Remove(kind, which) => remove(twins, kind, which),
        Action::Change(which, ref how) => change(twins, which, how),
        Action::Attachment(kind, which, numbers) => attachment(twins, kind, which, numbers),
        Action::Setting(which, number) => {
            let name = Settings::NAMES[usize::from(which) % Settings::NAMES.len()];
            let value = if name == "gravity_direction" { format!("{0},{which},1", number.0) } else { number.0.to_string() };
            twins.both(|simulation| {
                let mut settings = *simulation.settings();
                settings.set(name, &value)?;
                simulation.set_settings(settings)
            });
        }
        Action::Run { steps, dt } => {
            let steps = u64::from(steps % 40).min(*left);
            *left -= steps;
            twins.advance(steps, |simulation| simulation.run(steps, dt.0).map(drop));
        }
        Action::Phase(which) => phase(twins, which, left),
        Action::TimeStep(dt) => drop(twins.both(|simulation| simulation.set_time_step(dt.0))),
        Action::Observe => twins.observe(),
    }
}

fn phase(twins: &mut Twins, which: u8, left: &mut u64) {
    let phase = Phase::STEP[usize::from(which) % Phase::STEP.len()];
    if *left == 0 {
        return;
    }
    *left -= 1;
    twins.advance(1, |simulation| match phase {
        Phase::UpdateAabbs => simulation.update_aabbs(),
        Phase::BroadPhase => simulation.broad_phase(),
        Phase::HandleCollisions => simulation.handle_collisions(),
        Phase::UpdatePositions => simulation.update_positions(simulation.time_step()),
    });
}

/// Returns one of the objects of a kind, or `None` if there are none.
macro_rules! pick {
    ($twins:expr, $ids:ident, $which:expr) => {{
        let ids: Vec<_> = $twins.scene().$ids().collect();
        (!ids.is_empty()).then(|| ids[usize::from($which) % ids.len()])
    }};
}

fn ball(of: &Ball, used: Option<MaterialId>) -> Sphere {
    let mut sphere = Sphere::new(vector(of.position), of.radius.0).velocity(vector(of.velocity)).group(of.group.into());
    (sphere.fixed, sphere.material) = (of.fixed.is_set(), used);
    match of.more {
        Some((mass, spin, force)) => sphere.mass(mass.0).angular_momentum(vector(spin)).force(vector(force)),
        None => sphere,
    }
}

/// Returns the spheres of a block of 4 x 4 columns.
fn block(of: &Ball, used: Option<MaterialId>, count: u8, apart: Size) -> impl Iterator<Item = Sphere> {
    let first = ball(of, used);
    (0..u16::from(count % 32)).map(move |k| {
        let place = Vec3::new(f32::from(k % 4), f32::from(k / 16), f32::from(k / 4 % 4));
        let mut next = first;
        next.position += apart.0 * place;
        next
    })
}

fn ends(twins: &Twins, ends: [u8; 2]) -> Option<[SphereId; 2]> {
    let [one, two] = ends.map(|which| pick!(twins, sphere_ids, which));
    Some([one?, two?])
}

pub(crate) fn add(twins: &mut Twins, what: &Add, used: Option<MaterialId>) {
    let counts = twins.scene().counts();
    if counts.spheres + counts.rods + counts.boxes + counts.polygons + counts.springs + counts.tethers > OBJECTS {
        return;
    }
    match *what {
        Add::Sphere(ref of) => drop(twins.both(|simulation| simulation.add_sphere(ball(of, used)))),
        Add::Block(ref of, count, apart) => {
            for sphere in block(of, used, count, apart) {
                twins.both(|simulation| simulation.add_sphere(sphere));
            }
        }
        Add::Capsule { ends: [one, two], velocity, mass, radius, group } => {
            let mut capsule = Capsule::new(vector(one), vector(two), radius.0).mass(mass.0).velocity(vector(velocity));
            capsule.material = used;
            twins.both(|simulation| simulation.add_capsule(capsule.group(group.into())));
        }
        Add::Box { corners: [one, two], group } => {
            let mut cuboid = Cuboid::between(vector(one), vector(two)).group(group.into());
            cuboid.material = used;
            twins.both(|simulation| simulation.add_box(cuboid));
        }
        Add::Cuboid { corner, edges: [i, j, k], group } => {
            let mut cuboid = Cuboid::new(vector(corner), vector(i), vector(j), vector(k)).group(group.into());
            cuboid.material = used;
            twins.both(|simulation| simulation.add_box(cuboid));
        }
        Add::Polygon { corner, edges: [left, right], group } => {
            let mut polygon = Polygon::new(vector(corner), vector(left), vector(right)).group(group.into());
            polygon.material = used;
            twins.both(|simulation| simulation.add_polygon(polygon));
        }
        Add::Rod { .. } | Add::Spring { .. } | Add::Tether { .. } => attach(twins, what, used),
    }
}

/// Adds a rod, a spring or a tether to spheres that exist.
fn attach(twins: &mut Twins, what: &Add, used: Option<MaterialId>) {
    match *what {
        Add::Rod { ends: which, radius, length, group } => {
            let Some([one, two]) = ends(twins, which) else { return };
            let mut rod = Rod::new(one, two, radius.0).group(group.into());
            (rod.length, rod.material) = (length.map(|length| length.0), used);
            twins.both(|simulation| simulation.add_rod(rod));
        }
        Add::Spring { ends: which, numbers: [stiffness, length, damping] } => {
            let Some([one, two]) = ends(twins, which) else { return };
            let mut spring = Spring::new(one, two, stiffness.0, length.0).damping(damping.0);
            // A quarter of the springs are muscles. Some of them are out of range.
            spring.muscle = (which[0] >= 192).then(|| Muscle::new(stiffness.0 * 0.01, damping.0, length.0));
            twins.both(|simulation| simulation.add_spring(spring));
        }
        Add::Tether { sphere, point, numbers: [stiffness, length, damping] } => {
            let Some(sphere) = pick!(twins, sphere_ids, sphere) else { return };
            let tether = Tether::new(sphere, vector(point), stiffness.0).length(length.0).damping(damping.0);
            twins.both(|simulation| simulation.add_tether(tether));
        }
        _ => {}
    }
}

fn remove(twins: &mut Twins, kind: Kind, which: u8) {
    macro_rules! remove {
        ($ids:ident, $remove:ident) => {
            if let Some(id) = pick!(twins, $ids, which) {
                twins.both(|simulation| simulation.$remove(id));
                let stale = twins.both(|simulation| simulation.$remove(id));
                assert!(stale.is_none(), "removed twice");
            }
        };
    }
    match kind {
        Kind::Sphere => remove!(sphere_ids, remove_sphere),
        Kind::Rod => remove!(rod_ids, remove_rod),
        Kind::Capsule => remove!(capsule_ids, remove_capsule),
        Kind::Spring => remove!(spring_ids, remove_spring),
        Kind::Tether => remove!(tether_ids, remove_tether),
        Kind::Box => remove!(box_ids, remove_box),
        Kind::Polygon => remove!(polygon_ids, remove_polygon),
    }
}

fn change(twins: &mut Twins, which: u8, how: &Change) {
    let Some(id) = pick!(twins, sphere_ids, which) else { return };
    twins.both(|simulation: &mut Simulation| match *how {
        Change::Position(to) => simulation.set_position(id, vector(to)),
        Change::Velocity(to) => simulation.set_velocity(id, vector(to)),
        Change::AngularMomentum(to) => simulation.set_angular_momentum(id, vector(to)),
        Change::Orientation(to) => {
            let [x, y, z, w] = to.map(|number| number.0);
            simulation.set_orientation(id, Quat::from_xyzw(x, y, z, w))
        }
        Change::Impulse(by) => simulation.apply_impulse(id, vector(by)),
        Change::Force(to) => simulation.set_force(id, vector(to)),
    });
}

/// Changes a rod, a spring or a tether.
fn attachment(twins: &mut Twins, kind: Kind, which: u8, [one, two, three]: [Size; 3]) {
    match kind {
        Kind::Rod | Kind::Capsule => {
            let Some(id) = pick!(twins, rod_ids, which) else { return };
            twins.both(|simulation| {
                simulation.update_rod(id, |rod| (rod.radius, rod.length) = (one.0, (three.0 > 0.0).then_some(two.0)))
            });
        }
        Kind::Spring => {
            let Some(id) = pick!(twins, spring_ids, which) else { return };
            let change = |spring: &mut Spring| (spring.stiffness, spring.length, spring.damping) = (one.0, two.0, three.0);
            twins.both(|simulation| simulation.update_spring(id, change));
        }
        _ => {
            let Some(id) = pick!(twins, tether_ids, which) else { return };
            let change = |tether: &mut Tether| (tether.stiffness, tether.length, tether.damping) = (one.0, two.0, three.0);
            twins.both(|simulation| simulation.update_tether(id, change));
        }
    }
}
