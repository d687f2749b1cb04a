"""Reads .vtp files with the VTK library and prints what it found, as one JSON object per line.

The judge of our writer: what ParaView would see. A damaged file can crash VTK, so run this in a process of its own.
"""

import json
import sys

import vtk
from vtk.util.numpy_support import vtk_to_numpy


def arrays(attributes):
    """Minimum, maximum and mean of each numeric array (components together)."""
    found = {}
    for i in range(attributes.GetNumberOfArrays()):
        array = attributes.GetArray(i)
        if array is None:
            continue
        numbers = vtk_to_numpy(array)
        found[array.GetName()] = {
            "type": array.GetDataTypeAsString(),
            "components": array.GetNumberOfComponents(),
            "tuples": array.GetNumberOfTuples(),
            "min": float(numbers.min()) if numbers.size else None,
            "max": float(numbers.max()) if numbers.size else None,
            "mean": float(numbers.mean()) if numbers.size else None,
        }
    return found


def active(attributes):
    """Names of the active scalars and vectors."""
    scalars, vectors = attributes.GetScalars(), attributes.GetVectors()
    return [a.GetName() if a else None for a in (scalars, vectors)]


def volumes(data):
    """Volume of each block, from its closed surface; faces carry a `BlockId`."""
    ids = data.GetCellData().GetArray("BlockId")
    if ids is None or data.GetNumberOfPolys() == 0:
        return {}
    found = {}
    for block in sorted({int(ids.GetTuple1(i)) for i in range(ids.GetNumberOfTuples())}):
        faces = vtk.vtkThreshold()
        faces.SetInputData(data)
        faces.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_CELLS, "BlockId")
        faces.SetLowerThreshold(block)
        faces.SetUpperThreshold(block)
        surface = vtk.vtkGeometryFilter()
        surface.SetInputConnection(faces.GetOutputPort())
        triangles = vtk.vtkTriangleFilter()
        triangles.SetInputConnection(surface.GetOutputPort())
        mass = vtk.vtkMassProperties()
        mass.SetInputConnection(triangles.GetOutputPort())
        found[str(block)] = mass.GetVolume()
    return found


def names(fields):
    """Lists of names among the field data."""
    found = {}
    for i in range(fields.GetNumberOfArrays()):
        array = fields.GetAbstractArray(i)
        if isinstance(array, vtk.vtkStringArray) and array.GetName() != "Source":
            found[array.GetName()] = [array.GetValue(k) for k in range(array.GetNumberOfValues())]
    return found


def describe(path):
    """Everything about one file."""
    errors = []
    reader = vtk.vtkXMLPolyDataReader()
    reader.AddObserver("ErrorEvent", lambda *_: errors.append("error while reading"))
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    fields = data.GetFieldData()
    time, source = fields.GetArray("TimeValue"), fields.GetAbstractArray("Source")
    return {
        "file": path,
        "errors": errors,
        "points": data.GetNumberOfPoints(),
        "cells": data.GetNumberOfCells(),
        "vertices": data.GetNumberOfVerts(),
        "polygons": data.GetNumberOfPolys(),
        "bounds": data.GetBounds(),
        "time": time.GetValue(0) if time else None,
        "source": source.GetValue(0) if source else None,
        "names": names(fields),
        "point_arrays": arrays(data.GetPointData()),
        "cell_arrays": arrays(data.GetCellData()),
        "active_point": active(data.GetPointData()),
        "active_cell": active(data.GetCellData()),
        "volumes": volumes(data),
    }


if __name__ == "__main__":
    for name in sys.argv[1:]:
        print(json.dumps(describe(name)))
