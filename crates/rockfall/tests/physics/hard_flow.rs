//! Inlets, outlets and gauges under the contact law `rigid`.

use std::path::Path;

use rockfall::{Backend, GaugeReading, Meter, Options, Scene, Simulation};

use crate::hard::check_split_and_resumed;

const FRAME: f32 = 1.0 / 60.0;
/// A tray on a scale, an inlet above it, and an outlet below its open side.
const TRAY: &str = "set contact_law rigid\nset gravity 9.81\n\
    @name scale\nB -2 -1 -2  4 0 0  0 1 0  0 0 4\n@name -\n\
    B -2.2 0 -2.2  0.2 0 0  0 2 0  0 0 4.4\nB 2 0 -2.2  0.2 0 0  0 2 0  0 0 4.4\n\
    B -2 0 -2.2  4 0 0  0 2 0  0 0 0.2\nB -2 0 2  4 0 0  0 2 0  0 0 0.2\n\
    @gauge name=weight wall=scale\n";

fn open(text: &str, backend: Backend) -> Simulation {
    let scene = Scene::parse(&format!("{TRAY}{text}"), Path::new("test")).expect("a valid scene").scene;
    Simulation::with_options(scene, Options::new().backend(backend)).expect("it opens")
}

both! {
    a_scale_shows_the_weight_of_what_came_in,
    split_and_resumed_runs_with_inlets_have_the_same_bits,
    bodies_keep_their_contacts_while_others_come_and_go,
}

const INLET: &str = "@inlet name=top box=-1,3,-1,1,3.6,1 rate=20 radius=0.25 density=30 velocity=0,-2,0 limit=12\n";

fn a_scale_shows_the_weight_of_what_came_in(backend: Backend) {
    let mut simulation = open(INLET, backend);
    let mut meter = Meter::new(simulation.scene(), true, false);
    simulation.run(240, FRAME).expect("4 s");
    assert_eq!(simulation.flow().inlets[0].spheres, 12);
    simulation.run_metered(60, FRAME, &mut meter).expect("1 s");
    let mass = simulation.flow().inlets[0].mass;
    let weight = mass * 9.81;
    let mean = meter.take_means()[0][0];
    assert!((mean.y + weight).abs() < 0.02 * weight && mean.x.abs() < 0.02 * weight, "{mean} {weight}");
    let GaugeReading::Wall(load) = simulation.gauges().expect("readings")[0] else { panic!("a wall") };
    assert!((load.force.y + weight).abs() < 0.05 * weight && load.contacts >= 3, "{load:?}");
}

/// At 32 substeps the overlap of a body at rest is less than the rounding of its place. Its contacts are listed all the same.
#[test]
fn a_gauge_shows_the_weight_of_a_body_whose_overlap_is_rounding() {
    let text = "set contact_law rigid\nset gravity 9.81\n@run substeps=32\n@name floor\n@triangle -91 0 -91  0 0 364  364 0 0\n@name -\n\
        @body ell mass=3\nB 0 0 -0.4 2.3 0 0 0 0.8 0 0 0 0.8\nB 0 0 -0.4 0.8 0 0 0 2.3 0 0 0 0.8\n@end\n\
        @place ell centre=-2.78,3.04,0.07 axis=-0.919,-0.136,0.370 turn=0\n@gauge name=load wall=floor\n";
    let scene = Scene::parse(text, Path::new("test")).expect("a valid scene").scene;
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("it opens");
    simulation.run(360, 1.0 / 120.0).expect("3 s");
    for _ in 0..20 {
        simulation.run(1, 1.0 / 120.0).expect("a frame");
        let GaugeReading::Wall(load) = simulation.gauges().expect("readings")[0] else { panic!("a wall") };
        assert!((load.force.y + 3.0 * 9.81).abs() < 0.3, "{load:?}");
    }
}

/// Substeps suit what comes in: a diameter of 0.1 m takes 13 at 9.81 m/s² (docs/physics section 11.10), a cube of 0.3 m takes 8.
#[test]
fn substeps_suit_what_inlets_bring() {
    let cube =
        "@body crate density=1\nB 0 0 0 0.3 0 0 0 0.3 0 0 0 0.3\n@end\n@inlet name=top box=-1,3,-1,1,4,1 rate=20 shape=crate\n";
    let ball = "@inlet name=top box=-1,3,-1,1,4,1 rate=20 radius=0.05 density=1\n";
    for (text, substeps) in [(cube, 8), (ball, 13)] {
        let mut simulation = open(text, Backend::Cpu);
        assert_eq!(simulation.scene().hard_contacts(FRAME).expect("facts").auto_substeps, substeps);
        simulation.run(1, FRAME).expect("a frame");
        assert_eq!(simulation.substeps(), Some(substeps));
    }
}

fn split_and_resumed_runs_with_inlets_have_the_same_bits(backend: Backend) {
    let text = format!("{INLET}@outlet name=hole box=-2,-0.1,-2,0,0.5,2\n");
    let whole = check_split_and_resumed(|| open(&text, backend), 90, 10, &[13, 51]);
    assert!(whole.flow().outlets[0].spheres > 0, "{:?}", whole.flow());
}

/// A tower of ten cubes does not move while balls come in far from it: its contacts keep their impulses.
fn bodies_keep_their_contacts_while_others_come_and_go(backend: Backend) {
    let tower: String = (0..10).map(|number| format!("@place cube at=10,{},0\n", number as f32 + 0.5)).collect();
    let cube = "@body cube mass=1\nB -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1\n@end\nB 5 -1 -5  10 0 0  0 1 0  0 0 10\n";
    let heights = ["", "@inlet name=top box=-1,3,-1,1,3.6,1 rate=60 radius=0.1 density=20 velocity=0,-3,0\n"].map(|inlet| {
        let mut simulation = open(&format!("@run substeps=4\n{cube}{tower}{inlet}"), backend);
        simulation.run(120, FRAME).expect("2 s");
        simulation.sync().expect("states").bodies()[9].position
    });
    assert!(heights[0].distance(heights[1]) < 1e-6, "{heights:?}");
}
