//! Sequences of frames: blending between two states, and objects that are added, removed or reordered.

use rockfall::generate::Kind;
use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, BroadPhase, Cuboid, Look, Options, Scene, Simulation, Sphere, Tag};
use rockfall_viewer::camera::{Camera, Direction, Up};
use rockfall_viewer::draw::{ColourBy, Range, Style};
use rockfall_viewer::survey::Survey;

use crate::common::{
    HEIGHT, WIDTH, canvas, drawn_box, gpu, is_drawn, outlines, picture, pixel, pixels, projected, renderer, simulation, take,
};

fn camera() -> Camera {
    Camera::new([0.0, 0.0, 8.0], [0.0, 0.0, 0.0])
}

#[test]
fn bodies_are_blended_between_two_states() {
    for backend in [Backend::Cpu, Backend::Gpu] {
        let mut scene = Scene::new();
        scene.settings.gravity = 0.0;
        let ball = scene.add_sphere(Sphere::new([-1.0, 0.0, 0.0], 0.5)).unwrap();
        let mut simulation = simulation(scene, backend);
        let (mut renderer, canvas, style) = (renderer(), canvas(), outlines());
        renderer.update(&mut simulation, &style).unwrap();
        renderer.remember();
        simulation.set_position(ball, [1.0, 0.0, 0.0]).unwrap();
        simulation.set_orientation(ball, Quat::from_rotation_y(0.3)).unwrap();
        renderer.update(&mut simulation, &style).unwrap();
        for (blend, middle) in [(0.0, -1.0), (0.25, -0.5), (1.0, 1.0)] {
            renderer.set_blend(blend);
            let [left, _, right, _] = drawn_box(&canvas.take(&mut renderer, &camera(), &style).unwrap());
            let expected = projected(&camera(), Vec3::new(middle, 0.0, 0.0))[0];
            let found = 0.5 * (left + right + 1) as f32;
            assert!((found - expected).abs() < 1.5, "{backend} {blend}: {found} {expected}");
        }
    }
}

#[test]
fn update_detects_added_and_removed_objects() {
    for backend in [Backend::Cpu, Backend::Gpu] {
        let mut scene = Scene::new();
        let first = scene.add_sphere(Sphere::new([-1.0, 0.0, 0.0], 0.5)).unwrap();
        let mut simulation = simulation(scene, backend);
        let (mut renderer, canvas, style) = (renderer(), canvas(), outlines());
        let mut shown = |simulation: &mut Simulation| {
            renderer.update(simulation, &style).unwrap();
            drawn_box(&canvas.take(&mut renderer, &camera(), &style).unwrap())
        };
        let alone = shown(&mut simulation);
        simulation.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.5)).unwrap();
        let both = shown(&mut simulation);
        assert!(both[0] == alone[0] && both[2] > alone[2] + 50, "{alone:?} {both:?}");
        simulation.remove_sphere(first).unwrap();
        let other = shown(&mut simulation);
        assert!(other[0] > alone[2] && other[2] == both[2], "{other:?}");
    }
}

#[test]
fn the_memory_order_does_not_change_the_picture() {
    let style = Style::default();
    let pictures = [BroadPhase::BruteForce, BroadPhase::Grid].map(|broad_phase| {
        let scene = Kind::Mixed.generate(300, 1).unwrap();
        let camera = Camera::of_scene(&scene, crate::common::ASPECT, Direction::Oblique);
        let options = Options::new().backend(Backend::Gpu).broad_phase(broad_phase);
        let mut simulation = Simulation::on_device(scene, options, gpu().device(), gpu().queue()).unwrap();
        take(&mut simulation, &camera, &style)
    });
    // Only pixels of bodies at equal depths may differ, because they depend on the drawing order.
    let differing = pictures[0].pixels.iter().zip(&pictures[1].pixels).filter(|(one, two)| one != two).count();
    assert!(differing < 40, "{differing}");
}

