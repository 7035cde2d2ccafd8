//! Forces and the contact law that a program defines.

use pyo3::prelude::*;
use rockfall::{ContactForceLaw, ContactInput, ForceLaw};

use crate::arguments::{ContactLaw, Law, law};
use crate::errors::Raise;
use crate::simulation::Simulation;

/// Adds a law to a simulation.
#[pyfunction]
pub(crate) fn add_force_law(simulation: &Bound<'_, Simulation>, given: Law) -> PyResult<()> {
    simulation.get().edit(simulation.py(), |running| running.simulation.add_force_law(law(given)).or_raise())
}

/// Removes a law from a simulation.
#[pyfunction]
pub(crate) fn remove_force_law(simulation: &Bound<'_, Simulation>, name: &str) -> PyResult<()> {
    simulation.get().edit(simulation.py(), |running| running.simulation.remove_force_law(name).or_raise())
}

/// Changes a parameter of a law.
#[pyfunction]
pub(crate) fn set_force_law_parameter(
    simulation: &Bound<'_, Simulation>,
    name: &str,
    parameter: &str,
    value: f32,
) -> PyResult<()> {
    let set = |simulation: &mut rockfall::Simulation| simulation.set_force_law_parameter(name, parameter, value);
    simulation.get().edit(simulation.py(), |running| set(&mut running.simulation).or_raise())
}

/// The laws of a simulation, with the present values of their parameters.
#[pyfunction]
pub(crate) fn force_laws(simulation: &Bound<'_, Simulation>) -> PyResult<Vec<Law>> {
    simulation.get().locked(simulation.py(), |running| {
        let law =
            |law: &ForceLaw| (law.name().to_owned(), law.wgsl_text().unwrap_or_default().to_owned(), law.parameters().to_vec());
        Ok(running.simulation.force_laws().iter().map(law).collect())
    })
}

/// Changes a parameter of the contact law: for two materials, or for all that have no value of their own.
#[pyfunction]
pub(crate) fn set_contact_law_parameter(
    simulation: &Bound<'_, Simulation>,
    parameter: &str,
    value: f32,
    materials: Option<(String, String)>,
) -> PyResult<()> {
    simulation.get().edit(simulation.py(), |running| {
        match &materials {
            None => running.simulation.set_contact_law_parameter(parameter, value),
            Some((one, other)) => running.simulation.set_contact_law_pair_parameter([one, other], parameter, value),
        }
        .or_raise()
    })
}

/// The contact law of a simulation, with the present values of its parameters.
#[pyfunction]
pub(crate) fn contact_law(simulation: &Bound<'_, Simulation>) -> PyResult<Option<ContactLaw>> {
    simulation.get().locked(simulation.py(), |running| {
        let law = |law: &ContactForceLaw| {
            let pairs = law.pair_parameters().iter().map(|pair| {
                let [one, other] = pair.materials.clone();
                (one, other, pair.parameter.clone(), pair.value)
            });
            let text = law.wgsl_text().unwrap_or_default().to_owned();
            (law.name().to_owned(), text, law.parameters().to_vec(), pairs.collect())
        };
        Ok(running.simulation.contact_force_law().map(law))
    })
}

/// The duration, the largest overlap and the restitution of an impact by a law; `None` if there is no rebound.
#[pyfunction]
pub(crate) fn impact(given: ContactLaw, numbers: [f32; 5]) -> PyResult<Option<(f64, f64, f64)>> {
    let mut contact = ContactInput::default();
    [contact.speed, contact.mass, contact.radius, contact.young, contact.shear] = numbers;
    let found = crate::arguments::contact_law(given).impact(&contact).or_raise()?;
    Ok(found.map(|impact| (impact.seconds, impact.overlap, impact.restitution)))
}
