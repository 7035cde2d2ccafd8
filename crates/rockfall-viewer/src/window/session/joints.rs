//! Motors and springs of joints that the user changes, and plots of joints.

use rockfall::JointId;

use super::Session;
use crate::drives::Drive;
use crate::plot::{Graph, Plot};

impl Session {
    /// Changes the motor or the spring of a joint from the next step on.
    pub(crate) fn drive_joint(&mut self, id: JointId, drive: Drive) {
        let Ok(before) = self.simulation.scene().joint(id).cloned() else { return };
        let changed = self.simulation.update_joint(id, |joint| drive.give(joint));
        if self.ok_or_report(changed).is_some() {
            self.edited_joint(id, before);
        }
    }

    /// Sets the plots of joints in this scene and in those that are opened later. A scene that lacks a joint does not have its plot.
    pub fn plot_joints(&mut self, plots: Vec<Plot>) {
        self.joint_plots = plots;
        self.watch_joints();
    }

    pub(super) fn watch_joints(&mut self) {
        let scene = self.simulation.scene();
        let graphs: Vec<Graph> = self.joint_plots.iter().filter_map(|plot| plot.of(scene, &[]).ok()).collect();
        self.watch.set_graphs(graphs);
    }
}
