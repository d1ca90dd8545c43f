#!/usr/bin/env python3
"""source_key_test.py WORK: the key of a method in Python names all that its
numbers come from, and nothing else. A table of ways to change what a method
computes, each of which changes the key or is refused, and one of ways that
change nothing."""

import functools
import importlib
import itertools
import os
import shutil
import subprocess
import sys
import threading
import types
import unittest
from unittest import mock

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is missing")
    sys.exit(77)

try:
    import torch
except ImportError:
    torch = None

import physinv
from physinv import _libraries, _methods
from physinv._key import Refused, source_key

import source_key_rows as rows

sys.dont_write_bytecode = True
WORK = sys.argv[1]
HERE = os.path.dirname(os.path.abspath(__file__))
FOLDERS = itertools.count()
TWICE = """
import sys
sys.path[:0] = sys.argv[1:3]
import source_key_test_methods as m
import physinv
from physinv._methods import words_of
print(words_of("m", m.solve, m.OPTIONS))
"""


def written(files):
    """A folder of its own with these files."""
    folder = f"{WORK}/{next(FOLDERS)}"
    for name, text in files.items():
        os.makedirs(os.path.dirname(f"{folder}/{name}"), exist_ok=True)
        with open(f"{folder}/{name}", "w") as f:
            f.write(text)
    return folder


def key_of(files):
    """Of `solve` in methods.py; files are imported afresh."""
    folder = written(files)
    before = set(sys.modules)
    sys.path.insert(0, folder)
    importlib.invalidate_caches()
    try:
        methods = importlib.import_module("methods")
        return source_key(methods.solve, "solve")[0]
    finally:
        sys.path.remove(folder)
        for name in set(sys.modules) - before:
            if (getattr(sys.modules[name], "__file__", None) or "").startswith(
                    WORK):
                del sys.modules[name]


def edited(files, edits):
    """The files with each (old, new) of the edits; each is made somewhere."""
    out = dict(files)
    for old, new in edits:
        assert any(old in text for text in out.values()), old
        out = {name: text.replace(old, new) for name, text in out.items()}
    return out


def cells(*texts):
    """The namespace of a notebook in which these cells were run."""
    space = {"__name__": "__main__", "__builtins__": __builtins__}
    for k, text in enumerate(texts):
        exec(compile(text, f"/tmp/ipykernel_1/{k}.py", "exec"), space)
    return space


def key_of_cells(*texts):
    return source_key(cells(*texts)["solve"], "solve")[0]


