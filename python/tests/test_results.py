"""Tests of the reader: a small run is made with the program in FLYER_MPM, then read."""

import csv
import json
import os
import shutil
import tempfile
import unittest
from pathlib import Path

import numpy

import flyer_mpm

SCENES = Path(__file__).parents[2] / "inputs"


class RunsAndReads(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.TemporaryDirectory()
        folder = Path(cls.home.name) / "results"
        cls.changes = {
            "time.end": 4e-7,
            "output.profiles.times": [2e-7, 4e-7],
            "output.pictures": False,
            "domain.cell_size": "20 um",
        }
        cls.results = flyer_mpm.run(SCENES / "flyer.json", folder, set=cls.changes)

    @classmethod
    def tearDownClass(cls):
        cls.home.cleanup()

    def test_scene_is_the_one_that_ran(self):
        self.assertEqual(self.results.scene["time"]["end"], 4e-7)
        self.assertEqual(self.results.scene["domain"]["cell_size"], 2e-5)

    def test_profile_is_the_nearest_in_time(self):
        self.assertEqual(self.results.times, [2e-7, 4e-7])
        profile = self.results.profile(4.1e-7)
        self.assertEqual(len(profile), self.results.summary["particles"])
        self.assertEqual(set(profile["material"]), {"copper", "aluminium"})
        # pressure behind the shock, away from its front and from the fan
        x, pressure = profile["x"], profile["pressure"]
        plateau = pressure[(x > 1.5e-3) & (x < 2.0e-3)]
        self.assertAlmostEqual(plateau.mean() / 12.144294e9, 1.0, delta=1e-3)

    @unittest.skipUnless(shutil.which("mpirun"), "not run: no mpirun")
    def test_four_ranks_give_the_same_arrays(self):
        folder = Path(self.home.name) / "four"
        shared = flyer_mpm.run(SCENES / "flyer.json", folder, ranks=4, set=self.changes)
        self.assertEqual(shared.summary["ranks"], 4)
        for name in ("x", "pressure", "velocity"):
            one, four = (results.profile(4e-7)[name] for results in (self.results, shared))
            numpy.testing.assert_array_equal(one, four)
        for one, four in zip(self.results.x_t("pressure"), shared.x_t("pressure")):
            numpy.testing.assert_array_equal(one, four)

    def test_profile_has_the_doubles_of_the_file(self):
        with (self.results.folder / "profile_0.400us.csv").open() as file:
            rows = list(csv.DictReader(file))
        profile = self.results.profile(4e-7)
        for k in (0, len(rows) // 2, -1):
            self.assertEqual(profile["pressure"][k], float(rows[k]["pressure"]))

    def test_frames_are_the_profiles(self):
        frames = self.results.frames
        numpy.testing.assert_array_equal(frames.times, [2e-7, 4e-7])
        for frame, time in zip(frames, self.results.times):
            profile = self.results.profile(time)
            order = numpy.argsort(frame.points[:, 0], kind="stable")
            numpy.testing.assert_array_equal(frame["pressure"][order], profile["pressure"])
            names = numpy.array(frames.materials)[frame["material"][order]]
            numpy.testing.assert_array_equal(names, profile["material"])
        self.assertEqual(frames[-1].time, 4e-7)
        self.assertEqual(frames[-1].unit("pressure"), "Pa")
        with self.assertRaises(IndexError):
            frames[2]

    def test_x_t_holds_all_frames(self):
        t, x, pressure = self.results.x_t("pressure")
        self.assertEqual(len(t), 2 * self.results.summary["particles"])
        self.assertGreater(x[(pressure > 6e9) & (t == 4e-7)].max(), 2.4e-3)

    def test_histories_conserve_energy(self):
        histories = self.results.histories
        energy = histories["total_energy"]
        self.assertLess(abs(energy[-1] / energy[0] - 1.0), 1e-12)
        self.assertEqual(histories["time"][-1], 4e-7)

    def test_unknown_names_are_answered_with_the_known_ones(self):
        for holder in (self.results.profile(0.0), self.results.frames[0]):
            with self.assertRaisesRegex(KeyError, "pressure"):
                holder["pressures"]


class ReadsStudies(unittest.TestCase):
    def test_rows_of_a_study(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "study.csv").write_text("method.shape,l1,note\ncpdi,0.5,\ngimp,,x\n")
            table = flyer_mpm.open_study(folder)
            self.assertEqual(table.names, ["method.shape", "l1", "note"])
            self.assertEqual(list(table["method.shape"]), ["cpdi", "gimp"])
            self.assertTrue(numpy.isnan(table["l1"][1]))
            self.assertEqual(list(table.select(table["l1"] < 1.0)["method.shape"]), ["cpdi"])


class Refuses(unittest.TestCase):
    def setUp(self):
        self.home = tempfile.TemporaryDirectory()
        self.addCleanup(self.home.cleanup)
        self.folder = Path(self.home.name)

    def test_a_folder_that_is_not_there(self):
        with self.assertRaisesRegex(FileNotFoundError, "absent"):
            flyer_mpm.open(self.folder / "absent")

    def test_a_run_without_results(self):
        results = flyer_mpm.open(self.folder)
        self.assertEqual(results.times, [])
        study = lambda: flyer_mpm.open_study(self.folder)
        for read in (lambda: results.profile(0.0), lambda: results.frames, study):
            with self.assertRaises(FileNotFoundError):
                read()

    def test_a_summary_of_another_format(self):
        (self.folder / "summary.json").write_text(json.dumps({"format": 99}))
        with self.assertRaisesRegex(ValueError, "format 99"):
            flyer_mpm.open(self.folder).summary

    def test_a_line_of_another_length(self):
        path = self.folder / "histories.csv"
        path.write_text("time,x\n0.0,1.0\n1.0\n")
        with self.assertRaisesRegex(ValueError, "line 3"):
            flyer_mpm.open(self.folder).histories

    def test_a_scene_with_a_fault(self):
        with self.assertRaisesRegex(flyer_mpm.RunError, "courant") as caught:
            flyer_mpm.run(SCENES / "flyer.json", self.folder / "r", set={"time.courant": 7})
        self.assertEqual(caught.exception.code, 2)

    def test_a_program_that_is_not_there(self):
        before = os.environ.pop("FLYER_MPM", None)
        self.addCleanup(lambda: before and os.environ.update(FLYER_MPM=before))
        path = os.environ["PATH"]
        os.environ["PATH"] = ""
        self.addCleanup(lambda: os.environ.update(PATH=path))
        with self.assertRaisesRegex(FileNotFoundError, "FLYER_MPM"):
            flyer_mpm.run("scene.json")


if __name__ == "__main__":
    unittest.main()
