"""What rockfall runs on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rockfall import _rockfall
from rockfall._reports import Device


@dataclass(frozen=True)
class Info:
    """Versions and devices, as :func:`info` returns them."""

    #: Version of rockfall.
    version: str
    #: Version of NumPy.
    numpy: str
    #: All graphics adapters.
    devices: list[Device]
    #: The backend that ``backend="auto"`` uses.
    backend: str
    #: How arrays of the CPU backend and of the GPU backend reach Python.
    arrays: dict[str, str]

    def __str__(self) -> str:
        lines = [f"rockfall {self.version}, NumPy {self.numpy}", f"backend  auto is {self.backend}"]
        lines += [f"device   {device.name} ({device.backend}, {device.kind}), {device.driver}" for device in self.devices]
        lines += [f"arrays   {kind}: {how}" for kind, how in self.arrays.items()]
        return "\n".join(lines)


def devices() -> list[Device]:
    """All graphics adapters. The first is the one that a simulation with ``backend="gpu"`` uses."""
    return [Device(**device) for device in _rockfall.devices()]


def info() -> Info:
    """Versions and devices, and how arrays reach Python. ``print(rf.info())`` shows them as a table."""
    found = devices()
    arrays = {
        "cpu": "NumPy arrays; Simulation.state shares the memory without a copy",
        "gpu": "shared by DLPack with NVIDIA cards on Linux, else copied through the host; Simulation.array_sharing tells which",
    }
    backend = "gpu" if any(not device.software for device in found) else "cpu"
    return Info(_rockfall.__version__, np.__version__, found, backend, arrays)
