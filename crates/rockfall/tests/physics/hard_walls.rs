//! Smooth walls, capsules that never move and rods of fixed length under the contact law `rigid` (docs/physics section 11.1).

use std::f32::consts::{PI, TAU};
use std::path::Path;

use glam::Vec3;
use rockfall::{Backend, Options, Scene, Simulation};

const FRAME: f32 = 1.0 / 60.0;
const G: f32 = 9.81;
const CUBE: &str = "@body cube mass=1\nB -0.1 -0.1 -0.1 0.2 0 0 0 0.2 0 0 0 0.2\n@end\n";

fn open(text: &str, backend: Backend) -> Simulation {
    let scene = Scene::parse(&format!("set contact_law rigid\nset gravity 9.81\n{text}"), Path::new("test"));
    Simulation::with_options(scene.expect("a valid scene").scene, Options::new().backend(backend)).expect("it opens")
}

fn spheres(simulation: &mut Simulation) -> Vec<Vec3> {
    simulation.sync().expect("states").spheres().iter().map(|sphere| sphere.position).collect()
}

fn bodies(simulation: &mut Simulation) -> Vec<Vec3> {
    simulation.sync().expect("states").bodies().iter().map(|body| body.position).collect()
}

both! {
    a_ball_rolls_to_and_fro_in_a_trough_with_its_period,
    a_ball_rests_at_the_bottom_of_a_cone_and_of_a_bowl,
    boxes_stay_in_a_turning_drum,
    boxes_slide_through_a_hopper,
    a_box_slides_off_a_cylinder,
    fixed_capsules_carry_balls_and_boxes,
    a_rod_to_a_fixed_sphere_is_a_pendulum,
    a_chain_of_rods_hangs_from_a_body,
}

/// A ball that rolls without slipping in a cylinder has the period 2 pi sqrt(7 (R - r) / (5 g)), longer by 1 + a^2 / 16 with the
/// amplitude a.
fn a_ball_rolls_to_and_fro_in_a_trough_with_its_period(backend: Backend) {
    let (angle, reach) = (0.2_f32, 0.9);
    let text = format!(
        "set coulomb_friction 1\n@run substeps=8\n@cylinder at=0,0,-1 axis=0,0,1 radius=1 length=2 inside=yes\n\
         S 1 {} {} 0 0 0 0 0 0 0 1 0.1\n",
        reach * angle.sin(),
        -reach * angle.cos()
    );
    let mut simulation = open(&text, backend);
    let mut last = (0.0, spheres(&mut simulation)[0].x);
    let mut crossings = Vec::new();
    let mut farthest = 0.0_f32;
    // Software Vulkan is slow: there are two crossings, and the last swing is not looked at.
    let frames = if backend == Backend::Cpu { 360 } else { 250 };
    for frame in 1..=frames {
        simulation.run(1, FRAME).expect("a frame");
        let place = spheres(&mut simulation)[0];
        assert!((place.truncate().length() - reach).abs() < 2e-3, "{place} in frame {frame}");
        if last.1 < 0.0 && place.x >= 0.0 {
            crossings.push(last.0 + last.1 / (last.1 - place.x));
        }
        last = (frame as f32, place.x);
        farthest = if frame > 240 { farthest.max(place.x) } else { 0.0 };
    }
    let period = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f32 * FRAME;
    let expected = TAU * (7.0 * reach / (5.0 * G)).sqrt() * (1.0 + angle * angle / 16.0);
    assert!((period / expected - 1.0).abs() < 0.01, "{period} for {expected}");
    // It keeps most of its amplitude for two periods and more.
    assert!(farthest > 0.9 * reach * angle.sin() || backend != Backend::Cpu, "{farthest}");
}

