//! JKR cohesion (docs/physics section 4.13): force over overlap, pull-off force, sticking speed, energy lost in a contact.

use std::f64::consts::PI;

use rockfall::{
    Backend, Body, BroadPhase, CohesionModel, ContactLaw, Cuboid, MaterialId, Pair, Polygon, Rod, Scene, Simulation, Sphere,
    SphereId,
};

use super::{assert_close, ball, scene_with, simulation, soft};

/// E* of the material `soft` with itself.
pub(crate) const YOUNG: f64 = 1e5 / (2.0 * (1.0 - 0.0625));

/// A contact with JKR cohesion, from the formulas of Johnson, Kendall and Roberts (1971) in f64.
#[derive(Clone, Copy)]
pub(crate) struct Jkr {
    pub(crate) gamma: f64,
    /// R*.
    pub(crate) radius: f64,
}

impl Jkr {
    fn overlap(&self, a: f64) -> f64 {
        a * a / self.radius - 2.0 * (PI * self.gamma * a / YOUNG).sqrt()
    }

    /// Contact radius at which the contact tears, where the overlap is least.
    pub(crate) fn least_radius(&self) -> f64 {
        (PI * self.gamma * self.radius * self.radius / (4.0 * YOUNG)).cbrt()
    }

    /// Distance at which the contact tears.
    pub(crate) fn tearing(&self) -> f64 {
        -self.overlap(self.least_radius())
    }

