"""Building scenes."""

from __future__ import annotations

import copy
import pathlib
import pickle
import time

import numpy as np
import pytest

import rockfall as rf


def test_every_kind_of_object_is_added_in_bulk() -> None:
    scene = rf.Scene()
    spheres = scene.add_spheres(
        np.eye(3),
        [1, 2, 3],
        mass=[4, 5, 6],
        velocity=[0, 1, 0],
        angular_momentum=[1, 0, 0],
        orientation=[0, 1, 0, 0],
        force=[0, 0, 2],
        fixed=[False, True, False],
        group=7,
    )
    assert spheres.tolist() == [0, 1, 2] and spheres.dtype == np.int64
    assert scene.add_sphere([0, 9, 0], 1.0, 2.0, velocity=[1, 2, 3]) == 3
    assert scene.add_rods(spheres[:2], spheres[1:], 0.1, [0, 2]).tolist() == [0, 1]
    assert scene.add_rod(0, 3, 0.1, 9.0) == 2
    assert scene.add_springs(spheres[:2], spheres[1:], 5).tolist() == [0, 1]
    assert scene.add_spring(0, 2, 5, 1.5, 0.5) == 2
    assert scene.add_tethers([0, 1], [[0, 5, 0], [0, 6, 0]], 3, 1, 0.5).tolist() == [0, 1]
    capsules = scene.add_capsules([[0, 0, 5], [0, 0, 7]], [[1, 0, 5], [1, 0, 7]], 0.2, mass=3, velocity=[0, 1, 0])
    assert [part.tolist() for part in capsules] == [[0, 1], [[4, 5], [6, 7]], [3, 4]]
    assert scene.add_boxes([[0, 0, 0], [9, 0, 0]], np.eye(3)).tolist() == [0, 1]
    assert scene.add_box([0, 0, 0], [1, 2, 3]) == 2
    assert scene.add_polygons([0, 0, 0], [[1, 0, 0]], [[0, 0, 1]]).tolist() == [0]
    assert scene.counts == rf.Counts(8, 5, 2, 3, 2, 3, 1)

    table = scene.table("sphere")
    assert table["radius"][:4].tolist() == [1, 2, 3, 1] and table["mass"][:4].tolist() == [4, 5, 6, 2]
    assert table["fixed"][:4].tolist() == [0, 1, 0, 0] and table["group"][:4].tolist() == [7, 7, 7, 0]
    assert scene.table("rod")[["end1", "end2", "length"]].tolist()[:3] == [(0, 1, 0.0), (1, 2, 2.0), (0, 3, 9.0)]
    assert scene.table("rod")["end1"][3] == 4
    springs = scene.table("spring")
    np.testing.assert_allclose(springs["length"], [np.sqrt(2), np.sqrt(2), 1.5], rtol=1e-6)
    assert springs["damping"].tolist() == [0, 0, 0.5]
    assert scene.table("tether")["point"].tolist() == [[0, 5, 0], [0, 6, 0]]
    assert scene.table("capsule")[["end1", "end2"]].tolist() == [(4, 5), (6, 7)]
    assert scene.table("box")["k"].tolist() == [[0, 0, 1], [0, 0, 1], [0, 0, 3]]
    assert scene.table("polygon")["right"].tolist() == [[0, 0, 1]]

    sim = rf.Simulation(scene, backend="cpu")
    assert sim.velocities[3].tolist() == [1, 2, 3] and sim.velocities[6].tolist() == [0, 1, 0]
    assert sim.orientations[0].tolist() == [0, 1, 0, 0] and sim.angular_momenta[1].tolist() == [1, 0, 0]
    assert sim.external_forces[2].tolist() == [0, 0, 2] and sim.fixed.tolist()[:3] == [False, True, False]
    assert sim.masses[4] == 1.5 and sim.radii[4] == np.float32(0.2)


