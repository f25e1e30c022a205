"""Fields of all particles at many times, from VTKHDF files."""

import json
import os

import h5py
import numpy


class Frames:
    """Frames of a VTKHDF file of particles with time steps. Arrays are read when they are used."""

    def __init__(self, path):
        """Reads the times of the frames. Raises OSError if the file cannot be read, ValueError if
        it holds no time steps."""
        self.path = os.fspath(path)
        with h5py.File(self.path, "r") as file:
            root = file["VTKHDF"]
            if "Steps" not in root:
                raise ValueError(f"{self.path}: no time steps")
            steps = root["Steps"]
            self.times = steps["Values"][()].astype(float)
            counts = root["NumberOfPoints"][()]
            self._counts = counts[steps["PartOffsets"][()]]
            self._points = steps["PointOffsets"][()]
            self._offsets = {name: data[()] for name, data in steps["PointDataOffsets"].items()}
            self.units = {
                name: _text(data.attrs.get("units", ""))
                for name, data in root["PointData"].items()
            }
            #: Names of the materials and bodies, to which ``material`` and ``body`` are indices.
            self.materials = json.loads(_text(root.attrs.get("materials", "[]")))
            self.bodies = json.loads(_text(root.attrs.get("bodies", "[]")))

    def __len__(self):
        return len(self.times)

    def __getitem__(self, number):
        """Frame ``number``; negative numbers count from the end."""
        frames = len(self)
        if not -frames <= number < frames:
            raise IndexError(f"frame {number} of {frames}")
        return Frame(self, number % frames)

    def __iter__(self):
        return (self[number] for number in range(len(self)))

    def at(self, time):
        """The frame nearest to ``time`` [s]."""
        return self[int(numpy.argmin(numpy.abs(self.times - time)))]

    def __repr__(self):
        return f"{len(self)} frames of {self.path}"


class Frame:
    """All particles at one time, in order of id."""

    def __init__(self, frames, number):
        self._frames = frames
        self._number = number
        #: Time [s].
        self.time = float(frames.times[number])

    @property
    def names(self):
        """Names of the arrays."""
        return list(self._frames.units)

    def __len__(self):
        return int(self._frames._counts[self._number])

    def __contains__(self, name):
        return name in self._frames.units

    def unit(self, name):
        """SI unit of an array."""
        return self._frames.units[name]

    @property
    def points(self):
        """Positions [m], shape (particles, 3)."""
        return self._read("Points", self._frames._points[self._number])

    def __getitem__(self, name):
        """Array ``name``: shape (particles,) for a scalar, (particles, 3) for a vector,
        (particles, 6) for a symmetric tensor xx, yy, zz, xy, yz, xz. Raises KeyError, with the
        known names, if there is none."""
        if name not in self:
            raise KeyError(f"no array {name!r}; there are: {', '.join(self.names)}")
        return self._read(f"PointData/{name}", self._frames._offsets[name][self._number])

    def _read(self, dataset, start):
        with h5py.File(self._frames.path, "r") as file:
            return file["VTKHDF"][dataset][start : start + len(self)]

    def __repr__(self):
        return f"{len(self)} particles at {self.time:g} s: {', '.join(self.names)}"


def _text(value):
    return value.decode() if isinstance(value, bytes) else str(value)
