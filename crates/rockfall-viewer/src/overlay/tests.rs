use rockfall::glam::Vec3;
use rockfall::{Backend, Options, Scene, Simulation, Sphere};

use super::*;
use crate::legend::{Corner, Legend};
use crate::survey::Survey;

/// The motion after the states of two balls, of which the second moves to the right by 1 unit/s.
fn motion(overlay: &Overlay, states: usize) -> Motion {
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    scene.add_sphere(Sphere::new([-1.0, 0.0, 0.0], 0.2)).unwrap();
    scene.add_sphere(Sphere::new([0.0, 0.0, 0.0], 0.2).velocity([1.0, 0.0, 0.0])).unwrap();
    recorded(scene, overlay, states)
}

/// The motion of a scene after its first states, which are 0.1 s apart.
fn recorded(scene: Scene, overlay: &Overlay, states: usize) -> Motion {
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap();
    let mut motion = Motion::default();
    motion.want(overlay.needs_places(), overlay.arrows, overlay.trails);
    motion.set_blend(1.0);
    for state in 0..states {
        if state > 0 {
            simulation.run(1, 0.1).unwrap();
        }
        motion.update(&mut simulation).unwrap();
        motion.record();
    }
    motion
}

/// At the distance of the target, 240 pixels are 4 units.
fn camera() -> Camera {
    Camera::new([0.0, 0.0, 2.0 / (0.3_f32).tan()], [0.0; 3])
}

const SIZE: [f32; 2] = [320.0, 240.0];

fn texts(marks: &[Mark]) -> Vec<&str> {
    marks.iter().filter_map(|mark| if let Mark::Text { text, .. } = mark { Some(text.as_str()) } else { None }).collect()
}

#[test]
fn captions_have_the_title_the_time_and_a_round_length() {
    let overlay = Overlay { title: Some("A title".to_owned()), clock: true, scale_bar: true, ..Overlay::default() };
    let marks = overlay.marks(&motion(&overlay, 4), &camera(), SIZE, 11.0);
    assert_eq!(texts(&marks), ["A title", "t = 0.30 s", "1 unit"]);
    let bar = marks.iter().find_map(|mark| if let Mark::Line { ends, .. } = mark { Some(ends) } else { None }).unwrap();
    assert!((bar[1][0] - bar[0][0] - 60.0).abs() < 1e-3, "{bar:?}");
    let dark = Overlay { dark: true, ..overlay.clone() }.marks(&motion(&overlay, 4), &camera(), SIZE, 11.0);
    let is_light = |mark: &Mark| matches!(mark, Mark::Line { colour, .. } if *colour == LIGHT);
    assert_eq!([&marks, &dark].map(|marks| marks.iter().filter(|mark| is_light(mark)).count()), [0, 3]);
    assert_eq!([0.7, 1.0, 3.9, 51.0].map(round_below), [0.5, 1.0, 2.0, 50.0]);
}

#[test]
fn arrows_and_labels_are_at_the_spheres() {
    let overlay = Overlay { labels: true, arrows: Some(Arrows::Velocity), ..Overlay::default() };
    let marks = overlay.marks(&motion(&overlay, 3), &camera(), SIZE, 11.0);
    assert_eq!(texts(&marks), ["0", "1", "1 units/s"]);
    // The ball is at x = 0.2, the arrow is as long as that of the key.
    let heads = |wanted: Rgb| {
        marks.iter().filter_map(move |mark| match mark {
            Mark::Triangle { corners, colour } if *colour == wanted => Some(corners[0]),
            _ => None,
        })
    };
    let tip = heads(ARROW).next();
    // Every arrow has an outline of another colour behind it.
    assert_eq!((heads(ARROW).count(), heads(EDGING).count()), (2, 2));
    let expected = [160.0 + 0.2 * 60.0 + KEY * 240.0, 120.0];
    assert!(tip.unwrap().iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 0.01), "{tip:?}");
}

/// A label that is larger than its ball is above it, so that the ball is seen.
#[test]
fn labels_do_not_cover_small_balls() {
    let overlay = Overlay { labels: true, ..Overlay::default() };
    let label = |em: f32| {
        let marks = overlay.marks(&motion(&overlay, 1), &camera(), SIZE, em);
        let at = marks.iter().find_map(|mark| if let Mark::Text { at, align, .. } = mark { Some((*at, *align)) } else { None });
        (at.unwrap(), marks.iter().any(|mark| matches!(mark, Mark::Line { .. })))
    };
    // The radius of the ball is 12 pixels.
    assert_eq!(label(8.0), (([100.0, 120.0], [0.5, 0.5]), false));
    let (([x, y], align), has_line) = label(24.0);
    assert!(has_line && align == [0.5, 1.0] && x == 100.0 && y < 120.0 - 12.0 - 10.0, "{x} {y}");
}