def test_objects_are_removed_and_changed() -> None:
    scene = rf.Scene()
    ids = scene.add_spheres(np.arange(12).reshape(4, 3), 0.1)
    rods = scene.add_rods(ids[:-1], ids[1:], 0.05, 0)
    springs = scene.add_springs(ids[:-1], ids[1:], 1)
    tethers = scene.add_tethers(ids, [0, 0, 0], 1)
    scene.update_rods(rods[1], radius=0.02, length=3)
    scene.update_springs(springs, stiffness=[1, 2, 3], length=4, damping=0.5)
    scene.update_tethers(tethers[1:3], point=[1, 2, 3], stiffness=5, length=1, damping=2)
    assert scene.table("rod")["length"].tolist() == [0, 3, 0]
    assert scene.table("spring")["stiffness"].tolist() == [1, 2, 3]
    assert scene.table("tether")["point"].tolist() == [[0, 0, 0], [1, 2, 3], [1, 2, 3], [0, 0, 0]]
    scene.remove("sphere", [1, 1])
    assert scene.counts == rf.Counts(3, 1, 0, 1, 3, 0, 0)
    assert scene.table("sphere")["id"].tolist() == [0, 2, 3]
    assert scene.table("rod")[["id", "end1", "end2"]].tolist() == [(2, 1, 2)], "ends are rows, not numbers"
    assert scene.add_sphere([0, 0, 0], 1.0) == 4, "numbers are not used again"
    with pytest.raises(LookupError, match="not in the scene"):
        scene.add_rod(1, 2, 0.1)
    with pytest.raises(LookupError, match="not in the scene"):
        scene.remove("sphere", [0, 1])
    assert scene.counts.spheres == 4, "nothing was removed"
    for kind, number in [("rod", 2), ("spring", 2), ("tether", 0)]:
        scene.remove(kind, number)
    assert scene.counts == rf.Counts(4, 0, 0, 0, 2, 0, 0)


def test_many_objects_are_removed_in_one_pass() -> None:
    scene = rf.Scene()
    ids = scene.add_spheres(np.random.default_rng(1).random((100_000, 3)) * 100, 0.1)
    sim = rf.Simulation(scene, backend="cpu")

    def seconds(numbers: np.ndarray) -> float:
        start = time.process_time()
        sim.remove("sphere", numbers)
        return time.process_time() - start

    one = min(seconds(ids[k]) for k in range(5))
    assert seconds(ids[5::100]) < 100 * one, "1,000 spheres took 1,000 times as long as one"
    assert sim.counts.spheres == 100_000 - 5 - 1000
    assert sim.table("sphere")["id"][:2].tolist() == [6, 7]


def test_arrays_of_any_layout_and_dtype_are_taken() -> None:
    data = np.arange(24, dtype=np.float64).reshape(4, 6)
    data.flags.writeable = False
    scene = rf.Scene()
    scene.add_spheres(data[:, ::2], np.float16(0.5), mass=np.arange(1, 5, dtype=np.uint8))
    scene.add_spheres(np.asfortranarray(data[:, :3]), [1, 1, 1, 1])
    scene.add_spheres(data.astype(">f4")[:, :3], 1)
    scene.add_spheres(np.empty((0, 3)), 1)
    sim = rf.Simulation(scene, backend="cpu")
    np.testing.assert_array_equal(sim.positions, np.concatenate([data[:, ::2], data[:, :3], data[:, :3]]))
    assert sim.masses.tolist() == [1, 2, 3, 4] + 8 * [1]


class Foreign:
    """An array of another library in host memory, which speaks DLPack only."""

    def __init__(self, array: np.ndarray) -> None:
        self.array = array
        self.shape = array.shape

    def __dlpack__(self, **options: object) -> object:
        return self.array.__dlpack__(**options)  # type: ignore[arg-type]

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.array.__dlpack_device__()