fn a_ball_rests_at_the_bottom_of_a_cone_and_of_a_bowl(backend: Backend) {
    let text = "@ball at=0,0,0 radius=1 inside=yes\n@cone at=4,0,0 axis=0,1,0 radius=0.05..1 length=1 inside=yes\n\
                @cylinder at=8,0,-1 axis=0,0,1 radius=1 length=2\n@ball at=12,0,0 radius=1\n\
                S 1 0.1 -0.8 0 0 0 0 0 0 0 1 0.1\nS 2 4 0.8 0 0 0 0 0 0 0 1 0.2\nS 3 8 1.3 0 0 0 0 0 0 0 1 0.2\n\
                S 4 12 1.3 0 0 0 0 0 0 0 1 0.2\n";
    let mut simulation = open(text, backend);
    simulation.run(if backend == Backend::Cpu { 300 } else { 120 }, FRAME).expect("frames");
    let found = spheres(&mut simulation);
    assert!((found[0].length() - 0.9).abs() < 2e-3, "{}", found[0]);
    // A ball of radius r touches a cone of the half angle a all around at r / sin a above its apex.
    let slope = 0.95_f32.atan();
    let height = 0.2 / slope.sin() - 0.05 / 0.95;
    assert!((found[1] - Vec3::new(4.0, height, 0.0)).length() < 0.03, "{} for {height}", found[1]);
    assert!((found[2].y - 1.2).abs() < 2e-3 && (found[3].y - 1.2).abs() < 2e-3, "{found:?}");
}

/// Boxes, balls and capsules in a drum that turns: none leaves it, and the heap lies on the rising side.
fn boxes_stay_in_a_turning_drum(backend: Backend) {
    let mut text = format!(
        "{CUBE}@group 0\nB -2 -2 -0.51 4 0 0 0 4 0 0 0 0.1\nB -2 -2 0.41 4 0 0 0 4 0 0 0 0.1\n\
         @motion drum spin=1 axis=0,0,1 through=0,0,0\n@move drum\n\
         @cylinder at=0,0,-0.45 axis=0,0,1 radius=1 length=0.9 inside=yes\n@move -\n"
    );
    for place in 0..8 {
        let (x, y) = ((place % 4) as f32 * 0.3 - 0.45, (place / 4) as f32 * 0.3 - 0.4);
        text += &format!("@place cube at={x},{y},0.2\n");
        text += &format!("S {} {x} {} -0.2 0 0 0 0 0 0 0.5 0.1\n", place + 1, y + 0.02);
    }
    let mut simulation = open(&text, backend);
    let frames = if backend == Backend::Cpu { 300 } else { 90 };
    simulation.run(frames, FRAME).expect("frames");
    let boxes = bodies(&mut simulation);
    let balls = simulation.sync().expect("states").spheres().iter().filter(|sphere| sphere.mass == 0.5);
    let all: Vec<Vec3> = boxes.iter().take(8).copied().chain(balls.map(|ball| ball.position)).collect();
    assert_eq!(all.len(), 16);
    for place in &all {
        assert!(place.truncate().length() < 0.95 && place.z.abs() < 0.42, "{place}");
    }
    let middle: Vec3 = all.iter().sum::<Vec3>() / all.len() as f32;
    assert!(middle.y < -0.3 && (backend != Backend::Cpu || middle.x > 0.1), "{middle}");
}

fn boxes_slide_through_a_hopper(backend: Backend) {
    let mut text = format!(
        "set coulomb_friction 0.1\n{CUBE}@cone at=0,0,0 axis=0,1,0 radius=0.4..1.2 length=1.2 inside=yes\n\
         @cylinder at=0,1.2,0 axis=0,1,0 radius=1.2 length=1 inside=yes\nB -5 -2 -5 10 0 0 0 0.5 0 0 0 10\n"
    );
    for place in 0..8 {
        let (x, z) = ((place % 4) as f32 * 0.5 - 0.75, (place / 4) as f32 * 0.6 - 0.3);
        text += &format!("@place cube at={x},1.6,{z} axis=1,2,3 turn={}\n", 40 * place);
    }
    let mut simulation = open(&text, backend);
    let frames = if backend == Backend::Cpu { 240 } else { 120 };
    simulation.run(frames, FRAME).expect("frames");
    let places = bodies(&mut simulation);
    let below = places.iter().filter(|place| place.y < 0.0).count();
    assert!(below == 8 || backend != Backend::Cpu && below >= 3, "{places:?}");
    assert!(places.iter().all(|place| place.y > -1.5), "{places:?}");
}

/// It begins a little beside the top, and falls off.
fn a_box_slides_off_a_cylinder(backend: Backend) {
    let text =
        format!("set coulomb_friction 0\n{CUBE}@cylinder at=0,0,-2 axis=0,0,1 radius=1 length=4\n@place cube at=0.1,1.1,0\n");
    let mut simulation = open(&text, backend);
    simulation.run(15, FRAME).expect("frames");
    let start = bodies(&mut simulation)[0];
    assert!((start.truncate().length() - 1.1).abs() < 0.02, "{start}");
    simulation.run(75, FRAME).expect("frames");
    let end = bodies(&mut simulation)[0];
    assert!(end.x > 0.8 && end.y < 0.5, "{end}");
}

