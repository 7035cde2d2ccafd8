"""Sweeps give the same table wherever their runs take place."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import rockfall as rf

HEIGHTS = [1.0, 1.5, 2.0]
RESTITUTIONS = [0.5, 1.0]


def make_scene(height: float, restitution: float) -> rf.Scene:
    scene = rf.Scene()
    scene.settings.restitution = restitution
    scene.add_box([-5, -1, -5], [5, 0, 5])
    scene.add_spheres(np.array([[0.0, height, 0.0], [0.1, height + 0.5, 0.0]]), radius=0.2, mass=1.0)
    return scene


def run(scene: rf.Scene, backend: str, height: float, restitution: float) -> dict[str, object]:
    sim = rf.Simulation(scene, dt=0.01, backend=backend)
    sim.run(200)
    return {"positions": sim.positions.ravel().tolist(), "energy": sim.energy.total}


def lose_once(flag: Path):
    """Return a run whose process is killed the first time that it begins with a height of 1.5."""

    def lost(scene: rf.Scene, backend: str, height: float, restitution: float) -> dict[str, object]:
        if height == 1.5 and not flag.exists():
            flag.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return run(scene, backend, height, restitution)

    return lost


@pytest.fixture(scope="module")
def expected() -> list[dict[str, object]]:
    rows = []
    for height in HEIGHTS:
        for restitution in RESTITUTIONS:
            given = {"height": height, "restitution": restitution}
            rows.append({**given, **run(make_scene(**given), "cpu", **given)})
    return rows


PARAMETERS = {"height": HEIGHTS, "restitution": RESTITUTIONS}


def test_all_combinations_in_order(expected):
    result = rf.sweep(make_scene, PARAMETERS, run, backend="cpu", workers=2, progress=False)
    assert list(result) == expected


SCRIPT = """
import sys
{before}
import rockfall as rf

def make_scene(height):
    scene = rf.Scene()
    scene.add_spheres([[0, height, 0]], radius=0.2)
    return scene

def run(scene, backend, height):
    sim = rf.Simulation(scene, dt=0.01, backend=backend)
    sim.run(10)
    return {{"y": round(float(sim.positions[0, 1]), 3)}}

