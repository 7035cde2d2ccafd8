//! Communicators of a program that has started MPI itself.

use std::mem::ManuallyDrop;

use mpi::environment::{is_finalized, is_initialized, threading_support};
use mpi::raw::FromRaw as _;
use mpi::topology::SimpleCommunicator;
use mpi::{Threading, ffi};

use crate::error::{Error, Result};

/// A duplicate of the communicator with this Fortran handle. An error of MPI in the duplicate ends all processes.
#[allow(unsafe_code)]
pub(super) fn duplicate(handle: i32) -> Result<SimpleCommunicator> {
    let failed = |what: &str| Err(Error::Cluster(what.to_owned()));
    if !is_initialized() {
        return failed("MPI has not been started, or by another MPI library than that which this program was built with");
    }
    if is_finalized() {
        return failed("MPI has ended");
    }
    if threading_support() != Threading::Multiple {
        return failed(
            "MPI was started without MPI_THREAD_MULTIPLE, which is expected because calls come from several threads",
        );
    }
    // SAFETY: MPI runs. A handle that MPI does not know becomes the null communicator or an error of MPI, which ends the program. The
    // duplicate is a new communicator in one group that nothing else uses.
    unsafe {
        let given = ffi::RSMPI_Comm_f2c(handle);
        if given == ffi::RSMPI_COMM_NULL {
            return failed("the communicator is null");
        }
        let mut is_between_groups = 0;
        ffi::MPI_Comm_test_inter(given, &mut is_between_groups);
        if is_between_groups != 0 {
            return failed("the communicator connects two groups: expected one of a single group");
        }
        let mut own = ffi::RSMPI_COMM_NULL;
        if ffi::MPI_Comm_dup(given, &mut own) != ffi::MPI_SUCCESS as i32 || own == ffi::RSMPI_COMM_NULL {
            return failed("the communicator could not be duplicated");
        }
        // mpi4py returns errors, but calls here do not look at them.
        ffi::MPI_Comm_set_errhandler(own, ffi::RSMPI_ERRORS_ARE_FATAL);
        Ok(SimpleCommunicator::from_raw(own))
    }
}

/// Frees a communicator unless MPI made it. Nothing may use it afterwards.
#[allow(unsafe_code)]
pub(super) fn free(communicator: &mut ManuallyDrop<SimpleCommunicator>) {
    // SAFETY: it is called once, when the owner is dropped.
    unsafe { ManuallyDrop::drop(communicator) };
}
