//! Options of text, arrows and trails over pictures.

use rockfall::Scene;
use rockfall_viewer::overlay::{Arrows, Overlay, body_number, trails_of};

use super::camera::Named;
use crate::failure::Failure;
use crate::output;

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Captions {
    /// Write text at the upper edge, in smaller letters and several lines if it is long
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Show the time of the simulation
    #[arg(long)]
    clock: bool,
    /// Show the length of a round number of units at the distance of the middle of the picture
    #[arg(long)]
    scale_bar: bool,
    /// Write its label or its number on every body
    #[arg(long)]
    label: bool,
    /// Draw an arrow at every body, with a key: velocity, force or gravity
    #[arg(long, value_name = "WHAT", value_parser = Arrows::named)]
    arrows: Option<Arrows>,
    /// Mark the anchors of joints, and the axes of hinges and sliders
    #[arg(long)]
    show_joints: bool,
    /// Draw the path of every body in the last S seconds of the simulation, or only of some, as in 2:left,right
    #[arg(long, value_name = "S[:BODY,...]", value_parser = trails, allow_negative_numbers = true)]
    trails: Option<Trails>,
}

/// The length of trails in s, and the names or numbers of the bodies that have them.
#[derive(Clone, Debug, Default)]
struct Trails {
    seconds: f64,
    of: Vec<String>,
}

fn trails(text: &str) -> Result<Trails, String> {
    trails_of(text).map(|(seconds, of)| Trails { seconds, of })
}

/// Finds the bodies that have trails in the scene. The number of any of its spheres means a body.
pub(crate) fn find_trails(overlay: &mut Overlay, scene: &Scene) -> Result<(), Failure> {
    for name in &mut overlay.trails_of {
        let named = Named::parse(name).map_err(|error| Failure::usage(format!("--trails {name}: {error}")))?;
        let sphere = named.of(scene, "--trails")?;
        if let Named::Number(_) = named {
            *name = body_number(scene, sphere);
        }
    }
    Ok(())
}

/// Warns of letters that cannot be drawn.
pub(crate) fn warn_of_letters(overlay: &Overlay, scene: &Scene) {
    if let Some(warning) = overlay.warning_of_letters(scene) {
        output::note(&format!("warning: {warning}"));
    }
}

impl Captions {
    pub(crate) fn overlay(&self) -> Overlay {
        let trails = self.trails.clone().unwrap_or_default();
        Overlay {
            title: self.title.clone(),
            clock: self.clock,
            scale_bar: self.scale_bar,
            labels: self.label,
            arrows: self.arrows,
            arrow_key: None,
            trails: trails.seconds,
            trails_of: trails.of,
            joints: self.show_joints,
            dark: false,
        }
    }
}
