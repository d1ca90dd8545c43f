#!/usr/bin/env python3
"""own_problem_test.py WORK: problems written in Python, as experiments: recorded,
reused, verified, reported; what a problem lacks is skipped, what it raises ends a
case with a reason, and conformance says what is wrong."""

import contextlib
import functools
import importlib.util
import io
import os
import shutil
import subprocess
import sys
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is missing")
    sys.exit(77)

import physinv
import source_file

WORK = sys.argv[1]
define = functools.partial(source_file.define, WORK + "/problems.py")
TIMES = np.linspace(0.1, 2, 6)
SOLVERS = "(bfgs|lbfgsb|gd)"

DECAY = '''
import numpy as np
import physinv

TIMES = np.linspace(0.1, 2, 6)

@physinv.experiment("edited", iterations=20, updates=20)
class Decay(physinv.Problem):
    start = [1.0, 0.5]

    def sample(self, seed, n):
        return np.random.default_rng(seed).uniform([0.5, 0.1], [2, 2], (n, 2))

    def forward(self, x, given):
        return x[:, :1] * np.exp(-x[:, 1:] * TIMES)

    def jacobian(self, x, given):
        e = np.exp(-x[:, 1:] * TIMES)
        return np.stack([e, -x[:, :1] * TIMES * e], 2)
'''


class Plain(physinv.Problem):
    """Nothing but the forward pass: amplitude and rate of a decay that is seen at
    times of its own."""
    start = [1.0, 0.5]
    unknowns = ("amplitude, rate", "1, 1/s")

    def sample(self, seed, n):
        random = np.random.default_rng(seed)
        return (random.uniform([0.5, 0.1], [2, 2], (n, 2)),
                random.uniform(0.5, 1.5, (n, 1)))

    def forward(self, x, given):
        return x[:, :1] * np.exp(-x[:, 1:] * given * TIMES)


class Sloped(Plain):
    calls = 0

    def vjp(self, x, given):
        times = given * TIMES
        e = np.exp(-x[:, 1:] * times)

        def pullback(y_bar):
            return np.stack([(y_bar * e).sum(1),
                             (-y_bar * x[:, :1] * times * e).sum(1)], 1)
        return x[:, :1] * e, pullback


class Full(Plain):
    def jacobian(self, x, given):
        e = np.exp(-x[:, 1:] * given * TIMES)
        return np.stack([e, -x[:, :1] * given * TIMES * e], 2)

    def inverse(self, y, given, guess):
        """By the first and the last time."""
        with np.errstate(all="ignore"):
            span = given[:, 0] * (TIMES[-1] - TIMES[0])
            rate = np.log(y[:, 0] / y[:, -1]) / span
            x = np.stack([y[:, 0] * np.exp(rate * given[:, 0] * TIMES[0]),
                          rate], 1)
        return np.where(np.isfinite(x).all(1, keepdims=True), x, guess)


def run(pattern, out, profile="smoke", **flags):
    try:
        return physinv.run(profile, filter=pattern, out=f"{WORK}/{out}", jobs=1,
                           **flags)
    except physinv.ProgramError as error:
        if error.status != 4:
            raise
        return physinv.open(f"{WORK}/{out}")


def rows(results):
    return {(s["method"], s["stage"]): s for s in results.stages()}


def wrong_with(problem):
    with contextlib.redirect_stdout(io.StringIO()):
        return physinv.conformance(problem)


