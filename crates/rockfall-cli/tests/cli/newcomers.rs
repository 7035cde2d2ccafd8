//! Mistakes of people who use rockfall for the first time, and the messages that help them.

use std::fs;

use crate::common::Rockfall;

/// A pendulum with the given line of the rod.
fn pendulum(rod: &str) -> String {
    format!("# A pendulum\nset gravity 9.81\nS 1 0 0 0 0 0 0 0 0 0 1 0.05 1\nS 2 0.6 -0.8 0 0 0 0 0 0 0 1 0.05\n{rod}\n")
}

/// The lines of `check` and the warnings of a short `run`.
fn check_and_run(scene: &str) -> [String; 2] {
    let rockfall = Rockfall::with(scene);
    let (out, _) = rockfall.run("check scene.txt", 0);
    let (_, err) = rockfall.run("run scene.txt --backend cpu --steps 100", 0);
    [out, err]
}

#[test]
fn a_pendulum_has_no_warnings() {
    let [out, err] = check_and_run(&pendulum("R 1 2 0.01 1"));
    assert!(!out.contains("warning"), "{out}");
    assert_eq!(err, "");
    // The second ball may hit the first rod, but it cannot rest on it.
    let double = format!("{}S 3 0.6 -1.8 0 0 0 0 0 0 0 1 0.05\nR 2 3 0.01 1\n", pendulum("R 1 2 0.01 1"));
    assert!(check_and_run(&double).iter().all(|text| !text.contains("at rest")));
    // With a floor, a ball can rest.
    let floor = pendulum("R 1 2 0.01 1") + "B -1 -3 -1 2 0 0 0 1 0 0 0 2\n";
    assert!(check_and_run(&floor).iter().all(|text| text.contains("19.6 % of the smallest radius")));
}

#[test]
fn contacts_that_cannot_happen_do_not_limit_the_time_step() {
    let stiff = pendulum("R 1 2 0.01 1") + "set contact_force 1e8\n";
    assert!(check_and_run(&stiff).iter().all(|text| !text.contains("contact force")));
    let free = stiff.replace("R 1 2 0.01 1", "K 1 2 10 1 0");
    assert!(check_and_run(&free).iter().all(|text| text.contains("the contact force is too stiff")));
}

#[test]
fn rods_that_do_not_hold_what_they_join_have_a_warning() {
    let cases = [
        ("R 1 2 0.01", "the rod from sphere 1 to sphere 2 has no length, so it holds nothing; its ends are 1 units apart"),
        ("R 1 2 0.01 1.5", "the rod from sphere 1 to sphere 2 has a length of 1.5 units, but its ends are 1 units apart"),
        ("R 1 2 1 0.01", "at once; radius and length may be swapped, expected `R end1 end2 radius length`"),
    ];
    for (rod, warning) in cases {
        for text in check_and_run(&pendulum(rod)) {
            assert!(text.contains(warning), "{rod}: {text}");
            assert!(!text.contains("energy grew"), "{rod}: {text}");
        }
    }
    // 1 % is allowed. A spring, a tether or another rod may hold the ball.
    for rod in ["R 1 2 0.01 1.005", "R 1 2 0.01\nK 1 2 100 1 1", "R 1 2 0.01\nT 2 0 0 0 100 1 1", "R 1 2 0.01 1\nR 1 2 0.02"] {
        let texts = check_and_run(&pendulum(rod));
        assert!(texts.iter().all(|text| !text.contains("the rod from")), "{rod}: {texts:?}");
    }
    // Many are counted.
    let many = pendulum(&"R 1 2 0.01 1.5\n".repeat(12));
    assert!(check_and_run(&many).iter().all(|text| text.contains("warning: and 2 more like these")));
}

#[test]
fn advice_on_overlaps_holds_when_it_is_followed() {
    let mut scene = "set gravity 9.81\nB -0.5 -1 -0.5 1 0 0 0 1 0 0 0 1\n".to_owned();
    for ball in 0..100 {
        scene += &format!("S {ball} 0 {} 0 0 0 0 0 0 0 1 0.1\n", 0.1 + 0.21 * f64::from(ball));
    }
    let rockfall = Rockfall::with(&scene);
    let (out, _) = rockfall.run("check scene.txt", 0);
    assert_eq!(out.matches("contact_force of ").count(), 1, "{out}");
    assert!(out.contains("times their weight"), "{out}");
    let after = |text: &str, before: &str| {
        let rest = text.split_once(before).unwrap().1;
        rest.split([' ', '\n', ';']).next().unwrap().to_owned()
    };
    let [force, damping, dt] =
        ["contact_force of ", "contact_damping of ", "time step of at most "].map(|word| after(&out, word));
    let set = format!("--set contact_force={force} --set contact_damping={damping} --dt {dt}");
    let (out, _) = rockfall.run(&format!("check scene.txt {set}"), 0);
    assert!(
        !out.contains("times their weight") && !out.contains("bodies at rest") && !out.contains("too stiff"),
        "{set}\n{out}"
    );
}

