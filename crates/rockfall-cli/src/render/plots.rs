//! What `--plot` can show of a scene.

use rockfall::Scene;
use rockfall_viewer::plot::{Plot, Quantity};

use crate::failure::Failure;

/// Returns an error for the plot of a gauge or joint that the scene lacks, and of values that a trajectory does not have.
pub(crate) fn check_names(plot: &Plot, is_recorded: bool, scene: &Scene) -> Result<(), Failure> {
    if is_recorded && plot.quantity() == Quantity::Gauge {
        let message = "a trajectory has no springs of contacts, expected a scene or a checkpoint";
        return Err(Failure::usage(format!("--plot gauge: {message}")));
    }
    if let (true, Quantity::Joint(_)) = (is_recorded, plot.quantity()) {
        return Err(Failure::usage(
            "--plot joint: a trajectory does not have the values of joints, expected a scene or a checkpoint",
        ));
    }
    plot.check_names(scene).map_err(|error| Failure::usage(format!("--plot {error}")))
}
