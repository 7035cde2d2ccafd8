"""Many runs with different parameters, on the cores of this machine or on a Ray cluster."""

from __future__ import annotations

import itertools
import os
import pickle
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, cast, overload

from rockfall._attributes import hint, keywords
from rockfall._info import devices
from rockfall._progress import Progress
from rockfall._workers import SweepError, call, failed, on_processes, script_of, stop_if_reading
from rockfall.typing import BackendName

__all__ = ["SweepError", "SweepResult", "sweep"]

Parameters = Mapping[str, Any]

_NEEDS_CLOUDPICKLE = "functions of a notebook, and functions in functions, need cloudpickle: pip install cloudpickle"


class SweepResult(Sequence[dict[str, Any]]):
    """Parameters and results of all runs of a sweep, in the order of the parameters.

    A row is a dict with the parameters of a run followed by its results. ``result["y"]`` is the list of one of them in all runs.
    """

    def __init__(self, rows: list[dict[str, Any]]) -> None:
        self._rows = rows

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, index: int) -> dict[str, Any]: ...

    @overload
    def __getitem__(self, index: slice) -> SweepResult: ...

    @overload
    def __getitem__(self, index: str) -> list[Any]: ...

    def __getitem__(self, index: int | slice | str) -> dict[str, Any] | SweepResult | list[Any]:
        if isinstance(index, str):
            columns = self.columns()
            if index not in columns:
                raise KeyError(f"{index}: {hint(index, columns)}")
            return columns[index]
        return SweepResult(self._rows[index]) if isinstance(index, slice) else self._rows[index]

    def __repr__(self) -> str:
        names = ", ".join(self._rows[0]) if self._rows else ""
        return f"<SweepResult: {len(self)} runs; {names}>"

    def columns(self) -> dict[str, list[Any]]:
        """Return the table as lists by name. A run without a value has ``None``."""
        names = list(dict.fromkeys(name for row in self._rows for name in row))
        return {name: [row.get(name) for row in self._rows] for name in names}

    def to_pandas(self) -> Any:
        """Return a ``pandas.DataFrame`` with one row per run."""
        import pandas

        return pandas.DataFrame(self._rows)

    def to_arrow(self) -> Any:
        """Return a ``pyarrow.Table`` with one row per run."""
        import pyarrow

        return pyarrow.table(self.columns())

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Write the table as a Parquet file. Needs pyarrow."""
        from pyarrow import parquet

        parquet.write_table(self.to_arrow(), os.fspath(path))

    def _repr_html_(self) -> str:
        try:
            return str(self.to_pandas()._repr_html_())
        except ImportError:
            return repr(self)


@keywords
def sweep(
    make_scene: Callable[..., Any],
    parameters: Mapping[str, Iterable[Any]] | Iterable[Parameters],
    run: Callable[..., Mapping[str, Any]],
    *,
    backend: BackendName = "auto",
    workers: int | None = None,
    retries: int = 3,
    progress: bool = True,
    ray: bool | str = False,
    gpus: float = 0,
    cpus: float = 1,
) -> SweepResult:
    """Run a scene with every combination of parameters and collect the results.

    Parameters
    ----------
    make_scene : callable
        ``make_scene(**parameters)`` returns a `Scene`.
    parameters : dict of iterables, or iterable of dicts
        A dict of lists stands for all combinations, the last name changing fastest. A list of dicts is taken as it is.
    run : callable
        ``run(scene, backend=backend, **parameters)`` simulates the scene and returns a dict of results: numbers, strings or
        lists of them.
    backend : {"auto", "cpu", "gpu"}
        Backend that `run` is called with.
    workers : int, optional
        Number of processes. The default is 1 on a GPU, which the runs share, otherwise the number of cores. Without `ray` only.
    retries : int
        How often a run is tried again after its process was lost. An exception in `make_scene` or `run` is not tried again.
    progress : bool
        Whether to show a progress bar on standard error.
    ray : bool or str
        ``True`` or an address runs on a Ray cluster (``pip install rockfall[ray]``).
    gpus, cpus : float
        GPUs and cores per run on a Ray cluster. A run with ``gpus=1`` has a GPU of its own.

    Returns
    -------
    SweepResult
        One row per run in the order of the parameters, whatever ran where and when.

    Raises
    ------
    SweepError
        When a run raises an exception, which is its ``__cause__``, or when its process was lost more than `retries` times.
    ValueError
        When there are no parameters or a number is out of range.

    Notes
    -----
    Every run is a call of its own with the same arguments, so its results do not depend on where it ran or what ran beside it:
    they are bitwise equal on the CPU, and on GPUs of one kind. Functions travel to the workers by ``cloudpickle``, so they may be
    defined in a notebook or a script. A script needs no ``if __name__ == "__main__"``. Without ``cloudpickle``, each worker runs
    the script up to its first sweep to find the functions.

    Examples
    --------
    >>> def make_scene(height):
    ...     scene = rf.Scene()
    ...     scene.add_spheres([[0, height, 0]], radius=0.1, mass=1.0)
    ...     return scene
    >>> def run(scene, backend, height):
    ...     sim = rf.Simulation(scene, dt=0.01, backend=backend)
    ...     sim.run(100)
    ...     return {"y": float(sim.positions[0, 1])}
    >>> rf.sweep(make_scene, {"height": [1.0, 2.0]}, run, progress=False).columns()["height"]
    [1.0, 2.0]
    """
    stop_if_reading()
    if backend not in ("auto", "cpu", "gpu"):
        raise ValueError(f"backend: expected one of auto, cpu, gpu, got {backend!r}")
    runs = list(_combinations(parameters))
    if not runs:
        raise ValueError("parameters: expected at least one combination, got none")
    if retries < 0:
        raise ValueError(f"retries: expected a number from 0, got {retries}")
    if workers is not None and workers < 1:
        raise ValueError(f"workers: expected a number from 1, got {workers}")
    task, script = _dumps((make_scene, run, backend))
    with Progress(len(runs) if progress else None, unit="run") as shown:
        if ray:
            found = _on_ray(task, runs, address=ray, retries=retries, gpus=gpus, cpus=cpus, advance=shown.advance)
        else:
            count = workers or _default_workers(backend)
            found = on_processes(task, script, runs, workers=min(count, len(runs)), retries=retries, advance=shown.advance)
    return SweepResult([{**parameters, **result} for parameters, result in zip(runs, found)])


def _combinations(parameters: Mapping[str, Iterable[Any]] | Iterable[Parameters]) -> Iterator[dict[str, Any]]:
    if isinstance(parameters, Mapping):
        of_names = cast("Mapping[str, Iterable[Any]]", parameters)
        for name, values in of_names.items():
            if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
                raise TypeError(f"parameters: expected a list of values for {name!r}, got {type(values).__name__}")
        names, lists = list(of_names), [list(values) for values in of_names.values()]
        yield from (dict(zip(names, values)) for values in itertools.product(*lists) if names)
        return
    for index, entry in enumerate(parameters):
        if not isinstance(entry, Mapping):
            raise TypeError(f"parameters: expected a dict as entry {index}, got {type(entry).__name__}")
        yield dict(entry)


def _default_workers(backend: str) -> int:
    if backend == "gpu" or (backend == "auto" and any(not device.software for device in devices())):
        return 1
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _dumps(task: tuple[Any, ...]) -> tuple[bytes, str | None]:
    """The functions as bytes, and the script that a worker finds them in if they are there by name only."""
    try:
        import cloudpickle
    except ImportError:
        script = script_of(task)
        in_notebook = script is None and any(getattr(part, "__module__", None) == "__main__" for part in task)
        try:
            found = pickle.dumps(task)
        except (pickle.PicklingError, AttributeError) as error:
            raise TypeError(_NEEDS_CLOUDPICKLE) from error
        if in_notebook:
            raise TypeError(_NEEDS_CLOUDPICKLE) from None
        return found, script
    return bytes(cloudpickle.dumps(task)), None


def _on_ray(
    task: bytes,
    runs: list[dict[str, Any]],
    *,
    address: bool | str,
    retries: int,
    gpus: float,
    cpus: float,
    advance: Callable[[int], None],
) -> list[dict[str, Any]]:
    try:
        import ray
        import ray.exceptions
    except ImportError as error:
        raise ImportError("a sweep on a cluster needs Ray: pip install rockfall[ray]") from error
    if not ray.is_initialized():
        ray.init(address=address if isinstance(address, str) else None, log_to_driver=False)
    # Ray itself starts a run again when its worker is lost, and not when it raises an exception.
    remote = ray.remote(num_cpus=cpus, num_gpus=gpus, max_retries=retries, retry_exceptions=False)(call)
    shared = ray.put(task)
    indices = {remote.remote(shared, parameters): index for index, parameters in enumerate(runs)}
    results: dict[int, dict[str, Any]] = {}
    waiting = list(indices)
    while waiting:
        done, waiting = ray.wait(waiting)
        for reference in done:
            index = indices[reference]
            try:
                results[index] = ray.get(reference)
            except ray.exceptions.RayTaskError as error:
                cause = error.cause if isinstance(error.cause, Exception) else error
                for left in waiting:
                    ray.cancel(left, force=False)
                raise failed(index, runs[index], f"failed: {type(cause).__name__}: {cause}") from cause
            except (ray.exceptions.WorkerCrashedError, ray.exceptions.NodeDiedError) as error:
                raise failed(index, runs[index], f"lost its worker more than {retries} times") from error
            advance(1)
    return [results[index] for index in range(len(runs))]
