# SPDX-License-Identifier: MIT
"""Reads the series "wet" in a folder with VTK's own readers; exit status 77 where there is no VTK."""
import math
import sys
import xml.etree.ElementTree as xml

try:
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader
except ImportError:
    sys.exit(77)

folder = sys.argv[1]


def read(reader, phase):
    """The data set that the .pvd file of a phase lists first."""
    entry = xml.parse(f"{folder}/wet_{phase}.pvd").getroot().find("Collection/DataSet")
    reader.SetFileName(f"{folder}/{entry.get('file')}")
    reader.Update()
    return reader.GetOutput()


def names(data):
    return [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]


solid = read(vtkXMLPolyDataReader(), "solid")
assert solid.GetNumberOfPoints() == solid.GetNumberOfVerts() == 60
assert "bishop_stress [Pa]" in names(solid.GetPointData())
assert solid.GetPointData().GetArray("bishop_stress [Pa]").GetNumberOfComponents() == 6
liquid = read(vtkXMLPolyDataReader(), "liquid")
assert liquid.GetNumberOfPoints() == 76
salt = liquid.GetPointData().GetArray("salt [g/kg]")
assert salt.GetRange() == (0, 35)
grid = read(vtkXMLImageDataReader(), "grid")
assert grid.GetNumberOfCells() == 50 and grid.GetNumberOfPoints() == 66
assert grid.GetBounds()[:4] == (0, 1, 0, 0.5)
pressure = grid.GetCellData().GetArray("cell_pressure [Pa]")
assert sum(math.isnan(pressure.GetValue(i)) for i in range(50)) == 31
assert grid.GetPointData().GetArray("solid_velocity [m/s]").GetNumberOfComponents() == 3
