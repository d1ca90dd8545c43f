#!/usr/bin/env python3
"""libraries_test.py PROGRAM SOURCES BUILD WORK COMPILER: the plug-in of other
libraries' solvers, built on the installed suite. Skipped where its packages are
missing: apt-packages.txt, [libraries].

Its methods keep the contracts and run on the suite's problems, next to the suite's own,
which have the same losses as in the suite's experiments; versions are recorded; verify
finds the same bits; libraries are in the plug-in, not in the program.
"""

import collections
import csv
import importlib.util
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import unittest

PROGRAM, SOURCES, BUILD, WORK, COMPILER = sys.argv[1:6]
HEADERS = ["ceres/gradient_problem_solver.h", "dlib/optimization.h",
           "gsl/gsl_multimin.h", "nlopt.h"]
RESULTS, PLUGIN = WORK + "/results", WORK + "/tree/libraries.so"
PROBLEMS, LANDSCAPES, METHODS, OURS = 5, 17, 10, {"BFGS", "L-BFGS-B"}
SETTINGS = 7  # of our BFGS, in the study


def run(*command, status=0):
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        cwd=WORK)
    if done.returncode != status:
        raise AssertionError(f"{command}: {done.returncode}\n{done.stdout}")
    return done.stdout


def bench(*arguments, plugin=True, **options):
    return run(PROGRAM, *arguments, *["--plugin=" + PLUGIN] * plugin, **options)


def stages(folder, landscapes=False):
    with open(folder + "/results.json") as f:
        return [s for s in json.load(f)["benchmarks"]
                if ("/landscape-" in s["name"]) == landscapes]


def said(stage, words):
    """On how many problems a library's message begins with one of these."""
    found = re.compile(rf"(\d+) x (?:{words})")
    ends = map(found.match, stage["physinv"]["message"].split("; "))
    return sum(int(end[1]) for end in ends if end)


def table(folder, experiment, name):
    with open(f"{folder}/report/{experiment}/tables/{name}.csv") as f:
        return list(csv.DictReader(f))


