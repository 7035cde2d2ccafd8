//! What `check` says of scenes that are likely not meant, and exit codes of scenes that `run` refuses or that explode.

use crate::common::Rockfall;

/// Runs `check` on a scene and returns what it prints.
fn checked(text: &str, options: &str, code: i32) -> String {
    let (out, err) = Rockfall::with(text).run(&format!("check scene.txt {options}"), code);
    out + &err
}

#[test]
fn check_fails_where_run_refuses() {
    let text = "set contact_law hertz-mindlin\nS 1 0 0 0 0 0 0 0 0 0 1 0.01\n";
    let out = checked(text, "--integrator rk4", 2);
    assert!(out.contains("error: ") && out.contains("hertz-mindlin with the integrator rk4"), "{out}");
    let (_, err) = Rockfall::with(text).run("run scene.txt --backend cpu --steps 1 --integrator rk4", 2);
    assert!(err.contains("hertz-mindlin with the integrator rk4"), "{err}");
    let body = "@material a density=1\n@pair a a stiffness=1e3\n@use a\n@body b\nS 1 0 0 0 0 0 0 0 0 0 - 0.1\n@end\n\
                @place b at=0,0,0\n";
    let text = format!("set contact_law linear\nset collisions on\n{body}");
    let (_, err) = Rockfall::with(&text).run("run scene.txt --backend cpu --steps 1", 2);
    let expected = "collisions: on under linear with a rigid body ('b') is not allowed, expected off (contact forces \
                    alone), or `set contact_law rigid`";
    assert!(err.contains(expected), "{err}");
    assert!(checked(&text, "", 2).contains(expected));
    for text in [format!("set contact_law linear\n{body}"), format!("set continuous_collisions on\n{body}")] {
        Rockfall::with(&text).run("run scene.txt --backend cpu --steps 1", 0);
    }
}

#[test]
fn bodies_behind_polygons_are_reported() {
    let scene = |y: f32| format!("P -1 0 -1 2 0 0 0 0 2\nS 7 0 {y} 0 0 0 0 0 0 0 1 0.1\n");
    // The normal (2, 0, 0) x (0, 0, 2) points down.
    let out = checked(&scene(0.05), "", 0);
    assert!(out.contains("sphere 7 is behind polygon number 0"), "{out}");
    let out = checked(&scene(-0.05), "", 0);
    assert!(!out.contains("behind"), "{out}");
    // A body that is farther from the polygon falls through it, unless something is between them.
    let falls = "sphere 7 is behind polygon number 0 and falls through it";
    let out = checked(&scene(3.0), "", 0);
    assert!(out.contains(falls), "{out}");
    let (_, err) = Rockfall::with(&scene(3.0)).run("run scene.txt --backend cpu --steps 1", 0);
    assert!(err.contains(falls), "{err}");
    for other in [
        "P -1 1 -1 0 0 2 2 0 0",
        "B -1 1 -1 2 0 0 0 0.1 0 0 0 2",
        "S 8 0 1 0 0 0 0 0 0 0 1 0.1 1",
        "@plane at=0,1,0 normal=0,1,0",
        "@triangle -1 1 -1 4 0 0 0 0 4",
        "set gravity 0",
        "set gravity_direction 1 0 0",
    ] {
        let out = checked(&format!("{other}\n{}", scene(3.0)), "", 0);
        assert!(!out.contains("behind"), "{other}: {out}");
    }
    for other in ["P -1 -1 -1 0 0 2 2 0 0", "B 3 1 -1 2 0 0 0 0.1 0 0 0 2"] {
        let out = checked(&format!("{}{other}\n", scene(3.0)), "", 0);
        assert!(out.contains(falls), "{other}: {out}");
    }
}

