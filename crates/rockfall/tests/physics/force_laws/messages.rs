//! Errors name the law, the line and the column, and quote the line.

use rockfall::step::wgsl::shared;
use rockfall::{Error, Worlds};

use super::*;

fn refused(law: ForceLaw) -> String {
    law.check().expect_err("a wrong law").to_string()
}

fn refused_text(text: &str) -> String {
    refused(ForceLaw::new("pull").parameter("k", 1.0).wgsl(text))
}

#[test]
fn a_syntax_error_has_its_place() {
    let message = refused_text("let a = 1.0;\n  force = -k * position");
    assert!(message.starts_with("law 'pull', line 2"), "{message}");
    assert!(message.contains("expected ") && message.contains("\n      force = -k * position"), "{message}");
    let message = refused_text("let a = * 1.0;\nforce = a * position;");
    assert!(message.starts_with("law 'pull', line 1, column 9: "), "{message}");
    assert!(message.ends_with("\n    let a = * 1.0;\n            ^"), "{message}");
}

#[test]
fn an_unknown_name_has_its_place() {
    let message = refused_text("let a = 2.0 * k;\nforce = -a * positon;");
    assert!(
        message.starts_with("law 'pull', line 2, column 14: no definition in scope for identifier: `positon`"),
        "{message}"
    );
    assert!(message.ends_with("\n    force = -a * positon;\n                 ^"), "{message}");
}

#[test]
fn names_of_kernels_are_unknown() {
    for name in ["state", "topology", "status", "step", "WORKGROUP"] {
        let message = refused_text(&format!("force.x = f32({name});"));
        assert!(message.starts_with("law 'pull', line 1, column 15: "), "{message}");
    }
}

/// A declaration of a kernel would hide a built-in function from the text of a law. `step` is refused.
#[test]
fn kernels_do_not_hide_built_in_functions() {
    const FUNCTIONS: [&str; 42] = [
        "abs",
        "min",
        "max",
        "clamp",
        "saturate",
        "cos",
        "cosh",
        "sin",
        "sinh",
        "tan",
        "tanh",
        "acos",
        "asin",
        "atan",
        "atan2",
        "asinh",
        "acosh",
        "atanh",
        "radians",
        "degrees",
        "ceil",
        "floor",
        "round",
        "fract",
        "trunc",
        "exp",
        "exp2",
        "log",
        "log2",
        "pow",
        "dot",
        "cross",
        "distance",
        "length",
        "normalize",
        "sign",
        "fma",
        "mix",
        "smoothstep",
        "sqrt",
        "inverseSqrt",
        "select",
    ];
    for (part, name) in shared().flat_map(|part| FUNCTIONS.map(|name| (part, name))) {
        for declaration in
            [format!("fn {name}("), format!("var<private> {name}:"), format!("const {name}:"), format!("> {name}:")]
        {
            assert!(!part.text.contains(&declaration), "{} declares {name}", part.file);
        }
    }
}

#[test]
fn a_type_error_has_its_place() {
    for (text, place) in [
        ("force = -k;", "line 1, column 1: the type of this value is not that of the variable"),
        ("let a = 1.0;\nif k > 0.0 {\n    force = a;\n}", "line 3, column 5: the type of this value"),
        ("let a = 1.0;\nif a { }", "line 2, column 1: The `if` condition"),
        ("\n\ntorque = position * velocity.xy;", "line 3, column 10"),
        ("force.x = length(3u);", "line 1, column "),
        ("if mass { force.x = 1.0; }", "line 1, column 1: The `if` condition is not a boolean scalar"),
        ("force = vec3f(1.0, 2.0);", "line 1, column 9"),
        ("return;", "line 1, column 1"),
    ] {
        let message = refused_text(text);
        assert!(message.starts_with(&format!("law 'pull', {place}")), "{text}: {message}");
    }
}

/// Kernels run without bounds checks.
#[test]
fn what_could_leave_its_memory_is_refused() {
    for (text, what) in [
        ("var a: array<f32, 3>;\na[1] = 1.0;", "line 1"),
        ("let k2 = i32(k);\nforce[k2] = 1.0;", "line 2"),
        ("let k2 = i32(k);\nforce.x = position[k2];", "line 2"),
        ("force.x = f32(3 / i32(k));", "an integer may be divided by a constant other than 0 only"),
        ("let m = mat3x3f();\nforce = m * position;", "line 1"),
        ("workgroupBarrier();", "line 1"),
        ("force.x = modf(mass).fract;", "line 1"),
        ("let p = &force;\n(*p)[i32(k)] = 1.0;", "line 2"),
        ("} var<private> more: f32; fn f() {", "this '}' closes nothing"),
        ("@diagnostic(off, derivative_uniformity) if true {}", "attributes are not allowed"),
    ] {
        let message = refused_text(text);
        assert!(message.starts_with("law 'pull', line ") && message.contains(what), "{text}: {message}");
    }
}

