"""Opens trajectories of rockfall with numpy and VTK, and checks that every number is bitwise identical to that in the CSV.

    check_trajectories.py FOLDER

FOLDER contains frames.csv, frames.npz and frames.pvd of one run, and state.csv, state.npz and state.vtp of its final state.
"""

import csv
import sys
import xml.etree.ElementTree
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from output_files import arrays, poly_data, same

VECTORS = {"position": "x y z", "velocity": "vx vy vz", "orientation": "qw qx qy qz", "angular_momentum": "lx ly lz"}


def read_csv(path):
    """Returns the columns of a CSV file as text, by name."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [row[name] for row in rows] for name in rows[0]}


def vectors(table, names, shape):
    columns = [np.array([np.float32(text) for text in table[name]]) for name in names.split()]
    return np.stack(columns, axis=-1).reshape(*shape, len(columns))


def check_frame(path, npz, frame):
    """Compares one PolyData file with one frame of the arrays."""
    data = poly_data(path)
    points = arrays(data.GetPointData())
    points["position"] = vtk_to_numpy(data.GetPoints().GetData())
    for name in VECTORS:
        same(f"{path}: {name}", points[name], npz[name][frame])
    same(f"{path}: contacts", points["contacts"], npz["contacts"][frame])
    for name in ("radius", "mass"):
        same(f"{path}: {name}", points[name], npz[name])
    same(f"{path}: fixed", points["fixed"].astype(bool), npz["fixed"])
    same(f"{path}: reference", points["reference"], npz["reference"])
    fields = arrays(data.GetFieldData())
    assert fields["TimeValue"] == npz["time"][frame] and fields["step"] == npz["step"][frame], path

    n, rods, springs = len(npz["radius"]), len(npz["rods"]), len(npz["springs"])
    assert (data.GetNumberOfVerts(), data.GetNumberOfLines(), data.GetNumberOfPolys()) == (n, rods + springs, 0)
    ends = []
    for i in range(n + rods + springs):
        ids = [data.GetCell(i).GetPointId(p) for p in range(data.GetCell(i).GetNumberOfPoints())]
        if i < n:
            assert ids == [i], f"{path}: vertex {i} is {ids}"
        else:
            ends.append(ids)
    same(f"{path}: lines", np.array(ends, np.uint32), np.concatenate([npz["rods"], npz["springs"]]))
    cell_data = arrays(data.GetCellData())
    same(f"{path}: kind", cell_data["kind"], np.repeat(np.array([0, 1, 2], np.uint8), [n, rods, springs]))
    radii = np.concatenate([npz["radius"], npz["rod_radius"], np.zeros(springs, np.float32)])
    same(f"{path}: cell_radius", cell_data["cell_radius"], radii)


def check_static(path, npz):
    """Checks the volume of the boxes, and the area and the position of the polygons, from their faces."""
    data = poly_data(path)
    boxes, polygons = npz["boxes"].astype(float), npz["polygons"].astype(float)
    assert len(boxes) > 0 and len(polygons) > 0
    kinds = arrays(data.GetCellData())["kind"]
    same(f"{path}: kind", kinds, np.repeat(np.array([3, 4], np.uint8), [6 * len(boxes), len(polygons)]))
    faces = [np.array([data.GetCell(i).GetPoints().GetPoint(p) for p in range(4)]) for i in range(data.GetNumberOfCells())]
    for i, (corner, *edges) in enumerate(boxes):
        # Gauss: the outward flux of x / 3 through all faces is the volume. A reversed or missing face would change it.
        volume = 0
        for a, b, c, d in faces[6 * i : 6 * i + 6]:
            volume += np.cross(b - a, d - a) @ (a + c) / 6
            assert np.allclose(a + c, b + d), "not a parallelogram"
        assert np.isclose(volume, np.linalg.det(edges)), f"box {i}: {volume}, expected {np.linalg.det(edges)}"
    for (corner, left, right), (a, b, c, d) in zip(polygons, faces[6 * len(boxes) :]):
        assert np.allclose(np.cross(b - a, d - a), np.cross(left, right)) and np.allclose(a, corner)


def main(folder):
    table = read_csv(folder / "frames.csv")
    npz = np.load(folder / "frames.npz")
    frames, spheres = npz["position"].shape[:2]
    assert frames == 6 and spheres > 20, (frames, spheres)
    shape = (frames, spheres)
    for name, columns in VECTORS.items():
        same(name, npz[name], vectors(table, columns, shape))
        assert len(np.unique(npz[name][-1])) > 5, f"{name} has too few different values"
    same("step", npz["step"], np.array(table["step"], np.uint64).reshape(shape)[:, 0])
    same("time", npz["time"], np.array(table["time"], np.float64).reshape(shape)[:, 0])
    assert np.array_equal(np.array(table["sphere"], int).reshape(shape), np.tile(np.arange(spheres), (frames, 1)))
    references = [int(text or -1) for text in table["reference"]]
    same("reference", np.array(references, np.int64).reshape(shape)[-1], npz["reference"])
    assert 900 in references and -1 in references
    assert npz["contacts"].sum() > 0 and npz["contacts"].dtype == np.uint32
    assert npz["fixed"].dtype == bool and npz["fixed"].sum() == 1
    assert len(npz["rods"]) == 7 and len(npz["springs"]) == 2 and len(npz["tethers"]) == 1
    assert npz["tether_point"].shape == (1, 3)

    sets = xml.etree.ElementTree.parse(folder / "frames.pvd").getroot().findall("Collection/DataSet")
    of_part = {part: [entry for entry in sets if entry.get("part") == part] for part in "01"}
    assert len(of_part["0"]) == len(of_part["1"]) == frames
    for frame, entry in enumerate(of_part["0"]):
        assert float(entry.get("timestep")) == npz["time"][frame]
        check_frame(folder / entry.get("file"), npz, frame)
    check_static(folder / of_part["1"][0].get("file"), npz)

    state, last = read_csv(folder / "state.csv"), np.load(folder / "state.npz")
    for name, columns in VECTORS.items():
        same(f"state {name}", last[name], vectors(state, columns, (1, spheres)))
        same(f"last {name}", last[name][0], npz[name][-1])
    check_frame(folder / "state.vtp", last, 0)
    print(f"{frames} frames of {spheres} spheres are identical in all formats")


main(Path(sys.argv[1]))
