//! What `--plot` can show of a scene.

use rockfall::Scene;
use rockfall_viewer::plot::{Plot, Quantity};

use crate::failure::Failure;

/// Returns an error for the plot of a gauge that the scene lacks, and of forces that a trajectory does not know.
pub(crate) fn check_gauges(plot: &Plot, is_recorded: bool, scene: &Scene) -> Result<(), Failure> {
    if is_recorded && plot.quantity() == Quantity::Gauge {
        let message = "a trajectory has no springs of contacts, expected a scene or a checkpoint";
        return Err(Failure::usage(format!("--plot gauge: {message}")));
    }
    plot.check_gauges(scene).map_err(|error| Failure::usage(format!("--plot {error}")))
}