#[test]
fn a_mistyped_setting_is_an_error_where_a_number_sign_begins_a_comment() {
    let ball = "S 1 0 0 0 0 0 0 0 0 0 1 0.1\n";
    for text in ["# A ball\nset gravty 9.81\n", "set gravty 9.81 # Earth\n"] {
        let (_, err) = Rockfall::with(&(text.to_owned() + ball)).run("run scene.txt", 2);
        assert!(err.contains("set 'gravty': an unknown setting, did you mean gravity?"), "{err}");
    }
    // It may be a file of the thesis.
    let (_, err) = Rockfall::with(&("set gravty 9.81\n".to_owned() + ball)).run("run scene.txt --backend cpu --steps 1", 0);
    assert!(err.contains("taken for a comment"), "{err}");
}

#[test]
fn wrong_lines_say_how_to_write_them() {
    let cases = [
        ("set gravity=9.81", "expected a space in place of `=`: `set gravity 9.81`"),
        ("set gravity = 9.81", "expected no `=`: `set gravity 9.81`"),
        ("set dt 0.01", "not a constant, expected `@run dt=SECONDS`"),
        ("S 2 1 0 0 0 0 0 0 0 0 1 0.1 fixed", "S fixed: 'fixed' is not a number, expected 1 for a fixed sphere"),
        ("K is the stiffness of the spring", "if the line is a comment, begin it with #"),
        ("S 2 is the ball that moves", "if the line is a comment, begin it with #"),
    ];
    for (line, message) in cases {
        let rockfall = Rockfall::with(&format!("# A ball\nS 1 0 0 0 0 0 0 0 0 0 1 0.1\n{line}\n"));
        let (_, err) = rockfall.run("check scene.txt", 2);
        assert!(err.starts_with("error: scene.txt:3: ") && err.contains(message), "{line}: {err}");
    }
    let (_, err) = Rockfall::with("S 1 0 high 0 0 0 0 0 0 0 1 0.1\n").run("check scene.txt", 2);
    assert!(!err.contains("comment"), "{err}");
}

#[test]
fn check_notes_that_negative_gravity_acts_upwards() {
    let ball = "S 1 0 0 0 0 0 0 0 0 0 1 0.1\n";
    let (out, _) = Rockfall::with(&format!("set gravity -9.81\n{ball}")).run("check scene.txt", 0);
    assert!(
        out.contains("note: scene.txt: gravity is negative: it acts against gravity_direction, so bodies fall upwards"),
        "{out}"
    );
    let (out, _) = Rockfall::with(&format!("set gravity 9.81\n{ball}")).run("check scene.txt", 0);
    assert!(!out.contains("upwards"), "{out}");
}

#[test]
fn wrong_arguments_have_a_tip_that_helps() {
    let rockfall = Rockfall::with(&pendulum("R 1 2 0.01 1"));
    let cases = [
        ("run scene.txt --gravity 9.81", "tip: gravity is a constant: '--set gravity=9.81'"),
        ("run scene.txt --resting-overlap=0.02", "tip: resting_overlap is a constant: '--set resting_overlap=0.02'"),
        ("check scene.txt --friction high", "tip: friction is a constant: '--set friction=VALUE'"),
        ("run scene.txt --time 10", "tip: the simulated time is '--steps <N>' times '--dt <S>'"),
        ("run --set gravity 9.81 scene.txt", "expected NAME=VALUE, as in --set gravity=9.81"),
        ("run scene.txt --set gravity 9.81", "tip: a constant is set with NAME=VALUE: '--set gravity=9.81'"),
        ("scene.txt", "tip: to run this scene, use 'rockfall run scene.txt'"),
        ("missing.txt", "tip: to run this scene, use 'rockfall run missing.txt'"),
        ("render scene.txt --out a.png --look wood", "tip: looks are in the scene: a line '@look wood' above the objects"),
        ("run scene.txt -every 1", "tip: options of several letters begin with two dashes: '--every'"),
        ("run scene.txt --seteps 1", "tip: a similar argument exists: '--steps'"),
    ];
    for (command, tip) in cases {
        let (out, err) = rockfall.run(command, 2);
        assert!(err.contains(tip) && !err.contains("as a value"), "{command}: {err}");
        assert_eq!(out, "");
    }
    let (_, err) = rockfall.run("look", 2);
    assert!(!err.contains("scene"), "{err}");
}

