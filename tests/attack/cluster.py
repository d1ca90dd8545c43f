"""Programs of a cluster that hang, refuse, or answer what they like."""

import itertools
import os

import sandbox
import stores

ENDLESS = "while :; do echo 4711 1 RUNNING; done"
ANSWERS = {
    "23 digits": "echo 4711 99999999999999999999999 RUNNING",
    "hangs": "sleep 1000", "ignores signals": "trap '' TERM INT; sleep 1000",
    "without end": ENDLESS, "without a line's end": "cat /dev/zero",
    "garbage": "head -c 100000 /dev/urandom", "nothing": ":",
    "exit 1": "echo no cluster >&2; exit 1", "killed": "kill -9 $$",
    "errors without end": "while :; do echo no >&2; done",
    "negative": "echo 4711 -1 RUNNING", "a list": "echo '4711 [0-1] PENDING'",
    "no words": "echo; echo; echo 4711", "a long line":
    "head -c 3000000 /dev/zero | tr '\\0' 1", "escape": "printf '\\033[2J\\n'",
    "closes and stays": "exec >&- 2>&-; sleep 1000",
    "a child keeps the pipe": "sleep 1000 & echo 4711",
}
# A refused merge: the second call alone fails.
SECOND = ("if [ -e {mark} ]; then echo full >&2; exit 1; fi; "
          ": > {mark}; echo 4711")
CALLS = [("squeue", ["status", "cluster"]),
         ("squeue", ["submit", "--slurm=cluster", *stores.SMALL,
                     "--tasks=2"]),
         ("sbatch", ["submit", "--slurm=cluster", *stores.SMALL,
                     "--tasks=2"])]
ALL = list(itertools.product(CALLS, ANSWERS))
# Seconds that a program of the cluster may take; a submission asks three.
PATIENCE = {**stores.CACHE, "PHYSINV_SLURM_SECONDS": "1"}


def cluster(attempt):
    world = attempt.world
    attempt.hits = 1
    try:
        if attempt.seed % len(ALL) == len(ALL) - 1:
            merge_refused(attempt)
        else:
            answered(attempt)
    finally:
        world.fake("sbatch", stores.SBATCH)
        world.fake("squeue", stores.SQUEUE)


def answered(attempt):
    (name, arguments), answer = ALL[attempt.seed * 7 % len(ALL)]
    attempt.take("cluster", "cache")
    attempt.world.fake(name, ANSWERS[answer])
    attempt.note(f"{name}: {answer}")
    before = sandbox.snapshot(attempt.path("cluster"))
    ended = attempt.run(*arguments, env=PATIENCE)
    attempt.expect(ended.code in (0, 9, 10), f"{name} {answer}: {ended.code}")
    if name == "sbatch" and ended.code == 0:
        attempt.expect(answer in ("23 digits", "negative", "a list",
                                  "a child keeps the pipe", "no words"),
                       f"taken for the id of a job: {answer}")
    gone = [x for x in sandbox.differences(before, sandbox.snapshot(
        attempt.path("cluster"))) if "is gone" in x]
    attempt.expect(not gone, f"lost {gone}")


def merge_refused(attempt):
    """The array is in the queue; the same command does not submit it again."""
    attempt.take("cache")
    log = attempt.path("log")
    attempt.world.fake("sbatch", f'echo "$@" >> {log}; ' + SECOND.format(
        mark=attempt.path("mark")))
    submit = CALLS[2][1]
    ended = attempt.run(*submit, env=PATIENCE)
    attempt.expect(ended.code == 9, f"a refused merge: {ended.code}")
    os.remove(attempt.path("mark"))
    attempt.world.fake("sbatch", f'echo "$@" >> {log}; echo 4712')
    attempt.world.fake("squeue", "echo 4711 0 PENDING; echo 4711 1 PENDING")
    attempt.run(*submit, env=PATIENCE)
    arrays = sandbox.read(log).decode().count("--array=")
    attempt.expect(arrays == 1, f"the array was submitted {arrays} times")
