//! Constants of the contact laws with history, from materials and pairs (docs/physics.md section 4.11).

use crate::error::{Error, Result};
use crate::scene::restitution::damping_for;
use crate::scene::{Material, RollingModel, Scene};
use crate::settings::{ContactLaw, Integrator};

/// Ratio of the tangential to the normal stiffness in the law `linear`.
pub(crate) const TANGENTIAL_RATIO: f32 = 2.0 / 7.0;
/// Ratio of rolling damping where a pair has none: that of Ai, Chen, Rotter and Ooi (2011).
const ROLLING_DAMPING: f32 = 0.3;

/// Damping for each restitution that was asked for. Finding it takes milliseconds.
#[derive(Default)]
pub(crate) struct Dampings(Vec<(f32, f32)>);

impl Dampings {
    fn of(&mut self, law: ContactLaw, restitution: f32) -> f32 {
        if let Some((_, known)) = self.0.iter().find(|(known, _)| *known == restitution) {
            return *known;
        }
        let damping = damping_for(law, restitution);
        self.0.push((restitution, damping));
        damping
    }
}

impl Scene {
    /// Checks that the contact law of the scene has all the constants that it needs, and that the integrator suits it. A
    /// [`Simulation`](crate::Simulation) makes the same check.
    ///
    /// # Errors
    /// [`Error::Invalid`], which names the first object or pair of materials without a constant.
    pub fn check_contact_law(&self, integrator: Integrator) -> Result<()> {
        let law = self.settings.contact_law;
        if !law.has_history() {
            return Ok(());
        }
        let refused = |value: String, expected: &'static str| Err(Error::Invalid { field: "contact_law", value, expected });
        if integrator == Integrator::Rk4 {
            return refused(
                format!("{law} with the integrator rk4"),
                "the integrator symplectic-euler, because the law keeps a tangential spring, which needs one evaluation per step",
            );
        }
        if !(0.0..=1.0).contains(&self.settings.restitution) {
            return refused(format!("{law} with a restitution of {}", self.settings.restitution), "a restitution from 0 to 1");
        }
        let moves = |id| self.sphere(id).is_ok_and(|sphere| !sphere.fixed);
        // For each object: its material, and whether it may move.
        let kinds = [
            self.spheres().iter().map(|sphere| (sphere.material, !sphere.fixed)).collect::<Vec<_>>(),
            self.rods().iter().map(|rod| (rod.material, moves(rod.end1) || moves(rod.end2))).collect(),
            self.boxes().iter().map(|cuboid| (cuboid.material, false)).collect(),
            self.polygons().iter().map(|polygon| (polygon.material, false)).collect(),
        ];
        let (mut used, mut moving) = (vec![0_usize; self.materials().len() + 1], vec![false; self.materials().len() + 1]);
        for (kind, objects) in ["sphere", "rod", "box", "polygon"].into_iter().zip(&kinds) {
            for (index, (material, moves)) in objects.iter().enumerate() {
                let number = usize::from(self.material_number(*material)?);
                if number == 0 {
                    return refused(format!("{law} with {kind} {index}, which has no material"), "a material for every object");
                }
                used[number] += 1;
                moving[number] |= moves;
            }
        }
        let may_touch = |one: u16, other: u16| {
            let [one, other] = [usize::from(one), usize::from(other)];
            (moving[one] || moving[other]) && (one != other || used[one] > 1)
        };
        let used: Vec<u16> = (1..used.len()).filter(|number| used[*number] > 0).map(|number| number as u16).collect();
        let name = |number: u16| &self.materials()[usize::from(number) - 1];
        for (place, one) in used.iter().enumerate() {
            let Material { name: one_name, young, poisson, .. } = name(*one);
            if law == ContactLaw::HertzMindlin && (young.is_none() || poisson.is_none()) {
                return refused(format!("{law} with the material {one_name}"), "a material with young and poisson");
            }
            for other in &used[place..] {
                let lacks = may_touch(*one, *other) && self.normal_stiffness(*one, *other, 1.0, 1.0).is_none();
                if law == ContactLaw::Linear && lacks {
                    return refused(
                        format!("{law} with the pair {one_name} {}", name(*other).name),
                        "a pair with stiffness, or its materials with a stiffness with themselves; or characteristic_velocity, and \
                         materials with young and poisson",
                    );
                }
            }
        }
        Ok(())
    }

    /// Constants of a pair of numbers of materials for the law of the scene: normal, tangential, damping, friction;
    /// rolling friction, rolling damping (negative for the model of constant torque), twisting friction, pull-off force per R*. 0 where
    /// the law has no constants for the pair.
    pub(crate) fn law_constants(&self, one: u16, other: u16, dampings: &mut Dampings) -> [f32; 8] {
        let law = self.settings.contact_law;
        let pair = self.pair_of_numbers(one, other);
        let known = match law {
            ContactLaw::Thesis => None,
            ContactLaw::Linear => match pair.stiffness {
                Some(stiffness) => Some([stiffness, TANGENTIAL_RATIO * stiffness]),
                None => pair.characteristic_velocity.zip(self.moduli(one, other)).map(|(speed, [young, _])| [-young, speed]),
            },
            ContactLaw::HertzMindlin => self.moduli(one, other),
        };
        let Some([normal, tangential]) = known else {
            return [0.0; 8];
        };
        let restitution = pair.restitution.unwrap_or(self.settings.restitution);
        let friction = pair.friction.unwrap_or(self.settings.coulomb_friction);
        let rolling_damping = match pair.rolling_model.unwrap_or_default() {
            RollingModel::SpringDashpot => pair.rolling_damping.unwrap_or(ROLLING_DAMPING),
            RollingModel::ConstantTorque => -1.0,
        };
        // DMT: 4 pi gamma R*.
        let cohesion = 4.0 * std::f32::consts::PI * pair.surface_energy.unwrap_or_default();
        let [rolling, twisting] = [pair.rolling_friction, pair.twisting_friction].map(Option::unwrap_or_default);
        [normal, tangential, dampings.of(law, restitution), friction, rolling, rolling_damping, twisting, cohesion]
    }

    /// Normal stiffness of the law `linear` for two materials, from R* and m*.
    pub(crate) fn normal_stiffness(&self, one: u16, other: u16, radius: f64, mass: f64) -> Option<f64> {
        let pair = self.pair_of_numbers(one, other);
        if let Some(stiffness) = pair.stiffness {
            return Some(stiffness.into());
        }
        let (speed, [young, _]) = pair.characteristic_velocity.zip(self.moduli(one, other))?;
        let hertz = 16.0 / 15.0 * radius.sqrt() * f64::from(young);
        Some(hertz * (mass * f64::from(speed).powi(2) / hertz).powf(0.2))
    }

    /// E* and G* of two materials: 1/E* = (1 - nu_i^2)/E_i + (1 - nu_j^2)/E_j, 1/G* = (2 - nu_i)/G_i + (2 - nu_j)/G_j, with
    /// G = E / (2 (1 + nu)).
    pub(crate) fn moduli(&self, one: u16, other: u16) -> Option<[f32; 2]> {
        let of = |number: u16| {
            let material = self.materials().get(usize::from(number).checked_sub(1)?)?;
            let (young, poisson) = (f64::from(material.young?), f64::from(material.poisson?));
            Some([(1.0 - poisson * poisson) / young, (2.0 - poisson) * 2.0 * (1.0 + poisson) / young])
        };
        let ([normal, tangential], [other_normal, other_tangential]) = (of(one)?, of(other)?);
        Some([(1.0 / (normal + other_normal)) as f32, (1.0 / (tangential + other_tangential)) as f32])
    }
}