#[test]
fn pairs_without_friction_and_moving_surfaces_are_reported() {
    let scene = |pair: &str| {
        format!(
            "set contact_law hertz-mindlin\n@material glass density=2500 young=5e10 poisson=0.2\n{pair}@use glass\n\
             S 1 0 1 0 0 0 0 0 0 0 - 0.01\nS 2 1 1 0 0 0 0 0 0 0 - 0.01\nS 3 2 1 0 1 0 0 0 0 0 - 0.01 1\n"
        )
    };
    let options = "--integrator velocity-verlet --dt 1e-6";
    let out = checked(&scene(""), options, 0);
    assert!(out.contains("the pair of materials glass glass has no friction"), "{out}");
    assert!(out.contains("sphere 3 is fixed and has a velocity"), "{out}");
    let out = checked(&scene("@pair glass glass friction=0\n"), options, 0);
    assert!(!out.contains("has no friction"), "{out}");
    // Fixed spheres and walls are surfaces, too, for a single ball.
    let surfaces = ["@use steel\nS 2 0 0 0 0 0 0 0 0 0 - 0.1 1", "@plane at=0,0,0 normal=0,1,0"];
    for (surface, pair) in surfaces.into_iter().zip(["glass steel", "glass glass"]) {
        let text = format!(
            "set contact_law hertz-mindlin\n@material glass density=2500 young=5e10 poisson=0.2\n\
             @material steel density=7200 young=2e11 poisson=0.3\n@use glass\nS 1 0 1 0 0 0 0 0 0 0 - 0.01\n{surface}\n"
        );
        let out = checked(&text, options, 0);
        assert!(out.contains(&format!("the pair of materials {pair} has no friction")), "{out}");
    }
}

/// A grain of 10 MPa at 60 units/s is (15 m u² / (16 E* sqrt(r)))^(2/5) = 4.3 mm deep, and the centre passes a mesh at 2 mm.
/// The stiffness that `check` and `run` ask for is (4.3 / 2)^(5/2) = 6.8 times as high, and holds the grain.
#[test]
fn an_impact_that_is_deeper_than_a_mesh_is_reported() {
    let scene = |young: f64| {
        format!(
            "set contact_law hertz-mindlin\nset gravity 9.81\nset continuous_collisions on\n\
             @material p density=2500 young={young} poisson=0.2\n@pair p p restitution=0.8 friction=0.4\n@use p\n\
             @triangle -0.1 0 -0.1  0.2 0 0  0.2 0 0.2\n@triangle -0.1 0 -0.1  0.2 0 0.2  0 0 0.2\n\
             S 1 0.01 0.05 0.013 0 -60 0 0 0 0 - 0.002\n"
        )
    };
    let deep = "impacts of sphere 1 at 60 units/s are up to 0.0043 units deep, 2.15 radii, and may pass through polygons: \
                the limit is the radius, 0.002; make the material at least 6.79 times as stiff";
    let out = checked(&scene(1e7), "--dt 1e-6", 0);
    assert!(out.contains(deep), "{out}");
    let idle =
        "note: scene.txt: continuous_collisions has no effect: collisions are off, because contact law hertz-mindlin computes";
    assert!(out.contains(idle), "{out}");
    let run = "run scene.txt --backend cpu --dt 1e-6 --steps 1500";
    let (_, err) = Rockfall::with(&scene(1e7)).run(run, 0);
    assert!(err.contains(deep), "{err}");
    let stiff = Rockfall::with(&scene(6.8e7));
    let (_, err) = stiff.run(&format!("{run} --save end.txt"), 0);
    assert!(!err.contains("deep"), "{err}");
    let end = stiff.read("end.txt");
    let sphere = end.lines().find(|line| line.starts_with("S ")).unwrap();
    assert!(sphere.split_whitespace().nth(3).unwrap().parse::<f64>().unwrap() > 0.0, "{sphere}");
}

/// A stiff spring makes the energy explode. The last line names the cause, JSON has the growth, and `--strict` fails.
#[test]
fn an_explosion_is_a_failure_with_strict() {
    let text = "set gravity 0\nS 1 0 0 0 0 0 0 0 0 0 1 0.1\nS 2 1.2 0 0 0 0 0 0 0 0 1 0.1\nK 1 2 12000 1 0\n";
    let rockfall = Rockfall::with(text);
    let (_, err) = rockfall.run("run scene.txt --backend cpu --steps 40", 0);
    let last = err.lines().last().unwrap_or_default();
    assert!(last.contains("the energy grew by") && last.contains("the time step is too long"), "{err}");
    let (out, _) = rockfall.run("run scene.txt --backend cpu --steps 40 --json", 0);
    let summary: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert!(summary["energy_growth_without_cause"].as_f64().is_some_and(|growth| growth > 1.0), "{out}");
    let (_, err) = rockfall.run("run scene.txt --backend cpu --steps 40 --strict", 1);
    assert!(err.contains("error: ") && err.contains("the energy grew by"), "{err}");
    let (out, _) = rockfall.run("run scene.txt --backend cpu --steps 40 --dt 1e-3 --strict --json", 0);
    let summary: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert!(summary["energy_growth_without_cause"].is_null(), "{out}");
}
