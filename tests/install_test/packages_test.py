#!/usr/bin/env python3
"""packages_test.py BUILD WORK: the Debian packages that cpack makes of a build
tree, unpacked into a root of their own: what they depend on, a first result from
the program, and Python's package.
"""

import glob
import os
import shutil
import subprocess
import sys
import unittest

BUILD, WORK = sys.argv[1:3]
ROOT = WORK + "/root"


def run(*command, **options):
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        cwd=WORK, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: {done.returncode}\n{done.stdout}")
    return done.stdout


def field(package, name):
    return run("dpkg-deb", "-f", package, name).strip()


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(ROOT)
        run("cpack", "--config", BUILD + "/CPackConfig.cmake", "-B", WORK)
        cls.packages = {field(path, "Package"): path
                        for path in glob.glob(WORK + "/*.deb")}
        for path in cls.packages.values():
            run("dpkg-deb", "-x", path, ROOT)

    def test_program_gives_a_first_result(self):
        package = self.packages["physinv-bench"]
        needed = field(package, "Depends")
        for library in ("libc6", "libsleef3", "libre2"):
            self.assertIn(library, needed)
        for other in ("g++", "libfftw3", "openblas", "benchmark"):
            self.assertNotIn(other, needed)
        text = run(ROOT + "/usr/bin/physinv-bench", "run", "billiards",
                   "--profile=smoke", "--out=results")
        self.assertIn("results/report/index.html", text)
        self.assertTrue(os.path.exists(WORK + "/results/report/index.html"))

    def test_python_finds_package_and_program(self):
        if "python3-physinv" not in self.packages:
            self.skipTest("the build has no Python module")
        needed = field(self.packages["python3-physinv"], "Depends")
        self.assertIn("physinv-bench (= ", needed)
        self.assertIn("python3-numpy", needed)
        text = run(sys.executable, "-c", f"""
import site
site.addsitedir({ROOT + "/usr/lib/python3/dist-packages"!r})
import physinv
print(physinv.__file__)
print(physinv.problem("jpo/billiards").shape)
""")
        self.assertIn(ROOT + "/usr/lib/", text)


if __name__ == "__main__":
    if shutil.which("dpkg-deb") is None or shutil.which("cpack") is None:
        print("skipped: dpkg-deb and cpack make and read packages")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
