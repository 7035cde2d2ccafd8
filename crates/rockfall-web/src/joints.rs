//! Motors and springs of joints.

use rockfall_viewer::drives::controls;
use wasm_bindgen::prelude::*;

use crate::errors::thrown;
use crate::simulation::Simulation;

/// A slider for the motor or the spring of a joint.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug)]
pub struct JointControl {
    /// Name of the joint, or its kind and its number from 0.
    pub name: String,
    /// What the value is: the speed of a motor, or the target of a spring.
    pub title: String,
    /// Unit of the value.
    pub unit: String,
    /// Present value.
    pub value: f32,
    /// Least value of a slider.
    pub least: f32,
    /// Greatest value of a slider.
    pub greatest: f32,
}

#[wasm_bindgen]
impl Simulation {
    /// Sliders for the motors and springs of joints: those of joints with names first, and at most 100.
    #[wasm_bindgen(js_name = jointControls)]
    pub fn joint_controls(&self) -> Vec<JointControl> {
        let scene = self.inner.scene();
        let all = controls(scene, scene).into_iter().map(|control| {
            let (value, range) = control.shown();
            let (title, unit) = (control.drive.title().to_owned(), control.unit().to_owned());
            JointControl { name: control.name, title, unit, value, least: *range.start(), greatest: *range.end() }
        });
        all.collect()
    }

    /// Changes the value of a slider from the next step on. `index` is its place in `jointControls`, from 0.
    ///
    /// Throws for a value that is not allowed. An index that is too large changes nothing.
    #[wasm_bindgen(js_name = driveJoint)]
    pub fn drive_joint(&mut self, index: usize, value: f32) -> Result<(), JsValue> {
        let scene = self.inner.scene();
        let Some(control) = controls(scene, scene).into_iter().nth(index) else { return Ok(()) };
        let drive = control.drive_of(value);
        self.inner.update_joint(control.id, |joint| drive.give(joint)).map_err(thrown)
    }
}
