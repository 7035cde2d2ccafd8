//! Output files that a run is asked for.

use std::path::{Path, PathBuf};

use rockfall_trajectory::Format;

use super::place::whole;
use crate::failure::Failure;

/// Output files requested by the command line or by the run that is resumed.
#[derive(Debug, Default)]
pub(crate) struct Wanted {
    pub(crate) out: Option<PathBuf>,
    pub(crate) every: Option<u64>,
    /// Spheres of periodic scenes are written where they have got to, not where they are in the box.
    pub(crate) unwrapped: bool,
    pub(crate) trace: Option<PathBuf>,
    pub(crate) trace_every: Option<u64>,
    pub(crate) contacts: Option<PathBuf>,
    pub(crate) tensions: Option<PathBuf>,
    pub(crate) gauges: Option<PathBuf>,
    pub(crate) bodies: Option<PathBuf>,
    pub(crate) joints: Option<PathBuf>,
    pub(crate) events: Option<PathBuf>,
    pub(crate) save: Option<PathBuf>,
    pub(crate) checkpoint: Option<PathBuf>,
    pub(crate) checkpoint_every: Option<u64>,
}

impl Wanted {
    /// The files other than the checkpoint.
    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        let Self { out, trace, contacts, tensions, gauges, bodies, joints, events, save, .. } = self;
        [out, trace, contacts, tensions, gauges, bodies, joints, events, save].into_iter().flatten().map(PathBuf::as_path)
    }

    /// Returns an error if the options contradict each other.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let list = |path: &PathBuf| match Format::of(path) {
            Some(Format::Vtp) if self.every.is_some() => path.with_extension("pvd"),
            _ => path.clone(),
        };
        let [out, contacts] = [&self.out, &self.contacts].map(|path| path.as_ref().map(list));
        let names = [
            ("--out", &out),
            ("--contacts", &contacts),
            ("--tensions", &self.tensions),
            ("--gauges", &self.gauges),
            ("--bodies", &self.bodies),
            ("--joints", &self.joints),
            ("--events", &self.events),
            ("--trace", &self.trace),
            ("--save", &self.save),
            ("--checkpoint", &self.checkpoint),
        ];
        let names = names.map(|(name, path)| (name, path.as_deref().map(whole)));
        for (place, (one, path)) in names.iter().enumerate() {
            if let Some((other, _)) = names[..place].iter().find(|(_, other)| path.is_some() && other == path) {
                return Err(Failure::usage(format!("{other} and {one} name the same file")));
            }
        }
        let files = [&self.out, &self.contacts, &self.tensions, &self.gauges, &self.bodies, &self.joints];
        if self.every.is_some() && files.into_iter().all(Option::is_none) {
            let message = "--every needs a file to write to: expected --out FILE, --contacts FILE, --tensions FILE, --gauges FILE, \
                           --bodies FILE or --joints FILE";
            return Err(Failure::usage(message));
        }
        if self.unwrapped && self.out.is_none() {
            return Err(Failure::usage("--unwrapped needs a file to write to: expected --out FILE"));
        }
        if self.trace_every.is_some() && self.trace.is_none() {
            return Err(Failure::usage("--trace-every needs a file to write to: expected --trace FILE"));
        }
        if self.checkpoint_every.is_some() && self.checkpoint.is_none() {
            return Err(Failure::usage("--checkpoint-every needs a file to write to: expected --checkpoint FILE"));
        }
        for (option, path) in [("--out", &self.out), ("--contacts", &self.contacts)] {
            let pvd = |path: &PathBuf| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pvd"));
            if self.every.is_none() && path.as_ref().is_some_and(pvd) {
                return Err(Failure::usage(format!("{option}: a .pvd file holds a series of states, expected --every K")));
            }
        }
        Ok(())
    }
}
