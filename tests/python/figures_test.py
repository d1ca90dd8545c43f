#!/usr/bin/env python3
"""figures_test.py WORK: the three figures of examples/python, each in ten lines
and with the numbers of the others; drawn where matplotlib is installed."""

import ast
import glob
import os
import shutil
import sys
import unittest

try:
    import h5py  # noqa: F401
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing.name} is missing")
    sys.exit(77)
try:
    import matplotlib
except ImportError:
    matplotlib = None

import physinv

EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)),
                        "../../examples/python")
sys.path.insert(0, EXAMPLES)
import three_figures  # noqa: E402

WORK = sys.argv[1]
RESULTS = WORK + "/results"


class Axes:
    """Keeps what would be drawn."""

    def __init__(self):
        self.lines = {}
        self.words = {}

    def plot(self, x, y, *marker, label):
        self.lines[label] = np.asarray(x), np.asarray(y)

    def set(self, **words):
        self.words.update(words)


class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        cls.results = physinv.run(
            "smoke", filter="^jpo/billiards/(jpo|bfgs)/n=4/", out=RESULTS)
        physinv.verb("export", RESULTS, format="tidy", out=WORK + "/tidy.csv")

    def test_each_has_ten_lines(self):
        with open(os.path.join(EXAMPLES, "three_figures.py")) as f:
            tree = ast.parse(f.read())
        for one in tree.body:
            if isinstance(one, ast.FunctionDef) and one.name != "main":
                lines = one.end_lineno - one.body[0].end_lineno
                self.assertLessEqual(lines, 10, one.name)

    def test_tidy_csv(self):
        axes = Axes()
        three_figures.from_tidy_csv(WORK + "/tidy.csv", axes)
        self.assertEqual(set(axes.lines),
                         {"bfgs solve", "jpo fit", "jpo refine"})
        case = "jpo/billiards/bfgs/n=4/seed=0"
        losses, shares = axes.lines["bfgs solve"]
        self.assertEqual(losses.tolist(),
                         sorted(self.results.examples(case)["loss"]))
        self.assertEqual(shares.tolist(), [0.25, 0.5, 0.75, 1])

    def test_hdf5(self):
        axes = Axes()
        path, = glob.glob(RESULTS + "/cases/*+jpo+*.h5")
        three_figures.from_hdf5(path, axes)
        self.assertEqual(list(axes.lines), ["0_fit", "1_refine"])
        curve = self.results.curve("jpo/billiards/jpo/n=4/seed=0", "refine")
        seconds, loss = axes.lines["1_refine"]
        self.assertEqual(seconds.tolist(), curve["seconds"].tolist())
        self.assertEqual(loss.tolist(),
                         np.median(curve["loss"], axis=1).tolist())
        self.assertEqual(axes.words["xlabel"], "solving [s]")
        self.assertIn("10.48550/arXiv.2408.08119", axes.words["title"])

    def test_python(self):
        axes = Axes()
        three_figures.from_python(RESULTS, axes)
        work, loss = axes.lines["bfgs"]
        e = self.results.examples("jpo/billiards/bfgs/n=4/seed=0")
        self.assertEqual(work.tolist(), e["evaluations"].tolist())
        self.assertEqual(loss.tolist(), e["loss"].tolist())

    @unittest.skipIf(matplotlib is None, "matplotlib is missing")
    def test_drawn(self):
        picture = WORK + "/figures.png"
        three_figures.main(RESULTS, picture)
        from matplotlib import image
        pixels = image.imread(picture)
        for third in np.array_split(pixels[..., :3], 3, axis=1):
            self.assertGreater(len(np.unique(third.reshape(-1, 3), axis=0)),
                               20)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
