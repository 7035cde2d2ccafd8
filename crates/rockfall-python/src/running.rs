//! What a native simulation has beside its state.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::ids::Ids;
use crate::memory::Lender;
use crate::shared::Sharing;
use crate::team::Team;

/// A simulation, the numbers of its objects, and the arrays that use its memory.
#[derive(Debug)]
pub(crate) struct Running {
    pub(crate) simulation: rockfall::Simulation,
    pub(crate) ids: Ids,
    pub(crate) lender: Lender,
    /// Memory shared with other libraries on the device, or the reason why there is none. Opened at the first use.
    sharing: Option<Result<Sharing, String>>,
    /// There may be edits that have not reached the memory yet.
    pub(crate) edited: bool,
    /// The processes that share the simulation.
    pub(crate) team: Option<Team>,
}

impl Running {
    pub(crate) fn new(team: Option<Team>, simulation: rockfall::Simulation, ids: Ids) -> Self {
        Self { simulation, ids, lender: Lender::default(), sharing: None, edited: false, team }
    }

    /// An error if processes share the simulation.
    pub(crate) fn check_alone(&self) -> PyResult<()> {
        if self.team.is_none() {
            return Ok(());
        }
        Err(PyValueError::new_err(
            "comm: a simulation that processes share takes whole steps, and cannot be changed, copied, restored, filmed or profiled: expected \
             a change of the scene before, or a simulation without comm",
        ))
    }

    /// Gives the simulation the state after the last step of all processes. Without other processes it has that state.
    pub(crate) fn gather(&mut self) -> PyResult<()> {
        let Some(team) = self.team.as_mut().filter(|team| !team.is_current()) else { return Ok(()) };
        self.lender.release(&mut self.simulation);
        team.gather(&mut self.simulation)
    }

    pub(crate) fn sharing(&mut self) -> Result<(&mut Sharing, &mut rockfall::Simulation), &str> {
        let sharing = self.sharing.get_or_insert_with(|| Sharing::open(&self.simulation));
        sharing.as_mut().map(|sharing| (sharing, &mut self.simulation)).map_err(|reason| reason.as_str())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.lender.release(&mut self.simulation);
    }
}
