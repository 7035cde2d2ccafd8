"""Opens files of `rockfall run --contacts` with numpy and VTK, and checks them against each other and against the trajectory.

    check_contacts.py FOLDER

FOLDER contains contacts.csv, contacts.npz and contacts.pvd of one run with frames.npz, its trajectory, and last.csv, last.npz and
last.vtp of its final state.
"""

import csv
import sys
import xml.etree.ElementTree
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkTubeFilter

from output_files import arrays, poly_data, same

KINDS = {"sphere": 0, "rod": 1, "box": 3, "polygon": 4}
VECTORS = {"point": "x y z", "normal": "nx ny nz", "force": "fx fy fz", "impulse": "ix iy iz",
           "tangential_force": "tx ty tz", "displacement": "ux uy uz"}
STATES = {"": -1, "stick": 0, "slip": 1}


def check_csv(path, npz):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(npz["frame"]) == npz["count"].sum()
    for name, columns in VECTORS.items():
        text = [[np.float32(row[column]) for column in columns.split()] for row in rows]
        same(name, np.array(text, np.float32), npz[name] + np.float32(0))
    same("normal_force", np.array([row["normal_force"] for row in rows], np.float32), npz["normal_force"] + np.float32(0))
    same("slip", np.array([STATES[row["state"]] for row in rows], np.int8), npz["slip"])
    same("overlap", np.array([row["overlap"] for row in rows], np.float32), npz["overlap"])
    for side in "ab":
        same(side, np.array([row[side] for row in rows], np.uint32), npz[side])
        same(f"{side}_kind", np.array([KINDS[row[f"{side}_kind"]] for row in rows], np.uint8), npz[f"{side}_kind"])
        references = [int(row[f"{side}_reference"] or -1) for row in rows]
        same(f"{side}_reference", np.array(references, np.int64), npz[f"{side}_reference"])
    same("step", np.array([row["step"] for row in rows], np.uint64), npz["step"][npz["frame"]])
    same("time", np.array([row["time"] for row in rows], np.float64), npz["time"][npz["frame"]])


def check_lines(path, npz, frame):
    """Compares one PolyData file with one frame of the arrays. Returns the ends of its lines."""
    data = poly_data(path)
    of_frame = npz["frame"] == frame
    count = int(npz["count"][frame])
    assert (data.GetNumberOfPoints(), data.GetNumberOfLines(), data.GetNumberOfCells()) == (2 * count, count, count)
    fields = arrays(data.GetFieldData())
    assert fields["TimeValue"] == npz["time"][frame] and fields["step"] == npz["step"][frame], path
    if count == 0:
        return np.zeros((0, 2, 3))
    cells = arrays(data.GetCellData())
    for name in ("a", "b", "a_kind", "b_kind", "overlap", "point", "normal", "force", "impulse", "normal_force",
                 "tangential_force", "slip", "displacement"):
        same(f"{path}: {name}", cells[name], npz[name][of_frame])
    magnitude = np.linalg.norm(npz["force"][of_frame].astype(float), axis=1)
    assert np.allclose(cells["force_magnitude"], magnitude, rtol=1e-6)
    same(f"{path}: force_magnitude", arrays(data.GetPointData())["force_magnitude"], np.repeat(cells["force_magnitude"], 2))
    ids = [[data.GetCell(i).GetPointId(p) for p in range(data.GetCell(i).GetNumberOfPoints())] for i in range(count)]
    assert np.array_equal(ids, np.arange(2 * count).reshape(count, 2)), f"{path}: {ids}"

    # What ParaView's filter Tube does to show force chains.
    data.GetPointData().SetActiveScalars("force_magnitude")
    tube = vtkTubeFilter()
    tube.SetInputData(data)
    tube.SetVaryRadiusToVaryRadiusByScalar()
    tube.Update()
    assert tube.GetOutput().GetNumberOfPoints() > 0, f"{path}: no tubes"
    return vtk_to_numpy(data.GetPoints().GetData()).reshape(count, 2, 3)


def check_geometry(npz, frames, frame, lines):
    """Checks the ends of the lines, and the overlaps of two spheres, against the positions of the spheres."""
    of_frame = npz["frame"] == frame
    positions, radii = frames["position"][frame], frames["radius"]
    a, b = npz["a"][of_frame], npz["b"][of_frame]
    for side, index in ((0, a), (1, b)):
        is_sphere = npz["ab"[side] + "_kind"][of_frame] == 0
        assert np.allclose(lines[is_sphere, side], positions[index[is_sphere]], atol=2e-5), f"end {side} in frame {frame}"
    pairs = (npz["a_kind"][of_frame] == 0) & (npz["b_kind"][of_frame] == 0)
    distance = np.linalg.norm(positions[b[pairs]] - positions[a[pairs]], axis=1)
    assert np.allclose(npz["overlap"][of_frame][pairs], radii[a[pairs]] + radii[b[pairs]] - distance, atol=2e-6)
    static = npz["b_kind"][of_frame] >= 3
    assert np.array_equal(lines[static, 1], npz["point"][of_frame][static])


def main(folder):
    npz, frames = np.load(folder / "contacts.npz"), np.load(folder / "frames.npz")
    count = len(npz["step"])
    assert count == len(frames["step"]) == 6
    same("step", npz["step"], frames["step"])
    same("time", npz["time"], frames["time"])
    check_csv(folder / "contacts.csv", npz)
    kinds = set(zip(npz["a_kind"].tolist(), npz["b_kind"].tolist()))
    assert {(0, 0), (0, 3)} <= kinds, kinds
    assert np.any(npz["force"] != 0) and np.any(npz["impulse"] != 0)
    assert npz["a_reference"].max() > 0
    assert not np.any(np.any(npz["force"] != 0, axis=1) & np.any(npz["impulse"] != 0, axis=1))

    sets = xml.etree.ElementTree.parse(folder / "contacts.pvd").getroot().findall("Collection/DataSet")
    assert len(sets) == count
    for frame, entry in enumerate(sets):
        assert float(entry.get("timestep")) == npz["time"][frame]
        check_geometry(npz, frames, frame, check_lines(folder / entry.get("file"), npz, frame))

    last = np.load(folder / "last.npz")
    assert len(last["step"]) == 1
    check_csv(folder / "last.csv", last)
    check_lines(folder / "last.vtp", last, 0)
    for name in ("a", "b", "point", "force", "impulse"):
        same(f"last {name}", last[name], npz[name][npz["frame"] == count - 1])
    print(f"{len(npz['frame'])} contacts in {count} frames are identical in all formats")


main(Path(sys.argv[1]))
