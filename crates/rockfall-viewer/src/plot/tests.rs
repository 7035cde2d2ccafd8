use std::path::Path;

use rockfall::{Backend, Options};

use super::*;
use crate::overlay::Mark;
use crate::pixels::Picture;

fn scene(text: &str) -> Scene {
    Scene::parse(text, Path::new("test")).unwrap().scene
}

#[test]
fn plots_say_what_they_expect() {
    let wrong = |text: &str| Plot::parse(text).unwrap_err();
    let known =
        "expected one of: energy, kinetic, potential, momentum, contacts, x, y, z, height, speed, vx, vy, vz, gauge, joint";
    assert!(wrong("hight:1").contains(known), "{}", wrong("hight:1"));
    assert!(wrong("height").contains("expected names or numbers of bodies, as in height:left,right"));
    assert!(wrong("height:").contains("names or numbers") && wrong("height:1,").contains("names or numbers"));
    assert!(wrong("energy:1").contains("expected no bodies"));
    assert!(wrong("gauge").contains("expected names of gauges, as in gauge:weight"));
    assert!(wrong("joint:").contains("expected names or numbers of joints, as in joint:door or joint:door.speed"));
    assert_eq!(wrong("joint:a,b.speed"), "position and speed of joints need a plot each");
    assert!(wrong("joint:1,2,3,4,5,6,7").contains("at most 6 joints, got 7"));
    assert!(wrong("x:1,2,3,4,5,6,7").contains("at most 6 bodies, got 7"));
}

/// Runs a falling ball beside a capsule, with plots of both.
fn fallen(steps: u32, plots: &[&str]) -> Plots {
    let scene = scene("set gravity 10\nS 1 0 9 0 0 0 0 0 0 0 1 0.5\nC 5 2 0 7 4 0 0 0 0 2 0.2\n");
    let spheres: Vec<SphereId> = scene.sphere_ids().collect();
    let find = |text: &String| vec![Body::Sphere(spheres[text.parse::<usize>().unwrap()])];
    let graph = |text: &&str| {
        let plot = Plot::parse(text).unwrap();
        let found: Vec<_> = plot.bodies().iter().map(find).collect();
        plot.of(&scene, &found).unwrap()
    };
    let graphs = plots.iter().map(graph).collect();
    let mut plots = Plots::new(graphs);
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap();
    for step in 0..=steps {
        plots.update(&mut simulation).unwrap();
        plots.record(0.1 * f64::from(step), 0.0);
        simulation.step(0.1).unwrap();
    }
    plots
}

#[test]
fn plots_have_the_values_of_bodies_and_of_the_scene() {
    let plots = fallen(1, &["energy", "height:0,1", "x:2", "speed:0", "vy:0", "kinetic", "potential", "momentum"]);
    let last = |graph, line| plots.points(graph, line).last().unwrap();
    let near = |[time, value]: [f64; 2], expected: f64| time == 0.1 && (value - expected).abs() < 1e-4;
    // No springs and no contacts, so no lines of them.
    let shown: Vec<&str> = plots.lines(0).map(|(_, (name, _))| name.as_str()).collect();
    assert_eq!(shown, ["total", "kinetic", "potential"]);
    // The potential energy is relative to that at the start.
    assert!(near(last(0, 0), 0.0) && near(last(0, 1), 0.5 * 3.0) && near(last(0, 2), -0.5 * 3.0), "{:?}", last(0, 1));
    // The middle of the capsule, whichever end is named.
    assert!(near(last(1, 0), 8.95) && near(last(1, 1), 2.95) && near(last(2, 0), 6.0));
    assert!(near(last(3, 0), 1.0) && near(last(4, 0), -1.0));
    assert!(near(last(5, 0), 0.5 * 3.0) && near(last(6, 0), 10.0 * (8.95 + 2.0 * 2.95)));
    assert!(near(last(7, 0), 0.0) && near(last(7, 1), -3.0), "{:?}", last(7, 1));
}

#[test]
fn lines_have_the_colours_and_names_of_the_bodies() {
    let scene = scene(
        "@colour red\n@name left\nS 1 0 9 0 0 0 0 0 0 0 1 0.5\n@colour -\nS 2 3 9 0 0 0 0 0 0 0 1 0.5\n@name -\n\
         S 3 6 9 0 0 0 0 0 0 0 1 0.5\n@colour #0072b2\nS 4 9 9 0 0 0 0 0 0 0 1 0.5\nS 5 12 9 0 0 0 0 0 0 0 1 0.5\n",
    );
    let found: Vec<Vec<Body>> = scene.sphere_ids().map(|id| vec![Body::Sphere(id)]).collect();
    let graph = Plot::parse("x:1,2,3,4,5").unwrap().of(&scene, &found).unwrap();
    let expected = [
        ("left 1", "red".parse::<rockfall::Colour>().unwrap().0),
        ("left 2", COLOURS[1]),
        ("3", COLOURS[2]),
        ("4", COLOURS[0]),
        ("5", COLOURS[3]),
    ];
    assert_eq!(graph.lines, expected.map(|(name, colour)| (name.to_owned(), colour)));
}

