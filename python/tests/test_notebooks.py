"""The notebooks are executed, each in a folder of its own; they check their own figures.

They run with HARD_CASES=all, as in `.ci/run`. FLYER_MPM_WRITE_NOTEBOOKS names a folder for the executed
notebooks.
"""

import os
import tempfile
import unittest
from pathlib import Path

if os.environ.get("HARD_CASES") != "all":
    raise unittest.SkipTest("not run: HARD_CASES is not all")
try:
    import matplotlib
    import nbclient
    import nbformat
except ImportError as missing:
    raise unittest.SkipTest(f"not run: {missing.name} is not installed") from missing

ROOT = Path(__file__).parents[2]


class Notebooks(unittest.TestCase):
    def execute(self, name):
        notebook = nbformat.read(ROOT / "python" / "notebooks" / f"{name}.ipynb", as_version=4)
        before = os.environ.get("FLYER_MPM_INPUTS")
        self.addCleanup(lambda: before and os.environ.update(FLYER_MPM_INPUTS=before))
        os.environ["FLYER_MPM_INPUTS"] = str(ROOT / "inputs")
        with tempfile.TemporaryDirectory() as folder:
            client = nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3")
            client.execute(cwd=folder)
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        pictures = [output for output in outputs if "image/png" in output.get("data", {})]
        self.assertTrue(pictures)
        write_to = os.environ.get("FLYER_MPM_WRITE_NOTEBOOKS")
        if write_to:
            nbformat.write(notebook, Path(write_to) / f"{name}.ipynb")

    def test_figure_4(self):
        self.execute("figure_4")

    def test_sphere(self):
        self.execute("sphere")

    def test_cost_of_accuracy(self):
        self.execute("cost_of_accuracy")


if __name__ == "__main__":
    unittest.main()
