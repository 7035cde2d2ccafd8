//! Warnings of `run` and `check`: unstable steps, growing energy, overlaps, places of bodies.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::common::Rockfall;

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.is_file());
    paths.sort();
    paths
}

fn scene(name: &str) -> String {
    scenes().into_iter().find(|path| path.ends_with(name)).unwrap().display().to_string()
}

/// Ten balls of a radius of 0.05 that fall on a floor with walls, in SI units.
fn ten_balls() -> String {
    let mut text = "set gravity 9.81\nB -1 -1 -1 2 0 0 0 1 0 0 0 2\n".to_owned();
    for ball in 0..10 {
        text += &format!("S {ball} {} 0.2 0 0 0 0 0 0 0 1 0.05\n", 0.15 * f64::from(ball) - 0.7);
    }
    text
}

/// A grain that goes through a soft floor: the run names it at its end, and a slower one is not named.
#[test]
fn run_warns_of_spheres_that_passed_a_wall() {
    let text = |speed: f32| {
        format!(
            "set contact_law hertz-mindlin\nset gravity 9.81\n@material p density=2500 young=1e7 poisson=0.2\n\
             @pair p p restitution=0.8 friction=0.4\n@use p\n@triangle -0.1 0 -0.1  0.2 0 0  0.2 0 0.2\n\
             @triangle -0.1 0 -0.1  0.2 0 0.2  0 0 0.2\nS 1 0.01 0.003 0.013 0 -{speed} 0 0 0 0 - 0.002\n"
        )
    };
    let warning = "warning: scene.txt: the centre of a sphere passed a polygon, triangle or plane once, first that of sphere 1";
    let rockfall = Rockfall::with(&text(60.0));
    let (out, err) = rockfall.run("run scene.txt --backend cpu --dt 1e-6 --steps 200", 0);
    assert!(err.contains(warning) && err.contains(" in step ") && err.contains("smaller dt, a stiffer contact law"), "{err}");
    assert!(out.contains("passages    1 through"), "{out}");
    let (out, _) = rockfall.run("run scene.txt --backend cpu --dt 1e-6 --steps 200 --json", 0);
    assert!(out.contains("\"passages\":1,"), "{out}");
    let (out, err) = Rockfall::with(&text(1.0)).run("run scene.txt --backend cpu --dt 1e-6 --steps 2000", 0);
    assert!(!err.contains("passed") && !out.contains("passages"), "{out}{err}");
}

#[test]
fn run_warns_of_an_unstable_step_and_of_energy_that_grew() {
    let rockfall = Rockfall::with("");
    let bridge = scene("bridge.txt");
    let (_, err) = rockfall.run(&format!("run {bridge} --backend cpu --dt 0.1 --steps 200"), 0);
    assert!(err.contains("the contact force is too stiff for the time step"), "{err}");
    assert!(err.contains("the energy grew by ") && err.contains("units²/s²"), "{err}");
    // The first warning comes before the run starts, also if the run fails or is ended.
    let (_, err) = rockfall.run(&format!("run {bridge} --backend cpu --dt 1 --steps 0"), 0);
    assert!(err.contains("too stiff") && !err.contains("grew"), "{err}");
    let (_, err) = rockfall.run(&format!("run {bridge} --backend cpu --steps 200"), 0);
    assert_eq!(err, "");
}

/// Causes of growing energy: moving surfaces and walls, external forces, a restitution above 1.
#[test]
fn energy_may_grow_with_a_cause() {
    let ball = "set gravity 0\nS 1 0 0 0 0 0 0 0 0 0 1 0.1\n";
    let plate = "@motion up velocity=0,1,0\n@move up\nB -1 -0.4 -1 2 0 0 0 0.3 0 0 0 2\n";
    for cause in ["@force 1 1 0 0\n", "S 2 0 -0.19 0 1 0 0 0 0 0 1 0.1 1\n", plate] {
        let rockfall = Rockfall::with(&format!("{ball}{cause}"));
        let (out, err) = rockfall.run("run scene.txt --backend cpu --steps 100", 0);
        assert!(out.contains("energy") && !err.contains("grew"), "{cause}: {err}");
    }
}