/// A name in a plot means all bodies with it, and a rod by its middle.
#[test]
fn a_name_of_several_bodies_is_all_of_them() {
    let lines = |scene: &Scene, plot: &str| {
        let plot = Plot::parse(plot).unwrap();
        let found: std::result::Result<Vec<_>, _> = plot.bodies().iter().map(|name| bodies_named(scene, name)).collect();
        let mut graph = plot.of(scene, &found?)?;
        let mut simulation = Simulation::with_options(scene.clone(), Options::new().backend(Backend::Cpu)).unwrap();
        let values = graph.values(&mut simulation).unwrap();
        Ok::<_, String>(graph.lines.iter().map(|(name, _)| name.clone()).zip(values).collect::<Vec<_>>())
    };
    let named = |name: &str, value: f64| (name.to_owned(), value);
    let string = scene(
        "@name pair\nS 1 0 9 0 0 0 0 0 0 0 1 0.5\nS 2 0 1 0 0 0 0 0 0 0 1 0.5\n@name string\nR 1 2 0.1\n\
         @name wire\nK 1 2 30 8 0\n",
    );
    let expected = [named("pair 1", 9.0), named("pair 2", 1.0), named("string", 5.0)];
    assert_eq!(lines(&string, "height:pair,string").unwrap(), expected);
    let of_wire = lines(&string, "height:wire");
    assert!(of_wire.as_ref().unwrap_err().contains("only springs and static objects"), "{of_wire:?}");
    let crates = scene(
        "@body crate mass=1\nB -0.3 -0.4 -0.5 0.6 0 0 0 0.8 0 0 0 1\n@end\n\
         @name crates\n@repeat 7 2 0 0\n@place crate at=0,3,5\n@end\n",
    );
    assert_eq!(lines(&crates, "height:crates").unwrap_err(), "expected at most 6 bodies, got 7");
    let few = scene("@body crate mass=1\nB -0.3 -0.4 -0.5 0.6 0 0 0 0.8 0 0 0 1\n@end\n@name crates\n@place crate at=0,3,5\n");
    assert_eq!(lines(&few, "height:crates").unwrap(), [named("crates", 3.0)]);
}

#[test]
fn a_state_between_two_has_a_value_between() {
    let mut plots = fallen(0, &["height:0"]);
    (plots.before, plots.now) = (vec![4.0], vec![2.0]);
    plots.record(0.5, 0.25);
    assert_eq!(plots.points(0, 0).last(), Some([0.5, 2.5]));
    // A run that goes back forgets what came after.
    plots.record(0.2, 0.0);
    assert_eq!(plots.points(0, 0).map(|[time, _]| time).collect::<Vec<_>>(), [0.0, 0.2]);
}

#[test]
fn the_axes_of_a_film_are_those_of_all_of_it() {
    let mut plots = fallen(10, &["height:0"]);
    let whole = plots.range(0);
    assert!(whole[0] < 4.1 && whole[1] > 8.9, "{whole:?}");
    plots.fix([0.0, 1.0]);
    assert_eq!((plots.times(), plots.range(0), plots.points(0, 0).count()), ([0.0, 1.0], whole, 0));
    plots.now = vec![20.0];
    plots.record(0.5, 0.0);
    assert!(plots.range(0)[1] > 20.0, "a value that was not foreseen is in view");
}

/// Number of pixels near a colour in a part of a picture.
fn coloured(picture: &Picture, colour: Rgb, is_there: impl Fn(u32, u32) -> bool) -> usize {
    let near = |pixel: &[u8; 4]| pixel.iter().zip(colour).all(|(a, b)| a.abs_diff(b) < 20);
    let at = |index: usize| (index as u32 % picture.width, index as u32 / picture.width);
    let pixels = picture.pixels.iter().enumerate();
    pixels.filter(|(index, pixel)| near(pixel) && is_there(at(*index).0, at(*index).1)).count()
}