#[test]
fn a_trail_has_the_colour_of_its_sphere_and_labels_replace_numbers() {
    let overlay = Overlay { labels: true, trails: 1.0, ..Overlay::default() };
    let text = "set gravity 0\n@colour #102030\n@label ball\nS 7 0 0 0 1 0 0 0 0 0 1 0.2\n@colour -\n@label -\n\
                S 8 0 1 0 1 0 0 0 0 0 1 0.2\n";
    let scene = Scene::parse(text, std::path::Path::new("test")).unwrap().scene;
    let motion = recorded(scene, &overlay, 2);
    let marks = overlay.marks(&motion, &camera(), SIZE, 11.0);
    let colours = marks.iter().filter_map(|mark| match mark {
        Mark::Line { colour, .. } if *colour != DARK => Some(*colour),
        _ => None,
    });
    assert_eq!(colours.collect::<Vec<_>>(), [[0x10, 0x20, 0x30], TRAIL]);
    assert_eq!(texts(&marks), ["ball"]);
}

#[test]
fn gravity_pulls_bodies_that_are_not_fixed() {
    let overlay = Overlay { arrows: Some(Arrows::Gravity), ..Overlay::default() };
    let mut scene = Scene::new();
    scene.settings.gravity = 10.0;
    scene.add_sphere(Sphere::new([0.0; 3], 0.2).mass(3.0)).unwrap();
    scene.add_sphere(Sphere::new([1.0; 3], 0.2).mass(3.0).fixed()).unwrap();
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap();
    let mut motion = Motion::default();
    motion.want(overlay.needs_places(), overlay.arrows, 0.0);
    motion.update(&mut simulation).unwrap();
    assert_eq!(motion.arrows().map(|(_, arrow)| arrow).collect::<Vec<_>>(), [Vec3::new(0.0, -30.0, 0.0), Vec3::ZERO]);
}

#[test]
fn trails_are_as_long_as_their_time() {
    let overlay = Overlay { trails: 0.25, ..Overlay::default() };
    let marks = overlay.marks(&motion(&overlay, 9), &camera(), SIZE, 11.0);
    let lines: Vec<_> =
        marks.iter().filter_map(|mark| if let Mark::Line { ends, .. } = mark { Some(ends) } else { None }).collect();
    // Three steps of 0.1 s, of the ball that moves.
    assert_eq!(lines.len(), 3);
    assert!((lines[2][1][0] - 160.0 - 0.8 * 60.0).abs() < 0.01, "{lines:?}");
}

#[test]
fn marks_change_the_pixels_where_they_are() {
    let overlay = Overlay { title: Some("Title".to_owned()), arrows: Some(Arrows::Velocity), ..Overlay::default() };
    let mut picture = Picture { width: 320, height: 240, pixels: vec![[90, 90, 90, 255]; 320 * 240] };
    overlay.draw(&motion(&overlay, 1), &camera(), &mut picture).unwrap();
    let at = |x: usize, y: usize| picture.pixels[y * 320 + x];
    // The outline lightens the shaft. The head has the colour of the arrow alone.
    for (x, most_blue) in [(165, 100), (183, 60)] {
        let [red, _, blue, _] = at(x, 120);
        assert!(red > 150 && blue < most_blue, "{x}: {red} {blue}");
    }
    assert_eq!(at(165, 140), [90, 90, 90, 255]);
    assert!(at(11, 16)[0] > 150);
}

#[test]
fn letters_without_a_shape_are_found() {
    let mut scene = Scene::new();
    let ball = scene.add_sphere(Sphere::new([0.0; 3], 0.5)).unwrap();
    scene.set_tag(ball, rockfall::Tag::new().label("球 m₁")).unwrap();
    let mut overlay = Overlay { title: Some("Größe λ, Шар: x² ≤ 3 日本日".to_owned()), ..Overlay::default() };
    assert_eq!(overlay.missing_letters(&scene), ['日', '本']);
    overlay.labels = true;
    assert!(overlay.missing_letters(&scene).contains(&'球'));
    let expected = "the built-in font lacks the letters 日本球, which are drawn as boxes";
    assert_eq!(overlay.warning_of_letters(&scene).as_deref(), Some(expected));
    overlay.title = Some(('\u{4e00}'..).take(30).collect());
    assert!(overlay.warning_of_letters(&scene).unwrap().contains(" and others, "));
    overlay.title = None;
    assert_eq!(Overlay::default().missing_letters(&scene), []);
}

