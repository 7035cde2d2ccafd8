"""Interactive views."""

from __future__ import annotations

import importlib.util
from typing import TYPE_CHECKING, Any, Literal

from rockfall._attributes import keywords
from rockfall._window import open_window

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import ViewOptions
    from rockfall._simulation import Simulation


def in_notebook() -> bool:
    """Whether the program runs in a notebook, not in a script or a terminal."""
    try:
        from IPython import get_ipython
    except ImportError:
        return False
    shell = get_ipython()  # type: ignore[no-untyped-call, unused-ignore]
    return shell is not None and hasattr(shell, "kernel")


_WIDGET = "the widget of a notebook needs anywidget: pip install anywidget, or pip install 'rockfall[notebook]'"


@keywords
def view(sim: Simulation, kind: Literal["auto", "widget", "window"] = "auto", **options: Unpack[ViewOptions]) -> Any:
    """Open an interactive view of a simulation.

    In a notebook, this is a widget, which steps the simulation itself. Elsewhere it is the window of the program ``rockfall`` in a
    process of its own, with a copy of the simulation; the program that called goes on.

    Parameters
    ----------
    sim : Simulation
        The simulation.
    kind : {"auto", "widget", "window"}
        "auto" is "widget" in a notebook with ``anywidget`` (``pip install 'rockfall[notebook]'``), otherwise "window".
    **options
        Arguments of the widget: ``size``, ``colour_by``, ``range``, ``camera``, ``look_at``, ``up`` and ``plain`` as in
        :meth:`Simulation.render`, and ``steps``, the number of steps from picture to picture.

    Returns
    -------
    Window or Viewer
        The window, or the widget, which shows itself as the last value of a cell.

    Raises
    ------
    ValueError
        For an unknown kind, or options for a window.
    ImportError
        If ``anywidget`` is not installed.
    FileNotFoundError
        If the program ``rockfall`` is neither on the PATH nor named by the environment variable ``ROCKFALL``.
    OSError
        If the window cannot open, for example without a display.
    """
    from rockfall._simulation import Simulation

    if not isinstance(sim, Simulation):
        raise TypeError(f"sim: expected a rockfall.Simulation, got {type(sim).__name__}")
    if kind not in ("auto", "widget", "window"):
        raise ValueError(f"kind: expected auto, widget or window, got {kind!r}")
    has_widgets = importlib.util.find_spec("anywidget") is not None
    if kind == "widget" or (kind == "auto" and has_widgets and in_notebook()):
        if not has_widgets:
            raise ImportError(_WIDGET)
        from rockfall._widget import Viewer

        return Viewer(sim, **options)
    if options:
        hint = f"; {_WIDGET}" if in_notebook() else ""
        raise ValueError(f"{next(iter(options))}: expected no options for a window, which has controls for them{hint}")
    try:
        return open_window(sim)
    except FileNotFoundError as error:
        if in_notebook():
            raise FileNotFoundError(f"{error}; {_WIDGET}") from None
        raise

