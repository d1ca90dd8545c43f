#!/usr/bin/env python3
"""Every registered problem through the package: shapes, both precisions, what a
pullback is the transpose of, errors in words, no copies, threads, overheads."""

import ast
import inspect
import os
import pydoc
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is missing")
    sys.exit(77)

import physinv

N = 5


def distinct():
    """One experiment of each problem and setting."""
    seen = {}
    for name in physinv.problems():
        p = physinv.problem(name)
        seen.setdefault((repr(p).split(";")[0].split(":")[1],
                         tuple(p.options.items())), p)
    return list(seen.values())


PROBLEMS = distinct()


def labelled(p, n=N):
    return p.sample(seed=3, n=n, labelled=True)


class Problems(unittest.TestCase):
    def test_there_are_all(self):
        self.assertGreater(len(PROBLEMS), 15)
        for p in PROBLEMS:
            self.assertIn("forward", p.names)
            self.assertIn(p.name, repr(p))

    def each(self, ability):
        found = [p for p in PROBLEMS if ability in p.names]
        self.assertGreater(len(found), 1)
        for p in found:
            with self.subTest(p.name):
                yield p

    def test_forward_gives_the_samples(self):
        for p in self.each("forward"):
            s = labelled(p)
            self.assertEqual((s.x.shape, s.y.shape, s.given.shape),
                             tuple((N, k) for k in p.shape))
            y = p.forward(s.x, s.given)
            self.assertEqual(y.dtype, np.float64)
            self.assertTrue(np.array_equal(y, p.forward(s.x, s.given)))
            one = p.forward(s.x[2:3], s.given[2:3])
            self.assertTrue(np.array_equal(one[0], y[2], equal_nan=True))
            small = p.sample(seed=3, n=2, labelled=True)
            self.assertTrue(np.array_equal(small.x, s.x[:2]))
            self.assertEqual(p.start.shape, (p.shape[0],))

    def test_float_answers_in_float(self):
        for p in self.each("vjp"):
            s = labelled(p)
            x, given = s.x.astype(np.float32), s.given.astype(np.float32)
            y, tape = p.linearize(x, given)
            self.assertEqual(y.dtype, np.float32)
            self.assertTrue(np.array_equal(y, p.forward(x, given)))
            self.assertEqual(tape.pullback(y).dtype, np.float32)
            self.assertEqual(p.loss(y, y).dtype, np.float64)
            # Of other memory orders, too.
            self.assertTrue(np.array_equal(
                p.forward(np.asfortranarray(x), given), y))

    def test_pushforward_is_the_transpose_of_pullback(self):
        for p in self.each("jvp"):
            s = labelled(p)
            y, tape = p.linearize(s.x, s.given)
            x_dot, y_bar = np.sin(s.x + 1), np.cos(y)
            y_dot = tape.pushforward(x_dot)
            self.assertTrue(np.array_equal(
                y_dot, p.pushforward(s.x, x_dot, s.given)))
            left = (y_dot * y_bar).sum(1)
            right = (x_dot * tape.pullback(y_bar)).sum(1)
            size = np.abs(left).max() + np.abs(right).max()
            self.assertLess(np.abs(left - right).max(), 1e-9 * (1 + size))

    def test_jacobian_agrees_with_pullback(self):
        for p in self.each("jacobian"):
            s = labelled(p)
            if p.shape[0] * p.shape[1] > 1e6:
                continue
            y, tape = p.linearize(s.x, s.given)
            y_bar = np.cos(y)
            j = p.jacobian(s.x, s.given)
            self.assertEqual(j.shape, (N, p.shape[1], p.shape[0]))
            both = np.einsum("nyx,ny->nx", j, y_bar)
            x_bar = tape.pullback(y_bar)
            self.assertLess(np.abs(both - x_bar).max(),
                            1e-9 * (1 + np.abs(x_bar).max()))

    def test_inverse_and_hessian(self):
        for p in self.each("inverse"):
            s = p.sample(seed=0, n=N)
            x = p.invert(s.y, s.given)
            self.assertEqual(x.shape, (N, p.shape[0]))
        for p in self.each("hessian"):
            s = labelled(p)
            h = p.hessian(s.x, s.y, s.given)
            self.assertLess(np.abs(h - h.transpose(0, 2, 1)).max(),
                            1e-9 * (1 + np.abs(h).max()))

    def test_loss_gradient_is_that_of_half_the_square_or_its_own(self):
        p = physinv.problem("sip/heat")
        s = labelled(p)
        y = s.y + 1
        np.testing.assert_allclose(p.loss_gradient(y, s.y), y - s.y)
        np.testing.assert_allclose(p.loss(y, s.y),
                                   0.5 * ((y - s.y) ** 2).sum(1), rtol=1e-14)

    def test_a_tape_keeps_its_point(self):
        p = physinv.problem("jpo/robotic-arm")
        s = labelled(p, 4)
        y, first = p.linearize(s.x)
        expected = first.pullback(y)
        other, second = p.linearize(s.x + 1)
        self.assertTrue(np.array_equal(first.pullback(y), expected))
        del first, second
        again, third = p.linearize(s.x)
        self.assertTrue(np.array_equal(third.pullback(y), expected))

    def test_no_samples_give_none(self):
        for p in self.each("vjp"):
            unknowns, observations, side = p.shape
            x, given = np.empty((0, unknowns)), np.empty((0, side))
            y, tape = p.linearize(x, given)
            self.assertEqual(y.shape, (0, observations))
            self.assertEqual(p.forward(x, given).shape, (0, observations))
            self.assertEqual(tape.pullback(y).shape, (0, unknowns))
            self.assertEqual(p.loss(y, y).shape, (0,))

    def test_a_row_that_is_no_number_stays_alone(self):
        p = physinv.problem("jpo/robotic-arm")
        s = labelled(p)
        x = s.x.copy()
        x[1] = np.nan
        y = p.forward(x)
        self.assertTrue(np.isnan(y[1]).all())
        self.assertTrue(np.array_equal(np.delete(y, 1, 0),
                                       np.delete(s.y, 1, 0)))

    def test_errors_have_words(self):
        arm = physinv.problem("jpo/robotic-arm")
        s = labelled(arm)
        with self.assertRaisesRegex(ValueError, "nearest: .*jpo/billiards"):
            physinv.problem("jpo/biliards")
        with self.assertRaisesRegex(ValueError, r"x is \(5, 3\).*\(5, 4\)"):
            arm.forward(s.x[:, :3])
        with self.assertRaisesRegex(ValueError, r"x\[None\], \(1, 4\)"):
            arm.forward(s.x[0])
        with self.assertRaisesRegex(ValueError, r"x is \(3\)"):
            arm.forward(s.x[0, :3])
        with self.assertRaisesRegex(TypeError, "provides forward.*no inverse"):
            arm.invert(s.y)
        with self.assertRaisesRegex(TypeError, "x is not an array of numbers"):
            arm.forward("no")
        for wrong in ({"n": 0}, {"n": 1.5}, {"seed": -1}, {"first": "x"}):
            name, = wrong
            with self.assertRaisesRegex(ValueError, f"{name}=.*expected"):
                arm.sample(**wrong)
        with self.assertRaisesRegex(TypeError, "x is complex"):
            arm.forward(s.x + 1j)
        with self.assertRaisesRegex(ValueError, r"y\[None\], \(1, 2\)"):
            arm.loss(s.y[0], s.y)
        for dtype in (np.float32, np.float64):
            masked = np.ma.masked_array(s.x.astype(dtype), s.x > 9)
            with self.assertRaisesRegex(TypeError, "x is a masked array"):
                arm.forward(masked)
        with self.assertRaisesRegex(TypeError, "x is complex"):
            arm.forward((s.x + 1j).tolist())
        with self.assertRaisesRegex(TypeError, "x is not an array of numbers"):
            arm.forward(s.x.astype(str))
        with self.assertRaisesRegex(TypeError, "no jvp, which pushforward"):
            arm.pushforward(s.x, s.x)
        _, tape = arm.linearize(s.x)
        with self.assertRaisesRegex(ValueError, r"y_bar is \(5, 4\)"):
            tape.pullback(s.x)
        ks = physinv.problem("jpo/kuramoto-sivashinsky")
        if ks.shape[2] > 0:
            with self.assertRaisesRegex(ValueError, "needs given"):
                ks.forward(labelled(ks).x)

    def test_of_another_python_the_right_one_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            there = os.path.dirname(physinv.__file__)
            package = shutil.copytree(
                there, folder + "/physinv",
                ignore=shutil.ignore_patterns("_core.*", "__pycache__"))
            for file, words in (
                    (None, "no extension module _core"),
                    ("_core.cpython-399-x86_64-linux-gnu.so",
                     r"built for Python 3\.99, but this is Python 3\.\d+ "
                     r".*; use python3\.99")):
                if file is not None:
                    open(os.path.join(package, file), "w").close()
                done = subprocess.run(
                    [sys.executable, "-c", "import physinv"], text=True,
                    capture_output=True, env=dict(os.environ, PYTHONPATH=folder))
                self.assertRegex(done.stderr.splitlines()[-1],
                                 "^ImportError: .*" + words)

    def test_help_teaches(self):
        text = pydoc.plain(pydoc.render_doc(physinv))
        for words in ("linearize(x, given=None)", "(samples, unknowns)",
                      "invert(y, given=None, guess=None)",
                      "sample(self, seed=0, n=1, first=0, labelled=False)",
                      "loss_and_gradient(x, active=None)"):
            self.assertIn(words, text)
        self.assertNotIn("physinv._core.Problem, ", text)
        for name in physinv.__all__:
            self.assertTrue(getattr(physinv, name).__doc__, name)

    def stubs(self, name):
        path = os.path.join(os.path.dirname(physinv.__file__), name)
        with open(path) as f:
            return {node.name: node for node in ast.parse(f.read()).body
                    if isinstance(node, (ast.ClassDef, ast.FunctionDef))}

    @staticmethod
    def public(module):
        return {name for name in vars(module) if not name.startswith("__")}

    def test_stubs_name_what_there_is(self):
        core, stubs = physinv._core, self.stubs("_core.pyi")
        self.assertEqual(self.public(core), set(stubs))
        for name, node in stubs.items():
            if isinstance(node, ast.ClassDef):
                self.assertEqual(self.public(getattr(core, name)),
                                 {one.name for one in node.body}, name)
        own = self.stubs("__init__.pyi")
        self.assertEqual(set(own) | {"RegisteredProblem", "Run"}, set(physinv.__all__))
        for name, node in own.items():
            if isinstance(node, ast.FunctionDef):
                there = inspect.signature(getattr(physinv, name)).parameters
                given = node.args
                self.assertEqual(
                    [a.arg for a in (*given.args, *given.kwonlyargs,
                                     *filter(None, (given.vararg,
                                                    given.kwarg)))],
                    list(there), name)

    def test_threads_share_a_problem(self):
        p = physinv.problem("jpo/kuramoto-sivashinsky")
        s = labelled(p, 8)
        y, tape = p.linearize(s.x, s.given)
        expected = tape.pullback(y)
        wrong = []

        def work():
            for _ in range(5):
                y, tape = p.linearize(s.x, s.given)
                if not np.array_equal(tape.pullback(y), expected):
                    wrong.append(1)

        threads = [threading.Thread(target=work) for _ in range(4)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        self.assertEqual(wrong, [])

    def test_a_call_is_cheap(self):
        p = physinv.problem("physgrad/scaling" if "physgrad/scaling" in
                            physinv.problems() else "sip/exponential")
        s = labelled(p, 1)
        best = min(self.time(lambda: p.forward(s.x, s.given))
                   for _ in range(20))
        print(f"a call of {p.name}: {1e6 * best:.2f} us")
        self.assertLess(best, 20e-6)  # of a machine that does other things, too

    @staticmethod
    def time(call, count=200):
        begin = time.perf_counter()
        for _ in range(count):
            call()
        return (time.perf_counter() - begin) / count


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
