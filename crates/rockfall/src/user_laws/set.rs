//! All laws of a simulation, in the form in which the two backends use them.

use crate::error::{Result, quoted};
use crate::user_laws::forces::ForceLaws;
use crate::user_laws::{ContactForceLaw, ForceLaw};

/// The laws of a simulation.
#[derive(Clone, Debug, Default)]
pub(crate) struct UserLaws {
    pub(crate) forces: ForceLaws,
    pub(crate) contact: Option<ContactForceLaw>,
}

impl UserLaws {
    /// Checks laws and compiles them.
    pub(crate) fn new(forces: &[ForceLaw], contact: Option<&ContactForceLaw>) -> Result<Self> {
        contact.into_iter().try_for_each(ContactForceLaw::check)?;
        Ok(Self { forces: ForceLaws::new(forces)?, contact: contact.cloned() })
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.forces.is_empty() && self.contact.is_none()
    }

    /// The values that kernels read: the parameters of all force laws, then those of the contact law for each pair of materials.
    /// `materials` are the names of the materials of the scene.
    ///
    /// # Errors
    /// [`Error::Law`](crate::Error::Law) for a pair of materials that the scene does not have.
    pub(crate) fn values(&self, materials: &[&str]) -> Result<Vec<f32>> {
        let mut values = self.forces.parameters().to_vec();
        let Some(law) = &self.contact else { return Ok(values) };
        let (count, numbers) = (law.parameters().len(), materials.len() + 1);
        let first = values.len();
        for _ in 0..numbers * numbers {
            values.extend(law.parameters().iter().map(|(_, value)| *value));
        }
        for pair in law.pair_parameters() {
            let mut found = [0; 2];
            for (number, name) in found.iter_mut().zip(&pair.materials) {
                let place = materials.iter().position(|material| material == name);
                *number = 1 + place.ok_or_else(|| {
                    let names = if materials.is_empty() { "none".to_owned() } else { materials.join(", ") };
                    let (parameter, name) = (quoted(&pair.parameter), quoted(name));
                    law.error(format!("parameter {parameter} is given for the material {name}; the scene has {names}"))
                })?;
            }
            let place = law.parameters().iter().position(|(name, _)| *name == pair.parameter).unwrap_or_default();
            for [one, other] in [found, [found[1], found[0]]] {
                values[first + (one * numbers + other) * count + place] = pair.value;
            }
        }
        Ok(values)
    }

    /// Place of the parameters of the contact law for a pair of materials, by its number, after the first value.
    pub(crate) fn contact_values_at(&self, pair: u32) -> u32 {
        let count = self.contact.as_ref().map_or(0, |law| law.parameters().len());
        self.forces.parameters().len() as u32 + pair * count as u32
    }
}

/// The text of laws for kernels.
#[cfg(feature = "gpu")]
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct KernelLaws {
    forces: std::sync::Arc<str>,
    contact: std::sync::Arc<str>,
}

#[cfg(feature = "gpu")]
mod kernels {
    use super::{KernelLaws, Result, UserLaws};
    use crate::user_laws::forces;

    /// The function of contacts that has to be replaced in kernels (`laws/user.wgsl`).
    const PLACE: &str =
        "fn user_response(pair: u32, contact: UserContact) -> Response {\n    return Response(0.0, 0.0, 0.0);\n}\n";

    impl UserLaws {
        /// The text of the laws for kernels.
        ///
        /// # Errors
        /// [`Error::Law`](crate::Error::Law) for a law that has no WGSL.
        pub(crate) fn kernel_text(&self) -> Result<KernelLaws> {
            let forces = self.forces.kernel_text()?;
            let Some(law) = &self.contact else { return Ok(KernelLaws { forces, ..KernelLaws::default() }) };
            // The text has no names of its own that begin with `rockfall_`.
            let text = law.kernel_text()?.replace("rockfall_law", "rockfall_contact");
            let text = text.replace("rockfall_result", "rockfall_response");
            let (first, count) = (self.contact_values_at(0), law.parameters().len());
            let parameters: String = (0..count)
                .map(|place| format!(", float_at(step.laws_at + {}u + {count}u * pair)", first as usize + place))
                .collect();
            let contact = format!(
                "{text}fn user_response(pair: u32, contact: UserContact) -> Response {{\n    let found = rockfall_contact(\
                 contact.overlap, contact.speed, contact.radius, contact.mass, contact.young, contact.shear{parameters});\n    \
                 return Response(found.normal_force, found.tangential_stiffness, found.tangential_damping);\n}}\n"
            );
            Ok(KernelLaws { forces, contact: contact.into() })
        }
    }

    impl KernelLaws {
        /// Puts the laws into the text of a kernel.
        pub(crate) fn put_into(&self, kernel: &str) -> String {
            let kernel = forces::with_laws(kernel, &self.forces);
            if self.contact.is_empty() { kernel } else { kernel.replace(PLACE, &self.contact) }
        }

        /// The laws that a kernel evaluates. `files` gives the texts of its files.
        pub(crate) fn used_by<'a>(&self, files: impl FnOnce() -> Vec<&'a str>) -> Self {
            let mut used = Self::default();
            if *self == used {
                // Reading all files takes half a millisecond in a browser.
                return used;
            }
            for file in files() {
                if forces::takes_laws(file) {
                    used.forces.clone_from(&self.forces);
                }
                if file.contains(PLACE) {
                    used.contact.clone_from(&self.contact);
                }
            }
            used
        }
    }
}
