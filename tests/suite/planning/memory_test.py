"""What plan says of memory, compared with the resident set of a separate run for
one case of each paper's experiment; and repeated plans agree."""

import json
import os
import subprocess
import sys
import tempfile

BENCH = os.path.realpath(sys.argv[1])
FAILED = []
FACTOR = 2
# Whatever is smaller may be given as twice this.
SMALL = 128e6


def bench(d, *args):
    return subprocess.run([BENCH, *args], cwd=d, text=True, timeout=120,
                          capture_output=True,
                          env={**os.environ, "XDG_CACHE_HOME": d})


def planned(d, *args):
    return json.loads(bench(d, "plan", "--json", *args).stdout)


def peak(d, number, *args):
    out = f"out{number}"
    p = bench(d, *args, "--out=" + out, "--jobs=1", "--no-report", "-q")
    with open(os.path.join(d, out, "results.json")) as f:
        stages = json.load(f)["benchmarks"]
    return p.returncode, max(s["physinv"]["rss_bytes"] for s in stages)


def beside(d, number, name, told, *args):
    with open(os.path.join(d, f"case{number}"), "w") as f:
        f.write(name + "\n")
    _, measured = peak(d, number, *args, f"--cases=case{number}")
    good = measured <= FACTOR * told and told <= FACTOR * max(measured, SMALL)
    print("ok  " if good else "FAIL", name,
          f"{told / 1e6:.0f} MB told, {measured / 1e6:.0f} MB measured",
          flush=True)
    if not good:
        FAILED.append(name)


def main():
    with tempfile.TemporaryDirectory() as d:
        largest = {}
        for case in planned(d, "--profile=smoke"):
            experiment = "/".join(case["name"].split("/")[:2])
            known = largest.get(experiment)
            if experiment.split("/")[0] in ("hig", "jpo", "sip") and (
                    known is None or
                    case["memory_bytes"] > known["memory_bytes"]):
                largest[experiment] = case
        for number, case in enumerate(largest.values()):
            beside(d, number, case["name"], case["memory_bytes"],
                   "--profile=smoke")
        # A U-net on batches of 128: gigabytes.
        name = "sip/poisson/adam/n=128/seed=0"
        flags = ["--profile=paper", "--filter=^sip/poisson/adam/",
                 "--set=iterations=1"]
        told = {c["name"]: c["memory_bytes"] for c in planned(d, *flags)}
        beside(d, "b", name, told[name], *flags)
        one, two = (planned(d, "--profile=paper", "--filter=^jpo/")
                    for _ in range(2))
        sums = [sum(c["seconds"] or 0 for c in all) for all in (one, two)]
        if not (0.7 < sums[0] / sums[1] < 1.45):
            FAILED.append(f"two plans agree: {sums}")
    sys.exit(f"failed: {FAILED}" if FAILED else 0)


main()
