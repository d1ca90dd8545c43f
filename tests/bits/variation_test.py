"""The smoke profile of two programs of the same sources: every trajectory, loss,
estimate and metric has the same bits. The second program is linked in another
order, with registers of 256 bits where the first has 512, and states other
caches to Eigen; it runs without the C library's variants for FMA and AVX2, in
two shards with two threads per case, of which the first is interrupted and
resumed, where the first ran with eight workers. What depends on all that is left out:
times, memory, and work that a whole register skips.

PROGRAM (with its campaign RESULTS), VARIED, BASELINE"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

OTHER = ("time", "second", "_ms", "bytes", "key", "finished", "revision",
         "clocks", "crowded", "skipped", "threads")


# Fewer than some processor of x86-64-v3 would have.
VARIANTS = "glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA,-FMA4"


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


def smoke(program, out, *flags, check=True):
    return subprocess.run(
        [program, "run", "--profile=smoke", "--trace", f"--out={out}", *flags],
        check=check, stdout=subprocess.DEVNULL,
        env=os.environ | {"GLIBC_TUNABLES": VARIANTS})


def in_parts(program, out):
    shards = [out.with_name(f"shard{i}") for i in (1, 2)]
    flags = ["--threads=2", "--jobs=2"]
    # Ends early, with its own status; the next command continues.
    smoke(program, shards[0], "--shard=1/2", "--time-budget=1", *flags,
          check=False)
    for i, shard in enumerate(shards, 1):
        smoke(program, shard, f"--shard={i}/2", *flags)
    subprocess.run([program, "merge", out, *shards], check=True,
                   stdout=subprocess.DEVNULL)


def read(out):
    results = json.loads((out / "results.json").read_text())
    return {b["name"]: dict(numbers(b)) for b in results["benchmarks"]}


def main():
    program, results, varied, baseline = sys.argv[1:]
    first = read(pathlib.Path(results))
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "varied"
        in_parts(varied, out)
        second = read(out)
        # The hashes of all arrays, too, which results.json does not have.
        subprocess.run([program, "gate", f"--baseline={baseline}",
                        f"--results={out}", "--no-count"], check=True,
                       stdout=subprocess.DEVNULL)
    assert first.keys() == second.keys() and len(first) > 100, len(first)
    hashes, wrong = 0, []
    for stage, ours in first.items():
        hashes += sum(name.endswith("trajectory") for name in ours)
        theirs = second[stage]
        wrong += [f"{stage}{name}: {ours.get(name)} and {theirs.get(name)}"
                  for name in ours.keys() | theirs.keys()
                  if ours.get(name) != theirs.get(name)]
    print(f"{len(first)} stages, {hashes} trajectories, {len(wrong)} differences")
    print("\n".join(wrong[:40]))
    assert hashes == len(first)
    sys.exit(bool(wrong))


main()