/// With symplectic Euler and collisions, the energy at the start depends on the time step. It was that of 0.02 s.
#[test]
fn the_energy_at_the_start_is_that_of_the_time_step() {
    let stretched = |stiffness| format!("set gravity 0\nS 1 0.1 0 0 0 0 0 0 0 0 1 0.01\nT 1 0 0 0 {stiffness} 0 0\n");
    let rockfall = Rockfall::with(&stretched(10_000));
    let options = "--backend cpu --integrator symplectic-euler --steps 10 --json --trace trace.csv";
    let starts_with = |arguments: &str, expected: f64| {
        let (out, _) = rockfall.run(&format!("run {arguments} {options}"), 0);
        let object: serde_json::Value = serde_json::from_str(&out).unwrap();
        let total = object["energy_start"]["total"].as_f64().unwrap();
        assert!((total - expected).abs() < 5e-4, "{arguments}: {total}");
        let trace = rockfall.read("trace.csv");
        let energies = trace.lines().nth(1).unwrap().split(',').skip(2).take(4);
        let traced: f64 = energies.map(|energy| energy.parse::<f64>().unwrap()).sum();
        assert!((traced - expected).abs() < 5e-4, "{arguments}: {trace}");
        object["energy_end"]["total"].as_f64().unwrap()
    };
    let end = starts_with("scene.txt --dt 1e-4 --save saved.txt", 50.001_25);
    starts_with("saved.txt --dt 1e-4", end);
    starts_with("scene.txt --dt 4e-4 --substeps 4", 50.001_25);
    // The state is stable, and its energy stays within 3 %.
    let rockfall = Rockfall::with(&stretched(100));
    rockfall.run("run scene.txt --backend cpu --integrator symplectic-euler --dt 0.08 --steps 1000 --strict", 0);
}

#[test]
fn no_scene_of_the_project_warns_during_its_default_run() {
    let rockfall = Rockfall::with("");
    for path in scenes() {
        let (out, err) = rockfall.run(&format!("run {} --backend cpu", path.display()), 0);
        assert!(out.contains(" radii between bodies at rest"), "{out}");
        // A slow machine sees the progress of a long run.
        let said: Vec<&str> = err.lines().filter(|line| !line.ends_with(" steps")).collect();
        assert!(said.is_empty(), "{}: {said:?}", path.display());
    }
}

/// Every kind, from 100 to 1,000 spheres, and the kinds that press most with 5,000.
#[test]
fn generated_scenes_rest_with_small_overlaps() {
    let all = ["pile", "mixed", "soft", "chain", "hopper"].into_iter().flat_map(|kind| [(kind, 100), (kind, 1000)]);
    for (kind, spheres) in all.chain([("hopper", 5000), ("soft", 5000)]) {
        let rockfall = Rockfall::with("");
        rockfall.run(&format!("generate {kind} --spheres {spheres} --out {kind}.txt"), 0);
        let (out, _) = rockfall.run(&format!("check {kind}.txt"), 0);
        assert!(!out.contains("warning"), "{kind} {spheres}: {out}");
        let (_, err) = rockfall.run(&format!("run {kind}.txt --backend cpu --steps 1000"), 0);
        assert!(!err.contains("warning"), "{kind} {spheres}: {err}");
    }
}

#[test]
fn sinking_bodies_are_reported_in_radii_with_constants_that_help() {
    let rockfall = Rockfall::with(&ten_balls());
    let (out, err) = rockfall.run("run scene.txt --backend cpu", 0);
    assert!(out.contains("; 0.1962 radii between bodies at rest"), "{out}");
    let end = err.lines().last().unwrap();
    assert!(end.contains("at step 1000 sphere ") && end.contains(" overlap by 0.196 radii of the smaller one"), "{err}");
    assert!(end.contains("`set resting_overlap 0.02` chooses a contact_force of "), "{err}");
    let (out, _) = rockfall.run("check scene.txt", 0);
    let suggestion = out.lines().find(|line| line.starts_with("suggestion: ")).unwrap();
    let options: Vec<&str> =
        suggestion.split(' ').filter(|word| ["--", "0.0", "resting_"].iter().any(|begin| word.starts_with(begin))).collect();
    let (_, err) = rockfall.run(&format!("run scene.txt --backend cpu --steps 2000 {}", options.join(" ")), 0);
    assert_eq!(err, "", "{suggestion}");
}