def test_arrays_of_other_libraries_are_taken_and_given() -> None:
    scene = rf.Scene()
    position = np.arange(6.0).reshape(2, 3)
    scene.add_spheres(Foreign(position), Foreign(np.array([0.5, 0.25], np.float32)))
    sim = rf.Simulation(scene, backend="cpu")
    np.testing.assert_array_equal(sim.positions, position)
    sim.velocities = Foreign(position)
    shared = np.from_dlpack(Foreign(sim.velocities))
    np.testing.assert_array_equal(shared, position)
    twin = rf.Scene()
    twin.add_spheres(sim.positions, sim.radii, sim.masses, sim.velocities, orientation=sim.orientations)
    # The scene of a simulation has the contact law and the precision that were chosen for it.
    twin.settings.contact_law = sim.scene.settings.contact_law
    twin.settings.precision = sim.scene.settings.precision
    assert twin.to_text() == sim.scene.to_text(), "what comes out of one call goes into another"
    views = sim.state
    twin.add_spheres(views.positions, views.radii)
    assert twin.counts.spheres == 4


def test_settings_are_attributes_with_units() -> None:
    scene = rf.Scene()
    scene.settings.gravity = 9.81
    scene.settings.collisions = False
    scene.settings.gravity_direction = [0, 0, -1]
    scene.settings.update(friction=0, restitution=np.float32(0.1))
    scene.settings["linear_damping"] = 0.25
    assert scene.settings.gravity == 9.81 and scene.settings.collisions is False
    assert scene.settings.gravity_direction == (0, 0, -1) and scene.settings["linear_damping"] == 0.25
    assert dict(scene.settings.items())["restitution"] == 0.1
    assert "units/s²" in rf.Settings.gravity.__doc__  # type: ignore[attr-defined]
    assert "set gravity 9.81" in scene.to_text()
    other = rf.Scene()
    other.settings = scene.settings
    assert repr(other.settings) == repr(scene.settings)
    assert set(scene.settings) == set(scene.settings.keys()) and len(scene.settings) == len(list(scene.settings))


def test_every_setting_is_set_and_documented() -> None:
    for scene in (rf.Scene(), rf.Simulation(rf.Scene(), backend="cpu", integrator="symplectic-euler")):
        for name, value in scene.settings.items():
            words = {"contact_law": "hertz-mindlin", "precision": "double"}
            values = {tuple: (1.0, 0.0, 0.0), bool: not value, str: words.get(name), float: 0.25}
            new = 1.5 if name == "mesh_angle" else values[type(value)]
            setattr(scene.settings, name, new)
            assert scene.settings[name] == new, name
            assert "Default" in getattr(rf.Settings, name).__doc__


def test_declared_settings_are_those_of_the_library() -> None:
    declared = [name for name in rf.Settings.__annotations__ if not name.startswith("_")] or None
    text = pathlib.Path(rf.__file__).with_name("_settings.py").read_text()
    block = text.split("if TYPE_CHECKING:\n        ")[1].split("\n\n")[0]
    names = [line.split(":")[0].strip() for line in block.splitlines()]
    assert names == list(rf.Scene().settings), declared


