"""An unchanged program runs again and again: neither compare, whatever it is
asked to fail on, nor gate may see a change. Not a test of CI: real clocks,
minutes.

    python3 tests/gate/unchanged.py build/release/physinv-bench [RUNS] [BUSY]
        [FLAGS]

With BUSY neighbours that keep cores busy (default none); FLAGS are of `run`, by
default all methods of three experiments of jpo in the smoke profile."""

import json
import os
import subprocess
import sys
import tempfile

DEFAULT = ["--profile=smoke", "--filter=jpo/(billiards|robotic-arm|wave-packet)"]
ASPECTS = ("loss", "status", "claims", "work", "time", "missing")


def call(bench, *args, cwd):
    return subprocess.run([bench, *args], cwd=cwd, text=True,
                          capture_output=True, check=False)


def ratios_of(p):
    """Of times that count: raised to what is short."""
    worst = [r["against_first"][0]["worst"] for r in json.loads(p.stdout)["rows"]]
    return [w["raised_time_ratio"] for w in worst if w["raised_time_ratio"]]


def again(bench, d, flags, sides):
    """A run; what alarms, and the largest ratio of times."""
    done = call(bench, "run", *flags, "--trace", "--fresh", "--out=now", cwd=d)
    assert done.returncode == 0, done.stderr
    alarms, ratios = [], []
    for by in ("seed", "method"):
        p = call(bench, "compare", *sides, "--by=" + by, "--format=json",
                 *(f"--fail-on={a}" for a in ASPECTS), cwd=d)
        ratios += ratios_of(p)
        if p.returncode:
            alarms.append(f"compare --by={by} {p.returncode}: {p.stderr}")
    p = call(bench, "gate", "--baseline=base.txt", "--results=now", cwd=d)
    if p.returncode:
        alarms.append(f"gate {p.returncode}: {p.stderr}")
    return alarms, max(ratios)


def main():
    bench = os.path.abspath(sys.argv[1])
    runs = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    busy = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    flags = sys.argv[4:] or DEFAULT
    alarmed, most = 0, 0
    with tempfile.TemporaryDirectory() as d:
        call(bench, "run", *flags, "--trace", "--out=base", cwd=d)
        p = call(bench, "baseline", "base", "--out=base.txt", cwd=d)
        assert p.returncode == 0, p.stderr
        neighbours = [subprocess.Popen([sys.executable, "-c", "while True: pass"])
                      for _ in range(busy)]
        try:
            for i in range(runs):
                alarms, ratio = again(bench, d, flags, ("base", "now"))
                alarmed += bool(alarms)
                most = max(most, ratio)
                print(f"run {i + 1}: {'; '.join(alarms) or 'no alarm'}; times "
                      f"up to x{ratio:.2f}", flush=True)
        finally:
            for process in neighbours:
                process.kill()
    print(f"{alarmed} of {runs} runs with an alarm, {busy} busy neighbours; "
          f"times up to x{most:.2f}")
    sys.exit(bool(alarmed))


main()
