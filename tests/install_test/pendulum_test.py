#!/usr/bin/env python3
"""pendulum_test.py SOURCES BUILD WORK COMPILER: examples/pendulum on the
installed suite, as a stranger would have it: its own repository, a prefix that
moved, warnings that are errors. What an edit makes stale, report, verify, gate,
the contract tests, and what the stock program says of its results.
"""

import glob
import json
import os
import shutil
import subprocess
import sys
import unittest

SOURCES, BUILD, WORK, COMPILER = sys.argv[1:5]
PREFIX, PROJECT = WORK + "/moved", WORK + "/pendulum"
TREE, RESULTS = WORK + "/tree", WORK + "/results"
GIT = ["git", "-C", PROJECT, "-c", "user.name=a", "-c", "user.email=a@b.c"]


def run(*command, status=0):
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        cwd=WORK)
    if done.returncode != status:
        raise AssertionError(f"{command}: {done.returncode}\n{done.stdout}")
    return done.stdout


def pendulum(*arguments, status=0):
    return run(TREE + "/pendulum", *arguments, status=status)


def build(*targets, status=0):
    return run("ninja", "-C", TREE, *targets, status=status)


def edit(name, text="static_assert(true);\n"):
    with open(f"{PROJECT}/{name}", "a") as f:
        f.write(text)


