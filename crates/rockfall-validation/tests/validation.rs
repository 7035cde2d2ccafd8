//! Runs every experiment of the page and checks its bounds and its section in `docs/validation.md`.

use std::path::Path;

use rockfall_validation::{ALL, Effort, Experiment, Outcome, section};

/// Defines one test for each experiment. `every_experiment_has_a_test` detects experiments that are missing from the list.
macro_rules! experiments {
    ($($(#[$attribute:meta])* $name:ident),* $(,)?) => {
        $(
            $(#[$attribute])*
            #[test]
            fn $name() {
                let experiment = ALL.iter().find(|experiment| experiment.name == stringify!($name)).expect("an experiment");
                let outcome = (experiment.run)(Effort::Test).expect("it runs");
                assert!(!outcome.checks.is_empty(), "nothing was checked");
                let failures = outcome.failures();
                assert!(failures.is_empty(), "{failures}");
                section(experiment, &outcome).expect("its text is complete");
                check_page(experiment, &outcome);
            }
        )*

        const TESTED: &[&str] = &[$($(#[$attribute])* stringify!($name)),*];
    };
}

experiments!(
    order,
    drift,
    contact,
    bounce,
    gas,
    friction,
    pendulum,
    chain,
    string,
    top,
    heap,
    hopper,
    column,
    mixing,
    rebound,
    cradle,
    spinning,
    moving,
    zigzag,
    collapse,
    grains,
    precision,
    standing,
    runout,
    janssen,
    brazil,
    drum,
    incline,
    surfaces,
    walls,
    smooth,
    press,
    boxes,
    shear,
    bodies,
    hard,
    joints,
    rest,
    silent,
    #[cfg(feature = "gpu")]
    pile
);

/// Checks that the page in the repository has the heading and the plots of the experiment. (Its numbers come from longer runs.)
fn check_page(experiment: &Experiment, outcome: &Outcome) {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let page = std::fs::read_to_string(docs.join("validation.md")).expect("docs/validation.md");
    let expect = |text: &str| assert!(page.contains(text), "docs/validation.md lacks '{text}': run `cargo xtask validate`");
    expect(&format!("## {}\n", experiment.title));
    for chart in &outcome.charts {
        expect(&format!("validation/{}.svg", chart.name));
        assert!(docs.join("validation").join(chart.name).with_extension("svg").exists(), "{}", chart.name);
    }
}

#[test]
fn every_experiment_has_a_test() {
    let names: Vec<&str> = ALL.iter().map(|experiment| experiment.name).collect();
    assert_eq!(names, TESTED);
}
