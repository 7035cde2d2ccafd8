//! How a scene is run: what its line `@run` says, and the integrator that follows from its contact law.

use crate::common::Rockfall;

/// A grain on a floor, with Hertz's law.
const GRAIN: &str = "set contact_law hertz-mindlin\nset gravity 9.81\n@material glass density=2500 young=5e7 poisson=0.2\n\
                     @pair glass glass friction=0.3\n@use glass\nB -1 -1 -1 2 0 0 0 1 0 0 0 2\n\
                     S 1 0 0.0101 0 0 -0.5 0 0 0 0 - 0.01\n";

/// Scenes with a law that does not allow rk4 run without an option. The summary says what was chosen.
#[test]
fn the_integrator_follows_the_contact_law() {
    let rockfall = Rockfall::with(GRAIN);
    let run = "run scene.txt --backend cpu --dt 1e-5 --steps 5";
    let (out, _) = rockfall.run(run, 0);
    assert!(out.contains("integrator  velocity-verlet\n"), "{out}");
    let (out, _) = rockfall.run(&format!("{run} --integrator symplectic-euler"), 0);
    assert!(out.contains("integrator  symplectic-euler\n"), "{out}");
    let (out, _) = rockfall.run(&format!("{run} --set contact_law=thesis"), 0);
    assert!(out.contains("integrator  rk4\n"), "{out}");
    let (_, err) = rockfall.run(&format!("{run} --integrator rk4"), 2);
    assert!(err.contains("hertz-mindlin with the integrator rk4"), "{err}");
    let (out, _) = rockfall.run("check scene.txt --dt 1e-5", 0);
    assert!(out.contains("stable at a time step of 1e-5 s (velocity-verlet)"), "{out}");
}

/// A checkpoint has the integrator that was chosen. `auto` chooses again.
#[test]
fn a_resumed_run_keeps_the_integrator() {
    let rockfall = Rockfall::with(GRAIN);
    rockfall.run("run scene.txt --backend cpu --dt 1e-5 --steps 5 --integrator symplectic-euler --checkpoint a.ckpt", 0);
    let (out, _) = rockfall.run("run --resume a.ckpt --steps 8", 0);
    assert!(out.contains("integrator  symplectic-euler\n"), "{out}");
    let (_, err) = rockfall.run("run --resume a.ckpt --steps 10 --integrator auto", 0);
    assert!(err.contains("--integrator velocity-verlet instead of symplectic-euler from step 8 on"), "{err}");
}

/// The scene says how it is run, and each option overrides its value.
#[test]
fn a_scene_says_how_it_is_run() {
    let rockfall = Rockfall::with(&format!("{GRAIN}@run dt=0.00001 integrator=symplectic-euler steps=6 every=2 substeps=2\n"));
    let summary = |options: &str| {
        let (out, err) = rockfall.run(&format!("run scene.txt --backend cpu --json {options}"), 0);
        assert_eq!(err, "", "{options}");
        let object: serde_json::Value = serde_json::from_str(&out).unwrap();
        let number = |key: &str| object[key].as_f64().unwrap();
        (number("dt"), number("steps"), number("substeps"), object["integrator"].as_str().unwrap().to_owned())
    };
    let own = (1e-5, 6.0, 2.0, "symplectic-euler".to_owned());
    assert_eq!(summary(""), own);
    assert_eq!(summary("--dt 2e-6 --steps 3"), (2e-6, 3.0, 2.0, own.3.clone()));
    assert_eq!(summary("--integrator velocity-verlet --substeps 1"), (1e-5, 6.0, 1.0, "velocity-verlet".to_owned()));

    rockfall.run("run scene.txt --backend cpu --out a.csv", 0);
    let frames =
        |name: &str| rockfall.read(name).lines().skip(1).map(|line| line.split(',').next().unwrap().to_owned()).collect();
    let steps: Vec<String> = frames("a.csv");
    assert_eq!(steps, ["0", "2", "4", "6"]);
    rockfall.run("run scene.txt --backend cpu --out b.csv --every 3", 0);
    let steps: Vec<String> = frames("b.csv");
    assert_eq!(steps, ["0", "3", "6"]);
    let (out, _) = rockfall.run("check scene.txt", 0);
    assert!(out.contains("stable at a time step of 5e-6 s (symplectic-euler)"), "{out}");
    let (out, _) = rockfall.run("check scene.txt --dt 4e-6 --integrator velocity-verlet", 0);
    assert!(out.contains("stable at a time step of 2e-6 s (velocity-verlet)"), "{out}");
}