/// The advice does not name what the scene has, and no constants that are softer than those in use.
#[test]
fn overlaps_have_no_advice_that_the_scene_follows() {
    // A ball at rest in another one, which a fixed ball holds down.
    let pressed = "set collisions off\nset gravity 1\nS 1 0 0 0 0 0 0 0 0 0 1 0.5 1\nS 2 0 0.8 0 0 0 0 0 0 0 1 0.5\nS 3 0 1.6 0 0 0 0 0 0 0 1 0.5 1\n";
    for settings in ["set resting_overlap 0.02", "set contact_force 100000"] {
        let (_, err) =
            Rockfall::with(&format!("{settings}\n{pressed}")).run("run scene.txt --backend cpu --dt 0.001 --steps 10", 0);
        assert!(err.contains(": at step 10 sphere ") && !err.contains("chooses a contact_force"), "{err}");
    }
}

#[test]
fn check_estimates_the_overlap_below_a_pile() {
    // A column between a floor and a wall stays one: on a floor alone it would become a heap.
    let mut text = "B -0.5 -1 -0.5 1 0 0 0 1 0 0 0 1\nB -1.5 0 -0.5 1 0 0 0 30 0 0 0 1\n".to_owned();
    for ball in 0..100 {
        text += &format!("S {ball} 0 {} 0 0 0 0 0 0 0 1 0.1\n", 0.1 + 0.21 * f64::from(ball));
    }
    let (out, _) = Rockfall::with(&text).run("check scene.txt", 0);
    assert!(out.contains("bodies below others carry about 100 times their weight and overlap by about 0.2 units"), "{out}");
}

#[test]
fn check_finds_bodies_inside_others_and_names_them() {
    let text = "set gravity 0\nB 0 0 0 1 0 0 0 1 0 0 0 1\nS 7 5 0 0 0 0 0 0 0 0 1 0.2\nS 8 5 0 0 0 0 0 0 0 0 1 0.2\n\
                S 9 0.5 0.7 0.5 0 0 0 0 0 0 1 0.1\nS 10 0.5 1.05 0.5 0 0 0 0 0 0 1 0.1\nS 11 0.2 1.099 0.2 0 0 0 0 0 0 1 0.1\n\
                C 9 0 0 10 0 0 0 0 0 1 0.2\nS 12 10.3 0 0 0 0 0 0 0 0 1 0.2\n";
    let (out, _) = Rockfall::with(text).run("check scene.txt", 0);
    for line in [
        "warning: scene.txt: sphere 7 and sphere 8 have the same centre at the start",
        "warning: scene.txt: sphere 9 has its centre or axis inside box number 0, 4 radii (0.4 units) at the start",
        "warning: scene.txt: sphere 10 and box number 0 overlap by 0.5 radii (0.05 units) at the start",
        "warning: scene.txt: capsule number 0 and sphere 12 overlap by 0.5 radii (0.1 units) at the start",
        "deepest overlap at the start: 4 radii of the smaller body",
    ] {
        assert!(out.lines().any(|printed| printed == line), "{line}\n{out}");
    }
    assert!(!out.contains("sphere 11") && !out.contains("fall for ever"), "{out}");
}

