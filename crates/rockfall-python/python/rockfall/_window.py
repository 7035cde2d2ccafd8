"""The interactive window, in a process of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from types import TracebackType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rockfall._simulation import Simulation

#: Windows that were open when they were last looked at. They need no name in the program that opened them. If one of them is
#: still open when Python ends, its file stays in the temporary folder, because the window may still be reading it.
_open: list[Window] = []

#: Time in which a window that cannot open ends, in s.
_PATIENCE = 1.0


class Window:
    """A window that shows a simulation, in a process of its own. :func:`view` opens it.

    The window has a copy of the simulation and simulates it further. It stays open until it is closed, also when Python ends.
    """

    def __init__(self, process: subprocess.Popen[Any], folder: str) -> None:
        self._process = process
        self._folder = folder

    @property
    def is_open(self) -> bool:
        """Whether the window is open."""
        return self._process.poll() is None

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until the window is closed.

        Parameters
        ----------
        timeout : float, optional
            Longest time to wait, in s.

        Returns
        -------
        bool
            Whether the window is closed.
        """
        try:
            self._process.wait(timeout)
        except subprocess.TimeoutExpired:
            return False
        shutil.rmtree(self._folder, ignore_errors=True)
        return True

    def close(self) -> None:
        """Close the window."""
        if self.is_open:
            self._process.terminate()
        self.wait()

    def __enter__(self) -> Window:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<rockfall.Window, {'open' if self.is_open else 'closed'}>"


def program() -> str:
    """Returns the path of the program ``rockfall``."""
    found = os.environ.get("ROCKFALL") or shutil.which("rockfall")
    if found is None:
        raise FileNotFoundError(
            "the window is part of the program rockfall, which is not on the PATH; install it with "
            "`cargo install --path crates/rockfall-cli` in a copy of the repository, "
            "or set the environment variable ROCKFALL to its path"
        )
    return found


def open_window(sim: Simulation) -> Window:
    """Opens a window with a copy of a simulation."""
    path = program()
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise OSError("there is no display for a window: neither DISPLAY nor WAYLAND_DISPLAY is set; sim.render() draws without one")
    _open[:] = [window for window in _open if not window.wait(0)]
    folder = tempfile.mkdtemp(prefix="rockfall-")
    state, errors = os.path.join(folder, "simulation.ckpt"), os.path.join(folder, "errors.txt")
    # A session of its own, so that Ctrl-C in a terminal does not reach it.
    options: dict[str, Any] = {"start_new_session": True} if os.name == "posix" else {}
    try:
        sim.save_checkpoint(state)
        with open(errors, "wb") as file:
            process = subprocess.Popen(
                [path, "view", state], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=file, **options
            )
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    window = Window(process, folder)
    end = time.monotonic() + _PATIENCE
    while window.is_open and time.monotonic() < end:
        time.sleep(0.02)
    if process.poll():
        with open(errors, encoding="utf-8", errors="replace") as text:
            message = text.read().strip()
        window.wait()
        raise OSError(f"the window did not open: {message or f'{path} ended with code {process.returncode}'}")
    _open.append(window)
    return window
