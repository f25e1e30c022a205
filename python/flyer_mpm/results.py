"""Folder of results of a run, and tables of studies."""

import functools
import json
import re
from pathlib import Path

import numpy

from .frames import Frames
from .tables import Table

#: Files with fields of all particles, the first that is there is read.
FRAME_FILES = ("fields.vtkhdf", "results.hdf5")

#: Tables of studies, and of studies of the scaling.
STUDY_FILES = ("study.csv", "strong_scaling.csv", "weak_scaling.csv")

#: Format of ``summary.json`` that is read.
FORMATS = (2,)


class Results:
    """Results of a run. Files are read when they are used, and kept."""

    def __init__(self, folder):
        """Raises FileNotFoundError if ``folder`` is not a folder."""
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise FileNotFoundError(f"{self.folder}: no folder of results")

    @functools.cached_property
    def summary(self):
        """``summary.json``: errors, conserved sums, times. Raises ValueError if its format is not
        known, FileNotFoundError if the run has not ended."""
        text = (self.folder / "summary.json").read_text(encoding="utf-8")
        summary = json.loads(text)
        found = summary.get("format")
        if found not in FORMATS:
            raise ValueError(f"{self.folder}: summary.json has format {found}, expected {FORMATS}")
        return summary

    @property
    def scene(self):
        """The scene as run, all defaults written out."""
        return self.summary["scene"]

    @functools.cached_property
    def _profile_files(self):
        """Times [s] and paths of the profiles; those of a run that has not ended by their names,
        which give the time rounded to 1e-9 s."""
        if (self.folder / "summary.json").exists():
            profiles = self.summary["profiles"]
            return [(profile["time"], self.folder / profile["file"]) for profile in profiles]
        files = []
        for path in self.folder.glob("profile_*us.csv"):
            time = re.fullmatch(r"profile_([0-9.e+-]+)us\.csv", path.name)
            if time:
                files.append((float(time.group(1)) * 1e-6, path))
        return sorted(files)

    @property
    def times(self):
        """Times of the profiles [s]."""
        return [time for time, _ in self._profile_files]

    def profile(self, time):
        """The profile nearest to ``time`` [s], as a Table of particles. Raises FileNotFoundError
        if there is no profile."""
        if not self._profile_files:
            raise FileNotFoundError(f"{self.folder}: no profiles")
        _, path = min(self._profile_files, key=lambda item: abs(item[0] - time))
        return Table.read(path)

    @functools.cached_property
    def histories(self):
        """``histories.csv``, as a Table of times. Raises FileNotFoundError if the scene asks for
        no histories."""
        return Table.read(self.folder / "histories.csv")

    @functools.cached_property
    def frames(self):
        """Fields of all particles. Raises FileNotFoundError if the scene asks for none."""
        for name in FRAME_FILES:
            path = self.folder / name
            if path.exists():
                return Frames(path)
        raise FileNotFoundError(f"{self.folder}: none of {', '.join(FRAME_FILES)}")

    def x_t(self, quantity, times=None):
        """A quantity over position and time on a line: arrays (time, x, value), one row for each
        particle and frame. ``times`` [s] chooses frames; default all."""
        frames = list(self.frames) if times is None else [self.frames.at(t) for t in times]
        t = numpy.concatenate([numpy.full(len(frame), frame.time) for frame in frames])
        x = numpy.concatenate([frame.points[:, 0] for frame in frames])
        value = numpy.concatenate([_along_x(frame[quantity]) for frame in frames])
        return t, x, value

    def __repr__(self):
        return f"Results in {self.folder}"


def _along_x(values):
    """The values, or the first component of vectors and tensors."""
    return values if values.ndim == 1 else values[:, 0]


def open(folder):
    """Results of a run in ``folder``. Raises FileNotFoundError if it is not a folder."""
    return Results(folder)


def open_study(folder):
    """Rows of a study in ``folder``, as a Table. Raises FileNotFoundError if there are none."""
    for name in STUDY_FILES:
        path = Path(folder) / name
        if path.exists():
            return Table.read(path)
    raise FileNotFoundError(f"{folder}: none of {', '.join(STUDY_FILES)}")
