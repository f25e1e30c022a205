"""Tables with named columns: profiles, histories and rows of studies."""

import csv
from pathlib import Path

import numpy


class Table:
    """Columns of equal length by name. Numbers are float64 arrays; other columns hold text."""

    def __init__(self, columns):
        self._columns = dict(columns)

    @classmethod
    def read(cls, path):
        """Reads a CSV file with a line of names. An empty number is NaN.

        Raises ValueError if a line has more or fewer values than there are names.
        """
        path = Path(path)
        with path.open(newline="", encoding="utf-8") as file:
            lines = list(csv.reader(file))
        if not lines:
            raise ValueError(f"{path}: the file is empty")
        names, rows = lines[0], lines[1:]
        for number, row in enumerate(rows, start=2):
            if len(row) != len(names):
                raise ValueError(
                    f"{path}, line {number}: {len(row)} values, expected {len(names)}"
                )
        return cls((name, _values([row[k] for row in rows])) for k, name in enumerate(names))

    @property
    def names(self):
        """Names of the columns, in the order of the file."""
        return list(self._columns)

    def __contains__(self, name):
        return name in self._columns

    def __iter__(self):
        return iter(self._columns)

    def __len__(self):
        return len(next(iter(self._columns.values()), ()))

    def __getitem__(self, name):
        """Column ``name``. Raises KeyError, with the known names, if there is none."""
        try:
            return self._columns[name]
        except KeyError:
            known = ", ".join(self._columns)
            raise KeyError(f"no column {name!r}; there are: {known}") from None

    def __repr__(self):
        return f"Table of {len(self)} rows: {', '.join(self._columns)}"

    def select(self, rows):
        """Table of some rows: an index array, a mask or a slice."""
        return Table((name, values[rows]) for name, values in self._columns.items())

    def to_pandas(self):
        """The table as pandas.DataFrame; needs pandas."""
        import pandas

        return pandas.DataFrame(self._columns)


def _values(texts):
    """Array of numbers; of text if a value is not a number."""
    try:
        return numpy.array([float(text) if text else numpy.nan for text in texts])
    except ValueError:
        return numpy.array(texts, dtype=str)
