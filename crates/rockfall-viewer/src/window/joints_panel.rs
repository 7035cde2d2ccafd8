//! Sliders of the motors and springs of joints, and plots of joints.

use std::ops::RangeInclusive;

use egui::{RichText, ScrollArea, Slider, SliderClamping, Ui};
use egui_plot::{Line, PlotPoints};
use rockfall::{Joint, JointId, JointReading, Scene};

use super::constants_panel::row;
use super::panel::{colour, plot, stroke, widened};
use super::session::joints::Drive;
use super::viewer::Viewer;

/// Greatest number of joints with sliders.
const MOST: usize = 100;
/// Height above which the sliders scroll, in points.
const HEIGHT: f32 = 150.0;
const PLOT_HEIGHT: f32 = 110.0;
/// Least speed at the ends of the slider of a motor, in rad/s or units/s.
const LEAST_SPEED: f32 = 1.0;

/// A slider for a joint.
struct Control {
    id: JointId,
    /// Index of the joint in the scene.
    place: usize,
    name: String,
    drive: Drive,
    /// Range in rad or units, or their rates.
    range: RangeInclusive<f32>,
    is_angle: bool,
}

/// The sliders of a scene: those of joints with names first. The ranges are those of the initial scene, so that they stay while a slider
/// moves.
fn controls(scene: &Scene, initial: &Scene) -> Vec<Control> {
    let all = scene.joint_ids().zip(scene.joints()).enumerate();
    let (named, others): (Vec<_>, Vec<_>) = all.partition(|(_, (_, joint))| joint.name.is_some());
    let of = |(place, (id, joint)): (usize, (JointId, &Joint))| {
        let first = initial.joint(id).unwrap_or(joint);
        let name = joint.name.clone().unwrap_or_else(|| format!("{} {place}", joint.kind));
        let control = |drive: Drive, range: RangeInclusive<f32>| Control {
            id,
            place,
            name: name.clone(),
            drive,
            range,
            is_angle: joint.kind.turns(),
        };
        let motor = joint.speed.map(|speed| control(Drive::Speed(speed), speeds(first)));
        let spring = (joint.stiffness > 0.0).then(|| control(Drive::Target(joint.rest()), targets(first)));
        [motor, spring].into_iter().flatten().collect::<Vec<_>>()
    };
    named.into_iter().chain(others).flat_map(of).take(MOST).collect()
}

fn speeds(joint: &Joint) -> RangeInclusive<f32> {
    let most = 2.0 * joint.speed.unwrap_or_default().abs().max(0.5 * LEAST_SPEED);
    -most..=most
}

fn targets(joint: &Joint) -> RangeInclusive<f32> {
    let rest = joint.rest();
    let half = if joint.kind.turns() { std::f32::consts::PI } else { rest.abs().max(1.0) };
    let [least, most] = joint.limits.unwrap_or([rest - half, rest + half]);
    least..=most
}

/// Whether a scene has joints with sliders or plots.
pub(super) fn is_shown(viewer: &Viewer) -> bool {
    let has_control = |joint: &Joint| joint.speed.is_some() || joint.stiffness > 0.0;
    let joints = viewer.session.simulation_ref().scene().joints();
    viewer.session.played().is_none() && (joints.iter().any(has_control) || !viewer.session.watch.graphs().is_empty())
}

/// Shows the sliders and the plots.
pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    let controls = controls(viewer.session.simulation_ref().scene(), &viewer.session.source().scene);
    ui.spacing_mut().slider_width = 64.0;
    ui.spacing_mut().interact_size.x = 44.0;
    let mut changed = None;
    ScrollArea::vertical().id_salt("joints").max_height(HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
        for control in &controls {
            let reading = viewer.session.watch.joints().get(control.place).copied();
            if let Some(drive) = slider(ui, control, reading) {
                changed = Some((control.id, drive));
            }
        }
    });
    if let Some((id, drive)) = changed {
        viewer.session.drive_joint(id, drive);
    }
    plots(ui, viewer);
}

