//! `rockfall evolve`: files, resuming, errors.

use crate::common::Rockfall;

const SMALL: &str = "--population 16 --seconds 2 --backend cpu --seed 5";

fn centre(csv: &str) -> [f64; 2] {
    let rows: Vec<Vec<f64>> =
        csv.lines().skip(1).map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    [1, 3].map(|column| rows.iter().map(|row| row[column]).sum::<f64>() / rows.len() as f64)
}

/// The champion's scene walks the distance that its comment claims, between the steps that the comment names.
#[test]
fn the_champion_is_a_scene_that_walks_as_far_as_it_says() {
    let rockfall = Rockfall::with("");
    let (out, _) = rockfall.run(&format!("evolve {SMALL} --generations 3 --out walker.txt --history h.csv --gallery kinds"), 0);
    assert!(out.contains("champion     distance") && out.contains("energy       work"), "{out}");
    let audit = out.lines().find_map(|line| line.strip_prefix("audit ")).unwrap();
    let numbers: Vec<f64> = audit.split(' ').filter_map(|word| word.parse().ok()).collect();
    let fitness: f64 = out.split("champion     distance ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(numbers.len() == 3 && numbers.iter().all(|number| *number > 0.69 * fitness), "{out}");
    let scene = rockfall.read("walker.txt");
    let words: Vec<&str> = scene.lines().nth(1).unwrap().split_whitespace().collect();
    let after = |word: &str| words[words.iter().position(|found| *found == word).unwrap() + 1];
    let (from, to): (u64, u64) = (after("step").parse().unwrap(), 400);
    assert!(words.windows(2).any(|pair| pair == ["step", "400"]), "{words:?}");
    assert!(scene.contains("\n@run dt=0.005 steps=400\n"), "{scene}");
    let claimed: f64 = after("moves").parse().unwrap();
    let state = |steps: u64| {
        // The scene has the time step of the trial, and the number of its steps.
        let steps = if steps == to { String::new() } else { format!("--steps {steps}") };
        rockfall.run(&format!("run walker.txt {steps} --backend cpu --out s.csv"), 0);
        centre(&rockfall.read("s.csv"))
    };
    let ([x, z], [to_x, to_z]) = (state(from), state(to));
    let walked = (to_x - x).hypot(to_z - z);
    assert!(claimed > 0.1 && (walked / claimed - 1.0).abs() < 0.01, "{walked} {claimed}");

    let history = rockfall.read("h.csv");
    assert_eq!(history.lines().count(), 4, "{history}");
    assert!(
        history.starts_with("generation,champion,best,mean,niches,not_finite,exploded,unsteady,downhill,failed_audits\n1,")
    );
    let gallery = rockfall.read("kinds/gallery.csv");
    assert!(gallery.lines().count() > 2, "{gallery}");
    for line in gallery.lines().skip(1) {
        rockfall.run(&format!("check kinds/{}", line.split(',').next().unwrap()), 0);
    }
}

#[test]
fn a_resumed_evolution_gives_the_same_files() {
    let rockfall = Rockfall::with("");
    let files = |name: &str| ["txt", "csv"].map(|end| rockfall.read(&format!("{name}.{end}")));
    rockfall.run(&format!("evolve {SMALL} --generations 4 --out a.txt --history a.csv"), 0);
    rockfall.run(&format!("evolve {SMALL} --generations 2 --out b.txt --history b.csv --checkpoint b.json"), 0);
    rockfall.run("evolve --resume b.json --generations 4 --backend cpu --out b.txt --history b.csv", 0);
    assert_eq!(files("a"), files("b"));
    let (_, error) = rockfall.run("evolve --resume b.json --seed 3", 2);
    assert!(error.contains("--seed"), "{error}");
    std::fs::write(rockfall.path("bad.json"), "{}").unwrap();
    let (_, error) = rockfall.run("evolve --resume bad.json", 2);
    assert!(error.contains("bad.json: not a saved evolution"), "{error}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_everything_written() {
    let rockfall = Rockfall::with("");
    let arguments =
        "evolve --population 16 --seconds 2 --backend cpu --generations 100000 --out w.txt --history w.csv --checkpoint w.json";
    use std::process::Stdio;
    use std::time::{Duration, Instant};
    let child = rockfall.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while !rockfall.path("w.txt").exists() && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(50));
    }
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let (_, error) = crate::common::finish(child.wait_with_output().unwrap(), arguments, 130);
    assert!(error.contains("go on with rockfall evolve --resume w.json"), "{error}");
    let done = rockfall.read("w.csv").lines().count() - 1;
    rockfall.run(&format!("evolve --resume w.json --generations {} --backend cpu --out w.txt", done + 1), 0);
    rockfall.run("check w.txt", 0);
}

#[test]
fn wrong_arguments_are_errors_that_say_what_is_expected() {
    let rockfall = Rockfall::with("S 1 0 2 0 0 0 0 0 0 0 1 0.5\n");
    for (arguments, expected) in [
        ("--goal fly", "expected distance, speed, height, jump or climb"),
        ("--goal climb", "--goal climb needs --ground: on level ground there is nothing to climb"),
        ("--body round", "expected lattice or free"),
        ("--population 1", "expected a whole number from 2 to 1000000"),
        ("--seconds 0.5", "expected a number of seconds from 1 to 1000"),
        ("--dt 0.5 --seconds 2", "is 4 steps, expected at least 20"),
        ("--out best.csv", "expected a name that ends in .txt"),
        ("--checkpoint e.ckpt", "expected a name that ends in .json"),
        ("--ground scene.txt", "it has 1 spheres, expected only boxes, polygons and settings"),
        ("--ground none.txt", "none.txt"),
        ("--film walk.avi", "unknown extension .avi"),
    ] {
        let (_, error) = rockfall.run(&format!("evolve {arguments}"), 2);
        assert!(error.contains(expected), "{arguments}: {error}");
    }
}
