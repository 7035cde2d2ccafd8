"""Checks and measures arrays on the device. Needs an NVIDIA card, PyTorch and CuPy, so CI does not run it:

    python crates/rockfall-python/check_device.py

Every check is an assertion. A table of times ends the output.
"""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable
from typing import Any

import cupy
import numpy as np
import torch

import rockfall as rf
from rockfall import _rockfall

FIELDS = ("positions", "velocities", "orientations", "angular_momenta")


def pile(count: int, backend: str = "gpu") -> rf.Simulation:
    """A falling pile."""
    side = int(np.ceil(count ** (1 / 3)))
    cells = np.stack(np.unravel_index(np.arange(count), (side, side, side)), -1)
    scene = rf.Scene()
    scene.add_box([-10, -1, -10], [2 * side, 0, 2 * side])
    scene.add_spheres(cells * 0.9 + [0, 1, 0], radius=0.4, mass=1.0, velocity=[0.2, 0, 0.1])
    return rf.Simulation(scene, dt=0.005, backend=backend)


def check_reading() -> None:
    sim = pile(5_000)
    assert sim.array_sharing == "device", sim.array_sharing
    for _ in range(3):
        sim.run(40)
        host = sim._native.get("position")
        for field in FIELDS:
            array = getattr(sim, field)
            assert isinstance(array, rf.DeviceArray)
            tensor = torch.from_dlpack(array)
            assert tensor.is_cuda and tensor.dtype is torch.float32 and tuple(tensor.shape) == array.shape
            assert tensor.is_contiguous()
            np.testing.assert_array_equal(tensor.cpu().numpy(), array.numpy())
            np.testing.assert_array_equal(cupy.from_dlpack(array).get(), array.numpy())
        np.testing.assert_array_equal(sim.positions.numpy(), host)


def check_rigid_bodies() -> None:
    """Fields of rigid bodies, without those of a capsule that moves as a body."""
    scene = rf.Scene()
    scene.settings.contact_law = "linear"
    scene.add_material("stuff", density=1)
    scene.set_pair("stuff", "stuff", stiffness=1000)
    scene.add_capsules([20, 0, 0], [21, 0, 0], radius=0.2, material="stuff")
    shape = scene.add_shape(rf.Shape().sphere([0, 0, 0], 0.5, material="stuff").sphere([0.7, 0, 0], 0.4, material="stuff"))
    scene.add_bodies(shape, np.arange(30.0).reshape(10, 3), velocities=np.ones((10, 3)), spins=[1, 0, 2])
    sim = rf.Simulation(scene, dt=0.001, backend="gpu")
    for _ in range(3):
        sim.run(5)
        bodies = sim.bodies
        for field in FIELDS:
            array = getattr(bodies, field)
            assert isinstance(array, rf.DeviceArray)
            name = {"angular_momenta": "angular_momentum", "velocities": "velocity"}.get(field, field.removesuffix("s"))
            host = _rockfall.body_states(sim._native, name).reshape(10, -1)
            np.testing.assert_array_equal(torch.from_dlpack(array).cpu().numpy(), host)


def check_order_of_addition() -> None:
    """The same run on a device without sharing is the CPU's, within rounding; rows belong to the same bodies."""
    device, cpu = pile(3_000), pile(3_000, "cpu")
    for sim in (device, cpu):
        sim.run(20)
    moved = torch.from_dlpack(device.positions).cpu().numpy()
    assert np.abs(moved - cpu.positions).max() < 1e-3


def check_snapshots() -> None:
    """A tensor keeps its values while the simulation goes on, and shares memory with the array that it came from."""
    sim = pile(4_000)
    first = torch.from_dlpack(sim.positions)
    copied = first.clone()
    tensors = []
    for _ in range(5):
        sim.run(3)
        tensors.append(torch.from_dlpack(sim.positions))
    assert torch.equal(first, copied)
    assert len({tensor.data_ptr() for tensor in [first, *tensors]}) == 6
    array = sim.positions
    assert torch.from_dlpack(array).data_ptr() == torch.from_dlpack(array).data_ptr() == cupy.from_dlpack(array).data.ptr
    addresses = set()
    for _ in range(20):
        sim.run(1)
        addresses.add(torch.from_dlpack(sim.positions).data_ptr())
    assert len(addresses) < 6, "memory is used again"


def check_memory_is_not_reused_too_early() -> None:
    """Work that is still queued on the device reads the old state, although its tensor is gone."""
    sim = pile(300_000)
    big = torch.ones(8_000, 8_000, device="cuda")
    for _ in range(10):
        expected = sim.positions.numpy().astype(np.float64).sum()
        tensor = torch.from_dlpack(sim.positions)
        for _ in range(4):
            big = big @ big * 1e-4
        late = tensor.double().sum() + 0 * big[0, 0].nan_to_num(0, 0, 0)
        del tensor
        sim.run(1)
        sim.positions
        assert abs(late.item() - expected) < 1e-3 * abs(expected)


