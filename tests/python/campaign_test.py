#!/usr/bin/env python3
"""campaign_test.py WORK: a campaign run and read from Python, and SciPy's BFGS compared
with ours on 128 problems of billiards."""

import json
import os
import pathlib
import re
import shutil
import sys
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is missing")
    sys.exit(77)
try:
    from scipy.optimize import minimize
except ImportError:
    minimize = None

import physinv
from physinv import _compare

WORK = sys.argv[1]
BFGS = "jpo/billiards/bfgs/n=128/seed=0"
GTOL = 1e-5  # of the experiment


class Campaign(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        cls.results = physinv.run("smoke", filter=f"^{BFGS}$", jobs=1,
                                  out=WORK + "/smoke")

    def test_stages_are_those_of_results_json(self):
        rows = self.results.stages()
        with open(WORK + "/smoke/results.json") as f:
            entries = json.load(f)["benchmarks"]
        self.assertEqual([f"{r['case']}/{r['stage']}" for r in rows],
                         [e["name"] for e in entries])
        self.assertEqual(rows[0]["n"], 128)
        self.assertEqual(rows[0]["stop"], "converged")
        self.assertGreater(rows[0]["seconds"], 0)

    def test_examples_and_curves(self):
        e = self.results.examples(BFGS)
        p = physinv.problem("jpo/billiards")
        s = p.sample(seed=0, n=128)
        for mine, its in zip(s, (e["problem"][k] for k in ("x", "y", "given"))):
            self.assertTrue(np.array_equal(mine, its))
        again = p.loss(p.forward(e["x"], s.given), s.y)
        self.assertTrue(np.array_equal(again, e["loss"]))
        c = self.results.curve(BFGS)
        self.assertEqual(c["loss"].shape, (len(c["iteration"]), 128))
        self.assertTrue(np.array_equal(c["loss"][-1], e["loss"]))
        self.assertEqual(c["x"].shape, (len(c["iteration"]), 4, 2))
        self.assertTrue(np.array_equal(c["x"][-1], e["x"][:4]))
        self.assertEqual(e["arrays"]["first_step"].shape, (128,))
        told = {a["name"]: a for a in physinv.arrays()}
        self.assertLessEqual(set(e["arrays"]), set(told))
        self.assertEqual(told["first_step"]["axes"], "samples")

    def test_tidy_columns(self):
        columns = self.results.tidy()
        e = self.results.examples(BFGS)
        self.assertEqual({c.shape for c in columns.values()}, {(128,)})
        self.assertEqual(columns["example"].tolist(), list(range(128)))
        self.assertTrue(np.array_equal(columns["loss"], e["loss"]))
        self.assertEqual(columns["status"].tolist(), e["status"])
        self.assertEqual(set(columns["case"]), {BFGS})
        self.assertEqual(columns["n"].dtype, np.int64)
        text = physinv.verb("export", WORK + "/smoke", format="tidy")
        rows = [line.split(",") for line in text.splitlines()]
        self.assertEqual(rows[0], list(columns))
        for name in ("loss", "seconds", "iterations"):
            own = [float(row[rows[0].index(name)]) for row in rows[1:]]
            self.assertEqual(columns[name].tolist(), own)

    def test_parquet(self):
        path = WORK + "/tidy.parquet"
        try:
            from pyarrow import parquet
        except ImportError:
            with self.assertRaisesRegex(ImportError, "needs pyarrow"):
                self.results.to_parquet(path)
            return
        self.results.to_parquet(path)
        own = parquet.read_table(path).to_pydict()
        columns = self.results.tidy()
        self.assertEqual(own["loss"], columns["loss"].tolist())
        self.assertEqual(list(own), list(columns))

    def test_compare(self):
        row, = physinv.compare(WORK + "/smoke")
        e = self.results.examples(BFGS)
        self.assertEqual(
            [row[k] for k in ("experiment", "n", "method", "seeds", "problems")],
            ["jpo/billiards", 128, "bfgs", 1, 128])
        self.assertEqual(row["loss"], np.median(e["loss"]))
        self.assertEqual(row["converged"], sum(s in ("gtol", "ftol") for s in e["status"]) / 128)
        self.assertEqual(row["solved"], (e["loss"] <= 1e-6).mean())
        self.assertGreater(row["converged"], row["solved"])  # plateaus
        self.assertIn("counts as solved (default 1e-6)",  # as the program has it
                      " ".join(physinv.verb("compare", help=True).split()))
        self.assertEqual(row["seconds"], self.results.stages()[0]["seconds"])
        both = physinv.compare(WORK + "/smoke", WORK + "/smoke")
        self.assertEqual(both["rows"][0]["sides"][1]["same_bits"], 1)
        with self.assertRaisesRegex(TypeError, "need two campaigns"):
            physinv.compare(WORK + "/smoke", by="n")

    def test_compare_counts_what_failed(self):
        class Campaign:
            def stages(self):
                return [dict(case=f"c{seed}", experiment="e", method="m", n=2,
                             seed=seed, stage="solve", stop=stop,
                             seconds=None if stop == "failed" else 3.0)
                        for seed, stop in enumerate(
                            ("converged", "failed", "diverged"))]

            def examples(self, case, stage):
                lost = case == "c2"
                return dict(loss=np.array([1.0, np.nan if lost else 2.0]),
                            status=["gtol", "nonfinite" if lost else "gtol"],
                            iterations=np.array([4.0, 4.0]))

        row, = _compare.methods_of(Campaign())
        self.assertEqual((row["seeds"], row["failed"], row["problems"]),
                         (3, 1, 6))
        self.assertEqual(row["loss"], np.inf)  # of 1, 2, 1 and three without
        self.assertEqual(row["converged"], 3 / 6)
        self.assertEqual((row["iterations"], row["seconds"]), (4, 3))

    def test_published_numbers(self):
        found = physinv.published("jpo/billiards")
        values = {v["quantity"]: v["value"] for v in found}
        self.assertEqual(values["table4/jpo/better"], 44.3)
        self.assertEqual(set(found[0]),
                         {"quantity", "value", "spread", "unit", "where"})
        with self.assertRaisesRegex(ValueError, "no paper prints"):
            physinv.published("matrix/billiards")

    def test_what_is_not_there_is_said(self):
        with self.assertRaisesRegex(ValueError, "there is no case"):
            self.results.curve("jpo/billiards/bfgs")
        with self.assertRaisesRegex(ValueError, "no finished stage 'fit'"):
            self.results.examples(BFGS, "fit")
        with self.assertRaisesRegex(physinv.ProgramError, "nearest: ") as e:
            physinv.run("smoke", filter="biliards", out=WORK + "/none")
        self.assertEqual(e.exception.status, 3)
        with self.assertRaisesRegex(RuntimeError, "none"):
            physinv.open(WORK + "/nowhere/none")

    def test_figures(self):
        with self.assertRaisesRegex(ValueError, "known figures: "):
            self.results.plot("no-such")
        with self.assertRaisesRegex(ValueError, "known figures: ") as e:
            self.results.plot("no-such")
        name = str(e.exception).split("known figures: ")[1].split(",")[0]
        self.assertIn("<svg", self.results.plot(name))
        self.assertIn("losses of all methods", self.results.plot())
        page = os.path.join(os.path.dirname(__file__), "../../docs/python.md")
        with open(page) as f:
            named = re.findall(r'r\.plot\("([^"]+)"\)', f.read())
        self.assertTrue(named)
        for figure in named + ["jpo-billiards/" + named[0]]:
            self.assertIn("<svg", self.results.plot(figure))

    def test_figures_are_of_the_results_as_they_are(self):
        out = WORK + "/anew"
        lines = []
        for method in ("bfgs", "gd"):
            r = physinv.run("smoke", filter=f"^jpo/billiards/{method}/n=4/",
                            out=out, jobs=1, no_report=len(lines) > 0)
            lines.append(r.plot("run_time_against_loss"))
        self.assertFalse(lines[0] == lines[1])

    def test_one_of_several_figures_is_named(self):
        r = physinv.run("smoke", filter="^jpo/(billiards|robotic-arm)/bfgs/n=4/",
                        out=WORK + "/two", jobs=1)
        name = "run_time_against_loss"
        with self.assertRaisesRegex(ValueError, f"jpo-billiards/{name}, "
                                    f"jpo-robotic-arm/{name}"):
            r.plot(name)
        self.assertFalse(r.plot("jpo-billiards/" + name) ==
                         r.plot("jpo-robotic-arm/" + name))

    def test_another_working_directory_is_no_other_campaign(self):
        before = os.getcwd()
        try:
            os.chdir(WORK)
            r = physinv.open("smoke")
            os.chdir("/")
            self.assertEqual(r.directory, os.path.join(before, WORK, "smoke"))
            self.assertIn("<svg", r.plot("fig4a"))
        finally:
            os.chdir(before)

    def test_flags_as_python_has_them(self):
        def names(**flags):
            text = physinv.verb("list", profile="smoke", **flags)
            return re.findall(r"^jpo/billiards/bfgs/\S+", text, re.M)

        wanted = [f"jpo/billiards/bfgs/n=4/seed={k}" for k in (0, 1)]
        line = "^jpo/billiards/bfgs/n=4/"
        for seeds in ([0, 1], (0, 1), np.arange(2), range(2), "0,1"):
            self.assertEqual(names(filter=line, seeds=seeds), wanted)
        self.assertEqual(names(filter=line, seeds=np.int64(1)), wanted[1:])
        everything = names(filter=None)
        self.assertEqual(everything, names())
        self.assertGreater(len(everything), 1)
        self.assertEqual(names(filter=[line, "-seed=0"], seeds=[0, 1]),
                         wanted[1:])
        r = physinv.run("smoke", filter=line, out=pathlib.Path(WORK) / "typed",
                        no_report=False, dry_run=False, seeds=[0])
        self.assertEqual([s["case"] for s in r.stages()], wanted[:1])
        self.assertTrue(os.path.isdir(r.directory + "/report"))

    def test_what_was_printed_is_kept(self):
        other = WORK + "/other"
        physinv.run("smoke", filter="^jpo/billiards/bfgs/n=(4|128)/seed=0",
                    out=other, jobs=1, no_report=True)
        with self.assertRaises(physinv.ProgramError) as e:
            physinv.verb("compare", other, WORK + "/smoke", fail_on="missing")
        self.assertEqual(e.exception.status, 5)
        self.assertIn("jpo/billiards", e.exception.output)

    @unittest.skipIf(minimize is None, "scipy is missing")
    def test_scipy_does_as_ours(self):
        ours = self.results.examples(BFGS)
        p = physinv.problem("jpo/billiards")
        s = p.sample(seed=0, n=128)
        same, worst, counts = 0, 0.0, 0
        for i in range(128):
            target, given = s.y[i:i + 1], s.given[i:i + 1]

            def loss(x):
                y, tape = p.linearize(x[None], given)
                return (p.loss(y, target)[0],
                        tape.pullback(p.loss_gradient(y, target))[0])

            r = minimize(loss, p.start, jac=True, method="BFGS",
                         options={"gtol": GTOL, "maxiter": 1000})
            counts += (r.nit == ours["iterations"][i] and
                       r.nfev == ours["evaluations"][i])
            same += r.fun == ours["loss"][i]
            worst = max(worst, abs(r.fun - ours["loss"][i]))
        print(f"counts equal in {counts}, losses bit-identical in {same}, "
              f"largest difference {worst:.1e}")
        self.assertEqual(counts, 128)
        self.assertGreater(same, 64)
        self.assertLess(worst, 1e-18)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
