"""Evolution of creatures."""

from __future__ import annotations

import csv
import pathlib
import pickle
import runpy
import signal
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import rockfall as rf

SMALL: dict[str, Any] = {"seconds": 2.0, "seed": 5, "backend": "cpu"}


def test_the_champion_is_that_of_the_command_line(tmp_path: pathlib.Path, command_line: Callable[..., str]) -> None:
    found = rf.evolve(3, 24, progress=False, **SMALL)
    best, history, saved = tmp_path / "best.txt", tmp_path / "history.csv", tmp_path / "run.json"
    options = ["--seconds", 2, "--seed", 5, "--backend", "cpu", "--generations", 3, "--population", 24]
    command_line("evolve", *options, "--out", best, "--history", history, "--checkpoint", saved)
    assert found.champion is not None

    def bare(scene: rf.Scene) -> list[str]:
        # The program also writes how the scene is run, and colours.
        return [line for line in scene.to_text().splitlines() if not line.startswith(("@run", "@colour"))]

    assert bare(found.champion.scene) == bare(rf.Scene.load(best))
    rows = list(csv.reader(history.read_text().splitlines()))[1:]
    assert [[float(number) for number in row] for row in rows] == [list(row) for row in found.history.tolist()]
    loaded = rf.Evolution.load(saved, backend="cpu")
    loaded.run(1)
    found.run(1)
    assert loaded.history.tolist() == found.history.tolist() and len(loaded.history) == 4


def test_the_champion_walks_as_far_as_it_claims() -> None:
    found = rf.evolve(3, 24, progress=False, **SMALL)
    champion, plan = found.champion, found.plan
    assert champion is not None and champion.fitness == champion.distance == found.history["champion"][-1] > 0.1
    assert 4 <= champion.masses == champion.scene.counts.spheres <= 20
    sim = rf.Simulation(champion.scene, dt=plan["dt"], backend="cpu")
    sim.run(plan["settling_steps"])
    start = sim.positions.mean(axis=0, dtype=np.float64)
    sim.run(plan["steps"] - plan["settling_steps"])
    way = sim.positions.mean(axis=0, dtype=np.float64) - start
    assert np.hypot(way[0], way[2]) == pytest.approx(champion.distance, rel=1e-6)
    gallery = found.gallery(3)
    assert 1 <= len(gallery) <= 3 and gallery[0].fitness >= gallery[-1].fitness > 0
    assert gallery[0].length > 0.5 and gallery[0].bounce >= 0 and 0.4 <= gallery[0].frequency <= 3
    assert f"champion {champion.fitness:.3f}" in repr(found)


def test_a_checkpoint_is_gone_on_with(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.json"
    whole = rf.evolve(3, 16, progress=False, **SMALL)
    rf.evolve(2, 16, checkpoint=path, **SMALL)
    assert "champion" in capsys.readouterr().err
    resumed = rf.evolve(3, 16, checkpoint=path, progress=False, **SMALL)
    assert resumed.history.tolist() == whole.history.tolist()
    assert len(rf.Evolution.load(path).history) == 3
    with pytest.raises(ValueError, match="population: expected 16 as in .*run.json, got 17"):
        rf.evolve(4, 17, checkpoint=path, progress=False, **SMALL)
    copy = tmp_path / "copy.json"
    resumed.save(copy)
    assert copy.read_text() == path.read_text()


def test_evolutions_exchange_creatures() -> None:
    one, other = rf.evolve(1, 16, progress=False, **SMALL), rf.evolve(2, 24, progress=False, **{**SMALL, "seed": 6})
    kinds = [evolution.history["niches"][-1] for evolution in (one, other)]
    twin = pickle.loads(pickle.dumps(one))
    adopted = one.adopt(other)
    assert 0 < adopted <= kinds[1] and one.adopt(other) == 0
    assert twin.adopt(pickle.loads(pickle.dumps(other))) == adopted
    for evolution in (one, twin):
        evolution.run(1)
    assert one.history.tolist() == twin.history.tolist() and one.history["niches"][-1] > kinds[0]
    with pytest.raises(ValueError, match="other.*an evolution with the same body, goal"):
        one.adopt(rf.Evolution(2, seconds=3, backend="cpu"))
    with pytest.raises(TypeError, match="other: expected a rockfall.Evolution, got str"):
        one.adopt("another")  # type: ignore[arg-type]


def test_islands_on_ray_are_reproducible() -> None:
    ray = pytest.importorskip("ray")
    example = pathlib.Path(__file__).parents[1] / "examples" / "islands.py"
    islands = runpy.run_path(str(example))["islands"]
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        found = [islands(2, 2, generations=1, population=12, seconds=1.0, seed=3) for _ in range(2)]
    finally:
        ray.shutdown()
    assert [evolution.history.tolist() for evolution in found[0]] == [evolution.history.tolist() for evolution in found[1]]
    assert [len(evolution.history) for evolution in found[0]] == [2, 2]


def test_ctrl_c_leaves_out_the_generation_under_way() -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    evolution = rf.Evolution(2000, seconds=100, seed=1, backend="cpu")
    timer = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            evolution.run(1)
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)
    assert len(evolution.history) == 0 and evolution.champion is None and evolution.gallery() == []


