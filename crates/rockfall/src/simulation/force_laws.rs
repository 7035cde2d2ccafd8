//! Forces that the program defines: adding, changing and removing them between steps.

use crate::error::{Error, Result};
use crate::simulation::Simulation;
use crate::simulation::edit::Dirty;
use crate::user_laws::set::UserLaws;
use crate::user_laws::{ContactForceLaw, ForceInput, ForceLaw};

impl Simulation {
    /// Adds a force that the program defines. It acts from the next step on. On a GPU, some kernels are then compiled again.
    ///
    /// # Errors
    /// [`Error::Law`] when the law is not valid, has the name of another one, or has no WGSL and the simulation runs on a GPU.
    /// Nothing is changed then.
    pub fn add_force_law(&mut self, law: ForceLaw) -> Result<()> {
        let mut laws = self.options.force_laws.clone();
        laws.push(law);
        self.replace_force_laws(laws)
    }

    /// Removes a force that the program defined. On a GPU, some kernels are then compiled again.
    ///
    /// # Errors
    /// [`Error::Law`] when there is no law of this name.
    pub fn remove_force_law(&mut self, law: &str) -> Result<()> {
        let place = self.place_of_law(law)?;
        let mut laws = self.options.force_laws.clone();
        laws.remove(place);
        self.replace_force_laws(laws)
    }

    /// Changes a parameter of a force law from the next step on.
    ///
    /// # Errors
    /// [`Error::Law`] when there is no law of this name, when it has no such parameter, or for a value that is not finite.
    pub fn set_force_law_parameter(&mut self, law: &str, parameter: &str, value: f32) -> Result<()> {
        let place = self.place_of_law(law)?;
        let mut laws = self.options.force_laws.clone();
        laws[place].set_parameter(parameter, value)?;
        self.replace_force_laws(laws)
    }

    /// The forces that the program defined, in the order in which they act, with the present values of their parameters.
    pub fn force_laws(&self) -> &[ForceLaw] {
        &self.options.force_laws
    }

    fn place_of_law(&self, law: &str) -> Result<usize> {
        let names: Vec<&str> = self.options.force_laws.iter().map(ForceLaw::name).collect();
        names.iter().position(|name| *name == law).ok_or_else(|| {
            let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            ForceLaw::new(law).error(format!("there is no force law of this name, there are {known}"))
        })
    }

    pub(super) fn replace_force_laws(&mut self, laws: Vec<ForceLaw>) -> Result<()> {
        let contact = self.options.contact_force_law.clone();
        self.replace_laws(laws, contact)
    }

    /// Replaces all laws of the program.
    pub(super) fn replace_laws(&mut self, forces: Vec<ForceLaw>, contact: Option<ContactForceLaw>) -> Result<()> {
        let replacement = UserLaws::new(&forces, contact.as_ref())?;
        replacement.values(&self.scene.material_names())?;
        self.engine.check_laws(&replacement)?;
        self.put_laws(replacement, forces, contact);
        Ok(())
    }

    /// Puts laws that were checked in the place of the present ones.
    pub(super) fn put_laws(&mut self, laws: UserLaws, forces: Vec<ForceLaw>, contact: Option<ContactForceLaw>) {
        self.world.user_laws = laws;
        self.options.force_laws = forces;
        self.options.contact_force_law = contact;
        self.dirty = self.dirty.max(Dirty::Topology);
    }

    /// Replaces the error of a state that is not finite by that of the law that is the cause, if it is one.
    pub(super) async fn blame_law(&mut self, error: Error) -> Error {
        let Error::NonFinite { sphere: index, step, .. } = error else { return error };
        if self.world.user_laws.is_empty() {
            return error;
        }
        // The sphere was stopped at its last position. The velocity that it had is known if it was read before the step.
        let known = self.scene.spheres().get(index).cloned();
        let stopped = if self.pull().await.is_ok() { self.scene.spheres().get(index) } else { None };
        let what = format!("{} in step {step}", self.scene.name_of_sphere(index));
        let blamed = stopped.into_iter().chain(&known).find_map(|sphere| {
            let input = ForceInput {
                position: sphere.position,
                velocity: sphere.velocity,
                angular_velocity: sphere.angular_momentum / sphere.inertia(),
                mass: sphere.mass,
                radius: sphere.radius,
                time: self.muscle_clock.time() as f32,
                parameters: &[],
            };
            self.world.user_laws.forces.not_finite(&input, &what)
        });
        blamed.or_else(|| self.blamed_contact_law(index, step)).unwrap_or(error)
    }
}
