"""The smoke profile of two builds, for registers of 512 and of 256 bits: every
trajectory, loss, estimate and metric has the same bits. What hangs on the width
is left out: times, memory, and work that a whole register skips."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

OTHER = ("time", "second", "_ms", "bytes", "key", "finished", "revision",
         "clocks", "crowded", "skipped")


def numbers(value, name=""):
    if isinstance(value, dict):
        for key, item in value.items():
            if not any(word in key for word in OTHER):
                yield from numbers(item, f"{name}/{key}")
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from numbers(item, f"{name}/{i}")
    else:
        yield name, value


def run(program, out):
    subprocess.run(
        [program, "run", "--profile=smoke", "--trace", f"--out={out}",
         f"--jobs={os.cpu_count()}"],
        check=True, stdout=subprocess.DEVNULL)
    results = json.loads((out / "results.json").read_text())
    return {b["name"]: dict(numbers(b)) for b in results["benchmarks"]}


def main():
    with tempfile.TemporaryDirectory() as folder:
        wide, narrow = (run(program, pathlib.Path(folder) / str(i))
                        for i, program in enumerate(sys.argv[1:3]))
    assert wide.keys() == narrow.keys() and len(wide) > 100, len(wide)
    hashes, wrong = 0, []
    for stage, ours in wide.items():
        hashes += sum(name.endswith("trajectory") for name in ours)
        theirs = narrow[stage]
        wrong += [f"{stage}{name}: {ours.get(name)} and {theirs.get(name)}"
                  for name in ours.keys() | theirs.keys()
                  if ours.get(name) != theirs.get(name)]
    print(f"{len(wide)} stages, {hashes} trajectories, {len(wrong)} differences")
    print("\n".join(wrong[:40]))
    assert hashes == len(wide)
    sys.exit(bool(wrong))


main()
