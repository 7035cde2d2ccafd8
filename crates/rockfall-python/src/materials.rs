//! Materials and the properties of their pairs.

use pyo3::exceptions::PyLookupError;
use pyo3::prelude::*;
use rockfall::{Material, MaterialId, Pair};

use crate::doors::{Change, look, with};
use crate::errors::Raise;
use crate::ids::Ids;

/// The material that stands for none.
const NONE: i64 = -1;

/// Three numbers that may be unknown.
type Known = [Option<f32>; 3];

/// The materials with these numbers, one per row.
pub(crate) fn materials_of(ids: &Ids, numbers: &[i64]) -> PyResult<Vec<Option<MaterialId>>> {
    numbers.iter().map(|number| material_of(ids, *number)).collect()
}

fn material_of(ids: &Ids, number: i64) -> PyResult<Option<MaterialId>> {
    if number == NONE { Ok(None) } else { known(ids, number).map(Some) }
}

fn known(ids: &Ids, number: i64) -> PyResult<MaterialId> {
    let found = usize::try_from(number).ok().and_then(|place| ids.materials.get(place));
    let text = || format!("there is no material {number}: expected a number that add_material returned, or a name");
    found.copied().ok_or_else(|| PyLookupError::new_err(text()))
}

/// The number of a material, or that which stands for none.
pub(crate) fn number_of(ids: &Ids, material: Option<MaterialId>) -> i64 {
    let found = material.and_then(|material| ids.materials.iter().position(|id| *id == material));
    found.map_or(NONE, |place| place as i64)
}

/// Restitution, friction, stiffness, characteristic velocity, rolling friction, rolling damping, twisting friction and surface
/// energy; the models of rolling resistance and cohesion.
type Properties = ([Option<f32>; 8], [Option<String>; 2]);

/// The numbers among the properties of a pair, in the order of [`Properties`].
fn numbers_of(pair: &mut Pair) -> [&mut Option<f32>; 8] {
    [
        &mut pair.restitution,
        &mut pair.friction,
        &mut pair.stiffness,
        &mut pair.characteristic_velocity,
        &mut pair.rolling_friction,
        &mut pair.rolling_damping,
        &mut pair.twisting_friction,
        &mut pair.surface_energy,
    ]
}

/// Adds a material and returns its number. The constants are density, Young's modulus and Poisson's ratio.
#[pyfunction]
pub(crate) fn add_material(target: &Bound<'_, PyAny>, name: &str, constants: Known) -> PyResult<usize> {
    with(target, |doors, ids| {
        let mut material = Material::new(name);
        [material.density, material.young, material.poisson] = constants;
        ids.materials.push(doors.add_material(material).or_raise()?);
        Ok(ids.materials.len() - 1)
    })
}

/// Changes the constants of a material that are given.
#[pyfunction]
pub(crate) fn update_material(target: &Bound<'_, PyAny>, number: i64, constants: Known) -> PyResult<()> {
    with(target, |doors, ids| {
        let id = known(ids, number)?;
        let [density, young, poisson] = constants;
        let change: Change<'_, Material> = &|material| {
            material.density = density.or(material.density);
            material.young = young.or(material.young);
            material.poisson = poisson.or(material.poisson);
        };
        doors.update_material(id, change).or_raise()
    })
}

/// Sets the properties of the contacts between two materials that are given. Others keep their values.
#[pyfunction]
pub(crate) fn set_pair(target: &Bound<'_, PyAny>, one: i64, other: i64, properties: Properties) -> PyResult<()> {
    with(target, |doors, ids| {
        let [one, other] = [known(ids, one)?, known(ids, other)?];
        let mut pair = doors.objects().given_pair(one, other).or_raise()?.unwrap_or_default();
        let (numbers, [rolling_model, cohesion]) = properties;
        let fields = numbers_of(&mut pair);
        fields.into_iter().zip(numbers).for_each(|(field, number)| *field = number.or(*field));
        let rolling_model = rolling_model.map(|model| model.parse()).transpose().or_raise()?;
        let cohesion = cohesion.map(|model| model.parse()).transpose().or_raise()?;
        pair.rolling_model = rolling_model.or(pair.rolling_model);
        pair.cohesion = cohesion.or(pair.cohesion);
        doors.set_pair(one, other, pair).or_raise()
    })
}

/// The properties of the contacts between two materials, given or mixed.
#[pyfunction]
pub(crate) fn pair(target: &Bound<'_, PyAny>, one: i64, other: i64) -> PyResult<Properties> {
    look(target, |scene, ids| {
        let mut pair = scene.pair(material_of(ids, one)?, material_of(ids, other)?).or_raise()?;
        let numbers = numbers_of(&mut pair).map(|number| *number);
        let models = [pair.rolling_model.map(|model| model.to_string()), pair.cohesion.map(|model| model.to_string())];
        Ok((numbers, models))
    })
}

/// Name, density, Young's modulus and Poisson's ratio of every material, in order of addition.
#[pyfunction]
pub(crate) fn materials(target: &Bound<'_, PyAny>) -> PyResult<Vec<(String, Known)>> {
    look(target, |scene, _| {
        let row = |material: &Material| (material.name.clone(), [material.density, material.young, material.poisson]);
        Ok(scene.materials().iter().map(row).collect())
    })
}
