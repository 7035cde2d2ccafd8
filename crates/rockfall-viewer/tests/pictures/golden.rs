//! Compares pictures with reference pictures, and checks that the comparison detects errors.
//!
//! `ROCKFALL_BLESS=1` overwrites the reference pictures: inspect them before you commit them.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, Capsule, Cuboid, Polygon, Rod, Scene, Sphere, Spring, Tether};
use rockfall_viewer::camera::Camera;
use rockfall_viewer::draw::{ColourBy, Style};
use rockfall_viewer::picture::Picture;

use crate::common::{picture, simulation, take};

/// Number of pixels along a side of the blocks whose means are compared.
const BLOCK: u32 = 8;
/// Difference of the means, of 255, above which a block differs. Drivers round edges and filters differently, but by less
/// than this.
const TOLERANCE: f32 = 10.0;

/// Returns a description of the largest difference above the tolerance.
pub(crate) fn difference(one: &Picture, two: &Picture) -> Option<String> {
    assert_eq!((one.width, one.height), (two.width, two.height));
    let mut worst = (TOLERANCE, None);
    for top in (0..one.height).step_by(BLOCK as usize) {
        for left in (0..one.width).step_by(BLOCK as usize) {
            let mut sums = [0.0_f32; 3];
            for y in top..(top + BLOCK).min(one.height) {
                for x in left..(left + BLOCK).min(one.width) {
                    let [a, b] = [one, two].map(|picture| crate::common::pixel(picture, x, y));
                    for channel in 0..3 {
                        sums[channel] += f32::from(a[channel]) - f32::from(b[channel]);
                    }
                }
            }
            let off = sums.iter().fold(0.0_f32, |off, sum| off.max(sum.abs())) / (BLOCK * BLOCK) as f32;
            if off > worst.0 {
                worst = (off, Some(format!("{off:.1} of 255 off at {left}, {top}")));
            }
        }
    }
    worst.1
}

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name)
}

fn read(path: &Path) -> Picture {
    let file = File::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let pixels = bytes[..info.buffer_size()].chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2], 255]).collect();
    Picture { width: info.width, height: info.height, pixels }
}

#[track_caller]
pub(crate) fn assert_golden(name: &str, made: &Picture) {
    let path = golden(name);
    if std::env::var_os("ROCKFALL_BLESS").is_some() {
        made.write_png(File::create(&path).unwrap()).unwrap();
    }
    if let Some(difference) = difference(&read(&path), made) {
        let beside = std::env::temp_dir().join(name);
        made.write_png(File::create(&beside).unwrap()).unwrap();
        panic!("{name}: {difference}; the new picture is {}", beside.display());
    }
}

/// A variant of the test scene.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Variant {
    Correct,
    WithoutBall,
    WithoutRod,
    WithoutCapsule,
    WithoutSpring,
    WithoutTether,
    WithoutBox,
    WithoutPolygon,
    WrongColour,
    TurnedBall,
    OtherSide,
    Mirrored,
}

fn everything(variant: Variant) -> Scene {
    let mut scene = Scene::new();
    // Mirrors the scene, but not the patterns of the bodies.
    let x = if variant == Variant::Mirrored { -1.0 } else { 1.0 };
    let at = |place: [f32; 3]| Vec3::new(x * place[0], place[1], place[2]);
    let with = |part: Variant| variant != part;
    scene.add_box(Cuboid::between([-4.0, -0.3, -2.5], [4.0, 0.0, 2.5])).unwrap();
    let turn = if variant == Variant::TurnedBall { -0.6 } else { 0.6 };
    let ball = Sphere::new(at([-2.6, 0.6, 0.8]), 0.6).orientation(Quat::from_rotation_z(0.5) * Quat::from_rotation_y(turn));
    scene.add_sphere(ball).unwrap();
    if with(Variant::WithoutBall) {
        let small = Sphere::new(at([-1.3, 0.3, 1.5]), 0.3);
        scene.add_sphere(if variant == Variant::WrongColour { small.fixed() } else { small }).unwrap();
    }
    let ends = [[-1.6, 0.35, -1.2], [-0.2, 1.4, -1.2]].map(|end| scene.add_sphere(Sphere::new(at(end), 0.3)).unwrap());
    if with(Variant::WithoutRod) {
        scene.add_rod(Rod::new(ends[0], ends[1], 0.12)).unwrap();
    }
    if with(Variant::WithoutCapsule) {
        scene.add_capsule(Capsule::new(at([-0.4, 0.35, 1.5]), at([1.1, 0.35, 0.9]), 0.35)).unwrap();
    }
    let tops = [[0.9, 0.3, -0.8], [0.9, 1.7, -0.8]].map(|end| scene.add_sphere(Sphere::new(at(end), 0.3)).unwrap());
    if with(Variant::WithoutSpring) {
        scene.add_spring(Spring::new(tops[0], tops[1], 10.0, 1.4)).unwrap();
    }
    if with(Variant::WithoutTether) {
        scene.add_tether(Tether::new(tops[1], at([1.9, 2.4, -0.8]), 10.0).length(1.0)).unwrap();
    }
    if with(Variant::WithoutBox) {
        scene.add_box(Cuboid::new(at([2.3, 0.0, 0.6]), [x * 0.8, 0.0, 0.3], [0.0, 0.7, 0.0], [x * -0.3, 0.0, 0.8])).unwrap();
    }
    if with(Variant::WithoutPolygon) {
        let (mut left, mut right) = (at([1.0, 0.2, 0.4]), at([0.0, 1.2, -0.5]));
        if variant == Variant::OtherSide {
            std::mem::swap(&mut left, &mut right);
        }
        scene.add_polygon(Polygon::new(at([2.2, 0.0, -1.2]), left, right)).unwrap();
    }
    scene
}