fn fixed_capsules_carry_balls_and_boxes(backend: Backend) {
    let text = format!(
        "{CUBE}@group 0\n@body rail mass=1\nS 1 0 0 -1 0 0 0 0 0 0 1 0.05\nS 2 0 0 1 0 0 0 0 0 0 1 0.05\nR 1 2 0.05\n@end\n\
         @place rail at=-0.08,0,0 fixed=1\n@place rail at=0.08,0,0 fixed=1\n\
         @place cube at=0,0.16,-0.5\nS 9 0 0.2 0.5 0 0 0 0 0 0 1 0.1\n"
    );
    let mut simulation = open(&text, backend);
    simulation.run(60, FRAME).expect("frames");
    let cube = bodies(&mut simulation)[0];
    assert!((cube - Vec3::new(0.0, 0.15, -0.5)).length() < 2e-3, "{cube}");
    let all = spheres(&mut simulation);
    let ball = all[all.len() - 1];
    // Its centre is the distance of both radii away from both axes.
    assert!((ball.y - (0.15_f32.powi(2) - 0.08_f32.powi(2)).sqrt()).abs() < 2e-3 && ball.x.abs() < 1e-3, "{ball}");
}

/// The period of a pendulum with the amplitude a is 2 pi sqrt(l / g) (1 + a^2 / 16); a ball adds 2 r^2 / (5 l) to its length only if
/// it turns along, which a joint at its centre does not make it do.
fn a_rod_to_a_fixed_sphere_is_a_pendulum(backend: Backend) {
    let angle = 0.2_f32;
    let text = format!(
        "@run substeps=8\nS 1 0 0 0 0 0 0 0 0 0 1 0.02 1\nS 2 {} {} 0 0 0 0 0 0 0 1 0.1\nR 1 2 0.01 1\n",
        angle.sin(),
        -angle.cos()
    )
    .replace("F 1 0 0 0 0.02", "S 1 0 0 0 0 0 0 0 0 0 0 0.02");
    let mut simulation = open(&text, backend);
    let mut last = (0.0, angle.sin());
    let mut crossings = Vec::new();
    for frame in 1..=if backend == Backend::Cpu { 420 } else { 220 } {
        simulation.run(1, FRAME).expect("a frame");
        let place = spheres(&mut simulation)[1];
        assert!((place.length() - 1.0).abs() < 1e-3, "{place}");
        if last.1 < 0.0 && place.x >= 0.0 {
            crossings.push(last.0 + last.1 / (last.1 - place.x));
        }
        last = (frame as f32, place.x);
    }
    let period = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f32 * FRAME;
    let expected = 2.0 * PI * (1.0 / G).sqrt() * (1.0 + angle * angle / 16.0);
    assert!((period / expected - 1.0).abs() < 2e-3, "{period} for {expected}");
}

/// A chain of rods between a capsule that never moves and a loose ball keeps its lengths.
fn a_chain_of_rods_hangs_from_a_body(backend: Backend) {
    let mut text = "S 1 0 0 0 0 0 0 0 0 0 1 0.02 1\n".to_owned();
    for link in 1..=6 {
        text += &format!("S {} {} 0 0 0 0 0 0 0 0 0.1 0.02\nR {} {} 0.01 0.2\n", link + 1, 0.2 * link as f32, link, link + 1);
    }
    text += "@group 0\n@body crate mass=1\nB -0.1 -0.1 -0.1 0.2 0 0 0 0.2 0 0 0 0.2\n@end\n@place crate at=5,0,0\n";
    let mut simulation = open(&text, backend);
    let mut lowest = 0.0_f32;
    for _ in 0..if backend == Backend::Cpu { 18 } else { 10 } {
        simulation.run(5, FRAME).expect("frames");
        let places = spheres(&mut simulation);
        for pair in places[..7].windows(2) {
            assert!((pair[0].distance(pair[1]) - 0.2).abs() < 4e-3, "{}", pair[0].distance(pair[1]));
        }
        lowest = lowest.min(places[6].y);
    }
    assert!(lowest < -1.0, "{lowest}");
}
