"""The interactive widget for notebooks. Needs anywidget."""

from __future__ import annotations

import math
import pathlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import anywidget
import numpy as np
import numpy.typing as npt
import traitlets

from rockfall import _rockfall
from rockfall._arrays import FloatArray, whole
from rockfall._look import look
from rockfall.typing import ColourName, UpName

if TYPE_CHECKING:
    from rockfall._simulation import Simulation

#: Memory for states that the slider goes back to, in bytes.
_MEMORY = 256 << 20
_JPEG_QUALITY = 85
#: The camera does not get steeper than this, in rad, so that up stays up.
_STEEPEST = 1.5
#: Fields that a picture depends on.
_FIELDS = ("positions", "orientations", "velocities")


class Viewer(anywidget.AnyWidget):
    """A widget that shows a simulation in a notebook and steps it. :func:`view` makes it.

    Dragging turns the camera, with Shift it moves sideways; the wheel zooms and a double click shows everything. The button
    plays and pauses. The slider goes back to states that were shown; the simulation itself stays at its last step.
    """

    _esm = pathlib.Path(__file__).with_name("_widget.js")
    _css = pathlib.Path(__file__).with_name("_widget.css")

    #: The picture, as a JPEG file.
    frame = traitlets.Bytes(b"").tag(sync=True)
    #: Number of the state that is shown, and of the last state.
    shown = traitlets.Int(0).tag(sync=True)
    last = traitlets.Int(0).tag(sync=True)
    #: What is shown, in words.
    caption = traitlets.Unicode("").tag(sync=True)
    playing = traitlets.Bool(False).tag(sync=True)
    width = traitlets.Int(0).tag(sync=True)

    def __init__(
        self,
        sim: Simulation,
        *,
        steps: int = 1,
        size: tuple[int, int] = (640, 400),
        colour_by: ColourName | None = None,
        range: tuple[float, float] | None = None,
        camera: npt.ArrayLike | None = None,
        look_at: npt.ArrayLike | None = None,
        up: UpName = "auto",
        plain: bool = False,
    ) -> None:
        self._sim = sim
        self._steps = whole("steps", steps, least=1)
        self._look = look(size, colour_by, range, camera, look_at, plain, up=up)
        self._given = (self._look["camera"], self._look["look_at"])
        self._past: list[tuple[int, float, list[FloatArray]]] = []
        self._dropped = 0
        self._past_sim: Simulation | None = None
        super().__init__(width=self._look["size"][0])
        self._reset_camera()
        self._remember()
        self._draw()
        self.on_msg(self._receive)

    # The camera

    def _reset_camera(self) -> None:
        self._look["camera"], self._look["look_at"] = self._given
        self._sim._commit()
        shot = np.array(_rockfall.framing(self._sim._native, self._look), dtype=float)
        self._eye, self._target, self._up, self._front = shot

    def _axes(self) -> tuple[np.ndarray, np.ndarray, float]:
        """Unit vectors to the right and to the top of the picture, and the distance of the target."""
        away = self._eye - self._target
        distance = float(np.linalg.norm(away))
        right = np.cross(self._up, away)
        length = float(np.linalg.norm(right))
        right = right / length if length > 1e-6 * distance else np.cross(self._up, self._front)
        return right, np.cross(away / distance, right), distance

    def orbit(self, across: float, up: float) -> None:
        """Turn the camera around the middle of the picture, by angles in rad."""
        across_axis = np.cross(self._up, self._front)
        x, y, z = np.stack([across_axis, self._up, self._front]) @ (self._eye - self._target)
        distance = math.sqrt(x * x + y * y + z * z)
        angle = math.atan2(x, z) + across
        height = min(max(math.asin(y / distance) + up, -_STEEPEST), _STEEPEST)
        level = distance * math.cos(height)
        away = level * math.sin(angle) * across_axis + distance * math.sin(height) * self._up
        self._eye = self._target + away + level * math.cos(angle) * self._front
        self._draw()

    def pan(self, across: float, up: float) -> None:
        """Move the camera sideways, in heights of the picture at the distance of its middle."""
        right, top, distance = self._axes()
        # The picture is 2 tan(0.3) distances high.
        moved = 2 * math.tan(0.3) * distance * (across * right + up * top)
        self._eye, self._target = self._eye + moved, self._target + moved
        self._draw()

    def zoom(self, factor: float) -> None:
        """Multiply the distance of the camera by a factor."""
        self._eye = self._target + (self._eye - self._target) * min(max(factor, 0.01), 100.0)
        self._draw()

    # States

    def _remember(self) -> None:
        sim = self._sim
        state = [getattr(sim, field).copy() for field in _FIELDS]
        self._past.append((sim.steps, sim.time, state))
        size = sum(array.nbytes for array in state)
        while len(self._past) > max(_MEMORY // max(size, 1), 2):
            self._past.pop(0)
            self._dropped += 1
        self.last = self.shown = len(self._past) - 1

    def advance(self) -> None:
        """Run the steps to the next picture, and show it. In the past, show the next state instead."""
        if self.shown < self.last:
            self.show(self.shown + 1)
            return
        self._sim.run(self._steps)
        self._remember()
        self._draw()

    def show(self, state: int) -> None:
        """Show a state, from 0, the first that is remembered, to ``last``, the present."""
        self.shown = min(max(int(state), 0), self.last)
        self._draw()

    def _shown_sim(self) -> Simulation:
        """The simulation, or for the past another one with the state of then."""
        if self.shown == self.last:
            return self._sim
        from rockfall._simulation import Simulation

        state = self._past[self.shown][2]
        past = self._past_sim
        if past is None or past.counts != self._sim.counts:
            past = self._past_sim = Simulation(self._sim.scene, self._sim.dt, backend="cpu", check=False)
        if len(past.positions) != len(state[0]):
            raise ValueError("the number of spheres has changed since then")
        for field, array in zip(_FIELDS, state, strict=True):
            setattr(past, field, array)
        return past

    def _draw(self) -> None:
        if self.shown == self.last and self._past[-1][0] != self._sim.steps:
            # The simulation was run elsewhere.
            self._remember()
        step, time, _ = self._past[self.shown]
        self._look["camera"], self._look["look_at"] = self._eye.tolist(), self._target.tolist()
        try:
            sim = self._shown_sim()
            sim._commit()
            if sim._studio is None:
                sim._studio = _rockfall.Studio()
            self.frame = bytes(sim._studio.take(sim._native, self._look, False).jpeg(_JPEG_QUALITY))
            self.caption = f"step {step}, {time:.2f} s"
        except (ValueError, RuntimeError) as error:
            self.playing = False
            self.caption = f"step {step}: {error}"

    # Messages from the browser

    def _receive(self, _widget: Any, message: Any, _buffers: Sequence[Any]) -> None:
        if not isinstance(message, dict):
            return
        kind = message.get("kind")
        if kind == "next":
            # The browser asks for the next picture when it has shown the last one, so pictures never pile up.
            if self.playing:
                try:
                    self.advance()
                except (ValueError, RuntimeError) as error:
                    self.playing = False
                    self.caption = str(error)
        elif kind == "orbit":
            self.orbit(float(message["across"]), float(message["up"]))
        elif kind == "pan":
            self.pan(float(message["across"]), float(message["up"]))
        elif kind == "zoom":
            self.zoom(float(message["factor"]))
        elif kind == "show":
            self.playing = False
            self.show(int(message["state"]))
        elif kind == "frame all":
            self._reset_camera()
            self._draw()
        self.send({"kind": "done"})