class Libraries(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        run("cmake", "--install", BUILD, "--prefix", WORK + "/prefix",
            "--component", "development")
        run("cmake", "-S", SOURCES + "/baselines/libraries", "-B",
            WORK + "/tree", "-G", "Ninja", "-D", "LIBRARIES_TESTS=ON",
            "-D", "CMAKE_CXX_COMPILER=" + COMPILER,
            "-D", "CMAKE_CXX_FLAGS=-Wall -Wextra -Wshadow -Werror",
            "-D", "CMAKE_CXX_FLAGS_RELEASE=-O1",  # the same bits, sooner
            "-D", "CMAKE_PREFIX_PATH=" + WORK + "/prefix",
            "-D", "CMAKE_CXX_COMPILER_LAUNCHER="
            + (shutil.which("ccache") or ""))
        run("ninja", "-C", WORK + "/tree")
        bench("--profile=smoke", "--filter=^libraries/", "--out=" + RESULTS)

    def test_solver(self):
        print(run(WORK + "/tree/library_solver_test").splitlines()[-1])

    def test_losses_of_our_own_are_the_suites(self):
        suite = WORK + "/suite"
        bench("--profile=smoke", "--no-report", "--out=" + suite,
              "--filter=^jpo/(billiards|wave-packet|robotic-arm|"
              "kuramoto-sivashinsky)/bfgs/n=4/",
              plugin=False)

        def ends(folder):
            return {s["name"].split("/", 1)[1]:
                    (s["loss_mean"], s["loss_median"], s["vjp"])
                    for s in stages(folder) if "/bfgs/" in s["name"]}
        found = ends(RESULTS)
        self.assertEqual(len(ends(suite)), 4)
        for name, end in ends(suite).items():
            self.assertEqual(found[name], end, name)

    def test_what_is_recorded(self):
        for method, library in (("gsl-bfgs2", "gsl 2."),
                                ("nlopt-lbfgs", "nlopt 2."),
                                ("nlopt-slsqp", "nlopt 2."),
                                ("nlopt-mma", "nlopt 2."),
                                ("ceres-bfgs", "ceres 2."),
                                ("ceres-lbfgs", "ceres 2."),
                                ("dlib-bfgs", "dlib 19."),
                                ("dlib-lbfgs", "dlib 19.")):
            found = [s["physinv"] for s in stages(RESULTS)
                     if f"/{method}/" in s["name"]]
            self.assertEqual(len(found), PROBLEMS, method)
            for stage in found:
                self.assertIn(stage["stop"], ("converged", "iterations"))
                self.assertIn(library, stage["options"]["library"])
                self.assertIn(" x ", stage["message"])

    def test_ends_are_counted(self):
        """As often as the libraries say it in their own words."""
        successes = collections.Counter()
        for s in stages(RESULTS):
            experiment, method = s["name"].split("/")[1:3]
            successes[experiment, method] += said(
                s, r"success$|SUCCESS|[FX]TOL_REACHED|CONVERGENCE|"
                "change of the loss below")
        for problem in sorted({p for p, _ in successes}):
            rows = {r["method"]: r for r in
                    table(RESULTS, "libraries-" + problem, "ends")}
            self.assertEqual(len(rows), METHODS)
            for method in set(rows) - OURS:
                self.assertEqual(int(rows[method]["claims success"]),
                                 successes[problem, method],
                                 (problem, method))
                self.assertLessEqual(int(rows[method]["gradient left"]),
                                     successes[problem, method])
        self.assertGreater(sum(successes.values()), 0)

    def test_success_by_the_change_of_the_loss_is_ftol(self):
        words = "FTOL_REACHED|CONVERGENCE, Function|change of the loss below"
        libraries = collections.Counter()
        for s in stages(RESULTS) + stages(RESULTS, landscapes=True):
            if "library" in s["physinv"]["options"]:
                ftol = s["physinv"]["statuses"]["ftol"]
                self.assertEqual(ftol, said(s, words), s["name"])
                libraries[s["name"].split("/")[2].split("-")[0]] += ftol
        for library in ("ceres", "dlib"):
            self.assertGreater(libraries[library], 0, library)
        self.assertEqual(libraries["gsl"], 0)

    def test_landscapes(self):
        """Whatever a library does on them is a result."""
        ends = collections.defaultdict(dict)
        for s in stages(RESULTS, landscapes=True):
            self.assertIn(s["physinv"]["stop"],
                          ("converged", "iterations", "diverged"))
            landscape, method = s["name"].split("/")[1:3]
            ends[landscape.removeprefix("landscape-")][method] = s
        self.assertEqual(len(ends), LANDSCAPES)
        valley = [s["loss_mean"] for s in ends["valley"].values()]
        self.assertEqual(len(valley), METHODS)
        self.assertLess(max(valley), 1e-2)
        for method, s in ends["exception"].items():
            self.assertEqual(s["physinv"]["message"],
                             "1 x the objective threw", method)
        for method, s in ends["one-evaluation"].items():
            self.assertEqual((s["vjp"], s["physinv"]["statuses"]["maxiter"]),
                             (1, 1), method)
        for method, s in ends["box"].items():
            self.assertAlmostEqual(s["loss_mean"], 0.25, 3, method)

    def test_the_study_has_the_numbers_of_tables_4_and_5(self):
        """Against our BFGS; of other libraries' it has a row each."""
        suite, study = WORK + "/tables", WORK + "/study"
        bench("--profile=smoke", "--out=" + suite,
              "--filter=^jpo/(billiards|robotic-arm)/(bfgs|jpo)/n=4/",
              plugin=False)
        bench("--profile=smoke", "--out=" + study, "--filter="
              "^studies/whose-bfgs-(billiards|robotic-arm)/")
        for problem in ("billiards", "robotic-arm"):
            rows = table(study, "studies-whose-bfgs-" + problem,
                         "whose-bfgs")
            self.assertEqual(len(rows), METHODS + SETTINGS)
            for row in rows:
                for stage in ("", "refined "):
                    better, equal, f = (float(row[stage + share + " [%]"])
                                        for share in ("better", "equal", "f"))
                    self.assertAlmostEqual(better + equal / 2, f)
            ours = rows[0]
            self.assertEqual(ours["against"], "bfgs")
            for name, stage in (("table4", ""), ("table5", "refined ")):
                paper = [r for r in table(suite, "jpo-" + problem, name)
                         if (r["equality"], r["method"]) == ("strict", "JPO")]
                for share in ("better [%]", "equal [%]"):
                    self.assertEqual(ours[stage + share], paper[0][share])

    def test_the_study_judges_the_main_statements(self):
        """Against the BFGS of each library, on all problems of Sec. 4."""
        claims = [line for line in bench("list", "--claims").splitlines()
                  if "| studies/whose-bfgs-" in line]
        self.assertEqual(len(claims), 5)
        for claim in claims:
            for library in ("SciPy", "GSL", "NLopt", "Ceres", "dlib", "R"):
                self.assertRegex(claim, rf"\b{library}\b")
        self.assertIn("valid", bench("list", "--validate"))

    def needs_scipy(self):
        if not all(map(importlib.util.find_spec, ("numpy", "scipy"))) or \
                not os.path.exists(BUILD + "/python/physinv"):
            self.skipTest("no SciPy, or the package physinv is not built")

    def with_scipy(self, *flags):
        run("env", f"PYTHONPATH={BUILD}/python", "PHYSINV_BENCH=" + PROGRAM,
            "OPENBLAS_CORETYPE=Haswell", sys.executable,
            SOURCES + "/baselines/libraries/scipy_solvers.py", PLUGIN, "smoke",
            *flags)

    def test_scipy_and_r_end_as_they_say(self):
        self.needs_scipy()
        out = WORK + "/scipy"
        self.with_scipy("out=" + out, "no_report=true",
                        "filter=^libraries/(billiards/r-[a-z]*|"
                        "(billiards|wave-packet|robotic-arm)/"
                        "(bfgs|scipy-[a-z]*))/")
        ends = {tuple(s["name"].split("/")[1:3]): s for s in stages(out)}
        self.assertEqual(len([m for _, m in ends if "r-" not in m]), 3 * 5)
        for (problem, method), s in ends.items():
            ftol = s["physinv"]["statuses"]["ftol"]
            if method == "r-bfgs":  # it tests nothing else and says nothing
                self.assertGreater(ftol, 0)
            elif method != "bfgs":
                self.assertEqual(
                    ftol, said(s, r"CONVERGENCE: REL|Converged \(\|f|"
                               "relative conv|both X|absolute function"),
                    (problem, method))
        for problem in ("billiards", "wave-packet", "robotic-arm"):
            ours, theirs = ends[problem, "bfgs"], ends[problem, "scipy-bfgs"]
            self.assertAlmostEqual(
                theirs["loss_mean"] / max(ours["loss_mean"], 1e-12),
                ours["loss_mean"] / max(ours["loss_mean"], 1e-12), 6)
            self.assertIn("scipy",
                          theirs["physinv"]["options"]["libraries"])

    def test_the_page_has_what_landscapes_show(self):
        """With these versions, on x86-64: kernels of other processors round
        differently."""
        self.needs_scipy()
        if platform.machine() != "x86_64":
            self.skipTest("the page is of x86-64")
        out = WORK + "/landscapes"
        self.with_scipy("out=" + out, "filter=^libraries/landscape-")
        page = SOURCES + "/docs/solvers.md"
        table = [SOURCES + "/baselines/libraries/landscapes_table.py", out, page]
        if "other versions" in (said := run(sys.executable, *table)):
            self.skipTest(said)

    def test_the_same_bits(self):
        self.assertIn("0 mismatches", bench("verify", RESULTS))

    def test_contracts(self):
        # Of Navier-Stokes, whose solvers are these, they take 15 s. Landscapes
        # have no solutions to draw, and gradients that are wrong.
        said = bench("conformance", *("libraries/" + p for p in (
            "billiards", "wave-packet", "robotic-arm",
            "kuramoto-sivashinsky")))
        self.assertIn("gsl-bfgs2", said)
        self.assertIn(" 0 failed", said)

    def test_licence(self):
        linked, program = run("ldd", PLUGIN), run("ldd", PROGRAM)
        for library in ("libgsl.", "libgslcblas.", "libnlopt.", "libceres."):
            self.assertIn(library, linked)
            self.assertNotIn(library, program)


if __name__ == "__main__":
    missing = [h for h in HEADERS if not os.path.exists("/usr/include/" + h)]
    if missing:
        print(f"skipped: there is no {', '.join(missing)} (apt-packages.txt, "
              "[libraries])")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
