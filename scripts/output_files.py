"""What the checks of output files share: comparison of arrays, and reading of VTK files."""

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader


def same(what, one, other):
    """Asserts that two arrays have the same shape, the same type and the same bits."""
    one, other = np.asarray(one), np.asarray(other)
    assert one.shape == other.shape, f"{what}: shapes {one.shape} and {other.shape}"
    assert one.dtype == other.dtype, f"{what}: types {one.dtype} and {other.dtype}"
    assert one.tobytes() == other.tobytes(), f"{what} differs"


def poly_data(path):
    """Reads a PolyData file."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0, f"{path}: VTK error {reader.GetErrorCode()}"
    return reader.GetOutput()


def arrays(data):
    """Returns the arrays of points, cells or fields by name."""
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
