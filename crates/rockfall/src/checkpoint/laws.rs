//! The laws of a checkpoint that the program defined. A file has their names, parameters and a hash of their text: the program gives
//! the laws again.

use super::Checkpoint;
use crate::error::{Result, quoted};
use crate::user_laws::{ContactForceLaw, ForceLaw, PairParameter};

/// A law of the simulation that took a checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KeptLaw {
    pub(crate) name: String,
    /// Hash of the WGSL text, 0 without a text.
    pub(crate) text_hash: u64,
    pub(crate) parameters: Vec<(String, f32)>,
}

impl KeptLaw {
    pub(crate) fn of(law: &ForceLaw) -> Self {
        let parameters = law.parameters().to_vec();
        Self { name: law.name().to_owned(), text_hash: law.text_hash(), parameters }
    }

    /// Checks that a law is this one, and gives it the values of the parameters.
    ///
    /// # Errors
    /// [`Error::Law`](crate::Error::Law) when its text or the names of its parameters differ.
    pub(crate) fn restore(&self, law: &mut ForceLaw) -> Result<()> {
        self.compare(law.text_hash(), law.parameters()).map_err(|message| law.error(message))?;
        self.parameters.iter().try_for_each(|(name, value)| law.set_parameter(name, *value))
    }

    /// Returns what differs between this law and another one, if anything does.
    fn compare(&self, text_hash: u64, parameters: &[(String, f32)]) -> std::result::Result<(), String> {
        if text_hash != self.text_hash {
            return Err("its WGSL is not that of the law in the checkpoint".to_owned());
        }
        let names = |parameters: &[(String, f32)]| -> Vec<String> { parameters.iter().map(|(name, _)| name.clone()).collect() };
        let (own, kept) = (names(parameters), names(&self.parameters));
        if own != kept {
            let [own, kept] = [own, kept].map(|names| quoted(&names.join(", ")));
            return Err(format!("its parameters are {own}, those of the law in the checkpoint {kept}"));
        }
        Ok(())
    }
}

/// The contact law of the simulation that took a checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KeptContactLaw {
    pub(crate) law: KeptLaw,
    pub(crate) pairs: Vec<PairParameter>,
}

impl KeptContactLaw {
    pub(crate) fn of(law: &ContactForceLaw) -> Self {
        let parameters = law.parameters().to_vec();
        let kept = KeptLaw { name: law.name().to_owned(), text_hash: law.text_hash(), parameters };
        Self { law: kept, pairs: law.pair_parameters().to_vec() }
    }

    /// Returns a law with the values of the parameters of this one.
    ///
    /// # Errors
    /// [`Error::Law`](crate::Error::Law) when its name, its text or the names of its parameters differ.
    fn restored(&self, law: &ContactForceLaw) -> Result<ContactForceLaw> {
        if law.name() != self.law.name {
            return Err(law.error(format!("the simulation of the checkpoint had the contact law {}", quoted(&self.law.name))));
        }
        self.law.compare(law.text_hash(), law.parameters()).map_err(|message| law.error(message))?;
        let mut law = law.clone();
        self.law.parameters.iter().try_for_each(|(name, value)| law.set_parameter(name, *value))?;
        law.replace_pairs(self.pairs.clone())?;
        Ok(law)
    }
}

impl Checkpoint {
    /// Gives a force law that the simulation had. A checkpoint in a file has only the names of force laws, their parameters and a hash
    /// of their WGSL, so all laws must be given before the simulation is resumed. The parameters get the values of the checkpoint. A
    /// function of Rust cannot be compared: it must be the same one for the same results.
    ///
    /// # Errors
    /// [`Error::Law`](crate::Error::Law) when the checkpoint lacks no law of this name, and when the WGSL or the names of the
    /// parameters differ.
    pub fn give_force_law(&mut self, mut law: ForceLaw) -> Result<()> {
        let missing: Vec<&KeptLaw> = self.missing_laws().collect();
        let Some(kept) = missing.iter().find(|kept| kept.name == law.name()) else {
            let names: Vec<&str> = missing.iter().map(|kept| kept.name.as_str()).collect();
            let expected =
                if names.is_empty() { "lacks no force law".to_owned() } else { format!("lacks {}", names.join(", ")) };
            return Err(law.error(format!("the checkpoint {expected}")));
        };
        kept.restore(&mut law)?;
        self.options.force_laws.push(law);
        // Forces are summed in the order of the laws.
        let place = |law: &ForceLaw| self.kept_laws.iter().position(|kept| kept.name == law.name());
        self.options.force_laws.sort_by_key(place);
        Ok(())
    }

