//! Contacts that begin and end, and what enters and leaves sensors, against closed forms.

use std::path::Path;

use rockfall::glam::Vec3;
use rockfall::{
    Backend, Checkpoint, ContactChange, ContactEvent, Error, ObjectId, Options, Scene, SensorChange, SensorEvent, Simulation,
};

const FRAME: f32 = 1.0 / 60.0;
const RIGID: &str = "set contact_law rigid\nset gravity 10\n";
/// Balls that bounce without loss.
const THESIS: &str = "set gravity 10\nset restitution 1\nset activation_threshold 0\n";
const FLOOR: &str = "B -20 -1 -20 40 0 0 0 1 0 0 0 40\n";
const CUBE: &str = "@body cube mass=1\nB -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1\n@end\n";

/// A simulation whose contacts and sensors are watched.
fn open(text: &str, backend: Backend) -> Simulation {
    let scene = Scene::parse(text, Path::new("test")).expect("a valid scene").scene;
    let mut simulation = Simulation::with_options(scene, Options::new().backend(backend)).expect("it opens");
    simulation.watch_contacts(true).expect("contacts");
    simulation.watch_sensors(true).expect("sensors");
    simulation
}

fn events(simulation: &mut Simulation) -> Vec<ContactEvent> {
    simulation.contact_events().expect("watched contacts")
}

/// All that is the same in two simulations, whose handles differ.
fn facts(events: &[ContactEvent]) -> Vec<impl PartialEq + std::fmt::Debug + use<>> {
    let of = |event: &ContactEvent| {
        let vectors = [event.point, event.normal, event.force].map(|vector| vector.to_array().map(f32::to_bits));
        (event.step, event.time.to_bits(), event.change, [event.a.index, event.b.index], vectors.concat())
    };
    events.iter().map(of).collect()
}

both! {
    a_ball_of_the_law_rigid_touches_when_it_lands,
    a_ball_of_the_thesis_touches_when_it_lands,
    a_box_slides_from_tile_to_tile,
    a_box_that_rocks_has_one_contact,
    a_stack_at_rest_has_no_events,
    an_impact_of_two_balls_is_one_contact,
    split_and_resumed_runs_have_the_same_events,
    a_sensor_counts_what_falls_through,
}

/// The times at which a ball that falls from a height lands, at a restitution, in s.
fn landings<const N: usize>(height: f64, restitution: f64) -> [f64; N] {
    let first = (2.0 * height / 10.0).sqrt();
    let mut time = first;
    let mut flight = 2.0 * first;
    std::array::from_fn(|number| {
        if number > 0 {
            flight *= restitution;
            time += flight;
        }
        time
    })
}

/// Each bounce begins in the frame of its landing and ends in the next one. Its force is the change of momentum by the frame.
fn a_ball_of_the_law_rigid_touches_when_it_lands(backend: Backend) {
    let text = format!("{RIGID}set restitution 0.5\n{FLOOR}S 1 0 1.5 0 0 0 0 0 0 0 2 0.5\n");
    let mut simulation = open(&text, backend);
    simulation.run(58, FRAME).expect("frames");
    let events = events(&mut simulation);
    let times = landings::<2>(1.0, 0.5);
    assert_eq!(events.len(), 4, "{events:#?}");
    for (number, pair) in events.chunks(2).enumerate() {
        let [begin, end] = pair else { panic!("{pair:?}") };
        assert_eq!((begin.change, end.change), (ContactChange::Begin, ContactChange::End));
        assert_eq!(begin.step, (times[number] * 60.0).ceil() as u64, "{begin:?}");
        assert_eq!(end.step, begin.step + 1);
        assert!((begin.time - begin.step as f64 / 60.0).abs() < 1e-6);
        assert!(matches!((begin.a.id, begin.b.id), (ObjectId::Sphere(_), ObjectId::Box(_))));
        let speed = (2.0_f64 * 10.0).sqrt() * 0.5_f64.powi(number as i32);
        let push = -2.0 * speed * 1.5 * 60.0;
        assert!((f64::from(begin.force.y) - push).abs() < 0.02 * push.abs(), "{} {push}", begin.force);
        assert!(begin.normal.y < -0.999 && begin.point.y.abs() < 0.2, "{begin:?}");
        assert_eq!(end.force, Vec3::ZERO);
    }
}

