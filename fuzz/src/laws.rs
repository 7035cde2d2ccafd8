//! Materials, pairs and laws of a case.

use rockfall::{
    CohesionModel, ContactForceLaw, ContactLaw, ContactResponse, ForceLaw, Material, MaterialId, Options, Pair, Precision,
    Result, RollingModel, Scene,
};

use super::case::{Laws, Properties, Solid};
use super::hard::{self, Setup};

/// Names of the materials of a case.
const NAMES: [&str; 2] = ["one", "other"];

/// The scene and the options of a case with laws, before objects are added, and its materials.
pub(crate) fn prepare(laws: &Laws, mut options: Options, hard: Option<&Setup>) -> Result<(Scene, Options, Vec<MaterialId>)> {
    let mut scene = Scene::new();
    let all = ContactLaw::ALL;
    scene.settings.contact_law = all[usize::from(laws.contact) % all.len()];
    scene.settings.collisions = laws.collisions.is_set();
    scene.settings.precision = if laws.double.is_set() { Precision::Double } else { Precision::Single };
    let mut ids = Vec::new();
    for (name, solid) in NAMES.into_iter().zip(&laws.solids) {
        let mut material = Material::new(name);
        put_solid(&mut material, solid);
        ids.push(scene.add_material(material)?);
    }
    for ([one, other], properties) in [[0, 0], [0, 1], [1, 1]].into_iter().zip(&laws.pairs) {
        scene.set_pair(ids[one], ids[other], pair(properties))?;
    }
    if let Some(setup) = hard {
        // It refuses laws of a program.
        hard::prepare(&mut scene, setup);
        return Ok((scene, options, ids));
    }
    if let Some(law) = force(laws.force) {
        options = options.force_law(law);
    }
    if let Some(law) = contact(laws.response) {
        options = options.contact_force_law(law);
    }
    Ok((scene, options, ids))
}

/// A fraction of 1, up to 1.
fn part(byte: u8) -> f32 {
    f32::from(byte) / 255.0
}

pub(crate) fn put_solid(material: &mut Material, solid: &Solid) {
    material.density = solid.density.map(|density| density.0);
    (material.young, material.poisson) = (Some(solid.young.0), Some(0.5 * part(solid.poisson)));
}

pub(crate) fn pair(of: &Properties) -> Pair {
    let mut pair = Pair::default();
    pair.restitution = of.restitution.map(part);
    pair.friction = of.friction.map(part);
    pair.stiffness = of.stiffness.map(|stiffness| stiffness.0);
    pair.characteristic_velocity = of.speed.map(|speed| speed.0);
    if let Some((friction, model, damping)) = of.rolling {
        let models = [RollingModel::SpringDashpot, RollingModel::ConstantTorque];
        (pair.rolling_friction, pair.rolling_model) = (Some(part(friction)), Some(models[usize::from(model)]));
        pair.rolling_damping = Some(damping.0);
    }
    pair.twisting_friction = of.twisting.map(part);
    if let Some((energy, necks)) = of.cohesion {
        let models = [CohesionModel::Dmt, CohesionModel::Jkr];
        (pair.surface_energy, pair.cohesion) = (Some(energy.0), Some(models[usize::from(necks)]));
    }
    pair
}

/// A force law with the parameter `k`. Without the feature `wgsl`, a simulation refuses those with a text.
pub(crate) fn force(which: u8) -> Option<ForceLaw> {
    let law = |text: &str| ForceLaw::new("pull").parameter("k", 2.0).wgsl(text);
    match which % 6 {
        0 | 1 => None,
        2 => Some(ForceLaw::new("pull").parameter("k", 2.0).function(|body| -body.parameters[0] * body.velocity)),
        3 => Some(law("force = -k * position; torque = -0.5 * angular_velocity;")),
        4 => Some(law(
            "for (var i = 0; i < 3; i++) { force += sin(k * time) * velocity.zxy; }\nif mass > 2.0 { force = -force; }",
        )),
        _ => Some(law("force = vec3f(k / (position.x - radius), 0.0, 0.0);")),
    }
}

/// A contact law with the parameter `k`.
fn contact(which: u8) -> Option<ContactForceLaw> {
    let law = || ContactForceLaw::new("push").parameter("k", 1e3).pair_parameter(NAMES, "k", 10.0);
    match which % 5 {
        0 | 1 => None,
        2 => Some(law().function(|contact| ContactResponse {
            normal_force: contact.parameters[0] * contact.overlap + contact.mass * contact.speed,
            tangential_stiffness: 0.5 * contact.parameters[0],
            tangential_damping: 1.0,
        })),
        3 => Some(law().wgsl("normal_force = k * pow(overlap, 1.5) * sqrt(radius);\ntangential_stiffness = shear + k;")),
        _ => Some(law().wgsl("for (var i = 0; i < 2; i++) { tangential_damping += k; }\nnormal_force = k / speed;")),
    }
}
