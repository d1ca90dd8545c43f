"""What pip installs: the package with its module and programs, which CMake
builds in the checkout around it.

The build tree is that of ./bench for Debian's Python, one of its own for
another, or what PHYSINV_BUILD names. Nothing is written among the sources.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent.parent
TARGETS = ("physinv_python", "physinv-bench")
PACKAGES = "python3-dev python3-numpy pybind11-dev and those of ./bench"


def version():
    try:
        text = (ROOT / "CMakeLists.txt").read_text()
    except FileNotFoundError:
        sys.exit(f"{ROOT} is not a checkout of the suite; run 'pip install "
                 "./python' in one")
    return re.search(r"project\(physinv VERSION ([\d.]+)", text)[1]


def build_tree():
    named = os.environ.get("PHYSINV_BUILD")
    if named:
        return pathlib.Path(named).absolute()
    own = f"python-{sysconfig.get_config_var('SOABI')}"
    return ROOT / "build" / ("release" if sys.base_prefix == "/usr" else own)


def run(*command):
    if subprocess.run([str(word) for word in command]).returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} failed, see above; it needs "
                 f"Debian's {PACKAGES}")


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        if self.inplace or getattr(self, "editable_mode", False):
            sys.exit("the package has no editable installation; set "
                     f"PYTHONPATH={build_tree()}/python to follow its sources")
        tree = build_tree()
        if not (tree / "build.ninja").exists():
            run("cmake", "-S", ROOT, "--preset", "release", "-B", tree, "-D",
                "PHYSINV_TESTS=OFF", "-D", f"Python_EXECUTABLE={sys.executable}")
        run("cmake", "--build", tree, "--target", *TARGETS)
        module = pathlib.Path(self.get_ext_fullpath(ext.name))
        built = tree / "python/physinv" / module.name
        if not built.exists():
            sys.exit(f"{tree} is a build for another Python, without "
                     f"{module.name}; set PHYSINV_BUILD to an empty folder")
        module.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(built, module)
        run("cmake", "--install", tree, "--component", "programs", "--strip",
            "--prefix", module.parent)
        for program in (module.parent / "bin").iterdir():
            if program.name != "physinv-bench":  # for those who build the suite
                program.unlink()


SCRATCH = ROOT / "build/pip"
VERSION = version()
SCRATCH.mkdir(parents=True, exist_ok=True)
setup(version=VERSION,
      ext_modules=[Extension("physinv._core", sources=[])],
      cmdclass={"build_ext": CMakeBuild},
      options={"build": {"build_base": str(SCRATCH)},
               "egg_info": {"egg_base": str(SCRATCH)}})