def test_text_is_read_and_written_without_loss(scene: rf.Scene, tmp_path: pathlib.Path) -> None:
    text = scene.to_text()
    assert rf.Scene.parse(text).to_text() == text
    scene.save(tmp_path / "scene.txt")
    assert rf.Scene.load(tmp_path / "scene.txt").to_text() == text
    assert rf.Scene.load(str(tmp_path / "scene.txt")).counts == scene.counts
    for twin in (scene.copy(), copy.copy(scene), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
        twin.add_sphere([0, 20, 0], 1.0)
        assert twin.counts.spheres == scene.counts.spheres + 1
    assert scene.to_text() == text
    assert rf.Scene.parse("Sphere 1 0 0\nS 1 0 2 0 0 0 0 0 0 0 1 0.5 0").warnings[0][0] == 1


def test_check_reports_a_long_time_step(scene: rf.Scene) -> None:
    assert any("time step" in line for line in scene.check(dt=1.0)), scene.check(dt=1.0)
    single = rf.Scene()
    single.add_sphere([0, 0, 0], 1.0)
    assert single.check() == ["sphere number 0 will fall for ever: nothing holds it, and nothing is below it along gravity"]
    single.add_box([-1, -3, -1], [1, -2, 1])
    assert single.check() == []
    for _ in range(12):
        single.add_sphere([5, 3 * single.counts.spheres, 0], 1.0)
    found = single.check()
    assert len(found) == 11 and found[10] == "2 more bodies will fall for ever"


def test_settings_can_be_pickled(scene: rf.Scene) -> None:
    scene.settings.update(gravity=3.7, contact_law="linear", collisions=True, gravity_direction=(0, 0, -1))
    for twin in (pickle.loads(pickle.dumps(scene.settings)), copy.deepcopy(scene.settings)):
        assert dict(twin.items()) == dict(scene.settings.items())
        twin.gravity = 1.0
    assert scene.settings.gravity == pytest.approx(3.7)


def test_a_million_objects_are_added_in_a_second() -> None:
    count = 1_000_000
    position = np.random.default_rng(0).random((count, 3)) * 100
    scene = rf.Scene()
    # Processor time, so that other programs do not matter.
    start = time.process_time()
    ids = scene.add_spheres(position, 0.1)
    spheres = time.process_time()
    scene.add_rods(ids[:-1], ids[1:], 0.05)
    scene.add_springs(ids[:-1], ids[1:], 10.0)
    assert spheres - start < 1.0
    assert time.process_time() - spheres < 2.0
    assert scene.counts[:4] == (count, count - 1, 0, count - 1)


def test_a_scene_says_how_it_is_run() -> None:
    scene = rf.Scene.parse("@run dt=0.0002 integrator=symplectic-euler steps=50 substeps=2\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n")
    assert scene.run == rf.RunDefaults(dt=0.0002, integrator="symplectic-euler", steps=50, substeps=2)
    sim = rf.Simulation(scene, backend="cpu")
    assert (sim.dt, sim.integrator) == (0.0001, "symplectic-euler")
    assert rf.Scene.parse(sim.scene.to_text()).run == scene.run
    given = rf.Simulation(scene, 0.01, backend="cpu", integrator="rk4")
    assert (given.dt, given.integrator) == (0.01, "rk4")
    worlds = rf.Worlds(scene, count=2, backend="cpu")
    assert (worlds.dt, worlds.integrator) == (0.0001, "symplectic-euler")
    with pytest.raises(ValueError, match="dt: expected a time step, because the scenes have different ones"):
        rf.Worlds([scene, rf.Scene()], backend="cpu")


def test_how_a_scene_is_run_can_be_set() -> None:
    scene = rf.Scene()
    assert scene.run == rf.RunDefaults() and scene.copy().run == scene.run
    scene.run = rf.RunDefaults(dt=4e-5, every=10)
    assert scene.to_text() == "@run dt=0.00004 every=10\n"
    assert rf.Simulation(scene, backend="cpu").dt == 4e-5
    for wrong, message in (
        (rf.RunDefaults(dt=0.0), "run.dt: expected a finite number"),
        (rf.RunDefaults(integrator="euler"), "auto, rk4, symplectic-euler or velocity-verlet"),
        (rf.RunDefaults(steps=0), "run.steps: expected a whole number of at least 1"),
        (rf.RunDefaults(substeps=2_000_000), "from 1 to 1000000"),
    ):
        with pytest.raises(ValueError, match=message):
            scene.run = wrong
    with pytest.raises(TypeError, match=r"run: expected a rockfall.RunDefaults"):
        scene.run = (0.1,)  # type: ignore[assignment]
    assert scene.run == rf.RunDefaults(dt=4e-5, every=10)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("spher 1 2 3", "scene:1: 'spher 1 2 3' is not a line of a scene.*not one of S, R, C"),
        ("# balls\n\nball 0 0 0\nbox 1", "scene:3: 'ball 0 0 0' is not a line.*a line `S reference"),
        ("set gravty 9.81", "scene:1: .*set 'gravty' is an unknown setting, did you mean gravity"),
        ("s 1  0 1 0  0 0 0  0 0 0  1 0.5", "scene:1: "),
    ],
)
def test_a_text_that_yields_nothing_is_an_error(text: str, message: str, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValueError, match=message):
        rf.Scene.parse(text)
    (tmp_path / "scene").write_text(text)
    with pytest.raises(ValueError, match=message):
        rf.Scene.load(tmp_path / "scene")
    with pytest.raises(ValueError, match="Scene.load reads a file"):
        rf.Scene.parse(str(tmp_path / "scene"))


