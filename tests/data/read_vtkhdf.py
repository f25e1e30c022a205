"""Reads results.hdf5 with VTK's own reader and holds every time step against the CSV beside it.

Usage: read_vtkhdf.py FOLDER. Exit code 1 and a message where a bit differs.
"""

import csv
import json
import math
import pathlib
import struct
import sys

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader


def same(a, b):
    """Whether two numbers are the same to the bit, all NaN alike."""
    return struct.pack("d", a) == struct.pack("d", b) or (math.isnan(a) and math.isnan(b))


def check(condition, message):
    if not condition:
        sys.exit(message)


def main(folder):
    summary = json.loads((folder / "summary.json").read_text())
    materials = {}
    reader = vtkHDFReader()
    name = str(folder / "results.hdf5")
    check(reader.CanReadFile(name), f"{name}: not VTKHDF")
    reader.SetFileName(name)
    reader.UpdateInformation()
    key = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    times = reader.GetOutputInformation(0).Get(key)
    expected = [profile["time"] for profile in summary["profiles"]]
    check(list(times) == expected, f"times {times}, expected {expected}")
    for profile in summary["profiles"]:
        with open(folder / profile["file"], newline="") as file:
            rows = list(csv.DictReader(file))
        reader.UpdateTimeStep(profile["time"])
        data = reader.GetOutput()
        where = f"{profile['file']}:"
        check(data.GetClassName() == "vtkPolyData", f"{where} {data.GetClassName()}")
        check(data.GetNumberOfPoints() == len(rows), f"{where} {data.GetNumberOfPoints()} points")
        check(data.GetNumberOfVerts() == len(rows), f"{where} {data.GetNumberOfVerts()} vertices")
        check(data.GetNumberOfCells() == len(rows), f"{where} {data.GetNumberOfCells()} cells")
        for i in range(data.GetNumberOfVerts()):
            cell = data.GetCell(i)
            check((cell.GetNumberOfPoints(), cell.GetPointId(0)) == (1, i), f"{where} vertex {i}")
        points = data.GetPoints()
        check(points is None or points.GetDataType() == 11, f"{where} points are not doubles")
        axes = [axis for axis in ("x", "y", "z") if rows and axis in rows[0]]
        for i, row in enumerate(rows):
            place = [float(row[axis]) for axis in axes] + [0.0] * (3 - len(axes))
            check(all(map(same, points.GetPoint(i), place)), f"{where} point {i}")
        arrays = data.GetPointData()
        values = {
            arrays.GetArrayName(i): vtk_to_numpy(arrays.GetArray(i))
            for i in range(arrays.GetNumberOfArrays())
        }
        for index in ("particle_id", "material", "body"):
            check(index in values, f"{where} no {index}")
        check(len(set(values["particle_id"])) == len(rows), f"{where} ids are not unique")
        for column in rows[0] if rows else []:
            array = values[column]
            check(len(array) == len(rows), f"{where} {column} has {len(array)} values")
            for i, row in enumerate(rows):
                if column == "material":
                    equal = materials.setdefault(int(array[i]), row[column]) == row[column]
                else:
                    equal = same(float(array[i]), float(row[column] or "nan"))
                check(equal, f"{where} {column} of row {i}: {array[i]}, CSV {row[column]}")
    check(len(set(materials.values())) == len(materials), f"materials {materials}")
    print(f"{len(times)} time steps read, equal to the bit")


main(pathlib.Path(sys.argv[1]))
