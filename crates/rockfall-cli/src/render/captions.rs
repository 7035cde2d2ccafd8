//! Options of text, arrows and trails over pictures.

use rockfall::Scene;
use rockfall_viewer::overlay::{Arrows, Overlay};

use crate::output;

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Captions {
    /// Write a line of text at the upper edge
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Show the time of the simulation
    #[arg(long)]
    clock: bool,
    /// Show the length of a round number of units at the distance of the middle of the picture
    #[arg(long)]
    scale_bar: bool,
    /// Write its label or its number on every sphere
    #[arg(long)]
    label: bool,
    /// Draw an arrow at every sphere, with a key: velocity, force or gravity
    #[arg(long, value_name = "WHAT", value_parser = Arrows::named)]
    arrows: Option<Arrows>,
    /// Draw the path of every sphere in the last S seconds of the simulation
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    trails: Option<f64>,
}

fn seconds(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|seconds: &f64| seconds.is_finite() && *seconds > 0.0);
    found.ok_or_else(|| "expected a finite number of seconds greater than 0".to_owned())
}

/// Warns of letters that cannot be drawn.
pub(crate) fn warn_of_letters(overlay: &Overlay, scene: &Scene) {
    let missing = overlay.missing_letters(scene);
    if !missing.is_empty() {
        let letters: String = missing.iter().take(20).collect();
        let more = if missing.len() > 20 { " and others" } else { "" };
        output::note(&format!("warning: the built-in font lacks the letters {letters}{more}, which are drawn as boxes"));
    }
}

impl Captions {
    pub(crate) fn overlay(&self) -> Overlay {
        Overlay {
            title: self.title.clone(),
            clock: self.clock,
            scale_bar: self.scale_bar,
            labels: self.label,
            arrows: self.arrows,
            arrow_key: None,
            trails: self.trails.unwrap_or(0.0),
            dark: false,
        }
    }
}
