//! Saves evolutions and resumes them.

use std::io::Write as _;
use std::path::Path;

use rockfall::output::AtomicFile;
use serde::{Deserialize, Serialize};

use crate::archive::Archive;
use crate::evolution::{Champion, Evolution, Generation, Plan};
use crate::trial::Trial;

/// Version of the format.
const VERSION: u32 = 3;
/// What a file begins with, for people.
const KIND: &str = "rockfall evolution";

#[derive(Serialize, Deserialize)]
struct Stored<P, A, C, H> {
    kind: String,
    version: u32,
    plan: P,
    archive: A,
    champion: C,
    history: H,
}

type Loaded = Stored<Plan, Archive, Option<Champion>, Vec<Generation>>;

fn wrong(text: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> std::io::Error {
    std::io::Error::new(std::io::ErrorKind::InvalidData, text)
}

impl Evolution {
    /// Writes everything that determines the following generations to a file of JSON.
    ///
    /// # Errors
    /// Those of writing the file.
    pub fn save(&self, path: &Path) -> std::io::Result<()> {
        let stored = Stored {
            kind: KIND.to_owned(),
            version: VERSION,
            plan: self.plan(),
            archive: &self.archive,
            champion: &self.champion,
            history: &self.history,
        };
        let mut file = AtomicFile::create(path)?;
        serde_json::to_writer(&mut file, &stored)?;
        file.write_all(b"\n")?;
        file.commit()
    }

    /// Goes on where a saved evolution was. `trial` makes the conditions from the plan.
    ///
    /// # Errors
    /// Those of reading the file, `InvalidData` for a file that is not a saved evolution, and those of `trial`.
    pub fn load(path: &Path, trial: impl FnOnce(&Plan) -> std::io::Result<Trial>) -> std::io::Result<Self> {
        let text = std::fs::read_to_string(path)?;
        let stored: Loaded = serde_json::from_str(&text).map_err(|error| wrong(format!("not a saved evolution: {error}")))?;
        if stored.kind != KIND || stored.version != VERSION {
            return Err(wrong(format!("expected a {KIND} of version {VERSION}, got {} {}", stored.kind, stored.version)));
        }
        let genomes = stored.archive.ranked().into_iter().map(|(_, elite)| &elite.genome);
        if !genomes.chain(stored.champion.iter().map(|champion| &champion.genome)).all(|genome| genome.is_viable()) {
            return Err(wrong("a creature in it is not viable: the file was changed"));
        }
        let trial = trial(&stored.plan)?;
        let mut evolution = Self::new(stored.plan, trial);
        evolution.archive = stored.archive;
        evolution.champion = stored.champion;
        evolution.history = stored.history;
        Ok(evolution)
    }
}
