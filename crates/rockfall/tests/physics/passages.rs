//! Spheres whose centre passes a wall within a step are counted (docs/physics section 2.20).

use rockfall::glam::Vec3;
use rockfall::{
    Backend, Integrator, Material, Motion, MotionTerm, Pair, Passage, Placement, Polygon, Scene, Shape, Simulation, Sphere,
};

use crate::common::{on, simulation, with};
use crate::faults::scenes::{opened, scene};

/// Hits a floor of two triangles at 60 units/s: the impact is deeper than the radius.
const SOFT_FLOOR: &str = "\
set contact_law hertz-mindlin
set gravity 9.81
@material p density=2500 young=1e7 poisson=0.2
@pair p p restitution=0.8 friction=0.4
@use p
@triangle -0.1 0 -0.1  0.2 0 0  0.2 0 0.2
@triangle -0.1 0 -0.1  0.2 0 0.2  0 0 0.2
S 1 0.01 0.0035 0.013 0 -60 0 0 0 0 - 0.002
";

/// The integrators of the laws with history.
const WITH_HISTORY: [Integrator; 2] = [Integrator::SymplecticEuler, Integrator::VelocityVerlet];

/// A grain that goes through a soft floor is counted once, with the step, however steps are divided into calls.
fn a_grain_that_goes_through_a_soft_floor_is_counted(backend: Backend) {
    for integrator in WITH_HISTORY {
        let mut simulation = opened(scene(SOFT_FLOOR), backend, integrator);
        let mut step = None;
        for steps in 1..=10 {
            simulation.run(10, 1e-6).expect("steps");
            let is_below = simulation.spheres().expect("spheres")[0].position.y < 0.0;
            step = step.or(is_below.then_some(10 * steps));
        }
        let report = simulation.report();
        let last = step.expect("the grain goes through");
        let Some(Passage { sphere: 0, step }) = report.first_passage else { panic!("{integrator}: {report:?}") };
        assert!(report.passages == 1 && (last - 9..=last).contains(&step), "{integrator}: {report:?}, before {last}");
        // A checkpoint keeps the count.
        let checkpoint = simulation.checkpoint().expect("a checkpoint");
        let resumed = Simulation::resume(checkpoint).expect("the simulation resumes");
        assert_eq!(resumed.report().first_passage, report.first_passage);
    }
}

/// Balls without forces, in groups of their own, with the walls of their group and what is expected of each of them.
struct Cases {
    scene: Scene,
    expected: Vec<bool>,
}

impl Cases {
    fn new() -> Self {
        Self { scene: with(|settings| (settings.gravity, settings.collisions) = (0.0, false)), expected: Vec::new() }
    }

    fn add(&mut self, from: [f32; 3], velocity: [f32; 3], walls: impl IntoIterator<Item = Polygon>, passes: bool) {
        let group = self.expected.len() as u16;
        self.scene.add_sphere(Sphere::new(from, 0.1).velocity(velocity).group(group)).expect("a valid sphere");
        for wall in walls {
            self.scene.add_polygon(wall.group(group)).expect("a valid polygon");
        }
        self.expected.push(passes);
    }
}