#[test]
fn a_long_title_is_wrapped_beside_the_clock() {
    let title =
        "A long title that says what the film is about, which bodies it shows, how slow it is, and what to look at in it";
    let overlay = Overlay { title: Some(title.to_owned()), clock: true, ..Overlay::default() };
    for size in [[640.0, 360.0], [1280.0, 720.0], [400.0, 300.0]] {
        let em = letters(size[1] as u32);
        let marks = overlay.marks(&motion(&overlay, 1), &camera(), size, em);
        let lines = marks.iter().filter_map(|mark| match mark {
            Mark::Text { text, at, em, align: [0.0, 0.0], .. } => Some((text.as_str(), at[1], at[0] + width_of(text, *em))),
            _ => None,
        });
        let lines: Vec<_> = lines.collect();
        assert_eq!(lines.iter().map(|(text, ..)| *text).collect::<Vec<_>>().join(" "), title);
        let clock = size[0] - EDGE * em - width_of("t = 0.00 s", em);
        assert!(lines.len() > 1 && lines.iter().all(|(.., right)| *right < clock - 0.5 * em), "{lines:?} {clock}");
        assert!(lines.windows(2).all(|pair| pair[1].1 > pair[0].1 + 0.7 * em), "{lines:?}");
        let room = overlay.room_above(size.map(|side| side as u32));
        assert!(room * size[1] > lines[lines.len() - 1].1 + 0.7 * em, "{room} {lines:?}");
    }
    // A title that is a little too long for one line has smaller letters, and no second line with a single word.
    let longer = Overlay { title: Some("A title that needs a little more than the width".to_owned()), ..overlay.clone() };
    assert!(matches!(longer.title_lines(390.0, 14.0), (lines, letters) if lines.len() == 1 && letters == 14.0), "{longer:?}");
    let short = Overlay { title: Some("Short".to_owned()), ..overlay };
    assert_eq!(short.title_lines(640.0, 10.0), (vec!["Short".to_owned()], 12.0));
}

#[test]
fn trails_may_be_those_of_some_bodies() {
    assert_eq!(trails_of("2"), Ok((2.0, vec![])));
    assert_eq!(trails_of("0.5:left, 3"), Ok((0.5, vec!["left".to_owned(), "3".to_owned()])));
    for (wrong, expected) in [("0", "greater than 0"), ("x:left", "number of seconds"), ("2:", "names or numbers")] {
        assert!(trails_of(wrong).unwrap_err().contains(expected), "{wrong}");
    }
    let text = "set gravity 0\n@name left\n@colour red\nS 7 0 0 0 1 0 0 0 0 0 1 0.2\n@name -\n@colour blue\n\
                S 8 0 1 0 1 0 0 0 0 0 1 0.2\n";
    let scene = Scene::parse(text, std::path::Path::new("test")).unwrap().scene;
    let motion = recorded(scene, &Overlay { trails: 1.0, ..Overlay::default() }, 2);
    for (names, colours) in [(&[][..], 2), (&["left"], 1), (&["8"], 1), (&["left", "8"], 2), (&["right"], 0)] {
        let trails_of = names.iter().map(|name: &&str| (*name).to_owned()).collect();
        let overlay = Overlay { trails: 1.0, trails_of, ..Overlay::default() };
        assert_eq!(overlay.marks(&motion, &camera(), SIZE, 11.0).len(), colours, "{names:?}");
        assert!(motion.past(&overlay.trails_of).all(|bodies| bodies.count() == colours));
    }
}

#[test]
fn a_legend_is_where_it_covers_no_body() {
    let legend = Legend::scale("speed", [0.0, 2.0]);
    let corner = |overlay: &Overlay, balls: &[[f32; 2]]| {
        let mut scene = Scene::new();
        for [x, y] in balls {
            scene.add_sphere(Sphere::new([*x, *y, 0.0], 0.2)).unwrap();
        }
        overlay.corner(&legend, &Survey::new(&scene), &camera(), SIZE.map(|side| side as u32))
    };
    let plain = Overlay::default();
    assert_eq!(corner(&plain, &[[0.0, 0.0]]), Corner::default());
    let right = Corner { right: true, below: None };
    assert_eq!(corner(&plain, &[[-2.0, -1.7]]), right);
    let keys = Overlay { scale_bar: true, title: Some("title".to_owned()), ..Overlay::default() };
    let found = corner(&keys, &[[-2.0, -1.7]]);
    assert!(!found.right && found.below.unwrap() > 0.05, "{found:?}");
}