class OwnProblems(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        small = dict(iterations=40, updates=20, n=8, batch=8, hidden=(16, 16))
        physinv.experiment("plain", **small)(Plain)
        physinv.experiment("sloped", title="Decay", **small)(Sloped)
        physinv.experiment("full", **small)(Full())
        cls.full = run("^matrix/full/", "full", "quick")

    def test_solvers_run_and_agree_with_the_problem(self):
        results = run(f"^matrix/sloped/{SOLVERS}/", "sloped")
        found = rows(results)
        self.assertEqual({m for m, _ in found}, {"bfgs", "lbfgsb", "gd"})
        e = results.examples("matrix/sloped/bfgs/n=4/seed=0")
        self.assertLess(e["loss"].max(), 1e-14)
        s = physinv.problem("matrix/sloped").sample(seed=0, n=4)
        self.assertTrue(np.array_equal(e["problem"]["y"], s.y))
        y = Sloped().forward(e["x"], s.given)
        self.assertTrue(np.array_equal(s.y, Sloped().forward(s.x, s.given)))
        np.testing.assert_allclose(
            e["loss"], 0.5 * ((y - s.y) ** 2).sum(1), rtol=1e-12)

    def test_all_methods_of_a_full_problem(self):
        found = rows(self.full)
        expected = {"bfgs", "lbfgsb", "gd", "jpo", "supervised", "na", "adam",
                    "labels", "sip", "sip-sign", "hig", "gn"}
        self.assertLessEqual(expected, {m for m, _ in found})
        self.assertEqual({s["stop"] for s in found.values()}
                         - {"iterations", "converged"}, set())
        self.assertIn(("jpo", "refine"), found)
        self.assertEqual(set(physinv.skipped("matrix/full")),
                         {"adahessian", "newton"})
        with open(WORK + "/full/report/report.md") as f:
            page = f.read()
        self.assertRegex(page, r"8, bfgs +\| +100 ")
        self.assertRegex(page, r"newton +\| +skipped: no Hessian")
        self.assertIn("Half-inverse gradients", page)
        svg = WORK + "/full/report/matrix-full/figures/performance_profile.svg"
        self.assertTrue(os.path.isfile(svg))

    def test_runs_again_with_the_same_bits(self):
        self.assertIn(" 0 mismatches",
                      physinv.verb("verify", WORK + "/full"))
        again = run("^matrix/full/", "again", "quick", no_report=True)
        first, then = rows(self.full), rows(again)
        self.assertEqual(set(first), set(then))
        for name, s in first.items():
            self.assertEqual(s["key"], then[name]["key"])
            a, b = (r.examples(s["case"], s["stage"])
                    for r in (self.full, again))
            self.assertEqual(a["loss"].tobytes(), b["loss"].tobytes(), name)
            self.assertEqual(a["x"].tobytes(), b["x"].tobytes(), name)
        compared = physinv.compare(WORK + "/full", WORK + "/again")["rows"]
        self.assertTrue(all(r["sides"][1]["same_bits"] for r in compared))

    def test_what_it_lacks_is_skipped(self):
        without = physinv.skipped("matrix/plain")
        self.assertEqual(without["bfgs"], "no gradient")
        self.assertEqual(without["jpo"], "no gradient")
        self.assertEqual(without["sip"], "no inverse")
        self.assertEqual(physinv.skipped("matrix/sloped")["hig"], "no Jacobian")
        found = rows(run("^matrix/plain/", "plain"))
        self.assertEqual(set(found), {("supervised", "fit"), ("na", "fit"),
                                      ("na", "solve")})
        with self.assertRaisesRegex(ValueError, "matrix/plain"):
            physinv.skipped("matrix/none")

    def test_an_edit_makes_it_stale(self):
        def keys():
            return {name: s["key"] for name, s in rows(
                run("^matrix/edited/(bfgs|hig)/", "edited")).items()}
        define(DECAY)
        first = keys()
        define("# moved\n" + DECAY)
        self.assertEqual(keys(), first)
        define(DECAY.replace("linspace(0.1", "linspace(0.2"))
        second = keys()
        self.assertEqual(set(first), set(second))
        self.assertFalse(set(first.values()) & set(second.values()))

    def test_attributes_are_renewed_before_a_run(self):
        problem = Full()
        problem.note = 1
        physinv.experiment("noted", n=4)(problem)
        one = rows(run("^matrix/noted/bfgs/", "noted"))
        problem.note = 2
        two = rows(run("^matrix/noted/bfgs/", "noted"))
        self.assertNotEqual(one["bfgs", "solve"]["key"],
                            two["bfgs", "solve"]["key"])

    def failing(self, name, **functions):
        kind = type(name, (Sloped,), functions)
        physinv.experiment(name, iterations=5, updates=5)(kind)
        return rows(run(f"^matrix/{name}/bfgs/", name, no_report=True))[
            "bfgs", "solve"], physinv.open(f"{WORK}/{name}")

    def test_exceptions_end_a_case_with_a_reason(self):
        def vjp(self, x, given):
            raise ArithmeticError("not today")
        row, _ = self.failing("raises", vjp=vjp)
        self.assertEqual((row["stop"], row["message"]),
                         ("failed",
                          "vjp of matrix/raises: ArithmeticError: not today"))

        def leave(self, x, given):
            sys.exit(3)
        row, _ = self.failing("leaves", vjp=leave)
        self.assertEqual(row["stop"], "failed")
        self.assertIn("SystemExit", row["message"])

        def die(self, x, given):
            os._exit(3)
        row, _ = self.failing("dies", vjp=die)
        self.assertIn("the worker exited with status 3", row["message"])

    def test_wrong_shapes_have_words(self):
        def vjp(self, x, given):
            y, pullback = Sloped.vjp(self, x, given)
            return y[:, :3], pullback
        row, _ = self.failing("short", vjp=vjp)
        self.assertEqual(row["message"],
                         "vjp of matrix/short: its y is (4, 3); expected "
                         "(samples, features) = (4, 6)")

        def alone(self, x, given):
            return Sloped.vjp(self, x, given)[0]
        row, _ = self.failing("alone", vjp=alone)
        self.assertIn("must return y and a function", row["message"])

        def wide(self, x, given):
            return Sloped.vjp(self, x, given)[0], lambda y_bar: y_bar
        row, _ = self.failing("wide", vjp=wide)
        self.assertIn("its x_bar is (4, 6)", row["message"])

    def test_nan_is_of_one_problem_alone(self):
        def walled(x, given, y):
            """NaN where half of the problems start."""
            at_start = (x == Sloped.start).all(1, keepdims=True)
            return np.where(at_start & (given > 1), np.nan, y)

        def forward(self, x, given):
            return walled(x, given, Sloped.forward(self, x, given))

        def vjp(self, x, given):
            y, pullback = Sloped.vjp(self, x, given)
            return walled(x, given, y), pullback
        row, results = self.failing("walls", vjp=vjp, forward=forward)
        e = results.examples(row["case"])
        lost = e["problem"]["given"][:, 0] > 1
        self.assertTrue(0 < lost.sum() < 4, lost)
        self.assertEqual([s == "nonfinite" for s in e["status"]], list(lost))
        self.assertLess(e["loss"][~lost].max(), 1e-14)

    def test_data_that_are_not_finite_end_a_case(self):
        def forward(self, x, given):
            return np.where(given > 1, np.nan, Sloped.forward(self, x, given))
        row, _ = self.failing("holes", forward=forward)
        self.assertEqual(row["stop"], "failed")
        self.assertIn("forward of matrix/holes: its y is not finite for "
                      "drawn samples", row["message"])

        def sample(self, seed, n):
            raise KeyError("no file")
        physinv.experiment("unread")(type("P", (Sloped,), dict(
            sample=lambda self, seed, n: Sloped.sample(self, seed, n)
            if seed == 0 else sample(self, seed, n))))
        row = rows(run("^matrix/unread/bfgs/", "unread", no_report=True))[
            "bfgs", "solve"]
        self.assertEqual(row["message"],
                         "data: sample of matrix/unread: KeyError: 'no file'")

    def test_functions_never_see_what_is_not_finite(self):
        seen = []

        class Watched(Full):
            def forward(self, x, given):
                seen.append(np.isfinite(x).all())
                return super().forward(x, given)
        physinv.experiment("watched")(Watched)
        p = physinv.problem("matrix/watched")
        x, given = np.ones((3, 2)), np.ones((3, 1))
        x[1, 0] = np.nan
        y, tape = p.linearize(x, given)
        self.assertTrue(all(seen))
        self.assertEqual(list(np.isnan(y).all(1)), [False, True, False])
        slope = tape.pullback(np.ones_like(y))
        self.assertEqual(list(np.isnan(slope).all(1)), [False, True, False])
        self.assertTrue(np.isfinite(slope[[0, 2]]).all())

    def test_calls_of_a_registered_one(self):
        p = physinv.problem("matrix/full")
        self.assertEqual(p.shape, (2, 6, 1))
        self.assertEqual(set(p.names), {"forward", "labels", "vjp", "jvp",
                                        "jacobian", "inverse"})
        s = p.sample(seed=3, n=5)
        small = p.sample(seed=3, n=2)
        self.assertTrue(np.array_equal(small.x, s.x[:2]))
        own = Full()
        self.assertTrue(np.array_equal(p.jacobian(s.x, s.given),
                                       own.jacobian(s.x, s.given)))
        np.testing.assert_allclose(p.invert(s.y, s.given), s.x, rtol=1e-9)
        # Tapes live as long as they are kept.
        tapes = [p.linearize(s.x + k, s.given)[1] for k in range(8)]
        y_bar = np.ones_like(s.y)
        for k, tape in enumerate(tapes):
            np.testing.assert_array_equal(
                tape.pullback(y_bar),
                np.einsum("nou,no->nu", own.jacobian(s.x + k, s.given), y_bar))
        self.assertEqual(p.forward(s.x.astype("f"), s.given).dtype, np.float32)

    def test_methods_in_python_solve_it(self):
        @physinv.method("own-descent", experiments="matrix/sloped",
                        iterations=20)
        def descend(run):
            x = run.start
            while run.proceed(x):
                x = x - 0.2 * run.loss_and_gradient(x)[1]
            return x
        found = rows(run("^matrix/sloped/own-descent/", "descent"))
        self.assertEqual(found["own-descent", "solve"]["stop"], "iterations")
        # Again under its name, with the methods that it had.
        physinv.experiment("sloped", title="Decay", n=8)(Sloped)
        self.assertIn("own-descent", physinv.verb(
            "list", filter="^matrix/sloped/", profile="smoke"))

    def test_the_program_says_what_it_does_not_know(self):
        done = subprocess.run([physinv.program(), "verify", WORK + "/full"],
                              capture_output=True, text=True)
        self.assertIn("matrix/full", done.stdout + done.stderr)

    def test_definitions_have_words(self):
        def refused(words, problem=Sloped, name="refused", **settings):
            with self.assertRaisesRegex((ValueError, TypeError), words):
                physinv.experiment(name, **settings)(problem)
        refused("must have at most 100 characters", name="No Name")
        refused("already has an experiment matrix/billiards", name="billiards")
        refused("is not a physinv.Problem", problem=3)
        refused("a whole number of at least 1", n=0)
        refused("a whole number of at least 1", batch=1.5)
        refused("a positive number", gtol=0)
        refused("such as .64, 64.", hidden=3)
        refused("a problem must define start", type("P", (Sloped,), dict(start=None)))
        refused("x of sample is .1, 2.; expected .1, 3.",
                type("P", (Sloped,), dict(start=[1, 2, 3])))
        refused("what forward returns is .6.; expected .1, observations.",
                type("P", (Sloped,), dict(
                    forward=lambda self, x, given: TIMES)))
        refused("cannot cover all that .* LOCK", type("P", (Sloped,), dict(
            forward=lambda self, x, given: (LOCK, Plain.forward(
                self, x, given))[1])))
        with self.assertRaisesRegex(ValueError, "expected 'torch' or 'jax'"):
            type("P", (Sloped,), {}, autodiff="numpy")
        self.assertNotIn("matrix/refused", physinv.problems())


class Conformance(unittest.TestCase):
    def test_what_is_right(self):
        for problem in (Plain, Sloped, Full()):
            self.assertEqual(wrong_with(problem), {})

    def test_what_is_wrong(self):
        def broken(base=Full, **functions):
            return wrong_with(type("Broken", (base,), functions))

        def scaled(name, factor):
            return lambda self, x, given: factor * getattr(
                Full, name)(self, x, given)
        wrong = broken(jacobian=scaled("jacobian", 1.001))
        self.assertRegex(wrong["vjp agrees with differences"],
                         "by unknown 0 differs from differences: in 1.* of ")
        self.assertIn("jacobian agrees with differences", wrong)
        self.assertNotIn("vjp and jvp are adjoint", wrong)
        wrong = broken(jvp=lambda self, x, given, x_dot: x_dot[:, :1] * x[:, 1:]
                       * np.ones(6))
        self.assertEqual(set(wrong), {"jvp agrees with differences",
                                      "vjp and jvp are adjoint"})
        wrong = broken(forward=lambda self, x, given: Plain.forward(
            self, x, given) + 1e-3 * x.mean(0, keepdims=True)[:, :1])
        self.assertIn("depends on the other samples",
                      wrong["a batch gives what its samples give"])
        count = iter(range(1000))
        wrong = broken(Plain, forward=lambda self, x, given: Plain.forward(
            self, x, given) + next(count))
        self.assertIn("forward gives the same bits twice", wrong)
        wrong = broken(sample=lambda self, seed, n: Plain.sample(
            self, seed + next(count), n))
        self.assertIn("from seed alone", wrong["sample is of its seed"])
        wrong = broken(sample=lambda self, seed, n: Plain.sample(self, 1, n))
        self.assertIn("the same for seeds 5 and 6",
                      wrong["sample is of its seed"])
        wrong = broken(inverse=lambda self, y, given, guess: guess + 9)
        self.assertIn("further from y", wrong["inverse lowers the loss"])
        wrong = broken(start=None)
        self.assertIn("must define start", wrong["definition"])

        def writes(self, x, given):
            x[:, 0] *= 2
            return Plain.forward(self, x, given)
        self.assertIn("writes into x",
                      broken(Plain, forward=writes)[
                          "forward leaves its arguments alone"])

        def raises(self, x, given):
            if len(x) > 1:
                raise RuntimeError("one at a time")
            return Plain.forward(self, x, given)
        self.assertEqual(broken(Plain, forward=raises)["forward is finite"],
                         "RuntimeError: one at a time")


LOCK = sys.stdout


@unittest.skipUnless(importlib.util.find_spec("torch"), "python3-torch is missing")
class Torch(unittest.TestCase):
    def problem(self):
        import torch
        times = torch.from_numpy(TIMES)

        class Decay(physinv.Problem, autodiff="torch"):
            start = [1.0, 0.5]
            sample = Plain.sample

            def forward(self, x, given):
                return x[:, :1] * torch.exp(-x[:, 1:] * given * times)
        return Decay

    def test_autodiff(self):
        decay = self.problem()
        self.assertEqual(wrong_with(decay), {})
        physinv.experiment("torch", n=8, iterations=30, updates=20,
                           hidden=(16,))(decay)
        p, s = physinv.problem("matrix/torch"), Full().sample(1, 5)
        np.testing.assert_allclose(p.jacobian(*s), Full().jacobian(*s),
                                   rtol=1e-12)
        a, b = (rows(run("^matrix/torch/(bfgs|jpo|hig|adam)/", out, "quick",
                         no_report=True)) for out in ("torch", "torch-again"))
        self.assertEqual({s["stop"] for s in a.values()}
                         - {"iterations", "converged"}, set())
        for name, s in a.items():
            one, two = (physinv.open(f"{WORK}/{out}").examples(
                s["case"], s["stage"]) for out in ("torch", "torch-again"))
            self.assertEqual(one["loss"].tobytes(), two["loss"].tobytes(), name)

    def test_what_is_no_tensor_has_words(self):
        kind = type("P", (self.problem(),),
                    dict(forward=lambda self, x, given: x.numpy()))
        with self.assertRaisesRegex(TypeError, "expected a tensor"):
            physinv.experiment("no-tensor")(kind)


@unittest.skipUnless(importlib.util.find_spec("jax"), "jax is missing")
class Jax(unittest.TestCase):
    def test_autodiff(self):
        import jax.numpy as jnp

        class Decay(physinv.Problem, autodiff="jax"):
            start = [1.0, 0.5]
            sample = Plain.sample

            def forward(self, x, given):
                return x[:, :1] * jnp.exp(-x[:, 1:] * given * TIMES)
        self.assertEqual(wrong_with(Decay), {})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