/// Fast balls pass walls within the outline, from both sides of a triangle and from the front of a polygon. Beside the outline and from
/// behind they are not counted, nor with contacts within a step.
fn fast_balls_are_counted_within_the_outline(backend: Backend) {
    let face = || Polygon::new([-1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]);
    let triangle = || Polygon::triangle([-1.0, 0.0, -1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, -1.0]);
    let other = || Polygon::triangle([1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, 1.0]);
    let (down, up) = ([3.0, -40.0, 2.0], [3.0, 40.0, 2.0]);
    let mut cases = Cases::new();
    cases.add([0.0, 1.0, 0.0], down, [face()], true);
    cases.add([0.0, -1.0, 0.0], up, [face()], false);
    cases.add([0.0, 1.0, -0.8], down, [triangle()], true);
    cases.add([0.0, -1.0, -0.8], up, [triangle()], true);
    cases.add([0.8, 1.0, 0.8], down, [triangle()], false);
    // Through the seam, counted once.
    cases.add([0.0, 1.0, -0.05], [0.0, -40.0, 0.0], [triangle(), other()], true);
    cases.add([0.05, 1.0, -0.05], [0.0, -40.0, 0.0], [triangle(), other()], true);
    // Beside the border, nearer than the radius.
    cases.add([1.05, 1.0, 0.0], [0.0, -40.0, 0.0], [face()], false);
    cases.add([0.0, 1.0, 0.0], [40.0, -1.0, 0.0], [face()], false);
    cases.add([0.0, 1.0, 0.0], down, [Polygon::plane([0.0, 0.0, 0.0], [0.0, 1.0, 0.0])], true);
    for integrator in Integrator::ALL {
        let mut simulation = opened(cases.scene.clone(), backend, integrator);
        simulation.run(3, 0.02).expect("steps");
        let report = simulation.report();
        let expected = cases.expected.iter().filter(|passes| **passes).count() as u64;
        assert_eq!(report.passages, expected, "{integrator}");
        assert_eq!(report.first_passage, Some(Passage { sphere: 0, step: 2 }), "{integrator}");
        for (number, passes) in cases.expected.iter().enumerate() {
            // One by one on the CPU, where it is cheap.
            if backend == Backend::Cpu {
                let mut scene = cases.scene.clone();
                let others = scene.sphere_ids().enumerate().filter(|(other, _)| *other != number);
                let others: Vec<_> = others.map(|(_, id)| id).collect();
                scene.remove_spheres(&others).expect("spheres");
                let mut simulation = opened(scene, backend, integrator);
                simulation.run(3, 0.02).expect("steps");
                assert_eq!(simulation.report().passages, u64::from(*passes), "case {number}, {integrator}");
            }
        }
    }
    let mut scene = cases.scene;
    (scene.settings.collisions, scene.settings.continuous_collisions) = (true, true);
    let mut simulation = simulation(scene, backend);
    simulation.run(3, 0.02).expect("steps");
    assert_eq!(simulation.report().passages, 0, "they are taken back");
}

/// A ball that rolls over the edge of a table falls past it and is not counted.
fn a_ball_that_rolls_around_an_edge_is_not_counted(backend: Backend) {
    for (is_triangle, integrator) in [false, true].into_iter().zip(WITH_HISTORY) {
        let mut scene = with(|settings| settings.gravity = 10.0);
        scene.settings.set("contact_law", "hertz-mindlin").expect("a law");
        let material = Material::new("stuff").density(1000.0).young(1e6).poisson(0.3);
        let material = scene.add_material(material).expect("a material");
        scene.set_pair(material, material, Pair::default().restitution(0.5).friction(0.5)).expect("a pair");
        let corner = [-2.0, 0.0, -2.0];
        let table = if is_triangle {
            Polygon::triangle(corner, [-2.0, 0.0, 2.0], [0.0, 0.0, 0.0])
        } else {
            Polygon::new(corner, [0.0, 0.0, 4.0], [2.0, 0.0, 0.0])
        };
        scene.add_polygon(table.material(material)).expect("a valid polygon");
        let ball = Sphere::new([-0.03, 0.1, 0.0], 0.1).density(1000.0).velocity([0.3, 0.0, 0.0]).material(material);
        scene.add_sphere(ball).expect("a valid sphere");
        let mut simulation = opened(scene, backend, integrator);
        simulation.run(on(backend, 6000, 2500), on(backend, 1e-4, 2.4e-4)).expect("steps");
        let place = simulation.spheres().expect("spheres")[0].position;
        assert!(place.y < -0.2, "it falls: {place}");
        assert_eq!(simulation.report().passages, 0, "triangle: {is_triangle}");
    }
}

