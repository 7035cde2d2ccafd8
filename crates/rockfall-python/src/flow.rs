//! Inlets and outlets.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use rockfall::{GrainKind, Inlet, Outlet, Rate, Tag};

use crate::doors::with;
use crate::errors::Raise;
use crate::ids::{Ids, handle};
use crate::materials::materials_of;
use crate::names::{Texts, tag_of};
use crate::simulation::Simulation;

/// Two opposite corners.
type Corners = [[f64; 3]; 2];
/// Name, number and mass, and for an inlet the number of spheres that wait.
type Row = (String, u64, f64, u64);

/// When and how fast an inlet lets grains in.
#[derive(FromPyObject)]
pub(crate) struct Feed {
    #[pyo3(item)]
    rate: (String, f64),
    #[pyo3(item)]
    shares: String,
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
}

/// A kind of grains and its share.
#[derive(FromPyObject)]
pub(crate) struct Grains {
    #[pyo3(item)]
    share: f64,
    #[pyo3(item)]
    name: String,
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
    group: u16,
    #[pyo3(item)]
    material: i64,
    #[pyo3(item)]
    tag: Option<Texts>,
}

impl Grains {
    fn kind(self, ids: &Ids) -> PyResult<GrainKind> {
        let mut kind = match (self.shape, self.radius) {
            (Some(shape), _) => GrainKind::bodies(handle(&ids.shapes, "shape", shape)?),
            (None, Some(radius)) => GrainKind::spheres(1.0).radii(radius.parse().or_raise()?, self.by.parse().or_raise()?),
            (None, None) => return Err(PyTypeError::new_err("shape, radius: expected one of them")),
        };
        kind = self.mass.map_or(kind.clone(), |mass| kind.mass(mass));
        kind = self.density.map_or(kind.clone(), |density| kind.density(density));
        kind.material = materials_of(ids, &[self.material])?.pop().flatten();
        let tag = self.tag.map(tag_of).transpose().or_raise()?;
        Ok(kind.name(self.name).group(self.group).tag(tag.unwrap_or_else(Tag::new)))
    }
}

/// Adds an inlet.
#[pyfunction]
pub(crate) fn add_inlet(
    target: &Bound<'_, PyAny>,
    name: String,
    corners: Corners,
    feed: Feed,
    kinds: Vec<Grains>,
) -> PyResult<()> {
    let rate = match (feed.rate.0.as_str(), feed.rate.1) {
        ("rate", rate) => Rate::Number(rate),
        ("mass_rate", rate) => Rate::Mass(rate),
        (_, rate) => Rate::Volume(rate),
    };
    let inlet = Inlet::new(name, corners, rate, 1.0);
    let mut inlet = inlet.velocity(feed.velocity).during(feed.times.0, feed.times.1).seed(feed.seed);
    (inlet.limit, inlet.every) = (feed.limit, feed.every);
    let shares = feed.shares.parse().or_raise()?;
    with(target, |doors, ids| {
        let kinds: Vec<_> = kinds.into_iter().map(|kind| Ok((kind.share, kind.kind(ids)?))).collect::<PyResult<_>>()?;
        doors.add_inlet(inlet.mix(kinds.into_iter().map(|(share, kind)| (kind, share)), shares)).or_raise()
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
