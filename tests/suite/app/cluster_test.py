"""submit and status with a Slurm that refuses, hangs, prints without end or answers
nonsense."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time

from program import FAILED, check, expect, results, run

SELECTION = ["--profile=quick", "--filter=descend", "--tasks=3"]
LOG = 'echo "$@" >>"$(dirname "$0")/log"\n'


class Slurm:
    """Its programs are what a test makes of them."""

    def __init__(self, d):
        self.bin = os.path.join(d, "bin")
        self.env = {"PATH": self.bin + ":" + os.environ["PATH"],
                    "XDG_CACHE_HOME": os.path.join(d, "cache"),
                    "PHYSINV_SLURM_SECONDS": "1"}
        os.makedirs(self.bin, exist_ok=True)

    def put(self, **scripts):
        for name, script in scripts.items():
            path = os.path.join(self.bin, name)
            with open(path, "w") as f:
                f.write("#!/bin/bash\n" + script + "\n")
            os.chmod(path, 0o755)

    def log(self):
        with open(os.path.join(self.bin, "log")) as f:
            return f.read().splitlines()


def refused_merge(d):
    """The array is not submitted twice; the merge follows."""
    s = Slurm(d)
    s.put(sbatch=LOG + "[[ $* != *merge.sh ]] || { echo no >&2; exit 1; }\n"
          "echo warning; echo '77;local'", squeue="exit 0")
    submit = ["submit", "--slurm=m", *SELECTION]
    expect(9, submit, d, "job 77 is submitted, but its merge is not",
           env=s.env)
    with open(os.path.join(d, "m", "submission.json")) as f:
        check(json.load(f)["jobs"] == ["77"], "the array's id is kept")
    queued = "for k in 0 1 2; do echo 77 $k PENDING; done; echo 5 N/A RUNNING"
    s.put(squeue=queued)
    expect(9, submit, d, "repeat the command to submit it", env=s.env)
    expect(10, ["status", "m"], d, "tasks are in the queue", env=s.env)
    s.put(sbatch=LOG + "echo 78")
    expect(0, submit, d, "submitting the missing merge", env=s.env)
    expect(0, submit, d, "all missing tasks are in the queue", env=s.env)
    arrays = [line for line in s.log() if "--array=" in line]
    merges = [line for line in s.log() if "merge.sh" in line]
    check(len(arrays) == 1, f"one array: {arrays}")
    check(len(merges) == 3 and all("afterany:77" in m for m in merges),
          f"three tries of a merge: {merges}")


def other_cases(d):
    """A used folder is of its own list; one that Slurm refused is split again,
    and sbatch is asked for memory."""
    s = Slurm(d)
    names = sorted(json.loads(run("list", "--profile=quick", "descend",
                                  "--json", cwd=d).stdout),
                   key=lambda case: case["name"])
    names = [case["name"] for case in names]

    def put(name, chosen):
        with open(os.path.join(d, name), "w") as f:
            f.write("".join(line + "\n" for line in chosen))

    put("two", names[:2]), put("same", reversed(names[:2]))
    put("one", names[:1]), put("other", names[1:3])
    s.put(sbatch=LOG + "echo too many >&2; exit 1", squeue="exit 0",
          scontrol="echo 'MaxArraySize            = 7'")
    submit = ["submit", "--slurm=50%array", *SELECTION[:2]]
    p = expect(9, [*submit, "--cases=two", "--tasks=1"], d,
               "MaxArraySize is 7", env=s.env)
    check("--tasks" in p.stderr, "the advice names --tasks")
    s.put(sbatch=LOG + "echo 77")
    p = expect(0, [*submit, "--cases=two", "--tasks=2", "--threads=2"], d,
               "2 of 2 tasks", env=s.env)
    with open(os.path.join(d, "50%array", "task.sh")) as f:
        check("--threads=2" in f.read(), "flags of the next submit count")
    array = [line for line in s.log() if "--array=0,1" in line][-1]
    check("/50%%array/log/task-%a.txt" in array, "a % stands twice: " + array)
    check("--mem=" in array, "memory is asked for")
    for name, says in (("one", "left out"), ("other", names[2])):
        expect(2, [*submit, "--cases=" + name], d, says, env=s.env)
    expect(2, submit, d, "is new", env=s.env)
    expect(0, [*submit, "--cases=same"], d, env=s.env)
    expect(0, ["submit", "--slurm=own", *SELECTION, "--", "--mem=7G"], d,
           env=s.env)
    check(s.log()[-2].count("--mem") == 1, "the user's own --mem: " + s.log()[-2])
    expect(2, ["submit", "--slurm=a\\b", *SELECTION], d, "backslash",
           env=s.env)


def bad_queues(d):
    """Tasks that may be in the queue are not submitted again."""
    s = Slurm(d)
    s.put(sbatch=LOG + "echo 9", squeue="exit 0")
    submit = ["submit", "--slurm=q", *SELECTION]
    expect(0, submit, d, "job 9", env=s.env)
    before = s.log()
    for script, says in (
            ("sleep 60", "no exit within 1 s"),
            ("sleep 60 & exit 0", "no exit within 1 s"),
            ("trap '' TERM; while :; do sleep 1; done", "no exit within 1 s"),
            ("exec >&- 2>&-; sleep 60", "no exit within 1 s"),
            ("yes", "bytes of output"),
            ("yes >&2", "bytes of output"),
            ("head -c 100000 /dev/urandom", "other than a queue"),
            ("echo '<html>'; echo busy", "other than a queue"),
            ("echo unable to contact >&2; exit 1", "status 1 unable"),
            ("kill -9 $$", "status 137")):
        s.put(squeue=script)
        begin = time.time()
        expect(10, ["status", "q"], d, says, env=s.env)
        expect(9, submit, d, "could run tasks twice", env=s.env)
        check(time.time() - begin < 8, f"squeue that does {script}")
    for lines, queued in (("9 99999999999999999999999 RUNNING", 0),
                          ("9 -1 RUNNING", 0), ("9 3 RUNNING", 0),
                          ("9 1 RUNNING", 1), ("9 1_2 RUNNING", 0),
                          ("banner of the site\n9 2 PENDING", 1),
                          ("999999999999999999999999 1 RUNNING", 0),
                          ("8 1 RUNNING", 0), ("", 0)):
        s.put(squeue=f"printf '%s\\n' '{lines}'")
        p = expect(10, ["status", "q"], d, "incomplete", env=s.env)
        check(f"{queued} tasks in the queue" in p.stdout, f"queue of {lines}")
    check(s.log() == before, "nothing was submitted meanwhile")
    os.remove(os.path.join(s.bin, "squeue"))
    expect(10, ["status", "q"], d, "no squeue in PATH",
           env={**s.env, "PATH": s.bin})


def bad_sbatch(d):
    s = Slurm(d)
    s.put(squeue="exit 0")
    for k, (script, says) in enumerate((
            ("sleep 60", "no exit within 1 s"), ("yes", "bytes of output"),
            ("exec >&- 2>&-; sleep 60", "no exit within 1 s"),
            ("head -c 1000 /dev/urandom", "of a job id"), ("exit 0", "of a job id"),
            ("printf 'a\\0b\\303'", "of a job id"),
            ("echo hello", "of a job id"), ("echo -1", "of a job id"),
            ("echo --wrap=x", "of a job id"), ("printf '%0400d' 1", "of a job id"),
            ("echo down >&2; exit 3", "failed: down"),
            ("exit 1", "no message"))):
        s.put(sbatch=script)
        begin = time.time()
        expect(9, ["submit", f"--slurm=b{k}", *SELECTION], d, says, env=s.env)
        check(time.time() - begin < 5, f"sbatch that does {script}")
        expect(10, ["status", f"b{k}"], d, "submit", env=s.env)
    for seconds in ("x", "-1", "0", "nan", "inf", "1e9", "1s"):
        expect(2, ["submit", "--slurm=b0", *SELECTION], d,
               "PHYSINV_SLURM_SECONDS=",
               env={**s.env, "PHYSINV_SLURM_SECONDS": seconds})


def damaged(d):
    """Nothing in the file becomes an argument that it should not."""
    path = os.path.join(d, "q", "submission.json")
    with open(path) as f:
        good = json.load(f)
    for key, value in (("jobs", ["--wrap=touch x"]), ("jobs", [1]),
                       ("jobs", "9"), ("merges_after", "9 or so"),
                       ("tasks", [{"cases": ["a"], "seconds": -1}]),
                       ("tasks", [{"cases": "a", "seconds": 1}]),
                       ("tasks", 3), ("selection", {}), ("program", None)):
        with open(path, "w") as f:
            json.dump({**good, key: value}, f)
        expect(9, ["status", "q"], d, "submission.json is damaged")
    del good["merges_after"]  # as an earlier version wrote it
    with open(path, "w") as f:
        json.dump(good, f)
    expect(10, ["status", "q"], d, "incomplete")


def killed_in_a_task(d):
    """A killed worker inside a task is tried again."""
    s = Slurm(d)
    s.put(sbatch="echo 5", squeue="exit 0")
    pace = {"PHYSINV_FAKE_PACE_MS": "10"}
    selection = ["--profile=smoke", "--filter=descend", "--set=iterations=200"]
    expect(0, ["submit", "--slurm=k", *selection], d, "job 5", env=s.env)
    expect(0, [*selection, "--out=alone"], d)
    p = subprocess.Popen(["bash", os.path.join(d, "k", "task.sh")],
                         env={**os.environ, **pace, "SLURM_ARRAY_TASK_ID": "0"},
                         stdout=subprocess.PIPE, text=True)
    time.sleep(1)
    for pid in subprocess.run(["pgrep", "-P", str(p.pid)], text=True,
                              capture_output=True).stdout.split():
        for worker in subprocess.run(["pgrep", "-P", pid], text=True,
                                     capture_output=True).stdout.split():
            os.kill(int(worker), signal.SIGKILL)
    text, _ = p.communicate(timeout=60)
    check(p.returncode == 0 and "trying again" in text,
          f"the task goes on: {p.returncode} {text}")
    check(results(os.path.join(d, "k", "shards", "0"))
          == results(os.path.join(d, "alone")), "same results")
    expect(0, ["status", "k"], d, "1 of 1 cases done", env=s.env)


with tempfile.TemporaryDirectory() as directory:
    os.mkdir(os.path.join(directory, "published"))
    for test in (refused_merge, other_cases, bad_queues, bad_sbatch, damaged,
                 killed_in_a_task):
        test(directory)
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