#[test]
fn plots_are_beside_a_wide_picture_and_below_a_high_one() {
    for (size, columns) in [([400, 240], 256), ([240, 400], 240)] {
        let plots = fallen(10, &["height:0,1"]);
        let layout = Layout::new(size, 1);
        let [width, height] = layout.scene();
        assert_eq!(width, columns);
        let scene = Picture { width, height, pixels: vec![[9, 9, 9, 255]; (width * height) as usize] };
        let picture = layout.complete(scene, &plots).unwrap();
        assert_eq!([picture.width, picture.height], size);
        let is_scene = |x: u32, y: u32| x < width && y < height;
        assert_eq!(coloured(&picture, [9; 3], is_scene), (width * height) as usize, "the picture stays as it is");
        assert!(COLOURS[..2].iter().all(|colour| coloured(&picture, *colour, |x, y| !is_scene(x, y)) > 40));
        assert_eq!(coloured(&picture, COLOURS[2], |_, _| true), 0);
    }
    assert_eq!(Layout::new([400, 240], 0).scene(), [400, 240]);
}

/// Below a picture, each of several plots has the whole height, and no text reaches into the next.
#[test]
fn plots_below_a_picture_are_side_by_side() {
    let plots = fallen(10, &["energy", "height:0,1"]);
    let measure = |text: &str, em: f32| 0.55 * em * text.chars().count() as f32;
    let marks = Layout::new([400, 400], 2).marks(&plots, &measure);
    let places = |wanted: &str| -> Vec<[f32; 2]> {
        let place = |mark: &Mark| match mark {
            Mark::Text { text, at, .. } if text == wanted => Some(*at),
            _ => None,
        };
        marks.iter().filter_map(place).collect()
    };
    let axes = places("time in s");
    assert!(axes.len() == 2 && axes[0][1] == axes[1][1] && axes[0][0] < 200.0 && axes[1][0] > 200.0, "{axes:?}");
    assert_eq!(places("potential 0 at the start").len(), 1);
    for mark in &marks {
        if let Mark::Text { text, at, em, .. } = mark {
            let right = at[0] + measure(text, *em);
            assert!(right <= if at[0] < 200.0 { 200.0 } else { 400.0 }, "{text} at {at:?}");
        }
    }
}

#[test]
fn plots_beside_a_dark_picture_are_dark() {
    let plots = fallen(10, &["height:0"]);
    let brightness = |dark: bool| {
        let layout = Layout::new([400, 240], 1).dark(dark);
        let [width, height] = layout.scene();
        let scene = Picture { width, height, pixels: vec![[9, 9, 9, 255]; (width * height) as usize] };
        let picture = layout.complete(scene, &plots).unwrap();
        let right = picture.pixels.chunks(400).flat_map(|row| &row[width as usize..]);
        right.map(|pixel| f32::from(pixel[1])).sum::<f32>() / (240.0 * (400 - width) as f32)
    };
    assert!(brightness(false) > 230.0 && brightness(true) < 60.0, "{} {}", brightness(false), brightness(true));
}

/// The line of a film is as long as the time that has passed.
#[test]
fn lines_grow_with_the_time() {
    let mut plots = fallen(10, &["height:0"]);
    plots.fix([0.0, 1.0]);
    let mut ends = Vec::new();
    for step in 0..=10 {
        plots.now = vec![8.0 - 0.4 * f64::from(step)];
        plots.record(0.1 * f64::from(step), 0.0);
        let layout = Layout::new([600, 300], 1);
        let [width, height] = layout.scene();
        let scene = Picture { width, height, pixels: vec![[9, 9, 9, 255]; (width * height) as usize] };
        let picture = layout.complete(scene, &plots).unwrap();
        // The legend is above the field.
        ends.push((0..600).rev().find(|column| coloured(&picture, COLOURS[0], |x, y| x == *column && y > 60) > 0).unwrap());
    }
    assert!(ends.windows(2).all(|pair| pair[0] + 8 < pair[1]), "{ends:?}");
}

#[test]
fn plots_in_tiny_pictures_are_left_out() {
    let plots = fallen(3, &["energy", "height:0,1"]);
    for size in [[1, 1], [9, 5], [40, 20]] {
        let layout = Layout::new(size, 2);
        let [width, height] = layout.scene();
        let scene = Picture { width, height, pixels: vec![[9, 9, 9, 255]; (width * height) as usize] };
        layout.complete(scene, &plots).unwrap();
    }
}

/// As many plots as a picture has room for have axes, lines and two ticks each, and more are refused.
#[test]
fn plots_that_fit_have_axes() {
    let measure = |text: &str, em: f32| 0.55 * em * text.chars().count() as f32;
    for size in [[640, 360], [1280, 720], [320, 180], [400, 400], [300, 500]] {
        let most = Layout::most_plots(size);
        let plots = fallen(10, &vec!["height:0,1"; most]);
        let marks = Layout::new(size, most).marks(&plots, &measure);
        let axes = marks.iter().filter(|mark| matches!(mark, Mark::Text { text, .. } if text == "time in s")).count();
        assert_eq!(axes, most, "{size:?}");
        assert_eq!(Layout::check(size, most), Ok(()));
    }
    let expected = "5 plots do not fit into a picture of 640x360, expected at most 3";
    assert_eq!(Layout::check([640, 360], 5).unwrap_err(), expected);
}