#[test]
fn wrong_names_and_values_are_refused() {
    let law = || ForceLaw::new("pull").wgsl("force.x = 1.0;");
    for (wrong, message) in [
        (ForceLaw::new("pull"), "law 'pull': it has neither WGSL nor a function"),
        (ForceLaw::new("").wgsl("force.x = 1.0;"), "law '': a law needs a name"),
        (law().parameter("mass", 1.0), "law 'pull': the name 'mass' of a parameter is taken"),
        (law().parameter("k", 1.0).parameter("k", 2.0), "law 'pull': the name 'k' of a parameter is taken"),
        (
            law().parameter("2k", 1.0),
            "law 'pull': '2k' is no name for a parameter, expected a letter, then letters, digits and '_'",
        ),
        (law().parameter("k", f32::NAN), "law 'pull': parameter 'k' is NaN, expected a finite number"),
    ] {
        assert_eq!(refused(wrong), message);
    }
    // A word of WGSL.
    let message = refused(law().parameter("var", 1.0));
    assert!(message.starts_with("law 'pull': ") && message.contains("`var`"), "{message}");
    let mut simulation = with_laws(weightless(), Backend::Cpu, [trap()]);
    let message = |result: rockfall::Result<()>| result.expect_err("a wrong name").to_string();
    assert_eq!(message(simulation.add_force_law(trap())), "law 'trap': there is another law of this name");
    assert_eq!(
        message(simulation.set_force_law_parameter("trap", "q", 1.0)),
        "law 'trap': it has no parameter 'q': it has k, x"
    );
    assert!(message(simulation.set_force_law_parameter("trap", "k", f32::INFINITY)).contains("expected a finite number"));
    assert_eq!(simulation.force_laws().len(), 1);
    let error = Worlds::new([weightless()], Options::new().backend(Backend::Cpu).force_law(trap())).expect_err("no worlds");
    assert!(error.to_string().starts_with("law 'trap': Worlds do not take force laws"), "{error}");
}

/// Random texts are accepted or refused. None panics, and those that are accepted end.
#[test]
fn random_texts_cause_no_panic() {
    const WORDS: [&str; 48] = [
        "force", "torque", "position", "velocity", "mass", "k", "time", "x", "n", "=", "=", "+=", "+", "-", "*", "/", "<",
        "==", "&", "(", ")", "[", "]", "{", "}", ";", ";", ",", ".x", ".yz", "let", "var", "if", "else", "loop", "for",
        "while", "break", "continue", "return", "1.0", "2", "0u", "vec3f", "dot", "length", "select", "modf",
    ];
    const LINES: [&str; 12] = [
        "var x = k;",
        "x += 1.0;",
        "let n = 3;",
        "force = x * position;",
        "torque.y = x;",
        "if x > 2.0 { x = 0.0; }",
        "loop {",
        "}",
        "while x < 5.0 {",
        "break;",
        "for (var n = 0; n < 4; n++) {",
        "force = vec3f(modf(x).fract);",
    ];
    let mut number = 7_u64;
    let mut random = |below: usize| {
        number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (number >> 33) as usize % below
    };
    let (mut accepted, mut refused) = (0, 0);
    for round in 0..3000 {
        let count = 1 + random(9);
        let words: &[&str] = if round % 2 == 0 { &LINES } else { &WORDS };
        let text: Vec<&str> = (0..count).map(|_| words[random(words.len())]).collect();
        let law = ForceLaw::new("random").parameter("k", 1.5).wgsl(text.join(" "));
        if law.check().is_err() {
            refused += 1;
            continue;
        }
        accepted += 1;
        let mut scene = weightless();
        spheres(&mut scene, [Sphere::new([1.0, 2.0, 3.0], 0.1)]);
        let _ = with_laws(scene, Backend::Cpu, [law]).step(DT);
    }
    assert!(accepted > 20 && refused > 1000, "{accepted} accepted, {refused} refused");
}

/// A function alone cannot run on a GPU.
#[cfg(feature = "gpu")]
#[test]
fn function_alone_is_refused_on_the_gpu() {
    let law = || ForceLaw::new("pull").function(|body| -body.position);
    let mut simulation = with_laws(weightless(), Backend::Gpu, []);
    let expected = "law 'pull': it has no WGSL, which the GPU needs; give it with ForceLaw::wgsl, or use the CPU backend";
    assert_eq!(simulation.add_force_law(law()).expect_err("no WGSL").to_string(), expected);
    assert!(simulation.force_laws().is_empty());
    simulation.step(DT).expect("the simulation goes on");
    let options = Options::new().backend(Backend::Gpu).force_law(law());
    assert_eq!(Simulation::with_options(weightless(), options).expect_err("no WGSL").to_string(), expected);
}

both!(result_that_is_not_finite_names_its_line, loop_without_an_end_is_reported);

fn result_that_is_not_finite_names_its_line(backend: Backend) {
    let law =
        ForceLaw::new("sun").parameter("g", 4.0).wgsl("let d = length(position);\nforce = -g * position\n    / (d * d * d);");
    let mut scene = weightless();
    spheres(&mut scene, [Sphere::new([2.0, 0.0, 0.0], 0.1), Sphere::new([0.0; 3], 0.1)]);
    let mut simulation = with_laws(scene, backend, [drag(), law]);
    let error = simulation.run(3, DT).expect_err("0 / 0");
    let message = error.to_string();
    assert!(message.starts_with("law 'sun', line 2: the force on sphere number 1 in step 1 is "), "{message}");
    assert!(message.contains("which is not finite\n    force = -g * position"), "{message}");
    assert!(matches!(error, Error::Law { line: 2, .. }));
}

fn loop_without_an_end_is_reported(backend: Backend) {
    let law = ForceLaw::new("hang").wgsl("loop {\n    force.x += 0.0;\n}");
    let mut scene = weightless();
    spheres(&mut scene, [Sphere::new([2.0, 0.0, 0.0], 0.1)]);
    let error = with_laws(scene, backend, [law]).step(DT).expect_err("no end");
    let message = error.to_string();
    assert!(message.starts_with("law 'hang'") && message.contains("10000 rounds"), "{message}");
}
