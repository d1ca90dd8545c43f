"""Results of two processors are one campaign: smoke billiards by two programs.

    mixed_test.py PROGRAM OTHER

Each is a program over billiards (physinv-billiards), one of x86-64 and one of
aarch64, or a script that runs such a program (by qemu-aarch64-static). Shards of
both merge and pass `verify`; what one was killed in, the other ends, to the same
bits; each reports and compares what both made."""

import glob
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

PROGRAMS = [os.path.abspath(p) for p in sys.argv[1:3]]
RUN = ["run", "--profile=smoke", "--filter=billiards", "--trace", "--jobs=1"]




def run(program, *args, cwd):
    done = subprocess.run(
        [program, *args], cwd=cwd, text=True, capture_output=True,
        timeout=600, env={**os.environ, "PHYSINV_NO_REPORT": "1"})
    assert done.returncode == 0, (program, args, done.stdout, done.stderr)
    assert not done.stderr, (program, args, done.stderr)
    return done.stdout


def json_of(*path):
    with open(os.path.join(*path)) as f:
        return json.load(f)


def plan(d, out):
    return {k: json_of(d, out, "plan.json")[k]
            for k in ("fingerprint", "cases", "recipes", "keys")}


def tables(d, out):
    """What a baseline says of each stage but its times."""
    run(PROGRAMS[0], "baseline", out, "--out=" + out + ".txt", cwd=d)
    with open(os.path.join(d, out + ".txt")) as f:
        return [w.split(" ms=")[0] for w in f if w.startswith("jpo/")]


def whole(d):
    """The same keys and the same bits from each."""
    for name, program in zip(("a", "b"), PROGRAMS):
        run(program, *RUN, "--out=" + name, cwd=d)
    assert plan(d, "a") == plan(d, "b"), "keys of the two differ"
    assert tables(d, "a") == tables(d, "b"), "bits of the two differ"


def shards(d):
    for k, program in enumerate(PROGRAMS):
        run(program, *RUN, f"--shard={k + 1}/2", f"--out=s{k}", cwd=d)
    for program in PROGRAMS:
        out = f"m{PROGRAMS.index(program)}"
        run(program, "merge", out, "s0", "s1", cwd=d)
        for reader in PROGRAMS:
            run(reader, "verify", out, cwd=d)
            run(reader, "report", out, cwd=d)
            run(reader, "compare", "a", out, cwd=d)
        assert tables(d, out) == tables(d, "a"), "bits of a merged campaign"


def killed(program, out, d):
    """Kills it once a stage has saved its state."""
    process = subprocess.Popen(
        [program, *RUN, "--checkpoint=0.001", "--out=" + out], cwd=d,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        start_new_session=True)
    states = os.path.join(d, out, "checkpoints", "*")
    end = time.time() + 120
    while time.time() < end and process.poll() is None:
        if any(not p.endswith(".tmp") for p in glob.glob(states)):
            break
        time.sleep(0.001)
    begun = process.poll() is None
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
    process.wait()
    return begun and any(not p.endswith(".tmp") for p in glob.glob(states))


def handed_over(d):
    for k, (first, second) in enumerate((PROGRAMS, PROGRAMS[::-1])):
        tries = (f"k{k}-{n}" for n in range(20))
        out = next((t for t in tries if killed(first, t, d)), None)
        assert out, "no stage was killed in its middle"
        said = run(second, *RUN, "--checkpoint=0.001", "--out=" + out, cwd=d)
        assert "resuming " in said and "cannot resume" not in said, said
        run(first, "verify", out, cwd=d)
        assert tables(d, out) == tables(d, "a"), "bits of what two ended"


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as directory:
        for test in whole, shards, handed_over:
            test(directory)
            print("ok", test.__name__, flush=True)