    fn missing_laws(&self) -> impl Iterator<Item = &KeptLaw> {
        let is_given = |kept: &&KeptLaw| self.options.force_laws.iter().any(|law| law.name() == kept.name);
        self.kept_laws.iter().filter(move |kept| !is_given(kept))
    }

    /// Gives the contact law that the simulation had. A checkpoint in a file has only its name, its parameters and a hash of its WGSL,
    /// so it must be given before the simulation is resumed. The parameters get the values of the checkpoint. A function of Rust cannot
    /// be compared: it must be the same one for the same results.
    ///
    /// # Errors
    /// [`Error::Law`](crate::Error::Law) when the simulation had no contact law of the program or another one.
    pub fn give_contact_force_law(&mut self, law: ContactForceLaw) -> Result<()> {
        let Some(kept) = &self.kept_contact_law else {
            return Err(law.error("the checkpoint lacks no contact law"));
        };
        self.options.contact_force_law = Some(kept.restored(&law)?);
        Ok(())
    }

    /// The contact law of a simulation, with the parameters that it has in this checkpoint.
    ///
    /// # Errors
    /// [`Error::Law`](crate::Error::Law) when the law is not that of the checkpoint.
    pub(crate) fn restored_contact_law(&self, law: Option<&ContactForceLaw>) -> Result<Option<ContactForceLaw>> {
        let present = self.options.contact_force_law.as_ref().map(KeptContactLaw::of);
        match (self.kept_contact_law.as_ref().or(present.as_ref()), law) {
            (None, None) => Ok(None),
            (Some(kept), Some(law)) => kept.restored(law).map(Some),
            (None, Some(law)) => Err(law.error("the simulation of the checkpoint did not have this contact law")),
            (Some(kept), None) => Err(ContactForceLaw::new(&kept.law.name)
                .error("the simulation of the checkpoint had this contact law; set it first")),
        }
    }

    /// Checks that all laws are given.
    pub(crate) fn check_laws(&self) -> Result<()> {
        if let (Some(kept), None) = (&self.kept_contact_law, &self.options.contact_force_law) {
            return Err(ContactForceLaw::new(&kept.law.name).error(
                "the simulation of the checkpoint had this contact law, which is part of the program that ran it; give it with \
                 Checkpoint::give_contact_force_law, in Python with contact_law=...",
            ));
        }
        match self.missing_laws().next() {
            None => Ok(()),
            Some(kept) => Err(ForceLaw::new(&kept.name).error(
                "the simulation of the checkpoint had this force law, which is part of the program that ran it; give it with \
                 Checkpoint::give_force_law, in Python with force_laws=[...]",
            )),
        }
    }

    /// The laws of a simulation, with the parameters that they have in this checkpoint.
    ///
    /// # Errors
    /// [`Error::Law`](crate::Error::Law) when the laws are not those of the checkpoint.
    pub(crate) fn restored_laws(&self, laws: &[ForceLaw]) -> Result<Vec<ForceLaw>> {
        let present = || self.options.force_laws.iter().map(KeptLaw::of);
        let kept: Vec<KeptLaw> = if self.kept_laws.is_empty() { present().collect() } else { self.kept_laws.clone() };
        let mut laws = laws.to_vec();
        for law in &laws {
            if kept.iter().all(|kept| kept.name != law.name()) {
                return Err(law.error("the simulation of the checkpoint did not have this force law"));
            }
        }
        for kept in &kept {
            match laws.iter_mut().find(|law| law.name() == kept.name) {
                Some(law) => kept.restore(law)?,
                None => {
                    let message = "the simulation of the checkpoint had this force law; add it first";
                    return Err(ForceLaw::new(&kept.name).error(message));
                }
            }
        }
        laws.sort_by_key(|law| kept.iter().position(|kept| kept.name == law.name()));
        Ok(laws)
    }
}