#[test]
fn bodies_that_left_are_told_and_are_not_in_the_picture() {
    let mut scene = "set gravity 0\n".to_owned();
    for ball in 0..6 {
        scene += &format!("S {ball} {ball} {} 0 0 0 0 0 0 0 1 0.4\n", ball % 3);
    }
    let picture =
        |out: &str| out.lines().filter(|line| line.trim_start().starts_with("oo")).map(str::to_owned).collect::<Vec<_>>();
    let (near, _) = Rockfall::with(&scene).run("run scene.txt --backend cpu --steps 1", 0);
    assert!(!near.contains("\n  left "), "{near}");
    let far = scene + "S 9 2 -260 0 0 0 0 0 0 0 1 0.4\n";
    let (out, _) = Rockfall::with(&far).run("run scene.txt --backend cpu --steps 1", 0);
    assert!(out.contains("\n  left        1 body is at least 259 units away from all others"), "{out}");
    assert_eq!(picture(&near), picture(&out));
    assert!(picture(&near).len() > 10, "{near}");
    // Bodies below the floor count from a shorter distance on.
    let floor = near_floor() + "S 10 2 -40 0 0 0 0 0 0 0 1 0.4\nS 11 2 -300 0 0 0 0 0 0 0 1 0.4\n";
    let (out, _) = Rockfall::with(&floor).run("run scene.txt --backend cpu --steps 1", 0);
    assert!(out.contains("\n  left        2 bodies are at least 40 units away from all others"), "{out}");
    let (out, _) = Rockfall::with(&near_floor()).run("run scene.txt --backend cpu --steps 1", 0);
    assert!(!out.contains("\n  left "), "{out}");
}

/// Six balls in a row on a floor.
fn near_floor() -> String {
    let balls = (0..6).map(|ball| format!("S {ball} {ball} 0.4 0 0 0 0 0 0 0 1 0.4\n"));
    "B -1 -1 -1 8 0 0 0 1 0 0 0 2\n".to_owned() + &balls.collect::<String>()
}

#[test]
fn one_repeated_step_is_singular() {
    // With a capacity of one pair the lists of the first step are too short.
    let rockfall = Rockfall::with("");
    rockfall.run("generate pile --spheres 100 --out pile.txt", 0);
    let (out, _) = rockfall.run("run pile.txt --backend cpu --steps 1 --capacity 16", 0);
    let replays = out.lines().find(|line| line.starts_with("  replays")).unwrap_or_else(|| panic!("{out}"));
    let count = replays.split_whitespace().nth(1).unwrap();
    assert!(replays.contains(if count == "1" { "1 step repeated" } else { " steps repeated" }), "{out}");
    assert_eq!(count, "1", "{out}");
}

#[test]
fn a_gate_closes_the_opening_of_a_hopper() {
    let rockfall = Rockfall::with("");
    rockfall.run("generate hopper --spheres 100 --out open.txt", 0);
    let text = rockfall.read("open.txt");
    let gate = text.lines().find_map(|line| line.strip_prefix("# B ")).unwrap();
    let opening = text.lines().find(|line| line.starts_with("# The opening is at y = ")).unwrap();
    let height: f64 = opening.split(' ').nth(7).unwrap().trim_end_matches(',').parse().unwrap();
    fs::write(rockfall.path("closed.txt"), format!("{text}B {gate}\n")).unwrap();
    let lowest = |name: &str| {
        rockfall.run(&format!("run {name}.txt --backend cpu --steps 1000 --out {name}.csv"), 0);
        let table = rockfall.read(&format!("{name}.csv"));
        let heights = table.lines().skip(1).map(|line| line.split(',').nth(2).unwrap().parse::<f64>().unwrap());
        heights.fold(f64::INFINITY, f64::min)
    };
    let (out, _) = rockfall.run("check closed.txt", 0);
    assert!(!out.contains("warning"), "{out}");
    assert!(lowest("closed") > height && lowest("open") < height - 1.0);
}
