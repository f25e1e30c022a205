"""Reads fields.vtkhdf with VTK's own reader and holds every frame against its CSV beside it.

Usage: read_fields.py FOLDER. Exit code 1 and a message where a bit differs.
"""

import csv
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

# place of a component of a symmetric tensor in VTK's order
TENSOR = {"xx": 0, "yy": 1, "zz": 2, "xy": 3}


def check(condition, message):
    if not condition:
        sys.exit(message)


def component(values, column):
    """The values of an array that stand in a column of the CSV."""
    name, _, end = column.rpartition("_")
    if column == "velocity":
        return values[column][:, 0]
    if end in TENSOR and name in values:
        return values[name][:, TENSOR[end]]
    if end in "xy" and name in values:
        return values[name][:, "xy".index(end)]
    return values[column]


def main(folder):
    reader = vtkHDFReader()
    name = str(folder / "fields.vtkhdf")
    check(reader.CanReadFile(name), f"{name}: not VTKHDF")
    reader.SetFileName(name)
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    frames = sorted((folder / "fields").glob("frame_*.csv"))
    check(len(frames) == len(times), f"{len(times)} times, {len(frames)} tables")
    for time, frame in zip(times, frames):
        with open(frame, newline="") as file:
            rows = list(csv.DictReader(file))
        reader.UpdateTimeStep(time)
        data = reader.GetOutput()
        check(data.GetNumberOfPoints() == len(rows), f"{frame}: {data.GetNumberOfPoints()} points")
        check(data.GetNumberOfVerts() == len(rows), f"{frame}: {data.GetNumberOfVerts()} vertices")
        arrays = data.GetPointData()
        values = {
            arrays.GetArrayName(i): vtk_to_numpy(arrays.GetArray(i))
            for i in range(arrays.GetNumberOfArrays())
        }
        points = vtk_to_numpy(data.GetPoints().GetData())
        values["x"], values["y"] = points[:, 0], points[:, 1]
        for column in rows[0]:
            if column == "material":
                continue
            expected = np.array([float(row[column] or "nan") for row in rows])
            found = component(values, column)
            check(np.array_equal(found, expected, equal_nan=True), f"{frame}: {column}")
    print(f"{len(times)} frames read, equal to the bit")


main(pathlib.Path(sys.argv[1]))
