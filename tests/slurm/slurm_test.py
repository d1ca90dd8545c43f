"""A campaign on a real Slurm of two nodes: merged results are those of one
machine, to the bit; a killed task, a node that goes down and a cancelled array
lose nothing. Exit 77 (skipped) without root or Slurm."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

BENCH = os.path.realpath(sys.argv[1])  # as the program names itself
HERE = os.path.dirname(os.path.abspath(__file__))
FAILED = []
# Some seconds a task: journals are written every two.
SELECTION = ["--profile=quick", "--filter=jpo/billiards/(jpo|na|supervised)/",
             "--set=seeds=0-4"]


def check(condition, what):
    print("ok  " if condition else "FAIL", what, flush=True)
    if not condition:
        FAILED.append(what)


def bench(*args, env=None):
    return subprocess.run([BENCH, *args], text=True, capture_output=True,
                          timeout=120, env=env)


def slurm(*args):
    return subprocess.run(args, text=True, capture_output=True,
                          timeout=60).stdout.strip()


def wait_for(what, done, seconds=60):
    end = time.time() + seconds
    while time.time() < end:
        if done():
            return True
        time.sleep(0.1)
    check(False, f"{what} within {seconds} s")
    return False


def numbers(directory):
    """results.json without what may differ between runs."""
    with open(os.path.join(directory, "results.json")) as f:
        entries = json.load(f)["benchmarks"]
    for e in entries:
        for key in ("real_time", "cpu_time", "family_index", "threads"):
            e.pop(key, None)
        for key in ("setup_ms", "warmup_ms", "data_ms", "measure_ms", "times",
                    "timed_on", "rss_bytes", "crowded", "finished",
                    "revision"):
            e["physinv"].pop(key)
    return entries


def finished(directory):
    """Lines of all journals: stages on disk."""
    lines = set()
    shards = os.path.join(directory, "shards")
    for shard in os.listdir(shards):
        path = os.path.join(shards, shard, "journal.jsonl")
        if os.path.exists(path):
            with open(path) as f:
                lines |= {(shard, line) for line in list(f)[1:]
                          if line.endswith("\n")}
    return lines


def workers_of(directory):
    """Programs of running tasks."""
    pids = slurm("pgrep", "-f", f"{BENCH} run .*--out=shards/").split()
    return [int(p) for p in pids]


def logs(directory):
    text = ""
    for name in os.listdir(os.path.join(directory, "log")):
        with open(os.path.join(directory, "log", name)) as f:
            text += f.read()
    return text


def submit(directory, *more):
    p = bench("submit", "--slurm", directory, *SELECTION, "--tasks=2", *more)
    check(p.returncode == 0, f"submit: {p.stdout.strip()}{p.stderr.strip()}")
    return p.stdout.split(":")[0].removeprefix("job ")


def queue_is_empty():
    p = subprocess.run(["squeue", "-h"], text=True, capture_output=True,
                       timeout=60)
    return p.returncode == 0 and not p.stdout.strip()


def wait_merged(directory):
    # Twice: a controller at work may say nothing for a moment.
    return wait_for("an empty queue", lambda: queue_is_empty() and (
        time.sleep(0.5) or queue_is_empty()))


def complete(directory, alone, what):
    status = bench("status", directory)
    check(status.returncode == 0,
          f"{what}: {status.stdout.splitlines()[-1]} {status.stderr.strip()}")
    if status.returncode != 0:
        print(logs(directory), flush=True)
    merged = os.path.join(directory, "merged")
    if os.path.exists(merged):
        check(numbers(merged) == alone, f"{what}: the bits of one machine")
    else:
        check(False, f"{what}: merged")


def undisturbed(d, alone):
    submit(d)
    p = bench("status", d)
    check(p.returncode == 10 and "in the queue" in p.stderr, "status: queued")
    wait_merged(d)
    complete(d, alone, "undisturbed")
    p = bench("submit", "--slurm", d, *SELECTION)
    check("all missing tasks are in the queue" in p.stdout, "complete: nothing to submit")
    p = bench("submit", "--slurm", d, "--profile=smoke")
    check(p.returncode == 2 and len(p.stderr.splitlines()) == 1,
          "another selection is refused: " + p.stderr.strip())


def killed(d, alone):
    submit(d)
    wait_for("a task at work", lambda: finished(d) and workers_of(d))
    before = finished(d)
    for pid in workers_of(d)[:1]:
        os.kill(pid, signal.SIGKILL)
    wait_merged(d)
    check("status 137" in logs(d), "kill -9: a task was killed")
    check(before <= finished(d), "kill -9: what was finished stays")
    complete(d, alone, "a task killed with -9")


def node_down(d, alone):
    submit(d)
    wait_for("a task at work", lambda: finished(d) and workers_of(d))
    node = slurm("squeue", "-h", "-t", "RUNNING", "-o", "%N").split()[0]
    jobs = slurm("squeue", "-h", "-w", node, "-o", "%A").split()
    before = finished(d)
    slurm("scontrol", "update", f"nodename={node}", "state=down",
          "reason=test")
    wait_for("requeued tasks", lambda: slurm(
        "squeue", "-h", "-t", "RUNNING", "-o", "%N").find(node) < 0)
    # What is left of the first starts holds their shards.
    wait_for("the node without its jobs", lambda: not slurm(
        "pgrep", "-f", f"slurmstepd: .({'|'.join(jobs)})[.]"))
    check("Restarts=1" in slurm("scontrol", "show", "job"),
          "node down: a task was put back into the queue")
    # Slurm lets requeued jobs wait for two minutes, unless told otherwise.
    for job in slurm("squeue", "-h", "-r", "-t", "PENDING", "-o", "%i").split():
        slurm("scontrol", "update", f"jobid={job}", "StartTime=now")
    wait_merged(d)
    # Only now: a second start on the node within the second that revoked the
    # first is refused by Slurm itself ("credential revoked").
    slurm("scontrol", "update", f"nodename={node}", "state=resume")
    check(before <= finished(d), "node down: what was finished stays")
    complete(d, alone, "a node taken down")


def cancelled(d, alone):
    job = submit(d)
    wait_for("a finished stage", lambda: finished(d))
    slurm("scancel", job)
    wait_merged(d)
    before = finished(d)
    status = bench("status", d)
    check(before and status.returncode == 10
          and len(status.stderr.splitlines()) == 1,
          "cancelled: " + status.stderr.strip())
    submit(d)
    wait_merged(d)
    check(before <= finished(d), "cancelled: what was finished stays")
    complete(d, alone, "submitted again")


def main():
    if os.geteuid() != 0 or not shutil.which("sbatch"):
        print("skipped: needs root and Slurm")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as d:
        os.chmod(d, 0o711)  # for the user munge
        os.environ["XDG_CACHE_HOME"] = os.path.join(d, "cache")
        cluster = os.path.join(d, "cluster")
        alone = os.path.join(d, "alone")
        p = bench(*SELECTION, "--out", alone)
        check(p.returncode == 0, "one machine")
        expected = numbers(alone)
        script = os.path.join(HERE, "cluster.sh")
        try:
            subprocess.run([script, "start", cluster], check=True, timeout=60)
            os.environ["SLURM_CONF"] = os.path.join(cluster, "slurm.conf")
            for test in (undisturbed, killed, node_down, cancelled):
                begin = time.time()
                # Slurm replaces what follows a %.
                test(os.path.join(d, "50%a" + test.__name__), expected)
                print(f"     {test.__name__}: {time.time() - begin:.1f} s",
                      flush=True)
        finally:
            if FAILED:
                with open(os.path.join(cluster, "log/slurmctld.txt")) as f:
                    print(f.read(), flush=True)
            subprocess.run([script, "stop", cluster])
    sys.exit(1 if FAILED else 0)


main()
