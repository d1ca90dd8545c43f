#!/usr/bin/env python3
"""method_test.py WORK: methods written in Python, as cases of a campaign:
recorded, reused, verified, reported; what fails, fails alone."""

import functools
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is missing")
    sys.exit(77)

import physinv
import source_file

WORK = sys.argv[1]
define = functools.partial(source_file.define, WORK + "/methods.py")
WORK_FILE = sys.stdout
FILTER = "^jpo/robotic-arm/(bfgs|py-.*)/"
METHODS = '''
import physinv

@physinv.method("py-momentum", experiments="jpo/robotic-*", iterations=RATE)
def momentum(run):
    assert not hasattr(run, "x") and run.observations.shape == (run.n, 2)
    x, v, rounds = run.start, 0, 0
    while run.proceed(x):
        loss, gradient = run.loss_and_gradient(x)
        v = 0.9 * v - 0.05 * gradient
        x = x + v
    return x

@physinv.method("py-fails", experiments="jpo/robotic-*")
def fails(run):
    raise ArithmeticError("not today")

@physinv.method("py-silent", experiments="jpo/robotic-*")
def silent(run):
    return run.start

@physinv.method("py-single", experiments="jpo/robotic-*", iterations=3)
def single(run):
    x = run.start
    for i in range(run.n):
        for k in range(run.iterations + 1):
            loss, gradient = run.loss_and_gradient(x[i:i + 1], [i])
            run.accept(i, k, x[i], loss[0])
            if k < run.iterations:
                x[i] -= 0.1 * gradient[0]
    return x, {"status": ["gtol"] * run.n, "iterations": [7] * run.n,
               "arrays": {"own": range(run.n)}, "message": "four are done"}
'''

KINDS = '''
import ctypes
import numpy as np
import physinv

def libm():
    return ctypes.CDLL("libm.so.6")

def descend(run):
    x = run.start
    while run.proceed(x):
        x = x - 0.05 * run.loss_and_gradient(x)[1]
    return x

@physinv.method("kind-b", experiments="jpo/robotic-arm", iterations=20)
def upward(run):
    assert libm().fesetround(0x800) == 0  # FE_UPWARD
    return descend(run)

# One of them runs after it, whichever the order.
@physinv.method("kind-a", experiments="jpo/robotic-arm", iterations=20)
@physinv.method("kind-k", experiments="jpo/robotic-arm", iterations=20)
def nearest(run):
    assert libm().fegetround() == 0
    return descend(run)

def refused(call):
    try:
        call()
    except TypeError as error:
        assert "complex" in str(error) or "masked" in str(error), error
    else:
        raise AssertionError("taken")

@physinv.method("kind-c", experiments="jpo/robotic-arm", iterations=2)
def kinds(run):
    x = run.start
    for bad in (x + 1j, np.ma.masked_array(x, x > 9), (x + 1j).tolist()):
        refused(lambda: run.loss(bad))
        refused(lambda: run.loss_and_gradient(bad))
        refused(lambda: run.proceed(bad))
        refused(lambda: run.accept(0, 0, bad[0], 0.5))
    refused(lambda: run.accept(0, 0, x[0], np.complex128(1 + 1j)))
    y = x + np.arange(run.n)[:, None]
    mask = np.arange(run.n) != 1
    assert (run.loss(y[mask], mask) == run.loss(y)[mask]).all()
    assert run.loss(y[:0], []).shape == (0,)
    for bad in ([True], [0.5], 1, "0"):
        try:
            run.loss(x[:1], bad)
        except TypeError:
            continue
        raise AssertionError(bad)
    return descend(run)

@physinv.method("kind-d", experiments="jpo/robotic-arm", iterations=2)
def returned(run):
    return descend(run) + 1j

@physinv.method("kind-e", experiments="jpo/robotic-arm", iterations=2)
def masked(run):
    return np.ma.masked_array(descend(run), True)

@physinv.method("kind-f", experiments="jpo/robotic-arm", iterations=2)
def counts(run):
    return descend(run), {"iterations": np.ones(run.n) * 1j}

@physinv.method("kind-g", experiments="jpo/robotic-arm", iterations=2)
def nothing(run):
    descend(run)

@physinv.method("kind-h", experiments="jpo/robotic-arm", iterations=2)
def odd(run):
    raise ValueError("caf\\u00e9 \\udcff and \\0 end")

@physinv.method("kind-i", experiments="jpo/robotic-arm", iterations=2)
def wordless(run):
    class Odd(Exception):
        def __str__(self):
            raise KeyError
    raise Odd

@physinv.method("kind-j", experiments="jpo/robotic-arm", iterations=2)
def single(run):
    run.loss(run.start[0], [0])
'''