/// Shows a slider with the present position, and returns what the user has chosen.
fn slider(ui: &mut Ui, control: &Control, reading: Option<JointReading>) -> Option<Drive> {
    let Control { drive, range, is_angle, .. } = control;
    let (mut value, word, unit, scale) = match *drive {
        Drive::Speed(speed) => (speed, "Speed of the motor", if *is_angle { "rad/s" } else { "units/s" }, 1.0),
        Drive::Target(target) if *is_angle => (target.to_degrees(), "Target of the spring", "°", 1.0_f32.to_degrees()),
        Drive::Target(target) => (target, "Target of the spring", "units", 1.0),
    };
    let broken = reading.is_some_and(|reading| reading.broken);
    let position = match reading {
        _ if broken => "broken".to_owned(),
        Some(reading) if *is_angle => format!("{:.1}°", reading.position.to_degrees()),
        Some(reading) => format!("{:.3}", reading.position),
        None => String::new(),
    };
    let about = format!("{word} of the joint, in {}. On the right: its position.", if unit == "°" { "degrees" } else { unit });
    let mut is_changed = false;
    row(ui, &control.name, &about, |ui| {
        let range = scale * *range.start()..=scale * *range.end();
        let widget = Slider::new(&mut value, range).clamping(SliderClamping::Never).max_decimals(2);
        is_changed = ui.add_enabled(!broken, widget).on_hover_text(&about).changed();
        ui.label(RichText::new(unit).weak().small());
        ui.label(RichText::new(position).monospace().small());
    });
    is_changed.then(|| match drive {
        Drive::Speed(_) => Drive::Speed(value),
        Drive::Target(_) => Drive::Target(value / scale),
    })
}

/// Shows the plots of joints over time.
fn plots(ui: &mut Ui, viewer: &Viewer) {
    let watch = &viewer.session.watch;
    let mut first = 0;
    for graph in watch.graphs() {
        let lines = graph.lines();
        let title = format!("{} in {} over time in s", graph.title(), graph.unit());
        ui.label(RichText::new(&title).weak().small());
        ui.horizontal_wrapped(|ui| {
            for (name, rgb) in lines {
                ui.label(RichText::new(name).color(colour(*rgb)).small());
            }
        });
        let points = |line: usize| -> Vec<[f64; 2]> {
            let all = watch.plotted().iter().map(|sample| [sample.time, sample.values[first + line]]);
            all.filter(|[_, value]| value.is_finite()).collect()
        };
        let shown: Vec<Vec<[f64; 2]>> = (0..lines.len()).map(points).collect();
        let names: Vec<&str> = lines.iter().map(|(name, _)| name.as_str()).collect();
        widened(plot(&format!("{title} {}", names.join(" ")), PLOT_HEIGHT), &shown.concat()).show(ui, |plot| {
            for ((name, rgb), points) in lines.iter().zip(shown) {
                plot.line(Line::new(name.as_str(), PlotPoints::from(points)).stroke(stroke(*rgb)));
            }
        });
        first += lines.len();
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn joints_with_names_come_first_and_ranges_stay() {
        let text = "set contact_law rigid\n@body bar mass=2\nB 0 -0.05 -0.05 1 0 0 0 0.1 0 0 0 0.1\n@end\n\
                    @place bar at=0,0,0 name=one\n@place bar at=0,0,5 name=two\n@place bar at=0,0,9 name=three\n\
                    @joint hinge world one at=0,0,0 axis=0,1,0 speed=2\n@joint slider world two at=0,0,5 name=plain\n\
                    @joint hinge world three at=0,0,9 axis=0,1,0 limits=-90..90 target=30 stiffness=5 name=leg\n";
        let initial = Scene::parse(text, Path::new("test")).unwrap().scene;
        let mut scene = initial.clone();
        let first = scene.joint_ids().next().unwrap();
        scene.update_joint(first, |joint| joint.speed = Some(3.0)).unwrap();
        let found = controls(&scene, &initial);
        let names: Vec<&str> = found.iter().map(|control| control.name.as_str()).collect();
        assert_eq!(names, ["leg", "hinge 0"]);
        assert_eq!((found[1].drive, found[1].range.clone()), (Drive::Speed(3.0), -4.0..=4.0));
        let half = std::f32::consts::FRAC_PI_2;
        assert_eq!((found[0].drive, found[0].range.clone()), (Drive::Target(30.0_f32.to_radians()), -half..=half));
    }
}
