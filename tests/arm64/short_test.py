"""Tests of the elementary functions, random streams, a factorization and a
problem, cross-compiled for ARM and run by qemu-user, where a machine has the
packages of [arm64] and build/arm64-root (./check --arm64 makes it)."""

import pathlib
import shutil
import subprocess
import sys

root = pathlib.Path(sys.argv[1])
tree = root / "build/arm64"

for tool in ["aarch64-linux-gnu-g++", "qemu-aarch64-static"]:
    if not shutil.which(tool):
        print(f"skipped: there is no {tool} (apt-packages.txt, [arm64])")
        sys.exit(77)
if not (root / "build/arm64-root/.packages").exists():
    print("skipped: there is no build/arm64-root; ./check --arm64 makes it")
    sys.exit(77)

if not (tree / "build.ninja").exists():
    subprocess.run(["cmake", "-S", root, "--preset", "arm64"],
                   stdout=subprocess.DEVNULL, check=True)
subprocess.run(["ninja", "-C", tree, "arm64_short_test"], check=True)
sys.exit(subprocess.run(
    ["qemu-aarch64-static", "-L", root / "build/arm64-root",
     tree / "tests/arm64_short_test"]).returncode)