#[test]
fn gauges_have_the_size_of_the_force() {
    let scene = scene(
        "set gravity 10\n@name floor\nB -9 -1 -9 18 0 0 0 1 0 0 0 18\nS 1 0 0.1 0 0 0 0 0 0 0 3 0.1\n\
         @gauge name=weight wall=floor\n@gauge name=down plane=0,1,0,0,-1,0\n",
    );
    let wrong = |text: &str| Plot::parse(text).unwrap().check_names(&scene).unwrap_err();
    assert_eq!(wrong("gauge:weight,down"), "gauge:down: the gauge of a plane, expected that of a wall");
    assert_eq!(wrong("gauge:a"), "gauge:a: unknown, expected one of weight, down");
    let plot = Plot::parse("gauge:weight").unwrap();
    plot.check_names(&scene).unwrap();
    assert!(plot.bodies().is_empty());
    let mut graph = plot.of(&scene, &[]).unwrap();
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap();
    simulation.run(3000, 0.005).unwrap();
    let values = graph.values(&mut simulation).unwrap();
    assert!(values.len() == 1 && (values[0] - 30.0).abs() < 0.1, "{values:?}");
}

/// A hinge with a motor of 2 rad/s, a slider on which a bar falls with 10 units/s², and a joint that breaks.
const JOINTS: &str = "set contact_law rigid\nset gravity 10\n@body bar mass=2\nB 0 -0.05 -0.05 1 0 0 0 0.1 0 0 0 0.1\n@end\n\
                      @place bar at=0,0,0 name=one\n@place bar at=0,0,5 name=two\n@place bar at=0,0,9 name=three\n\
                      @joint hinge world one at=0,0,0 axis=0,1,0 speed=2 name=motor.0\n\
                      @joint slider world two at=0,0,5 axis=0,-1,0 name=fall\n\
                      @joint fixed world three at=0,0,9 break_force=1 name=weak\n@joint fixed three world at=0,0,9\n";

#[test]
fn joints_are_plotted_in_degrees_or_units() {
    let scene = scene(JOINTS);
    let graph = |text: &str| {
        let plot = Plot::parse(text).unwrap();
        plot.check_names(&scene).and_then(|()| plot.of(&scene, &[]))
    };
    let wrong = |text: &str| graph(text).unwrap_err();
    assert_eq!(wrong("joint:door"), "joint:door: unknown, expected motor.0, fall, weak, or a number from 0 to 3");
    assert_eq!(wrong("joint:4"), "joint:4: unknown, expected motor.0, fall, weak, or a number from 0 to 3");
    assert_eq!(wrong("joint:motor.0,fall"), "joint:fall: units and degrees need a plot each");
    assert_eq!(wrong("joint:3.speed"), "joint:3: a fixed joint has no speed, expected force or torque");
    let none = Plot::parse("joint:a").unwrap().check_names(&Scene::new()).unwrap_err();
    assert_eq!(none, "joint:a: the scene has no joints");

    let texts = [
        "joint:motor.0",
        "joint:fall",
        "joint:motor.0.speed",
        "joint:1.speed",
        "joint:motor.0.force,weak.force",
        "joint:3.torque",
    ];
    let mut graphs = texts.map(|text| graph(text).unwrap());
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap();
    simulation.run(30, 1.0 / 60.0).unwrap();
    let found: Vec<f64> = graphs.iter_mut().flat_map(|graph| graph.values(&mut simulation).unwrap()).collect();
    let near = |place: usize, expected: f64, by: f64| (found[place] - expected).abs() < by;
    assert!(near(0, 1.0_f64.to_degrees(), 0.5) && near(1, 0.5 * 10.0 * 0.25, 0.05), "{found:?}");
    assert!(near(2, 2.0, 0.01) && near(3, 5.0, 0.01) && near(4, (20.0_f64.powi(2) + 4.0_f64.powi(2)).sqrt(), 0.3), "{found:?}");
    // The broken joint, and the whole weight half a unit away.
    assert!(found[5].is_nan() && near(6, 10.0, 0.2), "{found:?}");
    assert_eq!(graphs.map(|graph| graph.unit()), ["degrees", "units", "rad/s", "units/s", "mass units/s²", "mass units²/s²"]);
}