class Table(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)

    def test_what_changes_the_numbers_changes_the_key(self):
        for name, files, *edits in rows.CHANGES:
            with self.subTest(name):
                files = rows.files_of(files)
                self.assertNotEqual(key_of(files), key_of(edited(files, edits)))
                self.assertEqual(key_of(files), key_of(files))
        self.assertGreaterEqual(len(rows.CHANGES), 30)

    @unittest.skipIf(torch is None, "torch is missing")
    def test_networks_and_tensors(self):
        for name, text, edit in rows.CHANGES_OF_TORCH:
            with self.subTest(name):
                files = rows.files_of(text)
                self.assertNotEqual(key_of(files), key_of(edited(files, [edit])))
                self.assertEqual(key_of(files), key_of(files))

    def test_what_cannot_be_followed_is_refused(self):
        for name, files, words in rows.REFUSED:
            with self.subTest(name), self.assertRaisesRegex(Refused, words):
                key_of(rows.files_of(files))

    def test_what_changes_nothing_keeps_the_key(self):
        for name, files, *edits in rows.SAME:
            with self.subTest(name):
                files = rows.files_of(files)
                self.assertEqual(key_of(files), key_of(edited(files, edits)))

    def test_cells_of_a_notebook(self):
        step, helper = "STEP = 0.1", "def helper(x): return x * STEP"
        solve = "def solve(run): return helper(run.start)"
        key = key_of_cells(step, helper, solve)
        for changed in ((step + "5", helper, solve),
                        (step, helper + " * 2", solve),
                        (step, helper, solve + " + 1"),
                        (step, helper, solve, "STEP = 0.2"),
                        (step, helper, solve, "helper = abs"),
                        (step, helper, solve, helper + " - 1")):
            self.assertNotEqual(key, key_of_cells(*changed), changed)
        for same in ((helper, solve, step), (step, helper, solve, solve),
                     ("import os", step, "x = 1", helper, "\n\n# now\n" + solve),
                     (step, helper, solve, "OTHER = 0.2", "print")):
            self.assertEqual(key, key_of_cells(*same), same)

    def test_what_libraries_have_is_no_obstacle(self):
        """All public names of some modules, but for readers of files."""
        readers = {"fromfile", "genfromtxt", "load", "loadtxt", "memmap"}
        for module in ("numpy", "numpy.linalg", "scipy.optimize", "math",
                       "torch.linalg", "torch.nn.functional"):
            try:
                names = sorted(set(dir(importlib.import_module(module))) - readers)
            except ImportError:
                continue
            for name in names:
                if name.startswith("_"):
                    continue
                with self.subTest(f"{module}.{name}"):
                    space = cells(f"import {module} as m\nf = m.{name}\n"
                                  f"def solve(run): return f, m.{name}")
                    source_key(space["solve"], "solve")

    def test_a_cache_does_not_keep_what_was(self):
        space = cells("import functools", "STEP = 1",
                      "@functools.lru_cache(None)\ndef f(): return STEP",
                      "def solve(run): return f()")
        first = source_key(space["solve"], "solve")[0]
        self.assertEqual(space["solve"](None), 1)
        space["STEP"] = 2
        self.assertNotEqual(first, source_key(space["solve"], "solve")[0])
        self.assertEqual(space["solve"](None), 2)

    def test_what_is_patched(self):
        def mine(*a):
            return 0
        files = rows.files_of("import numpy as np\nfrom fractions import Fraction"
                              "\ndef solve(run):\n"
                              "    return np.dot(run.start, Fraction(1, 2))\n")
        key = key_of(files)
        with mock.patch("numpy.dot", mine):
            self.assertNotEqual(key, key_of(files))
        with mock.patch("fractions.Fraction.__mul__", mine):
            self.assertNotEqual(key, key_of(files))
        with mock.patch("numpy.dot", np.vdot):
            self.assertNotEqual(key, key_of(files))
        self.assertEqual(key, key_of(files))
        files = rows.files_of("def solve(run):\n    import numpy as np\n"
                              "    return np.linalg.solve(run.start, 1)\n")
        key = key_of(files)
        with mock.patch("numpy.linalg.solve", functools.partial(mine, 1)):
            self.assertNotEqual(key, key_of(files))
        with mock.patch("numpy.linalg.svd", mine):
            self.assertNotEqual(key, key_of(files))
        self.assertEqual(key, key_of(files))


FIRST = """
import os, sys, physinv
sys.path[:0] = ["{folder}"]
import methods
decorated = physinv.method("decorated", "jpo/robotic-arm", iterations=3)
decorated(methods.solve)
STEP = 0.1
@physinv.method("global", "jpo/robotic-arm", iterations=3)
def solve(run):
    x = run.start
    while run.proceed(x): x = x - STEP * run.loss_and_gradient(x)[1]
    return x
def run():
    return physinv.run("smoke", filter="^jpo/robotic-arm/(decorated|global)/",
                       out="{out}", jobs=1, no_report=True)
def median(name):
    stage, = [s for s in run().stages() if s["method"] == name]
    return sorted(run().examples(stage["case"])["loss"])[2]
run()
"""
DECORATED = """
from decorators import plain
@plain
def solve(run):
    x = run.start
    while run.proceed(x): x = x - 0.1 * run.loss_and_gradient(x)[1]
    return x
"""


class Campaigns(unittest.TestCase):
    """In full, through physinv.run."""

    def run_once(self, text, method=DECORATED, more=""):
        folder = written({"methods.py": method, "decorators.py":
                          "def plain(f): return lambda run: f(run)\n"})
        text = text.format(folder=folder, out=WORK + "/out") + more
        return subprocess.run([sys.executable, "-c", text], text=True, cwd=folder,
                              check=True, stdout=subprocess.PIPE).stdout

    def test_edits_run_again_and_nothing_else(self):
        shutil.rmtree(WORK + "/out", ignore_errors=True)
        self.assertIn("2 stages run, 0 reused", self.run_once(FIRST))
        self.assertIn("0 stages run, 2 reused",
                      self.run_once("# moved" + FIRST, DECORATED + "# other\n"))
        out = self.run_once(FIRST, DECORATED.replace("0.1", "0.2"))
        self.assertIn("1 stages run, 1 reused", out)
        # As in a notebook, where a cell runs again after the method's.
        out = self.run_once(FIRST, DECORATED.replace("0.1", "0.2"), """
before = median("global")
STEP = 0.2
after = median("global")
print("differs", after != before, "equals", after == median("decorated"))
""")
        self.assertIn("0 stages run, 2 reused", out)
        self.assertIn("1 stages run, 1 reused", out)
        self.assertIn("differs True equals True", out)