/// `--save` writes how the scene was run, so that the saved scene goes on without options.
#[test]
fn a_saved_scene_goes_on_as_it_was_run() {
    let rockfall = Rockfall::with("@run steps=20\nset gravity 2\nS 1 0 0 0 1 0 0 0 0 0 1 0.5\n");
    rockfall.run("run scene.txt --backend cpu --dt 0.01 --integrator symplectic-euler --substeps 3 --save half.txt", 0);
    let text = rockfall.read("half.txt");
    assert!(text.contains("\n@run dt=0.01 integrator=symplectic-euler steps=20 substeps=3\n"), "{text}");
    rockfall.run("run half.txt --backend cpu --out end.csv", 0);
    rockfall
        .run("run scene.txt --backend cpu --dt 0.01 --integrator symplectic-euler --substeps 3 --steps 40 --out whole.csv", 0);
    assert_eq!(rockfall.read("end.csv"), rockfall.read("whole.csv"));
}

/// Generated grains have the time step for which they are made.
#[test]
fn generated_grains_run_without_options() {
    let rockfall = Rockfall::with("");
    rockfall.run("generate column --spheres 20 --out column.txt", 0);
    assert!(rockfall.read("column.txt").contains("\n@run dt=0.00004 integrator=velocity-verlet steps=25000 speed=0.25\n"));
    let (out, err) = rockfall.run("run column.txt --backend cpu --steps 2", 0);
    assert!(out.contains("2 of 4e-5 s") && out.contains("integrator  velocity-verlet\n"), "{out}");
    assert!(!err.contains("advised"), "{err}");
    assert!(rockfall.run("generate pile --spheres 20", 0).0.contains("\n@run dt=0.02 steps=1000 speed=2.5\n"));
}

#[test]
fn an_integrator_that_the_law_does_not_allow_names_its_line() {
    let rockfall = Rockfall::with(&format!("@run integrator=rk4\n{GRAIN}"));
    for command in ["run", "check"] {
        let (_, err) = rockfall.run(&format!("{command} scene.txt"), 2);
        assert!(err.contains("scene.txt:1: @run integrator: rk4 is not possible with the contact law hertz-mindlin"), "{err}");
    }
    let rockfall = Rockfall::with("@run integrator=rk4\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n");
    let (_, err) = rockfall.run("run scene.txt --backend cpu --set contact_law=linear", 2);
    assert!(err.contains("linear with the integrator rk4"), "{err}");
}

/// A film without `--steps` has the steps of the scene: 20 steps of 0.02 s at 10 pictures per second, with the first and the last.
#[test]
#[cfg(feature = "view")]
fn a_film_has_the_steps_of_the_scene() {
    let rockfall = Rockfall::with("@run dt=0.02 steps=20\nset gravity 2\nS 1 0 0 0 1 0 0 0 0 0 1 0.5\n");
    let (_, err) = rockfall.run("render scene.txt --out film.gif --fps 10 --size 64x48", 0);
    assert!(err.contains("5 pictures"), "{err}");
    rockfall.run("render scene.txt --out one.png --size 64x48", 0);
}

/// A row of three pendulums from one block. A saved scene has the copies.
#[test]
fn blocks_are_repeated() {
    let block = "S 1 0 2 0 0 0 0 0 0 0 1 0.1 1\nS 2 1 2 0 0 0 0 0 0 0 1 0.1\nR 1 2 0.05 1\n";
    let rockfall = Rockfall::with(&format!("@run steps=20 dt=0.01\n@repeat 3 0 0 1.5\n{block}@end\n"));
    let (out, _) = rockfall.run("check scene.txt", 0);
    assert!(out.contains("6 spheres, 3 rods"), "{out}");
    rockfall.run("run scene.txt --backend cpu --save saved.txt", 0);
    let saved = rockfall.read("saved.txt");
    assert!(saved.contains("\nR 5 6 0.05 1\n") && !saved.contains("@repeat"), "{saved}");
}
