"""Processes that share a simulation over MPI."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol


class Communicator(Protocol):
    """A communicator of mpi4py."""

    def py2f(self) -> int:
        """The Fortran handle."""
        ...


def handle_of(comm: Communicator | None) -> int | None:
    """Returns the Fortran handle of a communicator."""
    if comm is None:
        return None
    py2f = getattr(comm, "py2f", None)
    if py2f is None:
        raise TypeError(f"comm: expected a communicator of mpi4py such as MPI.COMM_WORLD, got {type(comm).__name__}")
    return int(py2f())


def on_first(native: Any, call: Callable[[], None]) -> None:
    """Calls a function on the first of the processes that share a simulation. If it fails there, the others raise an error, too."""
    if native.rank() is None:
        call()
        return
    try:
        if native.rank() == 0:
            call()
    except Exception:
        native.agree(True)
        raise
    native.agree(False)
