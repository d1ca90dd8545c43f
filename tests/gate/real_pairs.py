"""Gates of a program against itself by the clock: nothing may be slower or
faster. Not a test of CI: real clocks, minutes.

    python3 tests/gate/real_pairs.py build/release/physinv-bench [GATES] [FLAGS]

FLAGS are of `gate`; by default six cases of jpo and na of the
smoke profile, 20 seconds each gate."""

import json
import os
import statistics
import subprocess
import sys
import tempfile

DEFAULT = ["--filter=jpo/(billiards|robotic-arm|wave-packet)/(jpo|na)/n=4",
           "--budget=20"]


def main():
    bench = os.path.abspath(sys.argv[1])
    gates = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    flags = sys.argv[3:] or DEFAULT
    alarms, verdicts, noise = 0, {}, []
    with tempfile.TemporaryDirectory() as d:
        for i in range(gates):
            subprocess.run([bench, "gate", f"--against={bench}", *flags,
                            f"--seed={i + 1}", f"--out={d}", "--json=g.json"],
                           cwd=d, stdout=subprocess.DEVNULL, check=False)
            with open(os.path.join(d, "g.json")) as f:
                found = json.load(f)["findings"]
            moved = [f for f in found if f["verdict"] in ("slower", "faster")]
            alarms += bool(moved)
            for f in found:
                verdicts[f["verdict"]] = verdicts.get(f["verdict"], 0) + 1
                if "interval" in f["numbers"]:
                    low, high = f["numbers"]["interval"]
                    noise.append(high - low)
            print(f"gate {i + 1}: " + ("; ".join(
                f"{f['name']} {f['verdict']}: {f['why']}" for f in moved)
                or "no alarm"), flush=True)
    print(f"{alarms} of {gates} gates with an alarm; verdicts {verdicts}")
    if noise:
        print(f"median width of an interval {100 * statistics.median(noise):.1f}"
              f" %, of {len(noise)}")
    sys.exit(bool(alarms))


main()
