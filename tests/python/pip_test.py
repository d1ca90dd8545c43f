#!/usr/bin/env python3
"""pip_test.py WORK SOURCES BUILD: `pip install ./python --no-build-isolation`
into an environment of its own, without a network; what is installed needs nothing
else."""

import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import venv

for name in ("numpy", "pip", "setuptools", "wheel"):
    if importlib.util.find_spec(name) is None:
        print(f"skipped: python3-{name} is missing")
        sys.exit(77)

WORK, SOURCES, BUILD = sys.argv[1:4]
PYTHON = WORK + "/venv/bin/python"
USE = """
import physinv
p = physinv.problem("jpo/robotic-arm")
s = p.sample(n=3, labelled=True)
assert (p.forward(s.x) == s.y).all()
r = physinv.run("smoke", filter="^jpo/robotic-arm/bfgs/", out="results")
print(physinv.__file__, physinv.program(), len(r.stages()), len(r.plot("fig25a")))
"""


def run(*command, status=0, **environment):
    names = {key: value for key, value in os.environ.items()
             if not key.startswith(("PYTHON", "PHYSINV"))}
    done = subprocess.run(
        command, cwd=WORK, env=dict(names, **environment), text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode != status:
        raise AssertionError(f"{command}: {done.returncode}\n{done.stdout}")
    return done.stdout


def pip(*words, **more):
    return run(PYTHON, "-m", "pip", "install", "--no-index", "--no-deps",
               "--no-build-isolation", *words, PHYSINV_BUILD=BUILD, **more)


class Pip(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        venv.create(WORK + "/venv", system_site_packages=True)
        before = cls.sources()
        pip(SOURCES + "/python")
        cls.added = cls.sources() - before

    @staticmethod
    def sources():
        return {name for _, folders, files in os.walk(SOURCES + "/python")
                for name in (*folders, *files)}

    def test_it_is_used_from_anywhere(self):
        words = run(PYTHON, "-c", USE).split()
        site = os.path.realpath(WORK + "/venv/lib")
        self.assertTrue(os.path.realpath(words[-4]).startswith(site))
        self.assertTrue(os.path.realpath(words[-3]).startswith(site))
        self.assertEqual(words[-2], "1")

    def test_the_program_is_a_command(self):
        of_tree = run(BUILD + "/physinv-bench", "--version")
        self.assertEqual(run(WORK + "/venv/bin/physinv-bench", "--version"),
                         of_tree)
        site = run(PYTHON, "-c", "import physinv; print(physinv.__path__[0])")
        published = site.strip() + "/share/physinv/published"
        self.assertEqual(sorted(os.listdir(published)),
                         sorted(os.listdir(SOURCES + "/reports/published")))

    def test_types_go_along(self):
        out = run(PYTHON, "-m", "pip", "show", "-f", "physinv")
        for name in ("py.typed", "_core.pyi", "bin/physinv-bench"):
            self.assertIn("physinv/" + name, out)

    def test_components_stand_alone(self):
        # Apart, as a program is sought in the folders above the package, too.
        apart = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, apart)
        for component, there, absent in (
                ("programs", "bin/physinv-bench", "include"),
                ("development", "lib/cmake/physinv/physinv-config.cmake", "bin"),
                ("python", "lib/physinv/python/physinv/__init__.py", "bin")):
            prefix = f"{apart}/{component}"
            run("cmake", "--install", BUILD, "--component", component,
                "--prefix", prefix)
            self.assertTrue(os.path.exists(f"{prefix}/{there}"), there)
            self.assertFalse(os.path.exists(f"{prefix}/{absent}"), absent)
        out = run(sys.executable, "-c", "import physinv\n"
                  "print(physinv.problem('jpo/robotic-arm'))\n"
                  "try: print(physinv.program())\n"
                  "except FileNotFoundError as error: print(error)",
                  PYTHONPATH=apart + "/python/lib/physinv/python", PATH="/none")
        self.assertIn("<physinv problem jpo/robotic-arm", out)
        self.assertIn("set PHYSINV_BENCH", out)

    def test_sources_stay_as_they_were(self):
        self.assertEqual(self.added, set())

    def test_what_cannot_be_is_said(self):
        self.assertIn("PYTHONPATH=", pip("-e", SOURCES + "/python", status=1))
        shutil.copytree(SOURCES + "/python", WORK + "/apart/python")
        self.assertIn("is not a checkout of the suite",
                      pip(WORK + "/apart/python", status=1))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
