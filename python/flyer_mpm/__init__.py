"""Results of flyer-mpm as numpy arrays, in SI units.

``open`` reads a folder of results, ``open_study`` the table of a study, ``run`` starts a run.
"""

from .frames import Frame, Frames
from .results import Results, open, open_study
from .runner import RunError, run
from .tables import Table

__all__ = ["Frame", "Frames", "Results", "RunError", "Table", "open", "open_study", "run"]