def test_a_ground_of_your_own_and_other_goals() -> None:
    ground = rf.Scene()
    ground.settings.update(gravity=3.0, collisions=False, contact_force=8000.0, contact_damping=60.0, friction=16000.0)
    ground.add_box([-50, -1, -50], [50, 0, 50])
    found = rf.evolve(1, 8, ground=ground, goal="height", body="free", progress=False, **SMALL)
    assert found.champion is not None and found.champion.scene.settings.gravity == 3.0
    assert found.plan["goal"] == "height" and found.plan["body"] == "free" and "set gravity 3" in found.plan["ground"]


WRONG: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"population": 1}, ValueError, "population: expected a whole number of at least 2"),
    ({"population": 10**7}, ValueError, "population: expected at most 1000000"),
    ({"seconds": 0.5}, ValueError, "seconds: expected a number from 1 to 1000, got 0.5"),
    ({"seconds": "long"}, TypeError, "seconds: expected real numbers"),
    ({"dt": 0.5}, ValueError, "dt: expected at least 20 steps in 5 seconds, got 0.5"),
    ({"goal": "climb"}, ValueError, "ground: expected a Scene for the goal climb"),
    ({"goal": "win"}, ValueError, "goal: expected distance, speed, height, jump or climb, got \"win\""),
    ({"body": 5}, TypeError, "body: expected a str, got int"),
    ({"body": "snake"}, ValueError, "body: expected lattice or free"),
    ({"ground": "flat"}, TypeError, "ground: expected a rockfall.Scene, got str"),
    ({"seed": -1}, ValueError, "seed: expected a whole number"),
    ({"backend": "tpu"}, ValueError, "tpu"),
    ({"integrator": "euler"}, ValueError, "euler"),
]


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_errors_name_the_argument(number: int) -> None:
    options, kind, message = WRONG[number]
    with pytest.raises(kind, match=message):
        rf.Evolution(**{"backend": "cpu", "seconds": 5, **options})


def test_grounds_with_bodies_and_wrong_files_are_refused(tmp_path: pathlib.Path) -> None:
    ground = rf.Scene()
    ground.add_sphere([0, 0, 0], 1.0)
    with pytest.raises(ValueError, match="ground: expected only boxes, polygons and settings, got 1 spheres"):
        rf.Evolution(ground=ground)
    with pytest.raises(FileNotFoundError, match="none.json"):
        rf.Evolution.load(tmp_path / "none.json")
    (tmp_path / "bad.json").write_text("{}")
    with pytest.raises(ValueError, match="bad.json: not a saved evolution"):
        rf.Evolution.load(tmp_path / "bad.json")
    with pytest.raises(OSError, match="no/run.json"):
        rf.Evolution(2, backend="cpu").save(tmp_path / "no" / "run.json")