result = rf.sweep(make_scene, {{"height": [1.0, 2.0]}}, run, backend="cpu", workers=2, progress=False)
print(result.columns()["y"])
"""


@pytest.mark.parametrize("before", ["", "sys.modules['cloudpickle'] = None"])
def test_a_script_without_a_guard_runs_its_sweep(before: str, tmp_path: Path):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(before=before))
    found = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False, timeout=120)
    assert (found.stdout, found.stderr, found.returncode) == ("[0.995, 1.995]\n", "", 0)


def test_functions_without_a_script_need_cloudpickle(tmp_path: Path):
    script = SCRIPT.format(before="sys.modules['cloudpickle'] = None")
    found = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=120)
    assert found.stderr.endswith("need cloudpickle: pip install cloudpickle\n") and len(found.stderr.splitlines()) < 12


def test_a_list_of_parameters_is_taken_as_it_is(expected):
    given = [{"height": 2.0, "restitution": 1.0}, {"height": 1.0, "restitution": 0.5}]
    result = rf.sweep(make_scene, given, run, backend="cpu", workers=1, progress=False)
    assert list(result) == [expected[-1], expected[0]]


def test_a_lost_process_is_replaced(expected, tmp_path):
    flag = tmp_path / "lost"
    result = rf.sweep(make_scene, PARAMETERS, lose_once(flag), backend="cpu", workers=2, progress=False)
    assert flag.exists()
    assert list(result) == expected


def test_a_run_that_always_loses_its_process_is_an_error():
    def lost(scene, backend, height):
        os.kill(os.getpid(), signal.SIGKILL)

    with pytest.raises(rf.SweepError, match="lost its process 2 times") as caught:
        rf.sweep(lambda height: None, {"height": [1.0]}, lost, backend="cpu", workers=1, retries=1, progress=False)
    assert caught.value.parameters == {"height": 1.0}


def test_an_exception_names_its_run():
    def fails(scene, backend, height):
        if height == 2.0:
            raise ZeroDivisionError("no height")
        return {}

    with pytest.raises(rf.SweepError, match="run 1 with {'height': 2.0} failed: ZeroDivisionError: no height") as caught:
        rf.sweep(lambda height: None, {"height": [1.0, 2.0]}, fails, backend="cpu", workers=1, progress=False)
    assert caught.value.index == 1
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"parameters": {}}, "parameters: expected at least one combination"),
        ({"parameters": {"a": 3}}, "parameters: expected a list of values for 'a', got int"),
        ({"parameters": {"a": "xyz"}}, "parameters: expected a list of values for 'a', got str"),
        ({"parameters": [3]}, "parameters: expected a dict as entry 0, got int"),
        ({"parameters": {"a": [1]}, "workers": 0}, "workers: expected a number from 1, got 0"),
        ({"parameters": {"a": [1]}, "retries": -1}, "retries: expected a number from 0, got -1"),
        ({"parameters": {"a": [1]}, "backend": "tpu"}, "backend: expected one of auto, cpu, gpu, got 'tpu'"),
    ],
)
def test_wrong_arguments(arguments, message):
    with pytest.raises((TypeError, ValueError), match=message):
        rf.sweep(make_scene=lambda a: None, run=lambda scene, backend, a: {}, progress=False, **arguments)


def test_results_must_be_a_dict_with_new_names():
    for result, message in [(3, "expected a dict of results, got int"), ({"a": 1}, "parameters and results: a")]:
        with pytest.raises(rf.SweepError, match=message):
            rf.sweep(lambda a: None, {"a": [1]}, lambda scene, backend, a: result, backend="cpu", workers=1, progress=False)


def test_tables(tmp_path):
    def squares(scene, backend, a):
        return {"square": a * a}

    result = rf.sweep(lambda a: None, {"a": [1, 2, 3]}, squares, backend="cpu", workers=1, progress=False)
    assert result.columns() == {"a": [1, 2, 3], "square": [1, 4, 9]}
    assert len(result[1:]) == 2 and result[1] == {"a": 2, "square": 4}
    assert result["square"] == [1, 4, 9]
    with pytest.raises(KeyError, match="did you mean"):
        result["sqare"]
    pandas = pytest.importorskip("pandas")
    assert result.to_pandas().equals(pandas.DataFrame({"a": [1, 2, 3], "square": [1, 4, 9]}))
    parquet = pytest.importorskip("pyarrow.parquet")
    assert result.to_arrow().to_pydict() == result.columns()
    assert "<table" in result._repr_html_()
    result.to_parquet(tmp_path / "table.parquet")
    assert parquet.read_table(tmp_path / "table.parquet").to_pydict() == result.columns()


# A job in the background of a shell ignores SIGINT, and so do its children.
ENDLESS = '''
import os, signal, sys, time, rockfall as rf
signal.signal(signal.SIGINT, signal.default_int_handler)
def run(scene, backend, a):
    open(f"{sys.argv[1]}/{os.getpid()}", "w").close()
    time.sleep(1000)
    return {}
try:
    rf.sweep(lambda a: None, {"a": [1, 2, 3, 4]}, run, backend="cpu", workers=2, progress=False)
except KeyboardInterrupt:
    sys.exit(42)
'''


def is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    # The process that adopts orphans may not have taken its exit code yet.
    status = Path(f"/proc/{process}/stat")
    return not (status.exists() and status.read_text().rsplit(")", 1)[1].split()[0] == "Z")


# `kill` and many tools signal one process, and not its group as Ctrl-C in a terminal does.
@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 42), (signal.SIGTERM, -signal.SIGTERM)])
def test_a_signal_to_the_program_ends_its_workers(tmp_path, number, code):
    pytest.importorskip("cloudpickle")
    script, flags = tmp_path / "endless.py", tmp_path / "flags"
    script.write_text(ENDLESS)
    flags.mkdir()
    program = subprocess.Popen([sys.executable, script, flags], start_new_session=True)
    end = time.monotonic() + 60
    while len(list(flags.iterdir())) < 2:
        assert time.monotonic() < end and program.poll() is None, "the workers do not start"
        time.sleep(0.01)
    program.send_signal(number)
    assert program.wait(20) == code
    workers, end = [int(flag.name) for flag in flags.iterdir()], time.monotonic() + 20
    while any(map(is_alive, workers)):
        assert time.monotonic() < end, "the workers outlive their program"
        time.sleep(0.01)


# Ray itself warns of what later versions of it change.
@pytest.mark.filterwarnings("default")
def test_a_ray_cluster_gives_the_same_table_also_when_a_worker_dies(expected, tmp_path):
    cloudpickle, ray = pytest.importorskip("cloudpickle"), pytest.importorskip("ray")
    # The workers do not have this file.
    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        flag = tmp_path / "lost"
        result = rf.sweep(make_scene, PARAMETERS, lose_once(flag), backend="cpu", progress=False, ray=True)
        assert flag.exists()
        assert list(result) == expected
        with pytest.raises(rf.SweepError, match="failed: KeyError") as caught:
            rf.sweep(lambda a: None, {"a": [1]}, lambda scene, backend, a: {}["x"], progress=False, ray=True)
        assert isinstance(caught.value.__cause__, KeyError)
    finally:
        ray.shutdown()
