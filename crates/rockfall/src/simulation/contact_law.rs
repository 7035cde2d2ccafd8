//! The contact law that the program defines: replacing it and changing its parameters between steps.

use crate::error::{Error, Result};
use crate::physics::chain::touch;
use crate::physics::laws::contact::not_finite;
use crate::physics::surface::visible_row;
use crate::settings::ContactLaw;
use crate::simulation::Simulation;
use crate::simulation::observed::{observe, view_and_lists};
use crate::user_laws::ContactForceLaw;

impl Simulation {
    /// Replaces the contact law that the program defines, from the next step on, and sets `contact_law` to `user`. On a GPU, some
    /// kernels are then compiled again. Contacts keep their tangential springs.
    ///
    /// # Errors
    /// [`Error::Law`] when the law is not valid, names a material that the scene does not have, or has no WGSL and the simulation runs
    /// on a GPU; [`Error::Invalid`] when the integrator does not allow it. Nothing is changed then.
    pub fn set_contact_force_law(&mut self, law: ContactForceLaw) -> Result<()> {
        let before = self.options.contact_force_law.clone();
        self.replace_contact_law(Some(law))?;
        let mut settings = *self.settings();
        if settings.contact_law != ContactLaw::User {
            let set = settings.set("contact_law", ContactLaw::User.name());
            if let Err(error) = set.and_then(|()| self.set_settings(settings)) {
                self.replace_contact_law(before)?;
                return Err(error);
            }
        }
        Ok(())
    }

    /// Changes a parameter of the contact law that the program defines, for all pairs of materials that have no value of their own,
    /// from the next step on.
    ///
    /// # Errors
    /// [`Error::Law`] when the simulation has no such law, when the law has no such parameter, or for a value that is not finite.
    pub fn set_contact_law_parameter(&mut self, parameter: &str, value: f32) -> Result<()> {
        let mut law = self.present_contact_law()?;
        law.set_parameter(parameter, value)?;
        self.replace_contact_law(Some(law))
    }

    /// Changes a parameter of the contact law that the program defines, for the contacts of two materials, which are given by their
    /// names, from the next step on.
    ///
    /// # Errors
    /// As for [`Simulation::set_contact_law_parameter`], and [`Error::Law`] for a material that the scene does not have.
    pub fn set_contact_law_pair_parameter(&mut self, materials: [&str; 2], parameter: &str, value: f32) -> Result<()> {
        let mut law = self.present_contact_law()?;
        law.set_pair_parameter(materials, parameter, value)?;
        self.replace_contact_law(Some(law))
    }

    /// The contact law that the program defined, with the present values of its parameters.
    pub fn contact_force_law(&self) -> Option<&ContactForceLaw> {
        self.options.contact_force_law.as_ref()
    }

    /// The error of the contact law if its response for a contact of a sphere is not finite.
    pub(super) fn blamed_contact_law(&self, sphere: usize, step: u64) -> Option<Error> {
        let laws = &self.world.user_laws;
        laws.contact.as_ref().filter(|_| self.settings().contact_law == ContactLaw::User)?;
        let world = observe(&self.scene, self.time_step, self.methods(), step, &self.muscle_clock, laws).ok()?;
        let (view, lists) = view_and_lists(&world);
        visible_row(&view, &lists, sphere as u32).find_map(|entry| {
            let (a, b) = view.ordered(sphere as u32, entry.id());
            let touch = touch(&view, a, b, entry.feature())?;
            not_finite(&view, [a, b], &touch, &format!("a contact of {} in step {step}", self.scene.name_of_sphere(sphere)))
        })
    }

    fn present_contact_law(&self) -> Result<ContactForceLaw> {
        let missing = || Error::Law {
            law: String::new(),
            line: 0,
            column: 0,
            text: String::new(),
            message: "the simulation has no contact law of the program".to_owned(),
        };
        self.options.contact_force_law.clone().ok_or_else(missing)
    }

    fn replace_contact_law(&mut self, law: Option<ContactForceLaw>) -> Result<()> {
        let forces = self.options.force_laws.clone();
        self.replace_laws(forces, law)?;
        // Velocity Verlet keeps the forces of the last evaluation.
        self.status.forces_due = 1;
        Ok(())
    }
}