/// A ball that a program puts behind a wall is not counted, however fast it is, nor one that starts there.
fn a_ball_that_is_put_behind_a_wall_is_not_counted(backend: Backend) {
    for integrator in Integrator::ALL {
        let mut scene = with(|settings| (settings.gravity, settings.collisions) = (0.0, false));
        scene.add_polygon(Polygon::triangle([-1.0, 0.0, -1.0], [-1.0, 0.0, 3.0], [3.0, 0.0, -1.0])).expect("a valid polygon");
        let ball = scene.add_sphere(Sphere::new([0.0, 0.3, 0.0], 0.1).velocity([4.0, 0.0, 0.0])).expect("a valid sphere");
        let mut simulation = opened(scene, backend, integrator);
        for y in [-0.3, 0.3, -0.02, 0.02, -0.02] {
            simulation.run(2, 0.01).expect("steps");
            simulation.set_position(ball, [0.0, y, 0.0]).expect("an edit");
        }
        simulation.set_velocity(ball, [4.0, -5.0, 0.0]).expect("an edit");
        simulation.run(2, 0.01).expect("steps");
        assert_eq!(simulation.report().passages, 0, "{integrator}");
    }
}

/// A wall that moves through a ball at rest passes it. A ball that rides on it does not.
fn a_wall_that_moves_through_a_ball_is_counted(backend: Backend) {
    for integrator in Integrator::ALL {
        let mut scene = with(|settings| (settings.gravity, settings.collisions) = (0.0, false));
        (scene.settings.contact_force, scene.settings.contact_damping, scene.settings.friction) = (0.0, 0.0, 0.0);
        let motion = scene.add_motion(Motion::new("lift", MotionTerm::translation([0.0, 3.0, 0.0]))).expect("a motion");
        let wall = Polygon::triangle([-1.0, 0.0, -1.0], [-1.0, 0.0, 3.0], [3.0, 0.0, -1.0]);
        scene.add_polygon(wall.motion(motion)).expect("a valid polygon");
        scene.add_sphere(Sphere::new([0.0, 0.25, 0.0], 0.1)).expect("a valid sphere");
        let riding = Sphere::new([0.5, 0.05, 0.5], 0.1).velocity([0.0, 3.0, 0.0]);
        scene.add_sphere(riding).expect("a valid sphere");
        let mut simulation = opened(scene, backend, integrator);
        simulation.run(15, 0.01).expect("steps");
        let report = simulation.report();
        assert_eq!((report.passages, report.first_passage), (1, Some(Passage { sphere: 0, step: 9 })), "{integrator}");
    }
}

/// The spheres of a clump and the ends of a capsule are counted, too.
fn spheres_of_bodies_are_counted(backend: Backend) {
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        let mut scene = with(|settings| {
            settings.set("contact_law", "linear").expect("a law");
            settings.gravity = 0.0;
        });
        let stuff = scene.add_material(Material::new("stuff")).expect("a material");
        scene.set_pair(stuff, stuff, Pair::default().stiffness(1e3)).expect("a pair");
        let shape = Shape::new().material(stuff).sphere([0.0, 0.0, 0.0], 0.1).sphere([0.1, 0.0, 0.0], 0.1).mass(1.0);
        let shape = scene.add_shape(shape).expect("a valid shape");
        let placed = Placement::new(shape).at(Vec3::new(0.0, 0.5, 0.0).as_dvec3()).velocity([0.0, -30.0, 0.0]);
        scene.add_body(placed).expect("a valid place");
        let wall = Polygon::triangle([-1.0, 0.0, -1.0], [-1.0, 0.0, 3.0], [3.0, 0.0, -1.0]);
        scene.add_polygon(wall.material(stuff)).expect("a valid polygon");
        let mut simulation = opened(scene, backend, integrator);
        simulation.run(1, 0.02).expect("steps");
        assert_eq!(simulation.report().passages, 2, "{integrator}");
    }
}

both!(
    a_grain_that_goes_through_a_soft_floor_is_counted,
    fast_balls_are_counted_within_the_outline,
    a_ball_that_rolls_around_an_edge_is_not_counted,
    a_ball_that_is_put_behind_a_wall_is_not_counted,
    a_wall_that_moves_through_a_ball_is_counted,
    spheres_of_bodies_are_counted,
);
