//! Pictures of objects with looks (`@look`).

use std::path::Path;

use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, Capsule, Cuboid, Look, ObjectId, Polygon, Scene, Sphere, Tag};
use rockfall_viewer::camera::Camera;
use rockfall_viewer::draw::{ColourBy, Style};
use rockfall_viewer::picture::Picture;

use crate::common::{picture, pixel, projected, simulation};
use crate::golden::{assert_golden, difference};

/// The scene of all looks, with or without them.
fn showcase(with_looks: bool) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/looks.txt");
    let mut text = std::fs::read_to_string(&file).unwrap();
    if !with_looks {
        text = text.lines().filter(|line| !line.starts_with("@look")).map(|line| format!("{line}\n")).collect();
    }
    Scene::parse(&text, &file).unwrap().scene
}

#[test]
fn all_looks_look_like_the_reference() {
    let camera = Camera::new([2.2, 4.2, 8.5], [0.0, 0.3, 0.0]);
    let made = picture(showcase(true), &camera, &Style::default());
    assert_golden("looks.png", &made);
    let without = picture(showcase(false), &camera, &Style::default());
    assert!(difference(&made, &without).is_some(), "a scene without looks is not detected");
}

fn camera() -> Camera {
    Camera::new([0.0, 3.0, 10.0], [0.0, 1.0, 0.0])
}

/// A picture of an object with a look and a colour.
fn shown(look: Option<Look>, style: &Style, add: impl Fn(&mut Scene) -> ObjectId) -> Picture {
    let mut scene = Scene::new();
    // No sphere, because walls before one are removed.
    let behind = scene.add_box(Cuboid::between([-0.8, 0.2, -3.0], [0.8, 1.8, -2.2])).unwrap();
    scene.set_tag(behind, Tag::new().colour("blue".parse().unwrap())).unwrap();
    let object = add(&mut scene);
    let mut tag = Tag::new().colour("red".parse().unwrap());
    tag.look = look;
    scene.set_tag(object, tag).unwrap();
    picture(scene, &camera(), style)
}

fn ball(scene: &mut Scene, turned: f32) -> ObjectId {
    scene.add_sphere(Sphere::new([0.0, 1.0, 0.0], 1.0).orientation(Quat::from_rotation_y(turned))).unwrap().into()
}

/// Objects of every kind at about (0, 1, 0).
const KINDS: [fn(&mut Scene) -> ObjectId; 4] = [
    |scene| ball(scene, 0.0),
    |scene| scene.add_capsule(Capsule::new([-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], 0.8)).unwrap().into(),
    |scene| scene.add_box(Cuboid::between([-1.0, 0.1, -0.1], [1.0, 2.0, 0.1])).unwrap().into(),
    |scene| scene.add_polygon(Polygon::new([-1.0, 0.1, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0])).unwrap().into(),
];

#[test]
fn every_look_of_every_kind_of_object_differs() {
    let mut style = Style::default();
    style.ground = false;
    for (kind, add) in KINDS.into_iter().enumerate() {
        let looks: Vec<Option<Look>> = Look::ALL.into_iter().map(Some).chain([None]).collect();
        let pictures: Vec<Picture> = looks.iter().map(|look| shown(*look, &style, add)).collect();
        for (one, first) in pictures.iter().enumerate() {
            for (other, second) in pictures.iter().enumerate().skip(one + 1) {
                // A polygon has no pattern without a look, and a ball among few is striped.
                let alike = (kind == 3 && one == 0 && other == 5) || (kind < 2 && one == 1 && other == 5);
                assert_eq!(first == second, alike, "kind {kind}: {:?} and {:?}", looks[one], looks[other]);
            }
        }
    }
}