def test_texts_without_objects_that_are_meant_so_are_scenes() -> None:
    for text in ("", " \n", "# nothing\n", rf.Scene().to_text(), "set gravity 0\n", "@use -\nnothing yet"):
        assert not any(rf.Scene.parse(text).counts)
    # Comments beside what is understood are allowed, as in the files of the thesis.
    assert rf.Scene.parse("a ball\nS 1 0 1 0  0 0 0  0 0 0  1 0.5").counts.spheres == 1


def test_rods_without_a_length_are_held_at_the_distance_of_their_spheres() -> None:
    scene = rf.Scene()
    ids = scene.add_spheres([[0, 0, 0], [2, 0, 0], [2, 3, 0]], 0.1)
    scene.add_rods(ids[:-1], ids[1:], 0.05)
    scene.add_rod(0, 2, 0.05, length=0)
    assert scene.table("rod")["length"].tolist() == [2, 3, 0]
    scene.add_sphere([2, 3, 0], 0.1)
    with pytest.raises(ValueError, match="row 1: length: both spheres are at the same place"):
        scene.add_rods([0, 2], [1, 3], 0.05)
    assert scene.counts.rods == 3
    scene.add_rod(2, 3, 0.05, 0)


def test_rods_and_springs_of_a_simulation_take_the_present_distance() -> None:
    scene = rf.Scene()
    scene.settings.gravity = 0
    scene.add_spheres([[0, 0, 0], [2, 0, 0]], 0.1, velocity=[[0, 0, 0], [1, 0, 0]])
    sim = rf.Simulation(scene, 0.125, backend="cpu")
    sim.run(8)
    sim.add_rod(0, 1, 0.05)
    sim.positions[1, 0] = 5
    sim.add_spring(0, 1, 10.0)
    assert sim.table("rod")["length"].tolist() == [3] and sim.table("spring")["length"].tolist() == [5]


def test_messages_have_the_words_of_python() -> None:
    scene = rf.Scene()
    scene.settings.gravity = 9.81
    scene.add_box([-5, -1, -5], [5, 0, 5])
    scene.add_spheres(np.arange(60)[:, None] * [0.001, 0.2, 0] + [0, 0.1, 0], 0.1)
    found = "\n".join(scene.check(0.005))
    assert "`scene.settings.resting_overlap = 0.02` chooses" in found and "`set " not in found
    sim = rf.Simulation(scene, 0.005, backend="cpu")
    with pytest.warns(rf.SceneWarning, match=r"`scene.settings.resting_overlap = 0.02`"):
        sim.step()
    slippery = rf.Scene()
    slippery.settings.contact_law = "hertz-mindlin"
    slippery.add_material("glass", density=2500, young=1e7, poisson=0.2)
    slippery.add_spheres([[0, 0, 0], [5, 0, 0]], 0.1, material="glass")
    assert any("give `friction` to `scene.set_pair`" in text for text in slippery.check(1e-4))
    muscles = rf.Scene()
    muscles.add_spheres([[0, 0, 0], [1, 0, 0]], 0.1)
    muscles.add_springs(0, 1, 10.0, muscle=[0.5, 20, 0])
    assert any("so use dt=" in text and "--" not in text for text in muscles.check(0.02))
    # Messages about a scene text speak of its lines.
    with pytest.raises(ValueError, match="`set gravity 1`"):
        rf.Scene.parse("set gravity = 1\nset restitution 1")