/// Ground, sky, light, shadows and walls turn with the direction of gravity.
#[test]
fn a_scene_with_z_up_looks_like_the_same_scene_with_y_up() {
    let shown = |up: Up| {
        let at = |x: f32, y: f32, z: f32| up.to_scene(Vec3::new(x, y, z));
        let mut scene = Scene::new();
        scene.settings.gravity_direction = -up.vector();
        for k in 0..4 {
            // Stripes would turn with the axes of the scene.
            let id = scene.add_sphere(Sphere::new(at(1.2 * k as f32, 0.5 + 0.1 * k as f32, 0.0), 0.5)).unwrap();
            scene.set_tag(id, Tag::new().look(Look::Plain)).unwrap();
        }
        // A block on which a ball lies, and a wall in front, which is translucent.
        for (from, to) in [(at(-2.0, 0.0, -2.0), at(5.0, 0.01, 2.0)), (at(-1.0, 0.0, 1.5), at(1.0, 2.0, 1.7))] {
            scene.add_box(Cuboid::between(from, to)).unwrap();
        }
        let mut style = Style::default();
        (style.colour_by, style.range) = (ColourBy::Speed, Range::Given([0.0, 1.0]));
        let camera = Camera::of_scene(&scene, crate::common::ASPECT, Direction::Oblique);
        picture(scene, &camera, &style)
    };
    let level = shown(Up::Y);
    let is_drawn = level.pixels.iter().filter(|pixel| **pixel != level.pixels[0]).count();
    assert!(is_drawn > level.pixels.len() / 3, "{is_drawn}");
    for up in [Up::Z, Up::NegZ, Up::X] {
        let turned = shown(up);
        let differs = |(one, two): &(&[u8; 4], &[u8; 4])| (0..3).any(|k| one[k].abs_diff(two[k]) > 6);
        let differing = level.pixels.iter().zip(&turned.pixels).filter(differs).count();
        assert!(differing < level.pixels.len() / 200, "{up:?}: {differing}");
    }
}

/// A wall that hides a body late in a film is translucent from the start, so that it does not change in the middle.
#[test]
fn walls_are_translucent_for_all_states_of_a_survey() {
    let scene = |x: f32| {
        let mut scene = Scene::new();
        scene.add_sphere(Sphere::new([x, 0.0, 0.0], 0.5)).unwrap();
        scene.add_box(Cuboid::between([0.5, -1.0, 3.0], [1.5, 1.0, 3.2])).unwrap();
        scene
    };
    let mut simulation = simulation(scene(-1.5), Backend::Cpu);
    let (mut renderer, canvas, style) = (renderer(), canvas(), outlines());
    let at_wall = projected(&camera(), Vec3::new(1.0, 0.3, 3.2)).map(|place| place as u32);
    let mut shade = |survey: Option<Survey>| {
        renderer.set_scene(&simulation);
        survey.into_iter().for_each(|survey| renderer.set_survey(survey));
        renderer.update(&mut simulation, &style).unwrap();
        u32::from(pixel(&canvas.take(&mut renderer, &camera(), &style).unwrap(), at_wall[0], at_wall[1])[0])
    };
    let whole = shade(None);
    let mut survey = Survey::new(&scene(-1.5));
    assert_eq!(shade(Some(survey.clone())), whole);
    survey.add(&scene(1.6));
    // The background is white.
    let translucent = shade(Some(survey));
    assert!((whole + 10..255).contains(&translucent), "{whole} {translucent}");
}

#[test]
fn the_scale_does_not_depend_on_a_body_that_falls_for_ever() {
    for backend in [Backend::Cpu, Backend::Gpu] {
        let mut scene = Scene::new();
        scene.settings.gravity = 0.0;
        for k in 0..10 {
            scene.add_sphere(Sphere::new([2.0 * k as f32, 0.0, 0.0], 0.5).velocity([0.0, 0.9, 0.0])).unwrap();
        }
        scene.add_sphere(Sphere::new([5.0, -4000.0, 0.0], 0.5).velocity([0.0, -300.0, 0.0])).unwrap();
        let mut simulation = simulation(scene, backend);
        let mut renderer = renderer();
        let mut style = Style::default();
        style.colour_by = ColourBy::Speed;
        renderer.update(&mut simulation, &style).unwrap();
        assert_eq!(renderer.range(&style), [0.0, 1.0], "{backend}");
    }
}

