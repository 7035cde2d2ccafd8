"""Arrays on the device, as far as that needs no NVIDIA card: ``check_device.py`` tests the rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rockfall as rf
from rockfall import _states


class Shared:
    """Memory of a device, on the host."""

    def __init__(self, array: np.ndarray[Any, Any]) -> None:
        self.array = array
        self.copies = 0
        self.shape = array.shape

    def host(self) -> np.ndarray[Any, Any]:
        self.copies += 1
        return self.array.copy()

    def __dlpack_device__(self) -> tuple[int, int]:
        return (2, 0)

    def __dlpack__(self, **options: Any) -> Any:
        return ("capsule", options)


@pytest.fixture
def shared() -> Shared:
    return Shared(np.arange(12, dtype=np.float32).reshape(4, 3))


def test_a_device_array_does_what_an_array_does(shared: Shared) -> None:
    array: Any = rf.DeviceArray(shared)
    plain = shared.array
    assert (array.shape, array.ndim, array.size, len(array), array.dtype) == ((4, 3), 2, 12, 4, np.float32)
    assert shared.copies == 0
    for found, expected in [
        (array + 1, plain + 1),
        (plain - array, plain - plain),
        (array * array, plain * plain),
        (np.float32(2) * array, 2 * plain),
        (array @ np.ones(3), plain @ np.ones(3)),
        (array[1], plain[1]),
        (array[:, 2], plain[:, 2]),
        (array[array > 5], plain[plain > 5]),
        (np.concatenate([array, plain]), np.concatenate([plain, plain])),
        (np.linalg.norm(array, axis=1), np.linalg.norm(plain, axis=1)),
        (np.asarray(array), plain),
        (np.array(array, dtype=np.float64), plain.astype(np.float64)),
        (array.mean(0), plain.mean(0)),
        (array.T, plain.T),
        (np.stack(list(array)), plain),
    ]:
        np.testing.assert_array_equal(found, expected)
        assert not isinstance(found, rf.DeviceArray)
    assert float(array.max()) == 11.0 and array.tolist() == plain.tolist()
    assert "DeviceArray" in repr(array) and shared.copies == 1
    with pytest.raises(AttributeError):
        _ = array.no_such_attribute


def test_dlpack_gives_the_memory_of_the_device_until_the_array_is_written_to(shared: Shared) -> None:
    array = rf.DeviceArray(shared)
    assert array.__dlpack_device__() == (2, 0)
    name, options = array.__dlpack__(stream=1, max_version=(1, 0))
    assert name == "capsule" and options["stream"] == 1 and options["max_version"] == (1, 0)
    assert shared.copies == 0
    array[0] = 7
    assert array.__dlpack_device__() == (1, 0)
    np.testing.assert_array_equal(np.from_dlpack(array)[0], 7)


def test_a_snapshot_cannot_be_written_to(shared: Shared) -> None:
    array: Any = rf.DeviceArray(shared)
    array += 1
    array[2:] = 0
    np.testing.assert_array_equal(array, [[1, 2, 3], [4, 5, 6], [0, 0, 0], [0, 0, 0]])
    array._freeze()
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 1
    with pytest.raises(ValueError, match="read-only"):
        array += 1
    with pytest.raises(ValueError, match="read-only"):
        array.numpy()[0] = 1
    with pytest.raises(ValueError, match="copy"):
        np.array(rf.DeviceArray(shared), copy=False)


def test_what_is_written_to_a_device_array_reaches_the_simulation(sim: rf.Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    class Native:
        """Hands out positions and velocities as if they were on a device."""

        def __init__(self, native: Any) -> None:
            self.native = native

        def shared(self, field: str) -> Shared | None:
            return Shared(self.native.get(field)) if field in ("position", "velocity") else None

        def __getattr__(self, name: str) -> Any:
            return getattr(self.native, name)

    plain = rf.Simulation(sim.scene, dt=0.01, backend="cpu")
    monkeypatch.setattr(sim, "_native", Native(sim._native))
    for each in (sim, plain):
        each.velocities[3] = [1, 2, 3]
        each.velocities *= 2
        each.positions[:, 1] += 0.5
        before = each.positions
        each.run(5)
        with pytest.raises(ValueError, match="read-only"):
            before[0] = 0
    assert isinstance(sim.positions, rf.DeviceArray) and isinstance(plain.positions, np.ndarray)
    for field in ("positions", "velocities", "orientations", "angular_momenta"):
        np.testing.assert_array_equal(getattr(sim, field), getattr(plain, field))
    # What one call gives, another takes.
    plain.positions = sim.positions
    np.testing.assert_array_equal(plain.positions, sim.positions)


def test_arrays_on_another_device_are_errors_that_name_the_argument(sim: rf.Simulation) -> None:
    class Elsewhere:
        def __dlpack_device__(self) -> tuple[int, int]:
            return (2, 7)

    assert _states.is_on_cuda(Elsewhere()) and not _states.is_on_cuda(np.zeros(3))
    with pytest.raises(TypeError, match="velocity: expected an array in host memory"):
        sim.velocities = Elsewhere()  # type: ignore[assignment]


def test_the_cpu_backend_says_why_it_does_not_share(sim: rf.Simulation) -> None:
    assert sim.array_sharing == "host: the simulation runs on the CPU"
    assert isinstance(sim.positions, np.ndarray)


def test_software_vulkan_does_not_share(scene: rf.Scene) -> None:
    sim = rf.Simulation(scene, backend="gpu")
    if not any(device.software for device in rf.devices()[:1]):
        assert sim.array_sharing
        return
    assert sim.array_sharing.startswith("host: ")
    assert isinstance(sim.positions, np.ndarray)
