//! Names, colours, labels and looks of objects.

use std::collections::HashSet;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::{Colour, Look, ObjectId, Tag};

use crate::arguments::Numbers;
use crate::doors::{look, with};
use crate::errors::Raise;
use crate::ids::{Ids, handle};

/// Name, colour, label and look.
pub(crate) type Texts = (Option<String>, Option<String>, Option<String>, Option<String>);

pub(crate) fn tag_of((name, colour, label, look): Texts) -> rockfall::Result<Tag> {
    let mut tag = Tag::new();
    (tag.name, tag.label) = (name, label);
    tag.colour = colour.as_deref().map(str::parse::<Colour>).transpose()?;
    tag.look = look.as_deref().map(str::parse::<Look>).transpose()?;
    tag.validate()?;
    Ok(tag)
}

/// Checks a name, a colour, a label and a look.
#[pyfunction]
pub(crate) fn check_tag(tag: Texts) -> PyResult<()> {
    tag_of(tag).map(drop).or_raise()
}

pub(crate) fn object(ids: &Ids, kind: &str, number: i64) -> PyResult<ObjectId> {
    Ok(match kind {
        "sphere" => handle(&ids.spheres, kind, number)?.into(),
        "rod" => handle(&ids.rods, kind, number)?.into(),
        "capsule" => handle(&ids.capsules, kind, number)?.into(),
        "spring" => handle(&ids.springs, kind, number)?.into(),
        "box" => handle(&ids.boxes, kind, number)?.into(),
        "polygon" => handle(&ids.polygons, kind, number)?.into(),
        "body" => handle(&ids.bodies, kind, number)?.into(),
        _ => return Err(PyValueError::new_err(format!("kind: a {kind} has no name"))),
    })
}

/// Replaces the name, colour, label and look of objects of one kind.
#[pyfunction]
pub(crate) fn set_tags(target: &Bound<'_, PyAny>, kind: &str, numbers: Numbers<'_>, tag: Texts) -> PyResult<()> {
    let numbers = numbers.as_slice()?;
    let tag = tag_of(tag).or_raise()?;
    with(target, |doors, ids| {
        let objects: Vec<_> = numbers.iter().map(|number| object(ids, kind, *number)).collect::<PyResult<_>>()?;
        objects.iter().try_for_each(|id| doors.objects().tag(*id).map(drop)).or_raise()?;
        objects.into_iter().try_for_each(|id| doors.set_tag(id, tag.clone())).or_raise()
    })
}

/// The name, colour, label and look of an object.
#[pyfunction]
pub(crate) fn tag(target: &Bound<'_, PyAny>, kind: &str, number: i64) -> PyResult<Texts> {
    look(target, |scene, ids| {
        let tag = scene.tag(object(ids, kind, number)?).or_raise()?.cloned().unwrap_or_default();
        let look = tag.look.map(|look| look.to_string());
        Ok((tag.name, tag.colour.map(|colour| colour.to_string()), tag.label, look))
    })
}

/// All names.
#[pyfunction]
pub(crate) fn names(target: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    look(target, |scene, _| Ok(scene.names().into_iter().map(str::to_owned).collect()))
}

/// The numbers of the objects with a name: spheres, rods, capsules, springs, boxes and polygons.
#[pyfunction]
pub(crate) fn named(target: &Bound<'_, PyAny>, name: &str) -> PyResult<[Vec<i64>; 6]> {
    look(target, |scene, ids| {
        let found: HashSet<ObjectId> = scene.named(name).or_raise()?.into_iter().collect();
        fn numbers<T: Copy + Into<ObjectId>>(handles: &[T], found: &HashSet<ObjectId>) -> Vec<i64> {
            (0..).zip(handles).filter(|(_, handle)| found.contains(&(**handle).into())).map(|(number, _)| number).collect()
        }
        Ok([
            numbers(&ids.spheres, &found),
            numbers(&ids.rods, &found),
            numbers(&ids.capsules, &found),
            numbers(&ids.springs, &found),
            numbers(&ids.boxes, &found),
            numbers(&ids.polygons, &found),
        ])
    })
}
