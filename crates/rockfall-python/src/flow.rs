//! Inlets and outlets.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use rockfall::{Inlet, Outlet, Rate, Tag};

use crate::doors::with;
use crate::errors::Raise;
use crate::ids::handle;
use crate::materials::materials_of;
use crate::names::{Texts, tag_of};
use crate::simulation::Simulation;

/// Two opposite corners.
type Corners = [[f64; 3]; 2];
/// Name, number and mass, and for an inlet the number of spheres that wait.
type Row = (String, u64, f64, u64);

/// What an inlet lets in.
#[derive(FromPyObject)]
pub(crate) struct Spheres {
    #[pyo3(item)]
    rate: (String, f64),
    #[pyo3(item)]
    shape: Option<i64>,
    #[pyo3(item)]
    radius: Option<String>,
    #[pyo3(item)]
    by: String,
    #[pyo3(item)]
    mass: Option<f64>,
    #[pyo3(item)]
    density: Option<f64>,
    #[pyo3(item)]
    velocity: [f32; 3],
    #[pyo3(item)]
    times: (f64, f64),
    #[pyo3(item)]
    limit: Option<u64>,
    #[pyo3(item)]
    seed: u64,
    #[pyo3(item)]
    every: Option<u64>,
    #[pyo3(item)]
    group: u16,
    #[pyo3(item)]
    material: i64,
    #[pyo3(item)]
    tag: Option<Texts>,
}

/// Adds an inlet.
#[pyfunction]
pub(crate) fn add_inlet(target: &Bound<'_, PyAny>, name: String, corners: Corners, spheres: Spheres) -> PyResult<()> {
    let rate = match (spheres.rate.0.as_str(), spheres.rate.1) {
        ("rate", rate) => Rate::Number(rate),
        ("mass_rate", rate) => Rate::Mass(rate),
        (_, rate) => Rate::Volume(rate),
    };
    let mut inlet = Inlet::new(name, corners, rate, 1.0);
    if let Some(radius) = spheres.radius {
        inlet = inlet.radii(radius.parse().or_raise()?, spheres.by.parse().or_raise()?);
    }
    inlet = spheres.mass.map_or(inlet.clone(), |mass| inlet.mass(mass));
    inlet = spheres.density.map_or(inlet.clone(), |density| inlet.density(density));
    inlet = inlet.velocity(spheres.velocity).during(spheres.times.0, spheres.times.1).seed(spheres.seed).group(spheres.group);
    (inlet.limit, inlet.every) = (spheres.limit, spheres.every);
    let tag = spheres.tag.map(tag_of).transpose().or_raise()?;
    inlet = inlet.tag(tag.unwrap_or_else(Tag::new));
    with(target, |doors, ids| {
        inlet.material = materials_of(ids, &[spheres.material])?.pop().flatten();
        inlet.shape = spheres.shape.map(|shape| handle(&ids.shapes, "shape", shape)).transpose()?;
        doors.add_inlet(inlet).or_raise()
    })
}

/// Adds an outlet.
#[pyfunction]
pub(crate) fn add_outlet(target: &Bound<'_, PyAny>, name: String, corners: Corners, every: Option<u64>) -> PyResult<()> {
    let mut outlet = Outlet::new(name, corners);
    outlet.every = every;
    with(target, |doors, _| doors.add_outlet(outlet).or_raise())
}

/// What came in and left, and the number and mass of the spheres inside.
#[pyfunction]
pub(crate) fn flow(target: &Bound<'_, PyAny>) -> PyResult<(Vec<Row>, Vec<Row>, u64, f64)> {
    let simulation = target.cast::<Simulation>().map_err(|_| PyTypeError::new_err("target: expected a Simulation"))?;
    simulation.get().locked(target.py(), |running| {
        let flow = running.simulation.flow();
        let inlets = flow.inlets.into_iter().map(|inlet| (inlet.name, inlet.spheres, inlet.mass, inlet.waiting)).collect();
        let outlets = flow.outlets.into_iter().map(|outlet| (outlet.name, outlet.spheres, outlet.mass, 0)).collect();
        Ok((inlets, outlets, flow.spheres, flow.mass))
    })
}
