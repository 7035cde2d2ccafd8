//! Every experiment of the page, with its bounds, and the page as it stands.

use std::path::Path;

use rockfall_validation::{ALL, Effort, Experiment, Outcome, section};

/// A test of each experiment; one that is left out is told by `every_experiment_is_a_test`.
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
                on_the_page(experiment, &outcome);
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
    rest,
    #[cfg(feature = "gpu")]
    pile
);

/// The page in the repository has the experiment's heading and plots. (Its numbers come from longer runs.)
fn on_the_page(experiment: &Experiment, outcome: &Outcome) {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let page = std::fs::read_to_string(docs.join("validation.md")).expect("docs/validation.md");
    let told = |text: &str| assert!(page.contains(text), "docs/validation.md lacks '{text}': run `cargo xtask validate`");
    told(&format!("## {}\n", experiment.title));
    for chart in &outcome.charts {
        told(&format!("validation/{}.svg", chart.name));
        assert!(docs.join("validation").join(chart.name).with_extension("svg").exists(), "{}", chart.name);
    }
}

#[test]
fn every_experiment_is_a_test() {
    let names: Vec<&str> = ALL.iter().map(|experiment| experiment.name).collect();
    assert_eq!(names, TESTED);
}