fn a_ball_of_the_thesis_touches_when_it_lands(backend: Backend) {
    let text = format!("{THESIS}{FLOOR}S 1 0 0.7 0 0 0 0 0 0 0 2 0.5\n");
    let mut simulation = open(&text, backend);
    let dt = 1.0 / 256.0;
    simulation.run(180, dt).expect("steps");
    let events = events(&mut simulation);
    let times = landings::<2>(0.2, 1.0);
    assert_eq!(events.len(), 4, "{events:#?}");
    for (pair, time) in events.chunks(2).zip(times) {
        let [begin, end] = pair else { panic!("{pair:?}") };
        assert_eq!((begin.change, end.change), (ContactChange::Begin, ContactChange::End));
        assert!((begin.time - time).abs() < 1.5 * f64::from(dt), "{begin:?} {time}");
        assert!(end.step - begin.step <= 2, "{end:?}");
        let push = -2.0 * 2.0 * 2.0 * 256.0;
        assert!((begin.force.y - push).abs() < 0.05 * push.abs(), "{} {push}", begin.force);
    }
}

/// A cube without friction leaves one tile when its rear edge does.
fn a_box_slides_from_tile_to_tile(backend: Backend) {
    let tiles = "set coulomb_friction 0\nB -4 -1 -4 4 0 0 0 1 0 0 0 8\nB 0 -1 -4 4 0 0 0 1 0 0 0 8\n";
    let text = format!("{RIGID}{tiles}{CUBE}@place cube at=-1.52,0.5,0 velocity=2,0,0\n");
    let mut simulation = open(&text, backend);
    simulation.run(80, FRAME).expect("frames");
    let events = events(&mut simulation);
    let of = |change, tile| {
        let found: Vec<&ContactEvent> = events.iter().filter(|event| event.change == change && event.b.index == tile).collect();
        assert!(found.len() <= 1, "{found:#?}");
        found.first().map(|event| event.time)
    };
    assert!(of(ContactChange::Begin, 0).is_none_or(|time| time < 0.02), "{events:#?}");
    // The front edge is at the seam after 0.51 s, the rear one after 1.01 s.
    let begins = of(ContactChange::Begin, 1).expect("it comes to the second tile");
    let ends = of(ContactChange::End, 0).expect("it leaves the first tile");
    assert!((begins - 0.51).abs() < 0.035 && (ends - 1.01).abs() < 0.035, "{begins} {ends}");
    assert_eq!(of(ContactChange::End, 1), None);
    assert!(events.iter().all(|event| matches!(event.a.id, ObjectId::Body(_))));
}

/// A cube that is dropped on an edge falls to a face: one contact of the bodies, whatever corners touch.
fn a_box_that_rocks_has_one_contact(backend: Backend) {
    let text = format!(
        "{RIGID}set coulomb_friction 0.8\n{FLOOR}{CUBE}@place cube at=0,0.59,0 axis=0,0,1 turn=10\n\
         @body rod mass=1\nC -0.5 0 0 0.5 0 0 0 0 0 1 0.2\n@end\n@place rod at=3,0.25,0 axis=0,0,1 turn=3\n"
    );
    let mut simulation = open(&text, backend);
    simulation.run(120, FRAME).expect("frames");
    let events = events(&mut simulation);
    for body in 0..2 {
        let own: Vec<_> = events.iter().filter(|event| event.a.index == body).collect();
        assert_eq!(own.len(), 1, "{own:#?}");
        assert_eq!(own[0].change, ContactChange::Begin);
    }
}

fn a_stack_at_rest_has_no_events(backend: Backend) {
    let cubes: String = (0..3).map(|number| format!("@place cube at=0,{},0\n", number as f32 + 0.5)).collect();
    let mut simulation = open(&format!("{RIGID}{FLOOR}{CUBE}{cubes}"), backend);
    simulation.run(2, FRAME).expect("frames");
    let first = events(&mut simulation);
    assert!(first.len() <= 3 && first.iter().all(|event| event.change == ContactChange::Begin), "{first:#?}");
    simulation.run(60, FRAME).expect("frames");
    assert_eq!(events(&mut simulation), []);
    // Spheres of the thesis's law on each other.
    let text = format!("set gravity 10\n{FLOOR}S 1 0 0.499 0 0 0 0 0 0 0 1 0.5\nS 2 0 1.498 0 0 0 0 0 0 0 1 0.5\n");
    let mut simulation = open(&text, backend);
    simulation.run(20, 1.0 / 256.0).expect("steps");
    assert_eq!(events(&mut simulation), []);
}

