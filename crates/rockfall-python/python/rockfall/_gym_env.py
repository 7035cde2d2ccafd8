"""Environments of Gymnasium."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from rockfall._arrays import FloatArray, floats, time_step, whole
from rockfall._attributes import keywords
from rockfall._filming import Live
from rockfall._gym_actions import Actuators, Force, Motor
from rockfall._gym_bodies import Look, Start, begin, surroundings, walker
from rockfall._gym_checks import amount, bounds_of, reset_mask_of
from rockfall._scene import Scene
from rockfall._worlds import Worlds
from rockfall.typing import BackendName, IntegratorName

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import EnvOptions

_Bools = npt.NDArray[np.bool_]
_Doubles = npt.NDArray[np.float64]
_Infos = dict[str, Any]

#: Bounds of observations: large enough for bodies that are worth training.
_BOUND = 1000.0


class WorldsVectorEnv(VectorEnv[FloatArray, FloatArray, npt.NDArray[Any]]):
    """Environments of Gymnasium that step together, one world each. :func:`make_vec` makes them.

    Parameters
    ----------
    bodies : Scene or sequence of Scene, optional
        The body of each environment, or one for all; by default :func:`walker`. Bodies may differ.
    num_envs : int, optional
        Number of environments with the same body; 1 by default, or the number of bodies.
    dt : float
        Time step, in s.
    frame_skip : int
        Number of time steps in a step of the environment.
    max_steps : int
        Number of steps of the environment after which an episode is truncated.
    strength : float
        Greatest change of a rest length, as a share of it, from 0 to 1.
    muscles : bool
        Whether actions have a number for each spring.
    forces : iterable of Force, optional
        Forces on spheres. Actions have a number for each of them, after those for the springs.
    motors : iterable of Motor, optional
        Torques and forces of joints. Actions have a number for each of them, after those for the forces.
    choices : array_like, shape (C, M + F), optional
        The actions among which there is a choice. The actions of the environment are then whole numbers below C.
    clock : float
        Frequency of the clock in observations, in 1/s.
    noise : float
        Standard deviation of the velocities at the start of an episode about those of the body, in units/s. Not for bodies with
        rigid bodies.
    start : callable, optional
        ``start(random)`` with a NumPy generator of random numbers returns the :class:`Start` of an episode of one
        environment, in place of ``noise``.
    bounds : float or (array_like, array_like)
        Bounds of observations: the greatest size of all numbers, or the least and the greatest value of each of the D numbers.
        Numbers outside are clipped.
    observe : callable, optional
        ``observe(look)`` returns the observations, of shape (W, D). By default they have 3 + 6 N numbers: the height of the centre
        of mass, sin and cos of the clock, positions of the spheres from the centre of mass, and velocities of the spheres.
    reward : callable, optional
        ``reward(before, after, actions)`` with the :class:`Look` before and after a step returns rewards, of shape (W,). By
        default, the distance that the centre of mass moves along x, in units.
    terminate : callable, optional
        ``terminate(look)`` returns which episodes end, bool of shape (W,). Episodes of stopped worlds end in any case.
    autoreset_mode : {"NextStep", "SameStep", "Disabled"} or gymnasium.vector.AutoresetMode
        When environments whose episode has ended begin the next one. With "Disabled", ``reset(options={"reset_mask": mask})``
        does it.
    render_mode : {None, "rgb_array"}
        Whether :meth:`render` gives pictures.
    render_size : (int, int)
        Width and height of the pictures, in pixels.
    backend, integrator
        As for :class:`rockfall.Worlds`; but "auto" is the CPU for a single environment of up to 64 spheres and rods.

    Raises
    ------
    ValueError, TypeError
        For a value or a type that is not allowed. The message names the argument.

    Notes
    -----
    W is the number of environments, N the largest number of spheres in a body, M the largest number of springs (0 without
    ``muscles``), and F the number of forces and motors. An action has a number from -1 to 1 for each spring, in order of
    addition: the rest length becomes ``length * (1 + strength * action)``. Then it has a number for each of ``forces``
    (:class:`Force`), which add to the external forces of the body, and for each of ``motors`` (:class:`Motor`). Numbers
    outside of the range are clipped. Bodies with fewer spheres or springs than others have zeros in their observations, and
    ignore the last numbers for the springs.

    ``reset(seed=5)`` gives the environments the seeds 5, 6, 7 and so on; a list gives each its own. The same seeds and actions give
    bitwise identical results, and environment k of a vector behaves as a single :class:`WorldEnv` with its body and seed.

    Infos have ``centre``, the centre of mass, of shape (W, 3).
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "autoreset_mode": AutoresetMode.NEXT_STEP}

    @keywords
    def __init__(
        self,
        bodies: Scene | Sequence[Scene] | None = None,
        num_envs: int | None = None,
        *,
        dt: float = 0.005,
        frame_skip: int = 10,
        max_steps: int = 100,
        strength: float = 0.25,
        muscles: bool = True,
        forces: Iterable[Force] = (),
        motors: Iterable[Motor] = (),
        choices: npt.ArrayLike | None = None,
        clock: float = 1.0,
        noise: float = 0.01,
        start: Callable[[np.random.Generator], Start] | None = None,
        bounds: float | tuple[npt.ArrayLike, npt.ArrayLike] = _BOUND,
        observe: Callable[[Look], npt.ArrayLike] | None = None,
        reward: Callable[[Look, Look, FloatArray], npt.ArrayLike] | None = None,
        terminate: Callable[[Look], npt.ArrayLike] | None = None,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        render_size: tuple[int, int] = (640, 360),
        backend: BackendName = "auto",
        integrator: IntegratorName = "auto",
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode: expected None or 'rgb_array', got {render_mode!r}")
        try:
            self.autoreset_mode = AutoresetMode(autoreset_mode)
        except ValueError:
            expected = ", ".join(repr(mode.value) for mode in AutoresetMode)
            raise ValueError(f"autoreset_mode: expected one of {expected}, got {autoreset_mode!r}") from None
        self._frame_skip = whole("frame_skip", frame_skip, least=1)
        self._max_steps = whole("max_steps", max_steps, least=1)
        self._clock = amount("clock", clock)
        self._noise = amount("noise", noise)
        self._start, self._observe, self._reward, self._terminate = start, observe, reward, terminate
        #: The worlds, one per environment.
        self.worlds = _worlds(bodies, num_envs, time_step("dt", dt), backend, integrator)
        self._actuators = Actuators(self.worlds, amount("strength", strength, 1.0), bool(muscles), forces, motors, choices)
        self._is_loose = len(self.worlds.bodies) == 0
        self._live: Live | None = None
        self.num_envs = len(self.worlds)
        self.render_mode, self._render_size = render_mode, render_size
        self.metadata = {
            "render_modes": ["rgb_array"],
            "render_fps": max(1, round(1.0 / (self.worlds.dt * self._frame_skip))),
            "autoreset_mode": self.autoreset_mode,
        }
        self._mask, self._masses = self.worlds.mask, self.worlds.masses.astype(np.float64)
        self._velocities = self.worlds.velocities
        self._elapsed = np.zeros(self.num_envs, np.int64)
        self._ended = np.zeros(self.num_envs, np.bool_)
        self._randoms = [np.random.default_rng() for _ in range(self.num_envs)]
        self._last = self._look()
        self._low, self._high = bounds_of(bounds, self._observed(self._last).shape[1])
        self.single_observation_space = spaces.Box(self._low, self._high, dtype=np.float32)
        self.single_action_space = self._actuators.space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, _Infos]:
        """Begin episodes in all environments, or in those of ``options["reset_mask"]``, a bool array of shape (W,).

        Parameters
        ----------
        seed : int or sequence of int, optional
            Seed of environment 0, of which environment k has ``seed + k``; or the seed of each. Without one, the random numbers
            continue.
        options : dict, optional
            ``{"reset_mask": mask}``.

        Returns
        -------
        (ndarray of float32, dict)
            Observations of shape (W, D), and infos.
        """
        chosen = np.ones(self.num_envs, np.bool_)
        if options is not None and "reset_mask" in options:
            chosen = reset_mask_of(options["reset_mask"], self.num_envs)
        if isinstance(seed, (int, np.integer)):
            self._np_random_seed = whole("seed", seed)
            self._np_random = np.random.default_rng(self._np_random_seed)
            seed = [self._np_random_seed + place for place in range(self.num_envs)]
        if seed is not None:
            if len(seed) != self.num_envs:
                raise ValueError(f"seed: expected {self.num_envs} seeds, one per environment, got {len(seed)}")
            for place in np.flatnonzero(chosen).tolist():
                if seed[place] is not None:
                    self._randoms[place] = np.random.default_rng(whole("seed", seed[place]))
        self._begin(chosen)
        self._last = self._look()
        return self._observations(self._last), self._infos(self._last, chosen)

    def step(self, actions: npt.ArrayLike) -> tuple[FloatArray, _Doubles, _Bools, _Bools, _Infos]:
        """Apply an action in every environment.

        Parameters
        ----------
        actions : array_like, shape (W, M + F), or (W,) of int with ``choices``
            Numbers from -1 to 1 for the springs, the forces and the motors; or which of the choices.

        Returns
        -------
        (ndarray, ndarray, ndarray, ndarray, dict)
            Observations of float32 and shape (W, D), rewards of float64, terminations and truncations of bool and shape (W,), and
            infos.
        """
        return self._advance(self._actuators.rows("actions", actions))

    def _advance(self, given: FloatArray) -> tuple[FloatArray, _Doubles, _Bools, _Bools, _Infos]:
        again = self._ended.copy()
        if self.autoreset_mode == AutoresetMode.DISABLED and again.any():
            numbers = np.flatnonzero(again).tolist()
            raise RuntimeError(f"environments {numbers} have ended: reset them with options={{'reset_mask': mask}}")
        clipped = np.clip(given, -1.0, 1.0)
        self._actuators.apply(clipped)
        self._run()
        self._elapsed += 1
        before, after = self._last, self._look()
        rewards = self._rewards(before, after, clipped)
        terminations = self._terminations(after)
        truncations = self._elapsed >= self._max_steps
        if self.autoreset_mode == AutoresetMode.NEXT_STEP and again.any():
            self._begin(again)
            after = self._look()
            rewards[again], terminations[again], truncations[again] = 0.0, False, False
        self._ended = terminations | truncations
        infos: _Infos = {}
        if self.autoreset_mode == AutoresetMode.SAME_STEP and self._ended.any():
            ended = self._ended.copy()
            infos = self._finals(after, ended)
            self._begin(ended)
            after = self._look()
        self._last = after
        return self._observations(after), rewards, terminations, truncations, {**infos, **self._infos(after)}

    def render(self) -> tuple[npt.NDArray[np.uint8], ...] | None:
        """A picture of each environment of shape (height, width, 3); None without a render mode."""
        if self.render_mode is None:
            return None
        pictures = (self.worlds.render(world, self._render_size).numpy() for world in range(self.num_envs))
        return tuple(np.ascontiguousarray(picture[..., :3]) for picture in pictures)

    # Episodes

    def _run(self) -> None:
        """Runs the time steps of a step, for the pictures of a film in portions."""
        left = self._frame_skip
        while left > 0:
            count = left if self._live is None else min(left, self._live.until_due())
            self.worlds.run(count)
            if self._live is not None:
                self._live.saw(count)
            left -= count

    def _begin(self, chosen: _Bools) -> None:
        """Begins the episodes of the chosen environments."""
        numbers = np.flatnonzero(chosen)
        self.worlds.reset(numbers)
        if self._start is not None:
            begin(self.worlds, numbers, [self._start(self._randoms[place]) for place in numbers])
        elif self._noise > 0.0 and self._is_loose:
            velocities = self._velocities[numbers].astype(np.float64)
            for row, place in zip(velocities, numbers, strict=True):
                # As many random numbers as the body needs, so that it does not matter how large other bodies are.
                exists = self._mask[place]
                row[exists] += self._randoms[place].normal(0.0, self._noise, (int(exists.sum()), 3))
            self.worlds.set(numbers, velocities=velocities)
        self._elapsed[chosen] = 0
        self._ended[chosen] = False

    def _look(self) -> Look:
        positions, velocities = self.worlds.positions, self.worlds.velocities
        total = self._masses.sum(axis=1, keepdims=True)
        centres = np.einsum("wn,wni->wi", self._masses, positions, dtype=np.float64) / np.where(total > 0, total, 1.0)
        times: _Doubles = self._elapsed.astype(np.float64) * (self._frame_skip * self.worlds.dt)
        return Look(positions, velocities, self._mask, centres, times, self.worlds.joints, self.worlds.bodies)

    def _observations(self, look: Look) -> FloatArray:
        found: FloatArray = np.clip(self._observed(look), self._low, self._high)
        return found

    def _observed(self, look: Look) -> FloatArray:
        if self._observe is not None:
            found = np.asarray(self._observe(look), dtype=np.float32)
            if found.ndim != 2 or len(found) != self.num_envs:
                raise ValueError(f"observe: expected an array of shape ({self.num_envs}, D), got {found.shape}")
            return found
        return surroundings(look, self._clock)

    def _rewards(self, before: Look, after: Look, actions: FloatArray) -> _Doubles:
        if self._reward is None:
            moved: _Doubles = after.centres[:, 0] - before.centres[:, 0]
            return moved
        return self._checked("reward", self._reward(before, after, actions)).astype(np.float64)

    def _terminations(self, look: Look) -> _Bools:
        ended = np.zeros(self.num_envs, np.bool_)
        ended[list(self.worlds.stopped)] = True
        if self._terminate is not None:
            ended |= self._checked("terminate", self._terminate(look)).astype(np.bool_)
        return ended

    def _checked(self, name: str, value: npt.ArrayLike) -> npt.NDArray[Any]:
        array = np.array(value)
        if array.shape != (self.num_envs,):
            raise ValueError(f"{name}: expected an array of shape ({self.num_envs},), got {array.shape}")
        return array

    def _infos(self, look: Look, chosen: _Bools | None = None) -> _Infos:
        mask = np.ones(self.num_envs, np.bool_) if chosen is None else chosen
        return {"centre": np.where(mask[:, None], look.centres, 0.0), "_centre": mask.copy()}

    def _finals(self, look: Look, ended: _Bools) -> _Infos:
        """Observations and infos at the end of episodes, as Gymnasium gives them with "SameStep"."""
        observations = np.full(self.num_envs, None, dtype=object)
        found = self._observations(look)
        for place in np.flatnonzero(ended):
            observations[place] = found[place]
        final = self._infos(look, ended)
        return {"final_obs": observations, "_final_obs": ended, "final_info": final, "_final_info": ended.copy()}