def check_writing() -> None:
    for make in (torch.as_tensor, cupy.asarray):
        shared, host = pile(2_000), pile(2_000)
        rng = np.random.default_rng(1)
        for _ in range(3):
            speeds = rng.normal(size=(2_000, 3)).astype(np.float32)
            forces = rng.normal(size=(2_000, 3)).astype(np.float32)
            for sim, convert in ((shared, make), (host, np.asarray)):
                on_device = {"device": "cuda"} if convert is torch.as_tensor else {}
                sim.velocities = convert(speeds, **on_device)
                sim.external_forces = convert(forces, **on_device)
                sim.run(10)
            for field in FIELDS:
                np.testing.assert_array_equal(np.asarray(getattr(shared, field)), np.asarray(getattr(host, field)))
            np.testing.assert_array_equal(np.asarray(shared.external_forces), forces)
        shared.positions = torch.as_tensor(np.asarray(host.positions) + [0, 5, 0], device="cuda", dtype=torch.float32)
        assert abs(np.asarray(shared.positions - host.positions).mean(0) - [0, 5, 0]).max() < 1e-3


def check_a_network_drives_bodies() -> None:
    """Springs to a point, computed by PyTorch from tensors of positions and velocities, without the host."""
    scene = rf.Scene()
    scene.settings.gravity = 0.0
    scene.add_spheres([[1.0, 0, 0], [0, 3.0, 0]], radius=0.1, mass=[1.0, 2.0])
    sim = rf.Simulation(scene, dt=0.001, backend="gpu", integrator="symplectic-euler")
    for _ in range(3_142):
        sim.external_forces = -4.0 * torch.from_dlpack(sim.positions)
        sim.step()
    # omega = sqrt(4 / mass) is 2 and sqrt(2): cos(2 pi) and cos(sqrt(2) pi).
    t = sim.time
    expected = [[np.cos(2 * t), 0, 0], [0, 3 * np.cos(np.sqrt(2) * t), 0]]
    assert np.abs(np.asarray(sim.positions) - expected).max() < 0.02


def check_errors() -> None:
    sim = pile(100)
    cases: list[tuple[Any, type[Exception], str]] = [
        (torch.zeros(99, 3, device="cuda"), ValueError, "expected shape"),
        (torch.zeros(100, 3, device="cuda", dtype=torch.float64), TypeError, "expected float32"),
        (torch.zeros(100, 6, device="cuda")[:, :3], ValueError, "contiguous"),
        (torch.zeros(100, 3, device="cuda", requires_grad=True), TypeError, "gradient"),
    ]
    for value, kind, text in cases:
        try:
            sim.velocities = value
        except kind as error:
            assert str(error).startswith("velocity: ") and text in str(error), error
        else:
            raise AssertionError(f"no error for {value.shape} {value.dtype}")
    before = np.asarray(sim.velocities)
    bad = torch.zeros(100, 3, device="cuda")
    bad[42, 1] = float("nan")
    for field in ("velocities", "external_forces", "positions"):
        try:
            setattr(sim, field, bad)
        except ValueError as error:
            assert "row 42" in str(error) and "finite" in str(error), error
        else:
            raise AssertionError("a number that is not finite went unnoticed")
    np.testing.assert_array_equal(np.asarray(sim.velocities), before)
    sim.step()


def check_no_leak() -> None:
    def used() -> int:
        gc.collect()
        torch.cuda.synchronize()
        free, total = torch.cuda.mem_get_info()
        return int(total - free)

    kept = []
    for round in range(40):
        sim = pile(200_000)
        kept = [torch.from_dlpack(sim.positions) for _ in range(3)]
        sim.run(1)
        torch.from_dlpack(sim.velocities)
        if round == 5:
            before = used()
    assert used() < before + (64 << 20), (used() - before, "bytes more")
    assert all(torch.isfinite(tensor).all() for tensor in kept)


def median(call: Callable[[], Any], rounds: int = 30) -> float:
    call()
    times = []
    for _ in range(rounds):
        torch.cuda.synchronize()
        start = time.perf_counter()
        call()
        torch.cuda.synchronize()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def measure() -> None:
    print(f"\n{'spheres':>9} {'what':<34} {'us':>9} {'GB/s':>7}")
    for count in (1_000, 100_000, 1_000_000):
        sim = pile(count)
        sim.run(20)
        tensor = torch.from_dlpack(sim.positions).clone()

        def fresh(field: str) -> Any:
            sim._live.clear()
            return getattr(sim, field)

        rows: list[tuple[str, Callable[[], Any]]] = [
            ("positions into PyTorch, shared", lambda: torch.from_dlpack(fresh("positions"))),
            ("positions into NumPy", lambda: fresh("positions").numpy()),
            ("positions by the host into PyTorch", lambda: torch.as_tensor(sim._native.get("position"), device="cuda")),
            ("velocities from PyTorch", lambda: setattr(sim, "velocities", tensor)),
            ("forces from PyTorch", lambda: setattr(sim, "external_forces", tensor)),
        ]
        for name, call in rows:
            if "host" in name:
                # The host keeps the state that it has read, so it must change first.
                def call(call: Callable[[], Any] = call) -> None:
                    sim.velocities = tensor
                    call()

                seconds = median(call, 5) - median(lambda: setattr(sim, "velocities", tensor), 5)
            else:
                seconds = median(call)
            print(f"{count:>9} {name:<34} {seconds * 1e6:>9.1f} {12 * count / seconds / 1e9:>7.1f}")


if __name__ == "__main__":
    print(rf.info())
    print("torch", torch.__version__, "cupy", cupy.__version__)
    for name, check in list(globals().items()):
        if name.startswith("check_"):
            check()
            print("ok  ", name)
    measure()