class Pendulum(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        run("cmake", "--install", BUILD, "--prefix", WORK + "/prefix")
        os.rename(WORK + "/prefix", PREFIX)
        shutil.copytree(SOURCES + "/examples/pendulum", PROJECT)
        run("git", "init", "-q", PROJECT)
        run(*GIT, "add", ".")
        run(*GIT, "commit", "-q", "-m", "A pendulum")
        run("cmake", "-S", PROJECT, "-B", TREE, "-G", "Ninja",
            "-D", "CMAKE_CXX_COMPILER=" + COMPILER,
            "-D", "CMAKE_CXX_FLAGS=-Wall -Wextra -Werror",
            "-D", "CMAKE_CXX_FLAGS_RELEASE=-O1",  # the same bits, sooner
            "-D", "CMAKE_PREFIX_PATH=" + PREFIX)
        build("pendulum")

    def run_smoke(self):
        out = pendulum("--profile=smoke", "--out=" + RESULTS)
        line = next(s for s in out.splitlines() if " stages run, " in s)
        words = line.split()
        return int(words[0]), int(words[3])

    def test_1_records_whose_it_is(self):
        self.assertEqual(self.run_smoke(), (2, 0))
        head = run(*GIT, "rev-parse", "HEAD").strip()
        run(*GIT, "commit", "-q", "--allow-empty", "-m", "Not built")
        pendulum("--profile=smoke", "--out=" + WORK + "/later")
        for results in (RESULTS, WORK + "/later"):
            with open(results + "/results.json") as f:
                context = json.load(f)["context"]
            self.assertEqual(context["program"], "pendulum")
            self.assertEqual(context["git_revision"], head)
            self.assertFalse(context["git_dirty"])
        self.assertIn("pendulum, built on", pendulum("--version"))
        self.assertIn("pendulum list", pendulum("--help"))

    def test_2_an_edit_makes_its_stages_stale(self):
        self.assertEqual(self.run_smoke(), (0, 2))
        for name, stale in (("momentum.h", 1), ("pendulum.cpp", 2),
                            ("experiment.cpp", 0)):
            edit(name)
            if stale == 0:
                edit("momentum.h", "// edited\n")
            build("pendulum")
            self.assertEqual(self.run_smoke(), (stale, 2 - stale), name)
        with open(RESULTS + "/results.json") as f:
            self.assertTrue(json.load(f)["context"]["git_dirty"])

    def test_3_what_would_go_unseen_is_refused(self):
        edit("drift.cpp", "double drift() { return 1; }\n")
        lists = PROJECT + "/CMakeLists.txt"
        with open(lists) as f:
            before = f.read()
        for name, why in (("drift.cpp", "no stage depends on it"),
                          ("optimizers/bfgs.cpp", "already has a source")):
            os.makedirs(os.path.dirname(f"{PROJECT}/{name}"), exist_ok=True)
            edit(name, "")
            with open(lists, "w") as f:
                f.write(before.replace("pendulum.cpp", "pendulum.cpp " + name))
            if name == "drift.cpp":
                build("pendulum")
                self.assertIn(why, pendulum("--profile=smoke", status=2))
            else:
                self.assertIn(why, build("pendulum", status=1))
        with open(lists, "w") as f:
            f.write(before)
        build("pendulum")

    def test_4_report_verify_gate(self):
        quick, baseline = WORK + "/quick", WORK + "/baseline.txt"
        pendulum("--profile=quick", "--out=" + quick)
        self.assertIn("regression checks 1 reproduced",
                      pendulum("report", quick, "--check"))
        self.assertTrue(os.path.exists(quick + "/report/index.html"))
        self.assertIn("0 mismatches", pendulum("verify", quick))
        traced = WORK + "/traced"
        pendulum("--profile=smoke", "--trace", "--out=" + traced)
        pendulum("baseline", traced, "--out=" + baseline)
        self.assertIn("accuracy: 2 same",
                      pendulum("gate", "--baseline=" + baseline))

    def test_5_the_stock_program_says_what_it_cannot(self):
        bench = PREFIX + "/bin/physinv-bench"
        self.run_smoke()
        self.assertIn("does not have pendulum",
                      run(bench, "verify", RESULTS, status=10))
        self.assertIn("does not have pendulum",
                      run(bench, "report", RESULTS, status=3))

    def test_6_a_plug_in_does_the_same(self):
        bench, plugin = PREFIX + "/bin/physinv-bench", TREE + "/pendulum_plugin.so"
        build("pendulum_plugin")
        out = WORK + "/plugged"
        flags = ("--profile=smoke", "--filter=^pendulum/", "--out=" + out)
        run(bench, *flags, "--plugin=" + plugin)
        with open(out + "/results.json") as f:
            theirs = json.load(f)
        self.assertEqual(theirs["context"]["plugins"][0]["name"],
                         "pendulum_plugin")
        pendulum("--profile=smoke", "--out=" + RESULTS)
        with open(RESULTS + "/results.json") as f:
            ours = json.load(f)

        def numbers(results):
            return [(e["name"], e["loss_mean"], e["physinv"]["key"])
                    for e in results["benchmarks"]]
        self.assertEqual(numbers(theirs), numbers(ours))
        self.assertIn("8 bitwise equal",
                      run(bench, "verify", out, "--plugin=" + plugin))
        run(bench, "report", out, "--plugin", plugin)
        os.environ["PHYSINV_PLUGINS"] = plugin
        try:
            self.assertIn("pendulum/momentum",
                          run(bench, "list", "--profile=smoke"))
        finally:
            del os.environ["PHYSINV_PLUGINS"]

    def test_6_python_has_it(self):
        package = PREFIX + "/lib/physinv/python"
        if not os.path.isdir(package):
            self.skipTest("no Python package is built")
        use = WORK + "/use.py"
        with open(use, "w") as f:
            f.write("""
import sys, physinv
if sys.argv[1:]:
    physinv.load_plugin(sys.argv[1])
p = physinv.problem("pendulum")
s = p.sample(n=3, labelled=True)
y, tape = p.linearize(s.x, s.given)
assert (y == s.y).all() and tape.pullback(y).shape == (3, 3)
@physinv.method("still", experiments="pendulum", iterations=1)
def still(run):
    x = run.start
    while run.proceed(x): pass
    return x
r = physinv.run("smoke", filter="^pendulum/(momentum|still)/", out="python",
                no_report=True)
print([(s["method"], s["stop"]) for s in r.stages()])
try: physinv.load_plugin("none.so")
except ValueError as e: print(e)
""")
        plugin = TREE + "/pendulum_plugin.so"
        for words in ((plugin,), ()):
            out = run("env", "PYTHONPATH=" + package,
                      "PHYSINV_PLUGINS=" + (plugin if not words else ""),
                      "/usr/bin/python3", use, *words)
            self.assertIn("[('momentum', 'iterations'), ('still', "
                          "'iterations')]", out)
            self.assertIn("there is no plug-in", out)

    def test_7_what_is_no_plug_in_is_refused(self):
        bench, plugin = PREFIX + "/bin/physinv-bench", TREE + "/pendulum_plugin.so"

        def refused(file, why):
            out = run(bench, "list", "--profile=smoke", "--plugin=" + file,
                      status=2)
            self.assertEqual(out.count("\n"), 1)
            self.assertIn(why, out)
        refused(WORK + "/none.so", "there is no plug-in")
        refused(PREFIX + "/lib/libphysinv_core.a", "is not a plug-in")
        refused("", "--plugin= is empty")
        with open(plugin, "rb") as f:
            code = f.read()
        mark = b"physinv plug-in of build "
        at = code.index(mark) + len(mark)
        with open(WORK + "/older.so", "wb") as f:
            f.write(code[:at] + b"0" * 16 + code[at + 16:])
        refused(WORK + "/older.so", "was built with build 0000000000000000")
        shutil.copy(plugin, WORK + "/twice.so")
        os.environ["PHYSINV_PLUGINS"] = plugin
        try:
            refused(WORK + "/twice.so", "there are two plug-ins")
        finally:
            del os.environ["PHYSINV_PLUGINS"]

    def test_8_keeps_the_contracts(self):
        build("pendulum_contract_test")
        mine = run("ctest", "--test-dir", TREE, "--verbose")
        theirs = self.conformance()
        checks = [line for line in theirs.splitlines()
                  if line.startswith(("ok ", "skipped "))]
        self.assertGreater(len(checks), 25)
        for line in checks:
            self.assertIn(line, mine)
        for name in ("pendulum +ProblemContract.BatchesEqual",
                     "pendulum momentum +MethodContract.LowersAQuadratic"):
            self.assertRegex(theirs, "ok +" + name)
        self.assertEqual(pendulum("conformance"), run(
            TREE + "/pendulum_contract_test"))
        self.assertIn("nearest: pendulum", self.conformance("no", status=3))

    def test_8_a_build_that_stopped_has_no_contract_tests(self):
        stopped = WORK + "/stopped"
        shutil.copytree(PREFIX, stopped, symlinks=True)
        objects = glob.glob(stopped + "/lib/**/physinv_conformance/*.o",
                            recursive=True)
        self.assertEqual(len(objects), 1)
        os.remove(objects[0])
        out = run("cmake", "-S", PROJECT, "-B", WORK + "/none", "-G", "Ninja",
                  "-D", "CMAKE_CXX_COMPILER=" + COMPILER,
                  "-D", "CMAKE_PREFIX_PATH=" + stopped, status=1)
        self.assertIn("installed from a tree without contract tests",
                      " ".join(out.split()))
        shutil.rmtree(stopped)

    def conformance(self, *arguments, status=0):
        return run(PREFIX + "/bin/physinv-bench", "conformance", *arguments,
                   "--plugin=" + TREE + "/pendulum_plugin.so", status=status)

    def test_9_a_broken_contract_is_found(self):
        source = PROJECT + "/pendulum.cpp"
        with open(source) as f:
            before = f.read()
        for right, wrong, check in (
                ("std::fma(states(2 * k + 1, i)", "std::fma(-states(2 * k + 1, i)",
                 "PullbackAgreesWithCentralDifferences"),
                ("  const T force =",
                 "  static T seen = 0;\n  if (s.angle != s.angle) seen = s.angle;\n"
                 "  s.angle += seen;\n  const T force =",
                 "ADivergedSampleDisturbsNoOther")):
            self.assertIn(right, before)
            with open(source, "w") as f:
                f.write(before.replace(right, wrong))
            build("pendulum_plugin")
            out = self.conformance(status=4)
            self.assertRegex(out, r"FAILED +pendulum +ProblemContract\." + check)
            self.assertIn("problem_contract_test.cpp:", out)

    @unittest.skipUnless(os.environ.get("PHYSINV_FULL"), "more to compile")
    def test_91_who_has_no_smoke_profile_is_told(self):
        run(*GIT, "checkout", "-q", "pendulum.cpp")
        source = PROJECT + "/experiment.cpp"
        with open(source) as f:
            text = f.read()
        with open(source, "w") as f:
            f.write(text.replace('"smoke"', '"tiny"'))
        build("pendulum_plugin")
        self.assertIn("pendulum has no profile smoke",
                      self.conformance(status=2))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2, failfast=True)
