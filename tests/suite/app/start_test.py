"""What a start costs that runs nothing: little more than to say the version.

  start_test.py PROGRAM

What is registered is looked through by a test, and a start looks at the
experiments of the cases that it chooses.
"""

import resource
import subprocess
import sys

PROGRAM = sys.argv[1]
ROUNDS = 15


def cpu_seconds(args):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([PROGRAM, *args], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


VERSION = ("--version",)
ALL = ("run", "--benchmark_list_tests")
ONE = ALL + ("--filter=sip/heat",)
# In turns, so that other work on the machine meets all of them.
rounds = [{args: cpu_seconds(args) for args in (VERSION, ALL, ONE)}
          for _ in range(ROUNDS)]
least = {args: min(r[args] for r in rounds) for args in rounds[0]}

failed = False
for times, args in ((2.2, ALL), (1.5, ONE)):
    ratio = least[args] / least[VERSION]
    good = ratio <= times
    failed = failed or not good
    print("ok  " if good else "FAIL",
          f"{' '.join(args)}: {1e3 * least[args]:.1f} ms, {ratio:.2f} times "
          f"--version ({1e3 * least[VERSION]:.1f} ms)")
sys.exit(failed)