class WorldEnv(gymnasium.Env[FloatArray, FloatArray]):
    """One environment of Gymnasium. :func:`make` makes it. The arguments are those of :class:`WorldsVectorEnv`."""

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 20}

    def __init__(self, body: Scene | None = None, **options: Unpack[EnvOptions]) -> None:
        for name in ("num_envs", "autoreset_mode"):
            if name in options:
                raise TypeError(f"{name}: make_vec has this argument, a single environment has not")
        self._envs = WorldsVectorEnv(body, 1, autoreset_mode=AutoresetMode.DISABLED, **options)
        self.observation_space = self._envs.single_observation_space
        self.action_space = self._envs.single_action_space
        self.render_mode = self._envs.render_mode
        self.metadata = {**self.metadata, "render_fps": self._envs.metadata["render_fps"]}

    @property
    def worlds(self) -> Worlds:
        """The world of the environment, in a batch of one."""
        return self._envs.worlds

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[FloatArray, _Infos]:
        """Begin an episode. Without a seed, the random numbers continue."""
        super().reset(seed=seed)
        observations, infos = self._envs.reset(seed=seed)
        return observations[0], {"centre": infos["centre"][0]}

    def step(self, action: npt.ArrayLike) -> tuple[FloatArray, float, bool, bool, _Infos]:
        """Apply an action. A step after the end of an episode continues the episode."""
        self._envs._ended[:] = False
        rows = self._envs._actuators.rows("action", action)
        observations, rewards, terminations, truncations, infos = self._envs._advance(rows)
        return observations[0], float(rewards[0]), bool(terminations[0]), bool(truncations[0]), {"centre": infos["centre"][0]}

    def render(self) -> Any:
        """A picture of shape (height, width, 3); None without a render mode."""
        pictures = self._envs.render()
        return None if pictures is None else pictures[0]


#: Number of spheres and rods up to which "auto" is the CPU for a single environment, as for a Simulation.
_SMALL = 64


def _worlds(bodies: Any, num_envs: Any, dt: float, backend: BackendName, integrator: IntegratorName) -> Worlds:
    bodies = walker() if bodies is None else bodies
    is_single = isinstance(bodies, Scene) and num_envs in (None, 1)
    if backend == "auto" and is_single and bodies.counts.spheres + bodies.counts.rods <= _SMALL:
        # It needs no graphics device, which a forked process could not use.
        backend = "cpu"
    if isinstance(bodies, Scene):
        count = 1 if num_envs is None else whole("num_envs", num_envs, least=1)
        return Worlds(bodies, dt, count=count, backend=backend, integrator=integrator)
    if isinstance(bodies, Sequence) and not bodies:
        raise ValueError("bodies: expected at least one Scene")
    worlds = Worlds(bodies, dt, backend=backend, integrator=integrator)
    if num_envs is not None and num_envs != len(worlds):
        raise ValueError(f"num_envs: expected the number of bodies, {len(worlds)}, got {num_envs}")
    return worlds