#[test]
fn check_finds_bodies_that_fall_for_ever() {
    let floor = "B -5 -1 -5 10 0 0 0 1 0 0 0 10\n";
    let falling = |text: &str| {
        let (out, _) = Rockfall::with(text).run("check scene.txt", 0);
        let lines = out.lines().filter(|line| line.contains("will fall for ever")).map(|line| line.split(' ').nth(3).unwrap());
        lines.map(str::to_owned).collect::<Vec<String>>()
    };
    let ball = |number: u32, x: f32, y: f32, vx: f32| format!("S {number} {x} {y} 0 {vx} 0 0 0 0 0 1 0.5\n");
    assert_eq!(falling(&(floor.to_owned() + &ball(1, 0.0, 1.0, 0.0) + &ball(2, 8.0, 1.0, 0.0))), ["2"]);
    assert_eq!(falling(&ball(3, 0.0, 0.0, 0.0)), ["3"]);
    // Below the floor; on its way to the floor; away from it; upwards past it.
    assert_eq!(falling(&(floor.to_owned() + &ball(4, 0.0, -5.0, 0.0))), ["4"]);
    assert!(falling(&(floor.to_owned() + &ball(5, -8.0, 1.0, 2.0))).is_empty());
    assert_eq!(falling(&(floor.to_owned() + &ball(6, -8.0, 1.0, -2.0))), ["6"]);
    // Hung on a spring, a tether or a rod; lying on one that is caught; without gravity.
    for held in ["S 9 0 9 0 0 0 0 0 0 0 1 0.5 1\nK 1 9 10 1 0\n", "T 1 0 9 0 10 1 0\n", "@force 1 0 1 0\n", "set gravity 0\n"] {
        assert!(falling(&(ball(1, 0.0, 1.0, 0.0) + held)).is_empty(), "{held}");
    }
    assert!(falling(&(floor.to_owned() + &ball(1, 5.4, 0.5, 0.0) + &ball(2, 6.2, 1.5, 0.0))).is_empty());
    let side = "set gravity_direction 1 0 0\n".to_owned() + floor;
    assert_eq!(falling(&(side + &ball(1, 0.0, 1.0, 0.0))), ["1"]);
}

#[test]
fn check_warns_where_positions_are_coarse() {
    let scene = |x: f64| Rockfall::with(&format!("set gravity 0\nset precision single\nS 1 {x} 0 0 0 0 0 0 0 0 1 0.1\n"));
    let (out, _) = scene(5000.0).run("check scene.txt", 0);
    assert!(!out.contains("warning"), "{out}");
    let (out, _) = scene(100_000.0).run("check scene.txt", 0);
    assert!(out.contains("f32 resolves 0.00781 units, 7.81 % of the radius 0.1 units of sphere 1"), "{out}");
}

/// Grains of 1 mm and 1 GPa at 10 m from the origin overlap at rest by 0.035 µm under their own weight. f32 numbers are 0.95 µm apart
/// there, which is 0.1 % of the radius.
#[test]
fn check_warns_where_positions_are_coarser_than_overlaps_at_rest() {
    let check = |x: f64, more: &str| {
        let text = format!(
            "set contact_law hertz-mindlin\nset gravity 9.81\n{more}@material m density=2500 young=1e9 poisson=0.25\n\
             @use m\nB {} -1 -1 2 0 0 0 1 0 0 0 2\nS 1 {x} 0.001 0 0 0 0 0 0 0 - 0.001\n",
            x - 1.0
        );
        Rockfall::with(&text).run("check scene.txt --integrator symplectic-euler --dt 1e-7", 0).0
    };
    let out = check(10.0, "set precision single\n");
    let expected = "positions are too coarse: 10 units from the origin, f32 resolves 9.54e-7 units, too much for the overlap of \
                    3.47e-8 units of sphere 1 at rest on one like it, under its own weight alone (contact law hertz-mindlin)";
    assert!(out.contains(expected) && out.contains(", or set precision double"), "{out}");
    assert!(!check(10.0, "set precision double\n").contains("coarse"));
    assert!(!check(0.2, "set precision single\n").contains("coarse"));
    // By default it is chosen.
    let chosen = "precision double, because grains creep where rounding moves the springs of this contact law";
    let out = check(0.2, "");
    assert!(out.contains(chosen) && !out.contains("coarse"), "{out}");
    let text = "set contact_force 1e7\nB 100 -1 -1 2 0 0 0 1 0 0 0 2\nS 1 101 0.1 0 0 0 0 0 0 0 1 0.1\n";
    let out = Rockfall::with(text).run("check scene.txt", 0).0;
    let chosen = "precision double, because f32 resolves 7.63e-6 units at 102 units from the origin, and an overlap at rest is 1e-7 units";
    assert!(out.contains(chosen) && !out.contains("coarse"), "{out}");
}