/// Two balls that meet within a frame and part again touch once, at the place and with the momentum of their impact.
fn an_impact_of_two_balls_is_one_contact(backend: Backend) {
    let balls = "S 1 -1 0 0 6 0 0 0 0 0 1 0.25\nS 2 1 0 0 -6 0 0 0 0 0 1 0.25\n";
    let text = format!("set contact_law rigid\nset gravity 0\nset restitution 1\n{balls}");
    let mut simulation = open(&text, backend);
    simulation.run(15, FRAME).expect("frames");
    let events = events(&mut simulation);
    let [begin, end] = events[..] else { panic!("{events:#?}") };
    // They touch after 0.125 s, in the eighth frame.
    assert_eq!((begin.change, begin.step, end.change, end.step), (ContactChange::Begin, 8, ContactChange::End, 9));
    assert!((begin.force.x - 12.0 * 60.0).abs() < 1.0 && begin.normal.x > 0.999, "{begin:?}");
    assert!(begin.point.length() < 1e-3, "{begin:?}");
    assert_eq!([begin.a.index, begin.b.index], [0, 1]);
}

/// A run in parts, one that is resumed from a file, and one that is not watched.
fn split_and_resumed_runs_have_the_same_events(backend: Backend) {
    let rigid = format!("{RIGID}set restitution 0.5\n{FLOOR}{CUBE}@place cube at=0,0.9,0 axis=1,2,3 turn=40\n");
    let ball = "S 1 0.1 2 0.1 0 0 0 0 0 0 2 0.3\n";
    for (text, dt) in [(rigid + ball, FRAME), (format!("{THESIS}{FLOOR}{ball}S 2 0.3 1 0 0 0 0 0 0 0 1 0.2\n"), 1.0 / 64.0)] {
        let mut whole = open(&text, backend);
        whole.run(60, dt).expect("steps");
        let all = facts(&events(&mut whole));
        assert!(all.len() >= 3, "{all:?}");
        let mut parts = open(&text, backend);
        parts.run(1, dt).expect("a step");
        parts.run(36, dt).expect("steps");
        let mut found = facts(&events(&mut parts));
        let bytes = parts.checkpoint().expect("a checkpoint").to_bytes();
        let mut resumed = Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("bytes")).expect("it resumes");
        assert!(matches!(resumed.contact_events(), Err(Error::Invalid { field: "contact_events", .. })));
        resumed.watch_contacts(true).expect("contacts");
        resumed.run(23, dt).expect("steps");
        found.extend(facts(&events(&mut resumed)));
        assert_eq!(found, all);
        let mut plain = open(&text, backend);
        plain.watch_contacts(false).expect("no contacts");
        plain.watch_sensors(false).expect("no sensors");
        plain.run(60, dt).expect("steps");
        let ends = [&mut plain, &mut whole, &mut resumed].map(crate::common::bits_of);
        assert!(ends.iter().all(|bits| *bits == ends[0]));
    }
}

/// What falls through a sensor enters it once and leaves it once, when its centre does.
fn a_sensor_counts_what_falls_through(backend: Backend) {
    let sensors = "@sensor name=gate box=-1,-1,-1,1,0,1\n@sensor name=aside box=5,-9,-1,6,9,1\n";
    let ball = "S 1 0 0.5 0 0 0 0 0 0 0 1 0.25\n";
    let cube = format!("{CUBE}@place cube at=0.5,0.5,0.5\n@group 1 meets=2\n");
    let capsule = "C -0.5 0.5 -0.6 -0.3 0.5 -0.6 0 0 0 1 0.1\n";
    let rigid = format!("{RIGID}{sensors}{capsule}{cube}{ball}");
    for (text, dt, movers) in [(rigid, FRAME, 3), (format!("set gravity 10\n{sensors}{capsule}{ball}"), 1.0 / 64.0, 2)] {
        let mut simulation = open(&text, backend);
        simulation.run(40, dt).expect("steps");
        let events: Vec<SensorEvent> = simulation.sensor_events().expect("watched sensors");
        assert_eq!(events.len(), 2 * movers, "{events:#?}");
        let [enters, leaves] = [0.1_f64.sqrt(), 0.3_f64.sqrt()].map(|time| (time / f64::from(dt)).ceil() as u64);
        for (number, event) in events.iter().enumerate() {
            let (step, change) = if number < movers { (enters, SensorChange::Enter) } else { (leaves, SensorChange::Leave) };
            assert_eq!((event.change, event.sensor), (change, 0));
            assert!(event.step.abs_diff(step) <= 1, "{event:?} {step}");
            let height = if change == SensorChange::Enter { 0.0 } else { -1.0 };
            assert!(event.centre.y <= height && event.centre.y > height - 0.15, "{event:?}");
        }
        assert_eq!(events[0].object.id, events[movers].object.id);
        assert_eq!(simulation.sensor_events().expect("none"), []);
    }
}
