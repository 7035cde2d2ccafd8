"""Processes that do the runs of a sweep."""

from __future__ import annotations

import itertools
import os
import pickle
import sys
import threading
import types
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import parent_process
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any


class SweepError(RuntimeError):
    """A run of a sweep failed.

    Attributes
    ----------
    index : int
        Number of the run, in the order of the parameters, from 0.
    parameters : dict
        Parameters of the run.
    """

    def __init__(self, message: str, index: int, parameters: dict[str, Any]) -> None:
        super().__init__(message, index, parameters)
        self.index = index
        self.parameters = parameters

    def __str__(self) -> str:
        return str(self.args[0])


_starting = threading.Lock()


@contextmanager
def _without_main() -> Iterator[None]:
    """Hides ``__main__``. A process that is started by "spawn" would otherwise run the script again, and with it the sweep."""
    with _starting:
        main = sys.modules["__main__"]
        sys.modules["__main__"] = types.ModuleType("__main__")
        try:
            yield
        finally:
            sys.modules["__main__"] = main


class _Process(SpawnProcess):
    @staticmethod
    def _Popen(process_obj: Any) -> Any:
        with _without_main():
            return SpawnProcess._Popen(process_obj)


class _Context(SpawnContext):
    """Starts processes that do not run the script of the calling program, and can end them."""

    def __init__(self) -> None:
        super().__init__()
        self._started: list[_Process] = []

    def Process(self, *args: Any, **options: Any) -> _Process:  # type: ignore[override]  # noqa: N802
        process = _Process(*args, **options)
        self._started.append(process)
        return process

    def end(self) -> None:
        """Ends all processes, in the middle of a run."""
        for process in self._started:
            if process.pid is not None:
                process.terminate()


class SweepInScript(BaseException):
    """Ends a script that a worker reads for its functions, at its sweep."""


#: Whether this process reads the functions of a script.
_is_reading = False


def stop_if_reading() -> None:
    """Ends the script at its sweep if a worker reads it for its functions."""
    if _is_reading:
        raise SweepInScript


def script_of(task: tuple[Any, ...]) -> str | None:
    """The script that defines functions of a task, if there is one."""
    path = getattr(sys.modules["__main__"], "__file__", None)
    has_some = any(getattr(part, "__module__", None) == "__main__" for part in task)
    return os.path.abspath(path) if has_some and path is not None else None


def _read(script: str) -> None:
    """Runs a script up to its sweep, as ``__main__``, so that its functions can be found by their names."""
    global _is_reading
    main = types.ModuleType("__mp_main__")
    main.__file__ = script
    sys.modules["__main__"] = sys.modules["__mp_main__"] = main
    with open(script, "rb") as file:
        code = compile(file.read(), script, "exec")
    _is_reading = True
    try:
        exec(code, main.__dict__)
    except SweepInScript:
        pass
    finally:
        _is_reading = False


def call(task: bytes, parameters: dict[str, Any]) -> dict[str, Any]:
    """Do one run. Runs in a worker."""
    make_scene, run, backend = pickle.loads(task)
    result = run(make_scene(**parameters), backend=backend, **parameters)
    if not isinstance(result, Mapping):
        raise TypeError(f"run: expected a dict of results, got {type(result).__name__}")
    both = set(result) & set(parameters)
    if both:
        raise ValueError(f"run: these names are parameters and results: {', '.join(sorted(both))}")
    return dict(result)


def failed(index: int, parameters: dict[str, Any], why: str) -> SweepError:
    return SweepError(f"run {index} with {parameters} {why}", index, parameters)


def _set_up(in_one_thread: bool, script: str | None) -> None:
    """Prepares a worker. One thread each leaves a core to every worker. Results do not depend on the number of threads."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    if in_one_thread:
        os.environ.setdefault("RAYON_NUM_THREADS", "1")
    if script is not None:
        _read(script)


def _end_with_parent() -> None:
    """Ends a worker with the program that started it. Nobody would take its results."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def on_processes(
    task: bytes, script: str | None, runs: list[dict[str, Any]], *, workers: int, retries: int, advance: Callable[[int], None]
) -> list[dict[str, Any]]:
    results: dict[int, dict[str, Any]] = {}
    losses = [0] * len(runs)
    while len(results) < len(runs):
        waiting = [index for index in range(len(runs)) if index not in results]
        # A fork would copy the threads' locks in whatever state they are.
        context = _Context()
        pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_set_up, initargs=(workers > 1, script))
        try:
            _drain(pool, task, runs, waiting, workers, results, losses, retries, advance)
        except BaseException:
            # After an error or Ctrl-C the other runs are not needed, and each may take hours.
            context.end()
            raise
        finally:
            pool.shutdown(wait=True, cancel_futures=True)
    return [results[index] for index in range(len(runs))]


def _drain(
    pool: ProcessPoolExecutor,
    task: bytes,
    runs: list[dict[str, Any]],
    waiting: list[int],
    workers: int,
    results: dict[int, dict[str, Any]],
    losses: list[int],
    retries: int,
    advance: Callable[[int], None],
) -> None:
    """Run what is waiting until all is done or a process is lost."""
    queue = iter(waiting)
    # Few runs are submitted at a time, so that only those under way are lost with a process.
    under_way = {pool.submit(call, task, runs[index]): index for index in itertools.islice(queue, workers)}
    while under_way:
        done, _ = wait(under_way, return_when=FIRST_COMPLETED)
        for future in done:
            index = under_way.pop(future)
            try:
                results[index] = future.result()
            except BrokenProcessPool as error:
                for lost in [index, *under_way.values()]:
                    losses[lost] += 1
                    if losses[lost] > retries:
                        raise failed(lost, runs[lost], f"lost its process {losses[lost]} times") from error
                return
            except Exception as error:
                raise failed(index, runs[index], f"failed: {type(error).__name__}: {error}") from error
            advance(1)
            for index in itertools.islice(queue, 1):
                under_way[pool.submit(call, task, runs[index])] = index