#[test]
fn check_of_a_hundred_thousand_spheres_is_fast() {
    let rockfall = Rockfall::with("");
    rockfall.run("generate pile --spheres 100000 --out pile.txt", 0);
    let start = Instant::now();
    let (out, _) = rockfall.run("check pile.txt", 0);
    assert!(out.contains("no overlaps at the start"), "{out}");
    // 1 s on an idle machine.
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

/// A scene cannot define the law `user`. `check` claims nothing about its time step, and `run` refuses the scene.
#[test]
fn scene_with_the_law_of_a_program_is_not_run() {
    let rockfall = Rockfall::with("set contact_law user\nS 1 0 9 0 0 0 0 0 0 0 1 0.5\n");
    let (out, err) = rockfall.run("check scene.txt --integrator symplectic-euler", 2);
    assert!(err.contains("contact law user: a program defines this law") && !out.contains("stable at"), "{out} {err}");
    let (_, err) = rockfall.run("run scene.txt --integrator symplectic-euler --backend cpu --steps 1", 2);
    assert!(err.contains("a law of the program: Options::contact_force_law, in Python Simulation(contact_law=...)"), "{err}");
}

/// A contact law with history reports the time that bounds the time step, and what the scene or the run lacks for it. With
/// sqrt(rho / G) = sqrt(2500 / (5e10 / 2.4)) the Rayleigh time is pi 0.01 sqrt(rho / G) / (0.1631 * 0.2 + 0.8766) = 1.197e-5 s.
#[test]
fn contact_laws_report_their_time_and_what_they_lack() {
    let text = "set contact_law hertz-mindlin\n@material glass density=2500 young=5e10 poisson=0.2\n@pair glass glass friction=0.3\n@use glass\n\
                B -1 -1 -1 2 0 0 0 1 0 0 0 2\nS 1 0 0.0101 0 0 -0.5 0 0 0 0 - 0.01\n";
    let rockfall = Rockfall::with(text);
    let (out, _) = rockfall.run("check scene.txt --integrator symplectic-euler --dt 1e-6", 0);
    assert!(out.contains("the shortest Rayleigh time is 1.2e-5 s, that of sphere 1"), "{out}");
    assert!(out.contains("8.35 % of it") && out.contains("stable at a time step"), "{out}");
    // 2.87 (m*² / (R* E*² u))^(1/5) of two such spheres, at sqrt(0.5² + 2 G h) with the fall through h = 1e-4.
    assert!(out.contains("the shortest time of an impact at 0.5 units/s is 7.94e-5 s, that of sphere 1"), "{out}");
    assert!(out.contains("(79.4 steps per impact), at most 3.96e-6 s is advised"), "{out}");
    let (out, _) = rockfall.run("check scene.txt --integrator symplectic-euler --dt 1e-4", 0);
    assert!(
        out.contains("warning: ") && out.contains("the time step is 1.26 times as long, at most 3.96e-6 s is advised"),
        "{out}"
    );
    assert!(out.contains("at most 2.39e-6 s is advised") && !out.contains("stable at"), "{out}");
    let suggested = out.lines().find_map(|line| line.strip_prefix("suggestion: --dt ")).unwrap();
    let (time_step, _) = suggested.split_once(' ').unwrap();
    let (out, _) = rockfall.run(&format!("check scene.txt --integrator symplectic-euler --dt {time_step}"), 0);
    assert!(out.contains("stable at a time step") && !out.contains("suggestion"), "{time_step}: {out}");
    let (out, err) = rockfall.run("check scene.txt --integrator rk4 --dt 1e-6", 2);
    assert!(err.contains("symplectic-euler or velocity-verlet: the law keeps a tangential spring"), "{err}");
    assert!(!out.contains("stable at"), "{out}");
    let (out, _) = rockfall.run("check scene.txt --dt 1e-6", 0);
    assert!(out.contains("stable at a time step of 1e-6 s (velocity-verlet)"), "{out}");
    let run =
        "run scene.txt --backend cpu --integrator symplectic-euler --dt 1e-6 --steps 300 --contacts contacts.csv --every 300";
    let (_, err) = rockfall.run(run, 0);
    assert!(!err.contains("warning"), "{err}");
}

/// `--substeps auto` divides the step until no warning about the time of the contact law is left. Messages name spheres by the numbers
/// of the scene file, and print powers of ten.
#[test]
fn substeps_auto_obeys_the_time_of_the_contact_law() {
    let text = "set contact_law hertz-mindlin\nset gravity 9.81\n@material g density=2500 young=1e8 poisson=0.25\n\
                @pair g g restitution=0.5 friction=0.3\n@use g\nB -1 -1 -1 2 0 0 0 1 0 0 0 2\n\
                S 7 0 0.02 0 0 0 0 0 0 0 - 0.01\n";
    let rockfall = Rockfall::with(text);
    let run = "run scene.txt --backend cpu --integrator velocity-verlet --steps 20 --json";
    let (_, err) = rockfall.run(run, 0);
    assert!(err.contains("that of sphere 7; the time step is 73.9 times") && !err.contains("sphere 0"), "{err}");
    let (out, err) = rockfall.run(&format!("{run} --substeps auto"), 0);
    assert!(!err.contains("warning"), "{err}");
    let object: serde_json::Value = serde_json::from_str(&out).unwrap();
    let [start, end] = ["energy_start", "energy_end"].map(|key| object[key]["total"].as_f64().unwrap());
    assert!(end < 1.001 * start && end > 0.3 * start, "{start} {end}");
    let parts = object["substeps"].as_u64().unwrap();
    let (out, _) = rockfall.run("check scene.txt --integrator velocity-verlet", 0);
    assert!(out.contains(&format!("rockfall run --substeps {parts} makes the time step short enough")), "{parts}: {out}");
    // One part less is too few.
    let fewer = 0.02 / (parts - 1) as f64;
    let (out, _) = rockfall.run(&format!("check scene.txt --integrator velocity-verlet --dt {fewer}"), 0);
    assert!(out.contains("advised") && out.contains("warning"), "{out}");
}

/// Numbers in messages and summaries have few digits, with a power of ten where they are small or large.
#[test]
fn numbers_are_short() {
    let text = "set contact_law hertz-mindlin\nset gravity 9.81\nset precision double\n\
                @material glass density=2500 young=6.3e10 poisson=0.24\n@use glass\n\
                B -1 -1 -1 2 0 0 0 1 0 0 0 2\nS 5 0 0.0005 0 0 0 0 0 0 0 - 0.0005\n";
    let rockfall = Rockfall::with(text);
    let (out, _) = rockfall.run("run scene.txt --backend cpu --integrator velocity-verlet --steps 5 --dt 2e-8", 0);
    assert!(out.contains("5 of 2e-8 s = 1e-7 s, done in ") && !out.contains(" 0.0 times"), "{out}");
    let (out, _) = rockfall.run("check scene.txt --integrator velocity-verlet --set gravity=1e30", 0);
    let longest = |text: &str| text.split(|c: char| !c.is_ascii_digit() && c != '.').map(str::len).max();
    // Settings are shown as they are written.
    let mut messages = out.lines().filter(|line| line.starts_with("warning") || line.starts_with("suggestion"));
    assert!(messages.all(|line| longest(line) <= Some(6)), "{out}");
}

/// A text leaves out the springs of contacts, which is said only where there are some.
#[test]
fn saving_a_text_says_that_it_leaves_out_springs() {
    let text = "set contact_law linear\nset gravity 9.81\n@material m density=2500\n@pair m m stiffness=1e5 friction=0\n@use m\n\
                B -1 -1 -1 2 0 0 0 1 0 0 0 2\nS 1 0 0.00999 0 0 0 0 0 0 0 - 0.01\nS 2 0 0.05 0 0 0 0 0 0 0 - 0.01\n";
    let rockfall = Rockfall::with(text);
    let run = "run scene.txt --backend cpu --integrator velocity-verlet --dt 1e-5 --steps 20";
    let (_, err) = rockfall.run(&format!("{run} --save saved.txt"), 0);
    assert!(err.contains("note: saved.txt: a scene text leaves out the springs of 1 contact, "), "{err}");
    assert_eq!(err.lines().count(), 1, "{err}");
    let (_, err) = rockfall.run(&format!("{run} --checkpoint saved.ckpt"), 0);
    assert_eq!(err, "");
    let (_, err) = rockfall.run(&format!("{run} --save saved.txt --set gravity=-1e4"), 0);
    assert!(!err.contains("springs"), "{err}");
}