class Words(unittest.TestCase):
    """In addition to the hash of the source."""

    def words(self, solve=len, **options):
        return _methods.words_of("m", solve, options)

    def test_options_are_told_by_content(self):
        a, b = np.arange(2000.), np.arange(2000.)
        b[1000] += 1e-9
        pairs = [(a, b), (a, a.astype("f4")), (a, a.reshape(40, 50)),
                 (np.float64(0.1), np.float32(0.1)), (1, 1.0), (1, "1"),
                 (1, True), (0.0, -0.0), ("a", "b"), ([1], (1,)), ([1, 2], [12]),
                 ({1, 2}, {1, 3}), ({"a": 1}, {"a": 2}), ("1, 2", [1, 2]),
                 (lambda x: x, lambda x: x + 1), ("x" * 999, "x" * 998 + "y"),
                 (types.SimpleNamespace(a=1), types.SimpleNamespace(a=2)),
                 (np.dtype("f4"), np.dtype("f8")), (None, 0), ([a], [b])]
        for one, other in pairs:
            self.assertNotEqual(self.words(v=one), self.words(v=other),
                                (one, other))
        same = [(a, a.copy()), (lambda x: x, lambda x: x), ({1, 2}, {2, 1}),
                ({"a": 1, "b": 2}, {"b": 2, "a": 1}), (0.1, 0.1)]
        for one, other in same:
            self.assertEqual(self.words(v=one), self.words(v=other))
        self.assertEqual(self.words(a=1, b=2), self.words(b=2, a=1))
        for text in [t for _, t in self.words(v="a\n  w=1", w=a, u="\udc80")]:
            self.assertNotIn("\n", text)
            text.encode()
        for bad in (threading.Lock(), sys.stdout, (x for x in "a"),
                    np.random.default_rng(0), [threading.Lock()]):
            with self.assertRaisesRegex(TypeError, "the option rate has no st"):
                self.words(rate=bad)

    def test_versions_are_words(self):
        def solve(run):
            import scipy.optimize
            return scipy.optimize.minimize
        words = dict(self.words())
        self.assertEqual(words["python"], "%d.%d" % sys.version_info[:2])
        self.assertEqual(words["libraries"], f"numpy {np.__version__}")
        self.assertNotIn("physinv", words)
        if importlib.util.find_spec("scipy"):
            self.assertIn(", scipy 1", dict(self.words(solve))["libraries"])
        newer = {"numpy": "99.1"}.get
        with mock.patch.object(_libraries, "version", newer):
            self.assertEqual(dict(self.words())["libraries"], "numpy 99.1")

    def test_what_calls_problems_has_their_sources(self):
        def solve(run):
            return physinv.problem("sip/heat").forward(run.start)
        self.assertRegex(dict(self.words(solve))["physinv"], "^[0-9a-f]{32}$")

        def key(name):
            p = physinv.problem(name)
            return dict(self.words(lambda run: p.forward(run.start)))
        self.assertEqual(key("sip/heat"), key("sip/heat"))
        self.assertNotEqual(key("sip/heat"), key("jpo/billiards"))
        self.assertIn("physinv", key("sip/heat"))

    def test_other_processes(self):
        folder = written({"source_key_test_methods.py": rows.EVERYTHING})
        moved = written({"source_key_test_methods.py": "\n# moved\n" +
                         rows.EVERYTHING})
        found = set()
        for seed, where, at in (("0", folder, "/"), ("1", folder, WORK),
                                ("7", moved, WORK)):
            found.add(subprocess.run(
                [sys.executable, "-c", TWICE, where, HERE], text=True, cwd=at,
                env=dict(os.environ, PYTHONHASHSEED=seed), check=True,
                stdout=subprocess.PIPE).stdout)
        self.assertEqual(len(found), 1, "\n".join(found))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