    /// Contact radius at an overlap, by bisection.
    pub(crate) fn contact_radius(&self, overlap: f64) -> f64 {
        let (mut low, mut high) = (self.least_radius(), 10.0 * self.radius);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if self.overlap(middle) < overlap { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Repulsion minus attraction at an overlap.
    pub(crate) fn force(&self, overlap: f64) -> f64 {
        let a = self.contact_radius(overlap);
        4.0 * YOUNG * a.powi(3) / (3.0 * self.radius) - 2.0 * PI * a * a * (4.0 * self.gamma * YOUNG / (PI * a)).sqrt()
    }

    pub(crate) fn pull_off(&self) -> f64 {
        3.0 * PI * self.gamma * self.radius
    }

    /// Energy that a contact takes from its first touch to its end: the integral of the force over the overlap.
    pub(crate) fn loss(&self) -> f64 {
        let (steps, reach) = (4000, self.tearing());
        // The force has an infinite slope at the end. With the square of the variable, it has none.
        let at = |k: i32| f64::from(k) / f64::from(steps);
        let part = |k: i32| {
            let (x0, x1) = (at(k), at(k + 1));
            let middle = 0.5 * (x0 + x1);
            (x1 * x1 - x0 * x0) * reach * -self.force(middle * middle * reach - reach)
        };
        (0..steps).map(part).sum()
    }
}

/// A scene with one material that sticks to itself.
pub(crate) fn sticky(gamma: f64, restitution: f32) -> (Scene, MaterialId) {
    let mut scene = scene_with(ContactLaw::HertzMindlin);
    let material = soft(&mut scene, "soft");
    let properties = Pair::default().restitution(restitution).friction(0.5).surface_energy(gamma as f32);
    scene.set_pair(material, material, properties.cohesion(CohesionModel::Jkr)).expect("a valid pair");
    (scene, material)
}

/// A fixed ball of radius 0.5 and one of radius 0.3 below it, at an overlap.
fn two_balls(backend: Backend, jkr: Jkr, restitution: f32, overlap: f64, velocity: f64) -> (Simulation, SphereId) {
    let (mut scene, material) = sticky(jkr.gamma, restitution);
    scene.add_sphere(ball(&scene, material, [0.0; 3], 0.5).fixed()).expect("a valid sphere");
    let lower = ball(&scene, material, [0.0, (overlap - 0.8) as f32, 0.0], 0.3).velocity([0.0, velocity as f32, 0.0]);
    let id = scene.add_sphere(lower).expect("a valid sphere");
    (simulation(scene, backend), id)
}

fn height(simulation: &mut Simulation, id: SphereId) -> f64 {
    simulation.sync().expect("the state").sphere(id).expect("a sphere").position.y.into()
}

const BALLS: Jkr = Jkr { gamma: 20.0, radius: 0.5 * 0.3 / 0.8 };

/// A ball hangs below a fixed one as long as the force that pulls it is less than 3 pi gamma R*, at the overlap of the closed
/// form. That is negative before the ball is pulled off.
fn a_ball_hangs_by_its_neck_up_to_the_pull_off_force(backend: Backend) {
    let (steps, dt) = crate::common::on(backend, (1500_u64, 2e-4), (150, 1e-3));
    let most = BALLS.pull_off();
    let (mut simulation, id) = two_balls(backend, BALLS, 0.2, 1e-4, 0.0);
    for share in [0.0, 0.5, 0.8, 0.95, 0.99, 1.01] {
        simulation.set_force(id, [0.0, (-share * most) as f32, 0.0]).expect("a force");
        // A force just above the pull-off force takes long to tear the contact.
        simulation.run(if share > 1.0 { 3 * steps } else { steps }, dt).expect("steps");
        let found = height(&mut simulation, id) + 0.8;
        let contacts = simulation.contacts().expect("contacts");
        if share < 1.0 {
            // F = 4/3 f (u^6 - 6 u^3) with the pull-off force 12 f.
            let u = (3.0 * (1.0 + (1.0_f64 - share).sqrt())).cbrt();
            let expected = BALLS.tearing() / 3.0 * (u.powi(4) - 4.0 * u);
            let error = (found - expected).abs() / BALLS.tearing();
            assert!(error < 0.01, "{share}: overlap {found}, expected {expected}");
            assert_eq!(contacts.len(), 1, "{share}");
            assert!(contacts[0].overlap < 0.0 || share < 0.9, "{share}: {contacts:?}");
            assert_close(
                (-contacts[0].normal_force()).into(),
                share.max(1e-3) * most,
                if share > 0.0 { 0.01 } else { 10.0 },
                "force",
            );
        } else {
            assert!(found < -3.0 * BALLS.tearing(), "{share}: it hangs with the overlap {found}");
            assert!(contacts.is_empty(), "{share}: {contacts:?}");
        }
    }
}

/// Heavy balls are pulled slowly from a ball, a box, a polygon and a rod. Their accelerations are those of the formulas, from
/// the repulsion to the tear, at negative overlaps too.
fn the_force_follows_the_overlap_to_the_tear(backend: Backend) {
    let gamma = 20.0;
    let (mut scene, material) = sticky(gamma, 1.0);
    let radius = 0.3_f32;
    // The x coordinate, the surface's height and its radius.
    let mut pairs = Vec::new();
    scene.add_sphere(ball(&scene, material, [0.0, -0.5, 0.0], 0.5).fixed()).expect("a valid sphere");
    pairs.push((0.0_f32, 0.5));
    let cuboid = Cuboid::between([4.0, -1.0, -1.0], [6.0, 0.0, 1.0]).material(material);
    scene.add_box(cuboid).expect("a valid box");
    pairs.push((5.0, f64::INFINITY));
    scene
        .add_polygon(Polygon::new([9.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]).material(material))
        .expect("a valid polygon");
    pairs.push((10.0, f64::INFINITY));
    let ends = [14.0, 16.0].map(|x| ball(&scene, material, [x, -0.25, 0.0], 0.1).fixed());
    let [one, two] = ends.map(|end| scene.add_sphere(end).expect("a valid sphere"));
    scene.add_rod(Rod::new(one, two, 0.25).material(material)).expect("a valid rod");
    pairs.push((15.0, 0.25));
    let start = 2.5e-3;
    let (steps, dt) = crate::common::on(backend, (400_u32, 2.5e-4), (80, 1.25e-3));
    let ids: Vec<SphereId> = pairs
        .iter()
        .map(|(x, _)| {
            let heavy = Sphere::new([*x, radius - start, 0.0], radius).density(1e4).material(material);
            scene.add_sphere(heavy.velocity([0.0, 0.15, 0.0])).expect("a valid sphere")
        })
        .collect();
    let mut simulation = simulation(scene, backend);
    let state = |simulation: &mut Simulation| -> Vec<Sphere> {
        let scene = simulation.sync().expect("the state");
        ids.iter().map(|id| *scene.sphere(*id).expect("a sphere")).collect()
    };
    let mut before = state(&mut simulation);
    let mut deepest = vec![0.0_f64; pairs.len()];
    let mut torn = vec![false; pairs.len()];
    for _ in 0..steps {
        simulation.run(1, dt).expect("a step");
        let after = state(&mut simulation);
        for (place, (old, new)) in before.iter().zip(&after).enumerate() {
            let jkr = Jkr { gamma, radius: 1.0 / (1.0 / f64::from(radius) + 1.0 / pairs[place].1) };
            let overlap = f64::from(radius) - f64::from(old.position.y);
            let found = f64::from(new.velocity.y - old.velocity.y) / f64::from(dt) * f64::from(old.mass);
            let expected = if overlap > -jkr.tearing() { jkr.force(overlap) } else { 0.0 };
            // Near the tear the force is steep, and rounding decides whether the contact has ended.
            let share = (overlap + jkr.tearing()).abs() / jkr.tearing();
            if share > 0.01 {
                let error = (found - expected).abs() / jkr.pull_off();
                assert!(error < 0.01, "pair {place}: force {found} at {overlap}, expected {expected}");
                deepest[place] = deepest[place].min(if expected < 0.0 { overlap / jkr.tearing() } else { 0.0 });
                torn[place] |= expected == 0.0;
            }
        }
        before = after;
    }
    assert!(deepest.iter().all(|deepest| *deepest < -0.9) && torn.iter().all(|torn| *torn), "{deepest:?} {torn:?}");
}

/// The work of a contact from touch to tear is that of Thornton and Ning (1998), Powder Technology 99, 154: 7.09 (Gamma^5 R^4 /
/// E^2)^(1/3) with Gamma = 2 gamma. So is the sticking speed of a sphere on a plane, 1.84 ((Gamma / R)^5 / (rho^3 E^2))^(1/6).
#[test]
fn the_work_of_a_contact_is_that_of_the_literature() {
    let jkr = Jkr { gamma: 3.0, radius: 0.2 };
    let work = 7.09 * ((2.0 * jkr.gamma).powi(5) * jkr.radius.powi(4) / YOUNG.powi(2)).cbrt();
    assert_close(jkr.loss(), work, 1e-3, "work");
    let density = 1.5;
    let mass = 4.0 / 3.0 * PI * jkr.radius.powi(3) * density;
    let speed = 1.84 * ((2.0 * jkr.gamma / jkr.radius).powi(5) / (density.powi(3) * YOUNG.powi(2))).powf(1.0 / 6.0);
    assert_close((2.0 * jkr.loss() / mass).sqrt(), speed, 1e-3, "sticking speed");
    // The closed form of docs/physics: E* R*^(1/2) h^(5/2) (16/5 + 24/5 4^(4/3)).
    let unit = jkr.tearing() / 3.0;
    let closed = YOUNG * jkr.radius.sqrt() * unit.powf(2.5) * (3.2 + 4.8 * 4.0_f64.powf(4.0 / 3.0));
    assert_close(jkr.loss(), closed, 1e-4, "closed form");
}

/// Elastic balls stick below the speed whose energy is the work of the contact. Faster ones rebound with the rest of their
/// energy.
fn balls_stick_below_the_critical_speed(backend: Backend) {
    let mass = 4.0 / 3.0 * PI * 0.027;
    let critical = (2.0 * BALLS.loss() / mass).sqrt();
    let (steps, dt, shares) =
        crate::common::on(backend, (20_000_u64, 1e-5, &[0.5, 0.98, 1.02, 1.2, 2.0][..]), (800, 1e-4, &[0.95, 1.2][..]));
    for share in shares {
        let (mut simulation, id) = two_balls(backend, BALLS, 1.0, -1e-5, share * critical);
        simulation.run(steps, dt).expect("steps");
        let speed = -f64::from(simulation.sync().expect("the state").sphere(id).expect("a sphere").velocity.y);
        let contacts = simulation.contacts().expect("contacts").len();
        assert_eq!(contacts, usize::from(*share < 1.0), "{share} of the critical speed {critical}");
        if *share > 1.0 {
            let lost = 0.5 * mass * ((share * critical).powi(2) - speed * speed);
            assert_close(lost, BALLS.loss(), crate::common::on(backend, 0.01, 0.03), &format!("{share}: energy lost"));
        }
    }
}

/// While a contact lasts, its energy and the kinetic one have a constant sum.
#[test]
fn energy_is_kept_while_a_contact_lasts() {
    let (mut simulation, _) = two_balls(Backend::Cpu, BALLS, 1.0, 1e-4, 0.3);
    simulation.run(1, 1e-5).expect("a step");
    let start = simulation.energy().expect("energies");
    // Below the energy of separate bodies by the work of the first touch, and more.
    assert!(start.contact < -0.9 * BALLS.loss(), "{start:?}, loss {}", BALLS.loss());
    for _ in 0..40 {
        simulation.run(37, 1e-5).expect("steps");
        let now = simulation.energy().expect("energies");
        let error = now.kinetic + now.contact - start.kinetic - start.contact;
        assert!(error.abs() < 2e-3 * BALLS.loss(), "{now:?}, {start:?}");
    }
}

/// A neck of a fifth of the radius, more than the margin of lists, keeps its pair in the lists of all broad phases until it
/// tears.
fn long_necks_stay_in_the_lists(backend: Backend) {
    let jkr = Jkr { gamma: 500.0, ..BALLS };
    let (steps, dt) = (100_u64, 1e-3_f32);
    for method in [BroadPhase::BruteForce, BroadPhase::Grid, BroadPhase::SortAndSkip] {
        let (mut scene, material) = sticky(jkr.gamma, 1.0);
        scene.add_sphere(ball(&scene, material, [0.0; 3], 0.5).fixed()).expect("a valid sphere");
        let speed = 0.95 * jkr.tearing() / (steps as f64 * f64::from(dt));
        let heavy =
            Sphere::new([0.0, 1e-4 - 0.8, 0.0], 0.3).density(1e6).velocity([0.0, -speed as f32, 0.0]).material(material);
        scene.add_sphere(heavy).expect("a valid sphere");
        let options = super::options(backend).broad_phase(method);
        let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
        let report = simulation.run(steps, dt).expect("steps");
        assert!(report.contacts == 1 && report.list_builds > 2, "{method}: {report:?}");
        let contacts = simulation.contacts().expect("contacts");
        assert!(f64::from(contacts[0].overlap) < -0.9 * jkr.tearing(), "{method}: {contacts:?}");
        assert_eq!(simulation.run(steps / 5, dt).expect("steps").contacts, 0, "{method}");
    }
}

/// Contacts at a negative overlap are listed with it, and bodies that only pass by are not.
#[test]
fn a_neck_is_listed_as_a_contact() {
    let (mut simulation, id) = two_balls(Backend::Cpu, BALLS, 0.2, 1e-4, 0.0);
    simulation.set_force(id, [0.0, (-0.95 * BALLS.pull_off()) as f32, 0.0]).expect("a force");
    simulation.run(8_000, 1e-4).expect("steps");
    let report = simulation.report();
    assert_eq!((report.contacts, report.max_overlap), (1, 0.0), "{report:?}");
    let contacts = simulation.contacts().expect("contacts");
    assert!(matches!(contacts[0].b, Body::Sphere(b) if b == id) && contacts[0].overlap < 0.0, "{contacts:?}");
    assert_eq!(simulation.diagnostics().expect("diagnostics").iter().map(|found| found.contacts).collect::<Vec<_>>(), [1, 1]);
    // The same distance, without a touch before it.
    let (mut passing, _) = two_balls(Backend::Cpu, BALLS, 0.2, contacts[0].overlap.into(), 0.0);
    let report = passing.run(5, 1e-4).expect("steps");
    assert_eq!(report.contacts, 0);
    assert!(passing.contacts().expect("contacts").is_empty());
}

/// `linear` and collisions are refused, by the name of the pair, before the run and while it goes on.
#[test]
fn necks_need_hertz_mindlin_without_impulses() {
    let text = |law: &str, collisions: &str, pair: &str| {
        format!(
            "set contact_law {law}\nset collisions {collisions}\n@material a young=1e5 poisson=0.2\n@material b young=1e5 \
             poisson=0.2\n@pair a a stiffness=1e3\n@pair b b stiffness=1e3\n@pair a b {pair}\n@use a\n\
             S 1  0 0 0  0 0 0  0 0 0  1 0.5\n@use b\nS 2  1.1 0 0  0 0 0  0 0 0  1 0.5\n"
        )
    };
    let opened = |text: String| {
        let scene = Scene::parse(&text, std::path::Path::new("necks")).expect("a valid text").scene;
        Simulation::with_options(scene, super::options(Backend::Cpu)).map_err(|error| error.to_string())
    };
    let jkr = "surface_energy=2 cohesion=jkr";
    let error = opened(text("linear", "off", jkr)).map(drop).expect_err("refused");
    assert!(error.contains("jkr for the pair 'a' 'b' and the contact law linear"), "{error}");
    let error = opened(text("hertz-mindlin", "on", jkr)).map(drop).expect_err("refused");
    assert!(error.contains("pair 'a' 'b' and collisions on") && error.contains("cohesion=dmt"), "{error}");
    opened(text("linear", "off", "surface_energy=2 cohesion=dmt")).expect("DMT");
    opened(text("linear", "off", "surface_energy=0 cohesion=jkr")).expect("no cohesion");
    let mut simulation = opened(text("hertz-mindlin", "off", jkr)).expect("JKR");
    let settings = simulation.settings().with(|settings| settings.collisions = true);
    assert!(simulation.set_settings(settings).is_err());
    assert!(!simulation.settings().collisions);
    simulation.run(1, 1e-4).expect("a step");
}

both!(
    a_ball_hangs_by_its_neck_up_to_the_pull_off_force,
    the_force_follows_the_overlap_to_the_tear,
    balls_stick_below_the_critical_speed,
    long_necks_stay_in_the_lists,
);
