#!/usr/bin/env python3
"""examples_test.py WORK: what is in examples/python does what it says.
Tesseract's runtime is taken as it is installed, or else two of its names."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import types
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is missing")
    sys.exit(77)

import physinv

WORK = sys.argv[1]
EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)),
                        "../../examples/python")


class Schema:
    """Replaces pydantic's BaseModel."""

    def __init__(self, **values):
        vars(self).update(values)


class Type:
    """Replaces Tesseract's types of arrays."""

    def __class_getitem__(cls, item):
        return cls

    def __init__(self, **values):
        vars(self).update(values)


def stand_ins():
    names = ("Array", "Differentiable", "Float64", "ShapeDType")
    runtime = types.ModuleType("tesseract_core.runtime")
    vars(runtime).update({name: Type for name in names})
    pydantic = types.ModuleType("pydantic")
    pydantic.BaseModel = Schema
    return {"tesseract_core": types.ModuleType("tesseract_core"),
            "tesseract_core.runtime": runtime, "pydantic": pydantic}


class Examples(unittest.TestCase):
    @unittest.skipUnless(all(map(importlib.util.find_spec,
                                 ("scipy", "matplotlib"))),
                         "python3-scipy and python3-matplotlib are missing")
    def test_own_optimizer(self):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        subprocess.run([sys.executable, EXAMPLES + "/own_optimizer.py"],
                       cwd=WORK, check=True, stdout=subprocess.DEVNULL)
        with open(WORK + "/own_optimizer.svg") as f:
            picture = f.read()
        for words in ("best of 64 (here)", "jpo (paper, Table 4)"):
            self.assertIn(words, picture)
        rows = physinv.compare(WORK + "/own_optimizer")
        losses = {r["method"]: r["loss"] for r in rows}
        self.assertLess(losses["best-of-64"], losses["bfgs"])

    def own_problem(self, name, package, methods):
        """Losses by method; its table and its page are there."""
        if importlib.util.find_spec(package) is None:
            self.skipTest(f"python3-{package} is missing")
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        done = subprocess.run([sys.executable, f"{EXAMPLES}/{name}.py"],
                              cwd=WORK, check=True, text=True,
                              stdout=subprocess.PIPE)
        self.assertRegex(done.stdout, r"\nbfgs +solve +loss +[\d.e-]+ +solved")
        self.assertTrue(os.path.isfile(f"{WORK}/{name}/report/index.html"))
        r = physinv.open(f"{WORK}/{name}")
        self.assertEqual({s["method"] for s in r.stages()}, methods)
        return {s["method"]: r.examples(s["case"])["loss"] for s in r.stages()}

    def test_own_problem(self):
        losses = self.own_problem("own_problem", "torch", {
            "bfgs", "lbfgsb", "gd", "jpo", "supervised", "na", "adam", "hig"})
        self.assertLess(np.median(losses["bfgs"]), 1e-12)

    def test_own_ode(self):
        losses = self.own_problem("own_ode", "scipy", {"bfgs", "lbfgsb", "jpo"})
        self.assertLess(np.median(losses["bfgs"]), 1e-12)

    def test_tutorial(self):
        with open(EXAMPLES + "/../../docs/tutorial.md") as f:
            blocks = re.findall(r"^```python\n(.*?)^```", f.read(), re.S | re.M)
        self.assertGreater(len(blocks), 3)
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        done = subprocess.run([sys.executable, "-c", "\n".join(blocks)],
                              cwd=WORK, check=True, stdout=subprocess.PIPE,
                              text=True)
        solved = {(n, method, stage): float(share) for n, method, stage, share
                  in map(str.split, done.stdout.splitlines()[-12:])}
        bfgs, momentum = (solved["128", method, "solve"]
                          for method in ("bfgs", "momentum"))
        self.assertLess(bfgs, 0.5)
        self.assertGreater(momentum, 0.5)
        self.assertGreater(solved["128", "jpo", "refine"], momentum)
        with open(WORK + "/first.svg") as f:
            self.assertIn("momentum", f.read())

    def test_tesseract(self):
        if importlib.util.find_spec("tesseract_core") is None:
            sys.modules.update(stand_ins())
        spec = importlib.util.spec_from_file_location(
            "tesseract_api", EXAMPLES + "/tesseract_api.py")
        api = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(api)
        p = physinv.problem("sip/heat")
        s = p.sample(n=2, labelled=True)
        inputs = api.InputSchema(x=s.x, given=s.given)
        self.assertTrue(np.array_equal(api.apply(inputs).y, s.y))
        found = api.vector_jacobian_product(inputs, {"x"}, {"y"}, {"y": s.y})
        wanted = p.linearize(s.x, s.given)[1].pullback(s.y)
        self.assertTrue(np.array_equal(found["x"], wanted))
        shape = api.abstract_eval(inputs)["y"].shape
        self.assertEqual(tuple(shape), s.y.shape)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
