"""How films are taken of simulations, worlds and environments."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from rockfall import _rockfall
from rockfall._arrays import whole
from rockfall._look import number, warn_of_letters
from rockfall._progress import Progress


#: About the number of frames of a trajectory from which the camera is chosen.
_SURVEYED = 200


@dataclass(frozen=True)
class Shot:
    """What a film shows, and when."""

    look: dict[str, Any]
    steps: int
    dt: float
    fps: int
    speed: float | None
    follow: int | str | None
    orbit: float

    @classmethod
    def checked(
        cls, look: dict[str, Any], steps: Any, dt: float, fps: Any, speed: Any = None, follow: Any = None, orbit: Any = 0.0
    ) -> Shot:
        """Checks the arguments of a film."""
        count, rate = whole("steps", steps, least=1), whole("fps", fps, least=1)
        if rate > 1000:
            raise ValueError(f"fps: expected up to 1000 pictures per second, got {rate}")
        pace = None if speed is None else number("speed", speed, positive=True)
        turn = number("orbit", orbit)
        if follow is not None and look["look_at"] is not None:
            raise ValueError("look_at, follow: expected only one of them")
        followed = follow if follow is None or isinstance(follow, str) else whole("follow", follow)
        return cls(look, count, dt, rate, pace, followed, turn)

    def stretched(self, factor: int) -> Shot:
        """The same shot of ``factor`` times as many steps."""
        return replace(self, steps=self.steps * factor)

    def begin(self, simulation: Any, *, live: bool) -> Any:
        """Begins to film a native simulation. A live film is of steps that the caller runs."""
        warn_of_letters(simulation, self.look)
        timing = (self.steps, self.dt, self.fps, self.speed)
        return _rockfall.Filming(simulation, self.look, *timing, self.follow, self.orbit, live)


def rehearsed(simulation: Any, shot: Shot, progress: bool) -> Any:
    """Films a native simulation, whose steps are run first to find out what happens, and then for the pictures."""
    filming = shot.begin(simulation, live=False)
    try:
        while filming.survey(simulation):
            pass
    finally:
        filming.rewind(simulation)
    with Progress(filming.count() if progress else None, "picture") as bar:
        while filming.take(simulation):
            bar.advance(1)
    return filming.finish(simulation)


def played(states: Any, frames: int, shot: Shot, progress: bool) -> Any:
    """Films a trajectory with this number of frames. ``states`` gives its states to a native simulation."""
    states.show(0)
    filming = shot.begin(states.native, live=True)
    for frame in range(0, frames, max(1, frames // _SURVEYED)):
        states.show(frame)
        filming.look(states.native)
    with Progress(frames if progress else None, "frame") as bar:
        seen = 0
        while (due := filming.due()) is not None:
            states.show_interval(due)
            filming.see(states.native, due)
            bar.advance(due - seen)
            seen = due
    return filming.end()


class Live:
    """A film of steps that the caller runs. ``state`` returns a native simulation with the present state."""

    def __init__(self, shot: Shot, state: Callable[[], Any]) -> None:
        self._state = state
        self._filming = shot.begin(state(), live=True)
        self._steps = shot.steps
        self._done = 0
        self.saw(0)

    def until_due(self) -> int:
        """Number of steps until the next state that the film needs."""
        due = self._filming.due()
        left = self._steps - self._done
        return max(1, left if due is None else min(left, due - self._done))

    def saw(self, steps: int) -> None:
        """Takes the pictures that the present state completes, after this number of further steps."""
        self._done += steps
        due = self._filming.due()
        if due is not None and due <= self._done:
            self._filming.see(self._state(), self._done)

    def end(self) -> Any:
        """The native film."""
        return self._filming.end()


def watched(target: Any, state: Callable[[], Any], shot: Shot, on_step: Callable[[Any], object] | None, progress: bool) -> Any:
    """Runs steps of a simulation or of worlds once, calls ``on_step`` after each of them, and films them."""
    live = Live(shot, state)
    left = shot.steps
    with Progress(left if progress else None) as bar:
        while left > 0:
            count = live.until_due() if on_step is None else 1
            target.run(count)
            if on_step is not None:
                on_step(target)
            live.saw(count)
            left -= count
            bar.advance(count)
    return live.end()
