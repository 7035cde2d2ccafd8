use std::path::Path;

use crate::scene::{Loaded, Scene};
use crate::{Integrator, IntegratorChoice, Result, RunDefaults};

fn parse(text: &str) -> Result<Loaded> {
    Scene::parse(text, Path::new("a.txt"))
}

const BALL: &str = "S 1 0 0 0 0 0 0 0 0 0 1 0.5\n";

#[test]
fn the_line_is_read_and_written() {
    let text = "@run dt=0.0002 integrator=velocity-verlet steps=5000 every=50 substeps=4 speed=0.1 # slow\n";
    let scene = parse(&format!("# A ball.\n\n{text}{BALL}")).unwrap().scene;
    let expected = RunDefaults {
        dt: Some(0.0002),
        integrator: Some(Integrator::VelocityVerlet.into()),
        steps: Some(5000),
        every: Some(50),
        substeps: Some(4),
        speed: Some(0.1),
    };
    assert_eq!(scene.run, expected);
    assert_eq!(scene.run.time_step(), Some(0.00005));
    assert_eq!(parse(&scene.to_text()).unwrap().scene.run, expected);
    assert!(scene.to_text().starts_with(text.split(" #").next().unwrap()), "{}", scene.to_text());
}

#[test]
fn every_value_may_be_left_out() {
    let scene = parse(BALL).unwrap().scene;
    assert_eq!((scene.run, scene.run.time_step()), (RunDefaults::default(), None));
    assert!(!scene.to_text().contains("@run"));
    for (text, time_step) in
        [("dt=1e-3", Some(0.001)), ("substeps=10", Some(0.02 / 10.0)), ("integrator=auto", None), ("steps=1", None)]
    {
        let scene = parse(&format!("{BALL}@run {text}\n")).unwrap().scene;
        assert_eq!(scene.run.time_step(), time_step, "{text}");
        assert_eq!(parse(&scene.to_text()).unwrap().scene.run, scene.run, "{text}");
    }
}

#[test]
fn wrong_lines_name_the_field_and_what_was_expected() {
    let cases = [
        ("@run dt=0", "@run dt", "a finite number of seconds greater than 0"),
        ("@run dt=-1", "@run dt", "'-1' is not allowed"),
        ("@run dt=nan", "@run dt", "greater than 0"),
        ("@run dt=inf", "@run dt", "greater than 0"),
        ("@run dt=1e-50", "@run dt", "greater than 0"),
        ("@run dt=", "@run dt", "greater than 0"),
        ("@run dt=1ms", "@run dt", "greater than 0"),
        ("@run dt=1 dt=1", "@run dt", "given twice in the line"),
        ("@run integrator=euler", "@run integrator", "auto, rk4, symplectic-euler or velocity-verlet"),
        ("@run integrator=rk4 integrator=rk4", "@run integrator", "given twice"),
        ("@run steps=0", "@run steps", "a whole number of at least 1"),
        ("@run steps=1.5", "@run steps", "a whole number of at least 1"),
        ("@run steps=99999999999999999999", "@run steps", "a whole number of at least 1"),
        ("@run speed=0", "@run speed", "a finite number greater than 0"),
        ("@run speed=slow", "@run speed", "'slow' is not allowed"),
        ("@run every=0", "@run every", "a whole number of at least 1"),
        ("@run substeps=0", "@run substeps", "from 1 to 1000000"),
        ("@run substeps=1000001", "@run substeps", "from 1 to 1000000"),
        ("@run time=3", "@run 'time'", "expected one of dt, integrator, steps, every, substeps"),
        ("@run step=3", "@run 'step'", "did you mean steps?"),
        ("@run dt=1 fast", "@run 'fast'", "expected KEY=VALUE"),
        ("@run dt=1\n@run steps=1", "@run line", "given again after line 2, expected one @run line"),
        ("set gravity 1\n@run", "@run line", "expected @run dt=S integrator=NAME"),
        ("set gravity 1\n@run fast", "@run line", "expected @run dt=S integrator=NAME"),
    ];
    for (lines, field, expected) in cases {
        let error = parse(&format!("{BALL}{lines}\n")).map(drop).expect_err(lines).to_string();
        let number = 1 + lines.lines().count();
        assert!(error.contains(&format!("a.txt:{number}: {field}: ")) && error.contains(expected), "{lines}: {error}");
    }
}

/// Both lines may come first. The error is that of the line `@run`.
#[test]
fn an_integrator_that_the_law_does_not_allow_is_an_error() {
    for law in ["linear", "hertz-mindlin", "user"] {
        for (text, number) in [
            (format!("set contact_law {law}\n@run integrator=rk4\n"), 2),
            (format!("@run integrator=rk4\nset contact_law {law}\n"), 1),
        ] {
            let error = parse(&text).map(drop).expect_err(&text).to_string();
            let expected =
                format!("a.txt:{number}: @run integrator: rk4 is not possible with the contact law {law}, expected auto");
            assert!(error.contains(&expected), "{error}");
        }
        let scene = parse(&format!("set contact_law {law}\n@run integrator=auto\n")).unwrap().scene;
        assert_eq!(scene.integrator(IntegratorChoice::Auto), Integrator::VelocityVerlet);
    }
    let scene = parse("@run integrator=symplectic-euler\n").unwrap().scene;
    assert_eq!(scene.integrator(IntegratorChoice::Auto), Integrator::SymplecticEuler);
    assert_eq!(scene.integrator(Integrator::Rk4.into()), Integrator::Rk4);
}

/// In a file for the thesis's program, a line without any value is prose.
#[test]
fn prose_of_a_thesis_file_is_a_comment() {
    let loaded = parse(&format!("@run the soft cube\n{BALL}")).unwrap();
    assert_eq!((loaded.scene.run, loaded.warnings.len(), loaded.comments), (RunDefaults::default(), 1, 1));
    assert!(loaded.warnings[0].text.contains("taken for a comment"), "{}", loaded.warnings[0]);
}

#[test]
fn values_of_a_program_are_checked() {
    let mut scene = Scene::new();
    let run = RunDefaults::default();
    let wrong = [
        RunDefaults { dt: Some(f32::NAN), ..run },
        RunDefaults { dt: Some(0.0), ..run },
        RunDefaults { steps: Some(0), ..run },
        RunDefaults { every: Some(0), ..run },
        RunDefaults { substeps: Some(0), ..run },
        RunDefaults { speed: Some(0.0), ..run },
        RunDefaults { speed: Some(f64::INFINITY), ..run },
        RunDefaults { substeps: Some(RunDefaults::MAX_SUBSTEPS + 1), ..run },
    ];
    for run in wrong {
        scene.run = run;
        let error = scene.save("/nonexistent/scene.txt").unwrap_err().to_string();
        assert!(error.contains("run."), "{run:?}: {error}");
    }
    RunDefaults { dt: Some(1e-3), steps: Some(1), every: Some(1), substeps: Some(1), ..run }.validate().unwrap();
}