#[test]
fn glass_shows_what_is_behind_and_casts_a_light_shadow() {
    let mut style = Style::default();
    style.occlusion = false;
    let mut without = style;
    without.shadows = false;
    let behind = projected(&camera(), Vec3::new(0.0, 1.1, -2.2)).map(|side| side as u32);
    for (kind, add) in KINDS.into_iter().enumerate() {
        let [plain, glass] = [Look::Plain, Look::Glass].map(|look| shown(Some(look), &style, add));
        let blue = |picture: &Picture| pixel(picture, behind[0], behind[1])[2];
        assert!(blue(&glass) > blue(&plain) + 30, "kind {kind}: {} {}", blue(&glass), blue(&plain));
        let [plain, glass] = [(plain, Look::Plain), (glass, Look::Glass)]
            .map(|(picture, look)| ground_light(&shown(Some(look), &without, add)) - ground_light(&picture));
        assert!(0 < glass && 2 * glass < plain, "kind {kind}: shadows of {glass} and {plain}");
    }
}

/// The light of a part of the ground, to the right behind the objects, where their shadows fall.
fn ground_light(picture: &Picture) -> i64 {
    let corners = [[1.1, 0.0, -0.5], [2.6, 0.0, -1.8]].map(|corner| projected(&camera(), Vec3::from(corner)));
    let [left, right] = corners.map(|corner| corner[0] as u32);
    let [bottom, top] = corners.map(|corner| corner[1] as u32);
    (top..bottom).flat_map(|y| (left..right).map(move |x| i64::from(pixel(picture, x, y)[1]))).sum()
}

#[test]
fn wood_and_stone_turn_with_the_body_and_are_plain_where_colours_show_values() {
    let mut style = Style::default();
    for look in [Look::Wood, Look::Stone] {
        let [one, other] = [0.0, 0.5].map(|turned| shown(Some(look), &style, |scene| ball(scene, turned)));
        assert!(one != other, "{look} does not turn");
    }
    style.colour_by = ColourBy::Speed;
    let [plain, wood, striped] =
        [Look::Plain, Look::Wood, Look::Striped].map(|look| shown(Some(look), &style, |scene| ball(scene, 0.0)));
    assert!(plain == wood && plain != striped);
}

#[test]
fn a_look_that_changes_in_a_run_is_shown_on_both_backends() {
    let style = Style::default();
    for backend in [Backend::Cpu, Backend::Gpu] {
        let mut scene = Scene::new();
        let ball = scene.add_sphere(Sphere::new([0.0, 1.0, 0.0], 1.0)).unwrap();
        let mut simulation = simulation(scene, backend);
        let mut renderer = crate::common::renderer();
        let canvas = crate::common::canvas();
        let mut take = |simulation: &mut rockfall::Simulation| {
            renderer.update(simulation, &style).unwrap();
            canvas.take(&mut renderer, &camera(), &style).unwrap()
        };
        let before = take(&mut simulation);
        // It has no colour of its own, so that only the look changes.
        simulation.set_tag(ball, Tag::new().look(Look::Plain)).unwrap();
        let plain = take(&mut simulation);
        simulation.set_tag(ball, Tag::new()).unwrap();
        assert!(before != plain && before == take(&mut simulation), "{backend:?}");
    }
}

/// A ball that overlaps a pane by a hair has no dark dot where it touches.
#[test]
fn a_pane_covers_the_caps_of_balls_that_touch_it() {
    let camera = Camera::new([0.0, 0.0, 9.0], [0.0, 0.0, 0.0]);
    let touched = |overlap: f32| {
        let mut scene = Scene::new();
        let pane = scene.add_polygon(Polygon::new([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0])).unwrap();
        scene.set_tag(pane, Tag::new().look(Look::Glass)).unwrap();
        let ball = scene.add_sphere(Sphere::new([0.0, 0.0, overlap - 1.0], 1.0)).unwrap();
        scene.set_tag(ball, Tag::new().look(Look::Plain).colour("orange".parse().unwrap())).unwrap();
        let made = picture(scene, &camera, &Style::default());
        let [x, y] = projected(&camera, Vec3::ZERO);
        pixel(&made, x as u32, y as u32)
    };
    let [apart, overlapping] = [-0.01, 0.02].map(touched);
    let difference = apart.iter().zip(overlapping).map(|(one, other)| one.abs_diff(other)).max();
    assert!(difference.unwrap() < 6, "{apart:?} {overlapping:?}");
}