fn camera() -> Camera {
    Camera::new([1.2, 4.2, 10.0], [0.0, 0.6, 0.0])
}

#[test]
fn all_objects_look_like_the_reference() {
    assert_golden("everything.png", &picture(everything(Variant::Correct), &camera(), &Style::default()));
}

#[test]
fn every_wrong_variant_is_detected() {
    let whole = read(&golden("everything.png"));
    for variant in [
        Variant::WithoutBall,
        Variant::WithoutRod,
        Variant::WithoutCapsule,
        Variant::WithoutSpring,
        Variant::WithoutTether,
        Variant::WithoutBox,
        Variant::WithoutPolygon,
        Variant::WrongColour,
        Variant::TurnedBall,
        Variant::OtherSide,
        Variant::Mirrored,
    ] {
        let made = picture(everything(variant), &camera(), &Style::default());
        assert!(difference(&whole, &made).is_some(), "{variant:?} is not detected");
        if variant == Variant::Mirrored {
            // The picture mirrored back also differs, because of the patterns and the light.
            let rows = made.pixels.chunks_exact(made.width as usize);
            let pixels = rows.flat_map(|row| row.iter().rev().copied()).collect();
            assert!(difference(&whole, &Picture { pixels, ..made }).is_some(), "a mirrored picture is not detected");
        }
    }
    let styles: [fn(&mut Style); 3] =
        [|style| style.shadows = false, |style| style.occlusion = false, |style| style.ground = false];
    for (number, change) in styles.into_iter().enumerate() {
        let mut style = Style::default();
        change(&mut style);
        let made = picture(everything(Variant::Correct), &camera(), &style);
        assert!(difference(&whole, &made).is_some(), "change {number} of the style is not detected");
    }
}

#[test]
fn colours_of_values_look_like_the_reference() {
    for by in ColourBy::ALL.into_iter().skip(1) {
        let mut scene = everything(Variant::Correct);
        // A moving sphere with an overlap of 0.1 with the floor.
        scene.add_sphere(Sphere::new([0.2, 0.3, 0.2], 0.4).velocity([1.5, 0.0, 0.0])).unwrap();
        let mut style = Style::default();
        style.colour_by = by;
        let mut moving = simulation(scene, Backend::Cpu);
        let mut renderer = crate::common::renderer();
        renderer.update(&mut moving, &style).unwrap();
        let mut made = crate::common::canvas().take(&mut renderer, &camera(), &style).unwrap();
        renderer.legend(&style).draw(&mut made).unwrap();
        assert_golden(&format!("{}.png", by.name()), &made);
    }
}

#[test]
fn both_backends_give_the_same_picture() {
    let style = Style::default();
    let made = |backend| {
        let mut simulation = simulation(everything(Variant::Correct), backend);
        let before = take(&mut simulation, &camera(), &style);
        simulation.run(40, 0.01).unwrap();
        [before, take(&mut simulation, &camera(), &style)]
    };
    let [cpu, gpu] = [made(Backend::Cpu), made(Backend::Gpu)];
    assert!(cpu[0] == gpu[0], "the first pictures show the same state but differ");
    assert_eq!(difference(&cpu[1], &gpu[1]), None);
    assert!(difference(&cpu[0], &cpu[1]).is_some(), "nothing has moved");
}