KILLED = '''
import os, sys, time
import physinv

def stay(run, seconds):
    x = run.start
    while run.proceed(x):
        time.sleep(seconds)
    return x

@physinv.method("py-first", experiments="jpo/robotic-arm", iterations=1)
def first(run):
    return stay(run, 0)

@physinv.method("py-last", experiments="jpo/robotic-arm", iterations=1)
def last(run):
    return stay(run, 60 * os.path.exists(sys.argv[1] + ".stays"))

physinv.run("smoke", filter="^jpo/robotic-arm/py-(first|last)/", jobs=2,
            out=sys.argv[1])
'''


def keep(run):
    """Stays where it starts."""
    while run.proceed(run.start):
        pass
    return run.start


def run(**flags):
    with_failure = None
    try:
        results = physinv.run("smoke", filter=FILTER, out=WORK + "/smoke",
                              jobs=2, **flags)
    except physinv.ProgramError as error:
        if error.status != 4:
            raise
        with_failure = error
        results = physinv.open(WORK + "/smoke")
    return {r["method"]: r for r in results.stages()}, results, with_failure


class Methods(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        define(METHODS.replace("RATE", "60"))
        cls.rows, cls.results, cls.error = run()

    def test_cases_like_any_other(self):
        row = self.rows["py-momentum"]
        self.assertEqual(row["case"], "jpo/robotic-arm/py-momentum/n=4/seed=0")
        self.assertEqual((row["stop"], row["iterations"]), ("iterations", 60))
        c = self.results.curve(row["case"])
        self.assertEqual(c["iteration"][0], 0)
        self.assertEqual(c["iteration"][-1], 60)
        self.assertLess(c["loss"][-1].sum(), 0.1 * c["loss"][0].sum())
        # The same again by hand.
        p = physinv.problem("jpo/robotic-arm")
        s = p.sample(seed=0, n=4)
        x, v = np.repeat(p.start[None], 4, 0), 0
        for _ in range(60):
            y, tape = p.linearize(x)
            v = 0.9 * v - 0.05 * tape.pullback(p.loss_gradient(y, s.y))
            x = x + v
        self.assertTrue(np.array_equal(
            self.results.examples(row["case"])["x"], x))
        # Of a method that returns x alone the counts are those of the suite.
        e = self.results.examples(row["case"])
        self.assertEqual(list(e["iterations"]), [60] * 4)
        self.assertEqual(list(e["evaluations"]), [60] * 4)
        self.assertEqual(e["evaluations"].sum(), c["evaluations"][-1])

    def kinds(self):
        out = WORK + "/kinds"
        if not os.path.isdir(out):
            define(KINDS)
            with self.assertRaises(physinv.ProgramError):
                physinv.run("smoke", filter="^jpo/robotic-arm/kind-", out=out,
                            jobs=1, no_report=True)
        results = physinv.open(out)
        return results, {s["method"][-1]: s for s in results.stages()}

    def test_no_part_of_a_number_is_dropped(self):
        _, rows = self.kinds()
        self.assertEqual(rows["c"]["message"], "")
        for method, words in (("d", "x is complex; expected real numbers"),
                              ("e", "x is a masked array"),
                              ("f", "iterations is complex"),
                              ("g", "returned None"),
                              ("j", "x[None], (1, 4)")):
            self.assertIn(words, rows[method]["message"])
            self.assertEqual(rows[method]["stop"], "failed")

    def test_messages_keep_what_no_text_has(self):
        _, rows = self.kinds()
        self.assertEqual(rows["h"]["message"],
                         "ValueError: caf\u00e9 \\udcff and \\x00 end")
        self.assertEqual(rows["i"]["message"],
                         "Odd without a readable message")

    def test_rounding_is_of_one_stage_alone(self):
        results, rows = self.kinds()
        self.assertEqual([rows[k]["message"] for k in "abk"], [""] * 3)
        first, then = (results.examples(rows[k]["case"]) for k in "ak")
        self.assertTrue(np.array_equal(first["loss"], then["loss"]))
        self.assertTrue(np.array_equal(first["x"], then["x"]))
        # What the suite computes for a method is rounded to nearest anyway.
        p = physinv.problem("jpo/robotic-arm")
        upward = results.examples(rows["b"]["case"])
        self.assertTrue(np.array_equal(
            p.loss(p.forward(upward["x"]), upward["problem"]["y"]),
            upward["loss"]))

    def test_examples_may_go_one_by_one(self):
        row = self.rows["py-single"]
        self.assertEqual((row["stop"], row["iterations"]), ("converged", 3))
        e = self.results.examples(row["case"])
        self.assertEqual(e["status"], ["gtol"] * 4)
        # As they were accepted and asked for; what it says is stored next to them.
        self.assertEqual(list(e["iterations"]), [3] * 4)
        self.assertEqual(list(e["evaluations"]), [4] * 4)
        self.assertEqual(list(e["arrays"]["claimed_iterations"]), [7] * 4)
        self.assertEqual(list(e["arrays"]["own"]), [0, 1, 2, 3])
        self.assertEqual(row["message"], "four are done")
        c = self.results.curve(row["case"])
        self.assertTrue(np.array_equal(c["loss"][-1], e["loss"]))

    def test_what_fails_fails_alone(self):
        self.assertEqual(self.error.status, 4)
        self.assertEqual(self.rows["py-fails"]["stop"], "failed")
        self.assertEqual(self.rows["py-fails"]["message"],
                         "ArithmeticError: not today")
        self.assertIsNone(self.rows["py-fails"]["seconds"])
        self.assertIn("neither run.proceed", self.rows["py-silent"]["message"])
        self.assertEqual(self.rows["bfgs"]["stop"], "converged")

    def test_the_program_verifies_and_reports_them(self):
        program = physinv.program()
        done = subprocess.run([program, "verify", WORK + "/smoke"],
                              capture_output=True, text=True)
        self.assertIn(" 0 mismatches", done.stdout + done.stderr)
        subprocess.run([program, "report", WORK + "/smoke"],
                       capture_output=True)
        with open(WORK + "/smoke/report/report.md") as f:
            self.assertIn("py-momentum", f.read())

    def test_report_pages_have_it(self):
        with self.assertRaises(physinv.ProgramError) as e:
            physinv.verb("report", WORK + "/smoke")
        self.assertEqual(e.exception.status, 10)  # as two of them failed
        pages = WORK + "/smoke/report/jpo-robotic-arm/"
        self.assertIn("py-momentum", self.read(pages, "index.html"))
        rows = self.read(pages, "tables/results.csv")
        self.assertIn("py-momentum", rows)
        for name in ("figures/fig25c.svg", "figures/learning_curves.svg",
                     "figures/run_time_against_loss.svg",
                     "figures/performance_profile.svg"):
            self.assertIn("py-momentum", self.read(pages, name))

    @staticmethod
    def read(*path):
        with open(os.path.join(*path)) as f:
            return f.read()

    def test_gate_and_compare(self):
        base, line = WORK + "/baseline.txt", "^jpo/robotic-arm/(bfgs|py-momentum)/"
        flags = dict(filter=line, jobs=1, trace=True, no_report=True)
        first, again, other = (WORK + "/" + name for name in ("a", "b", "c"))
        physinv.run("smoke", out=first, **flags)
        self.assertIn("2 stages", physinv.verb("baseline", first, out=base))
        self.assertIn("robotic-arm/py-momentum/", self.read(base))
        physinv.run("smoke", out=again, **flags)
        held = dict(baseline=base, no_count=True)
        self.assertIn("accuracy: 2 same",
                      physinv.verb("gate", results=again, **held))
        self.assertIn("accuracy: 2 same",
                      physinv.verb("gate", out=WORK + "/gate", **held))
        rows = physinv.compare(first, again)["rows"]
        self.assertEqual({r["method"]: r["sides"][1]["same_bits"] for r in rows},
                         {"bfgs": 1, "py-momentum": 1})
        # A program without the method leaves nothing out in silence.
        done = subprocess.run([physinv.program(), "baseline", first,
                               "--out=" + WORK + "/none.txt"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("does not have jpo/robotic-arm/py-momentum/", done.stderr)
        try:
            define(METHODS.replace("RATE", "60").replace("0.05 *", "1e-4 *"))
            physinv.run("smoke", out=other, **flags)
            with self.assertRaisesRegex(physinv.ProgramError, "worse") as e:
                physinv.verb("gate", results=other, **held)
            self.assertEqual(e.exception.status, 5)
            with self.assertRaises(physinv.ProgramError) as e:
                physinv.compare(first, other, fail_on="loss")
            self.assertEqual(e.exception.status, 5)
            json.loads(e.exception.output)
        finally:
            define(METHODS.replace("RATE", "60"))

    def test_many_methods_are_as_many_cases(self):
        for k in range(40):
            physinv.method(f"many-{k}", experiments="jpo/billiards")(keep)
        listed = physinv.verb("list", filter="^jpo/billiards/many-",
                              profile="smoke").splitlines()
        cases = [line.split()[0] for line in listed
                 if line.startswith("jpo/billiards/many-")]
        self.assertEqual(len(cases), 40 * 5)  # n = 4, and 128 with four seeds
        self.assertEqual(len(set(cases)), len(cases))

    def test_a_run_that_ended_shows_nothing(self):
        kept = []

        @physinv.method("keeps", experiments="jpo/robotic-arm")
        def keeps(run):
            print(kept and kept[0].n)
            kept.append(run)
            raise ArithmeticError("not today")

        out = WORK + "/kept"
        with self.assertRaises(physinv.ProgramError):
            physinv.run("smoke", filter="^jpo/robotic-arm/keeps/", out=out,
                        seeds="0,1", jobs=1, no_report=True)
        self.assertEqual([s["message"] for s in physinv.open(out).stages()],
                         ["ArithmeticError: not today",
                          "RuntimeError: this run has already ended"])

    def test_no_two_share_a_key(self):
        keys = [r["key"] for r in self.rows.values()]
        self.assertEqual(len(set(keys)), len(keys))

    def test_zz_an_edit_makes_it_stale(self):
        before = {m: r["key"] for m, r in self.rows.items()}
        again, _, _ = run()
        self.assertEqual({m: r["key"] for m, r in again.items()}, before)
        define("# moved\n" + METHODS.replace("RATE", "60"))
        again, _, _ = run()
        self.assertEqual({m: r["key"] for m, r in again.items()}, before)
        define(METHODS.replace("RATE", "60").replace("0.05 *", "0.04 *"))
        edited, _, _ = run()
        for method, row in edited.items():
            same = row["key"] == before[method]
            self.assertEqual(same, method != "py-momentum", method)

    def test_killed_and_taken_up_again(self):
        script, out = WORK + "/killed.py", WORK + "/killed"
        for path, text in ((script, KILLED), (out + ".stays", "")):
            with open(path, "w") as f:
                f.write(text)

        def start():
            return subprocess.Popen(
                [sys.executable, script, out], text=True, stdout=subprocess.PIPE,
                start_new_session=True)
        process = start()
        self.wait_for_a_stage(out)
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        os.remove(out + ".stays")
        again, _ = start().communicate()
        rows = physinv.open(out).stages()
        self.assertEqual({r["method"]: r["stop"] for r in rows},
                         {"py-first": "iterations", "py-last": "iterations"})
        self.assertIn("1 stages run, 1 reused", again)

    def wait_for_a_stage(self, out):
        for _ in range(300):
            try:
                if physinv.open(out).stages():
                    return
            except RuntimeError:
                pass  # nothing there yet
            time.sleep(0.1)
        self.fail("no stage finished")

    def test_errors_have_words(self):
        with self.assertRaisesRegex(ValueError, "already has a method bfgs"):
            physinv.method("bfgs", experiments="jpo/*")(lambda run: run.start)
        for name in ("py x", "Py", "", "a/b", "a\n", 3, None, "a" * 101):
            with self.assertRaisesRegex(ValueError, "name must have"):
                physinv.method(name, experiments="jpo/*")
        for budget in (0, -1, 1.5, "9", True, None, 10 ** 9 + 1, np.nan):
            with self.assertRaisesRegex(ValueError, "whole number from 1 to"):
                physinv.method("py-x", iterations=budget)
        for function in (None, "solve", 3):
            with self.assertRaisesRegex(ValueError, "which cannot be called"):
                physinv.method("py-x")(function)
        for function in (lambda: 0, lambda run, x: 0, lambda *, run: 0):
            with self.assertRaisesRegex(ValueError, "one argument, the run"):
                physinv.method("py-x")(function)
        for needs in (3, None, ["vjp", 3]):
            with self.assertRaisesRegex(ValueError, "such as 'vjp'"):
                physinv.method("py-x", needs=needs)
        with self.assertRaisesRegex(ValueError, "a pattern such as"):
            physinv.method("py-x", experiments=["jpo/*"])
        with self.assertRaisesRegex(ValueError, "has an option source"):
            physinv.method("py-x", source="mine")
        with self.assertRaisesRegex(TypeError, "the option v has no stable"):
            physinv.method("py-x", v=sys.stdout)(keep)
        with self.assertRaisesRegex(ValueError, "py-x cannot cover all .* <lambda> "
                                    "-> WORK_FILE .* cannot be followed"):
            physinv.method("py-x")(lambda run: WORK_FILE)
        with self.assertRaisesRegex(ValueError, "must be an identifier; 'a b'"):
            physinv.method("py-x", **{"a b": 1})
        self.assertNotIn("py-x", physinv.verb("list", profile="smoke"))
        with self.assertRaisesRegex(ValueError, "no experiment that matches"):
            physinv.method("py-x", experiments="none/*")(lambda run: run.start)
        with self.assertRaisesRegex(ValueError, "no experiment that matches"):
            physinv.method("py-x", "numerics/transport", ("vjp", "network"))(
                lambda run: run.start)
        with self.assertRaisesRegex(ValueError, "no capability 'gradients'"):
            physinv.method("py-x", needs="gradients")(lambda run: run.start)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
