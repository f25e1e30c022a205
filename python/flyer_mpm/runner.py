"""Runs from Python: the program is started, and its results are opened."""

import json
import os
import shutil
import subprocess

from .results import Results


class RunError(RuntimeError):
    """The program has ended with an error. ``code`` is its exit code."""

    def __init__(self, message, code):
        super().__init__(message)
        self.code = code


def run(scene, output=None, *, ranks=1, threads=None, set=None, program=None):
    """Runs the scene file ``scene`` and returns its Results.

    ``output`` is the folder of the results; default ``output/NAME``. With ``ranks`` above 1 it is
    started by mpirun. ``set`` maps keys to values, as ``{"time.end": 1e-7}``. ``program`` is the
    path of flyer-mpm; default: the variable FLYER_MPM, then the search path.

    Raises FileNotFoundError if there is no program, RunError with its message if the run fails.
    """
    program = program or os.environ.get("FLYER_MPM") or shutil.which("flyer-mpm")
    if not program:
        raise FileNotFoundError("flyer-mpm is not on the search path; set FLYER_MPM to its path")
    name = os.path.splitext(os.path.basename(os.fspath(scene)))[0]
    output = os.path.join("output", name) if output is None else os.fspath(output)
    command = [os.fspath(program), os.fspath(scene), "--quiet", "--output", output]
    if ranks > 1:
        command = ["mpirun", "-n", str(ranks), *command]
    if threads is not None:
        command += ["--threads", str(threads)]
    for key, value in (set or {}).items():
        command += ["--set", f"{key}={_value(value)}"]
    ended = subprocess.run(command, capture_output=True, text=True)
    if ended.returncode != 0:
        raise RunError(ended.stderr.strip() or ended.stdout.strip(), ended.returncode)
    return Results(output)


def _value(value):
    """Text of a value for --set: JSON, and text as it stands."""
    return value if isinstance(value, str) else json.dumps(value)