#[test]
fn spheres_have_their_own_colours_and_the_light_comes_from_the_given_side() {
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    for x in [-1.0, 1.0] {
        scene.add_sphere(Sphere::new([x, 0.0, 0.0], 0.8)).unwrap();
    }
    let mut simulation = simulation(scene, Backend::Cpu);
    let (mut renderer, canvas, mut style) = (renderer(), canvas(), Style::default());
    renderer.set_colours(vec![None, Some([255, 0, 0])]);
    style.kinds[0] = [0, 255, 0];
    /// The sum of the colours in a square around a point.
    fn around(picture: &rockfall_viewer::picture::Picture, point: Vec3) -> [u32; 3] {
        let [x, y] = projected(&camera(), point).map(|place| place as u32);
        let mut sum = [0; 3];
        for (dx, dy) in (0..6).flat_map(|dx| (0..6).map(move |dy| (dx, dy))) {
            let found = pixel(picture, x + dx - 3, y + dy - 3);
            (0..3).for_each(|channel| sum[channel] += u32::from(found[channel]));
        }
        sum
    }
    for by in [ColourBy::Kind, ColourBy::Speed, ColourBy::Kind] {
        style.colour_by = by;
        renderer.update(&mut simulation, &style).unwrap();
        let picture = canvas.take(&mut renderer, &camera(), &style).unwrap();
        let [one, two] = [-1.0, 1.0].map(|x| around(&picture, Vec3::new(x, 0.0, 0.0)));
        if by == ColourBy::Kind {
            assert!(one[1] > one[0] && two[0] > two[1], "{one:?} {two:?}");
        } else {
            assert!(one[0].abs_diff(two[0]) < 300, "{one:?} {two:?}");
        }
    }
    for side in [-1.0, 1.0] {
        style.light = Some(Vec3::new(side, 0.2, 0.2));
        let picture = canvas.take(&mut renderer, &camera(), &style).unwrap();
        let [left, right] = [-0.6, 0.6].map(|x| around(&picture, Vec3::new(1.0 + x, 0.0, 0.0)).iter().sum::<u32>());
        assert_eq!(right > left, side > 0.0, "{left} {right}");
    }
}

/// The pattern shows how a body turns. It would cover the shapes of a crowd, and a fixed sphere does not turn.
#[test]
fn the_pattern_is_faint_in_a_crowd_and_fixed_spheres_are_plain() {
    let mut style = outlines();
    style.colour_by = ColourBy::Kind;
    let camera = Camera::new([0.0, 0.0, 6.0], [0.0; 3]);
    // The range of red on the ball, in % of blue: of coloured sectors and light ones.
    let contrast = |others: u32, fixed: bool| {
        let mut scene = Scene::new();
        let ball = Sphere::new([0.0; 3], 1.0);
        scene.add_sphere(if fixed { ball.fixed() } else { ball }).unwrap();
        for number in 0..others {
            // Behind the camera.
            scene.add_sphere(Sphere::new([0.0, 3.0 * number as f32, 30.0], 1.0)).unwrap();
        }
        let picture = picture(scene, &camera, &style);
        let middle = (WIDTH / 2 - 45..WIDTH / 2 + 45).map(|x| pixel(&picture, x, HEIGHT / 2));
        let red: Vec<u8> = middle.map(|[red, _, blue]| (100 * u32::from(red) / u32::from(blue)) as u8).collect();
        red.iter().max().unwrap() - red.iter().min().unwrap()
    };
    let [few, many, fixed] = [contrast(0, false), contrast(600, false), contrast(0, true)];
    assert!(few > 45 && (8..2 * few / 3).contains(&many) && fixed < 8, "{few} {many} {fixed}");
}

/// A wall that moves out of a periodic box comes in on the other side; one that is in the box, or whose middle is on a face, stays.
#[test]
fn walls_are_drawn_in_the_periodic_box() {
    let text = |motion: &str, x: f32| {
        format!("@periodic x -2 2\n{motion}B {x} -0.5 -0.5 1 0 0 0 1 0 0 0 1\nP {} -0.5 0.6 0.5 0 0 0 0.5 0\n", x + 0.2)
            + "@move -\nB 1.5 -1 -1 1 0 0 0 0.2 0 0 0 1\nS 1 0 1.2 0 0 0 0 0 0 0 1 0.2\n"
    };
    let scene = |text: &str| Scene::parse(text, std::path::Path::new("test")).unwrap().scene;
    let camera = Camera::new([0.0, 1.0, 12.0], [0.0; 3]);
    let mut style = outlines();
    style.colour_by = ColourBy::Kind;
    for backend in [Backend::Cpu, Backend::Gpu] {
        // 3 periods and a quarter.
        let mut moving = simulation(scene(&text("set gravity 0\n@motion slide velocity=1.3,0,0\n@move slide\n", 0.2)), backend);
        moving.run(100, 0.1).unwrap();
        let found = take(&mut moving, &camera, &style);
        let expected = take(&mut simulation(scene(&text("set gravity 0\n", 0.2 + 13.0 - 12.0)), backend), &camera, &style);
        let differ = pixels().filter(|(x, y)| pixel(&found, *x, *y) != pixel(&expected, *x, *y)).count();
        assert!(differ < 20, "{backend}: {differ} pixels differ");
        let far = pixels().filter(|(x, y)| is_drawn(&expected, *x, *y)).count();
        assert!(far > 1000, "{far}");
    }
}
