"""What a start costs that runs nothing: little more than to say the version.

  start_test.py PROGRAM

What is registered is looked through by a test, and a start looks at the
experiments of the cases that it chooses.
"""

import resource
import subprocess
import sys

PROGRAM = sys.argv[1]
ROUNDS = 7


def cpu_seconds(*args):
    """Of the best of several rounds."""
    best = float("inf")
    for _ in range(ROUNDS):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([PROGRAM, *args], check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        best = min(best, after.ru_utime + after.ru_stime
                   - before.ru_utime - before.ru_stime)
    return best


LEAST = cpu_seconds("--version")
FAILED = []
for times, args in ((2.2, ["--benchmark_list_tests"]),
                    (1.5, ["--benchmark_list_tests", "--filter=sip/heat"])):
    seconds = cpu_seconds("run", *args)
    good = seconds <= times * LEAST
    print("ok  " if good else "FAIL",
          f"{' '.join(args)}: {1e3 * seconds:.1f} ms, "
          f"{seconds / LEAST:.2f} times --version ({1e3 * LEAST:.1f} ms)")
    if not good:
        FAILED.append(args)
sys.exit(bool(FAILED))
