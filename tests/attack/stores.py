"""What is attacked: files of every kind that the suite writes, made once by
the program itself, and the calls that read them."""

import dataclasses
import glob
import os
import shutil
import signal
import time

import sandbox
from world import SOURCE, results

SMALL = ["--profile=smoke", "--filter=physgrad/comparison/(gd|pg_numeric)/",
         "--filter=jpo/billiards/(jpo|bfgs)/n=4/"]
TRAINING = ["--profile=smoke", "--filter=jpo/billiards/(jpo|supervised)/"]
SHORT = [*TRAINING, "--set=iterations=2000"]
CACHE = {"XDG_CACHE_HOME": "{here}/cache"}
PUBLISHED = {"PHYSINV_PUBLISHED_DIR": "published"}
SBATCH = 'echo "$@" >> "${FAKE_LOG:-/dev/null}"; echo 4711'
# In the queue is nothing.
SQUEUE = "exit 0"


@dataclasses.dataclass
class Reader:
    """A call, what it needs and what it makes."""
    arguments: list
    needs: tuple
    makes: tuple = ()
    env: dict = dataclasses.field(default_factory=dict)
    whole: str = ""  # runs continue; these results come of it
    store: str = ""


READERS = {
    "verify": Reader(["verify", "done"], ("done",)),
    "report": Reader(["report", "done", "--out=page"], ("done",), ("page",)),
    "publish": Reader(["report", "done", "--out=page", "--publish=p"],
                      ("done",), ("p/digest.json",)),
    "export": Reader(["export", "done", "--format=github"], ("done",)),
    "compare": Reader(["compare", "done", "part1"], ("done", "part1")),
    "merge": Reader(["merge", "joined", "part1", "part2"],
                    ("part1", "part2"), ("joined",)),
    "gate": Reader(["gate", "--baseline=base.txt", "--results=done",
                    "--no-count"], ("base.txt", "done")),
    "plan": Reader(["plan", "--exact", *SMALL], ("cache",), env=CACHE),
    "results": Reader(["results", "--campaigns=campaigns", "--out=page.md"],
                      ("campaigns",), ("page.md",)),
    "list": Reader(["list", *SMALL, "--cases=names.txt"], ("names.txt",)),
    "published": Reader(["report", "done", "--out=page"],
                        ("done", "published"), env=PUBLISHED),
    "status": Reader(["status", "cluster"], ("cluster",)),
    "again": Reader(["run", *SMALL, "--trace", "--out=done"], ("done",),
                    whole="done", store="done"),
    "resume": Reader(["run", *SHORT, "--trace", "--jobs=1", "--out=half"],
                     ("half",), whole="whole", store="half"),
}

# Kind of file -> where it is, what reads it.
TARGETS = {
    "journal": ("done/journal.jsonl",
                ("verify", "report", "export", "compare", "again")),
    "plan": ("done/plan.json", ("verify", "report", "compare", "again")),
    "case": ("done/cases/*.h5",
             ("verify", "report", "compare", "gate", "again")),
    "results": ("done/results.json", ("export", "publish")),
    "repetitions": ("done/repetitions.json", ("export",)),
    "shard": ("part1/journal.jsonl", ("merge", "compare")),
    "shard-plan": ("part2/plan.json", ("merge",)),
    "shard-case": ("part1/cases/*.h5", ("merge", "compare")),
    "checkpoint": ("half/checkpoints/*", ("resume",)),
    "baseline": ("base.txt", ("gate",)),
    "cache": ("cache/physinv/*.json", ("plan",)),
    "submission": ("cluster/submission.json", ("status",)),
    "campaign": ("campaigns/one/digest.json", ("results",)),
    "published": ("published/*.json", ("published",)),
    "names": ("names.txt", ("list",)),
}


def form_of(kind):
    """How files of this kind are sealed, see seals.py."""
    return {"shard": "journal", "shard-plan": "plan",
            "shard-case": "case"}.get(kind, kind)


def checkpoints(store):
    """States that are whole, not those aside."""
    return [p for p in glob.glob(os.path.join(store, "checkpoints", "*"))
            if len(os.path.basename(p)) == 32]


def files(folder, kind):
    return sorted(glob.glob(os.path.join(folder, TARGETS[kind][0])))


def interrupted(world, store):
    """Killed in a training, with its state saved."""
    for _ in range(50):
        shutil.rmtree(store, ignore_errors=True)
        process = world.start(["run", *SHORT, "--trace", "--jobs=1",
                               "--checkpoint=0.005", "--out", store],
                              cwd=world.golden)
        while process.alive() and not checkpoints(store):
            time.sleep(0.001)
        process.signal(signal.SIGKILL)
        process.end()
        if checkpoints(store):
            return
    raise SystemExit("no checkpoint could be had")


def make(world):
    """All of it. A program that cannot do that is not worth an attack."""
    world.fake("sbatch", SBATCH)
    world.fake("squeue", SQUEUE)

    def run(*arguments, env=None):
        ended = world.start(arguments, cwd=world.golden, env=env).wait(120)
        if ended.code not in (0, 10):
            raise SystemExit(f"{' '.join(arguments)}: exit {ended.code} "
                             f"{ended.err}")
        return ended

    run("run", *SMALL, "--trace", "--benchmark_repetitions=2", "--out=done")
    for part in ("1", "2"):
        run("run", *SMALL, f"--shard={part}/2", "--out=part" + part)
    run("run", *SHORT, "--trace", "--out=whole")
    interrupted(world, os.path.join(world.golden, "half"))
    run("report", "done", "--out=page", "--publish=campaigns/one")
    run("baseline", "done", "--out=base.txt")
    run("plan", "--exact", *SMALL, env=CACHE)
    names = [entry["run_name"].rsplit("/", 1)[0]
             for entry in results(os.path.join(world.golden, "done"))]
    sandbox.write(os.path.join(world.golden, "names.txt"),
                  "\n".join(dict.fromkeys(names)) + "\n")
    run("submit", "--slurm=cluster", *SMALL, "--tasks=2", env=CACHE)
    reports = os.path.join(SOURCE, "reports")
    shutil.copytree(os.path.join(reports, "published"),
                    os.path.join(world.golden, "published"))
    for kind in TARGETS:
        if not files(world.golden, kind):
            raise SystemExit(f"there is no file of the kind {kind} to attack")


def made(attempt, reader):
    """The result of a call, but for times."""
    found = {}
    for name in reader.makes:
        path = attempt.path(name)
        if os.path.isfile(os.path.join(path, "results.json")):
            found[name] = results(path)
        elif os.path.isdir(path):
            found[name] = {k: v[2] for k, v in sandbox.snapshot(path).items()}
        elif os.path.isfile(path):
            found[name] = sandbox.state(path)[1:3]
    return found


def call(attempt, name):
    reader = READERS[name]
    ended = attempt.run(*reader.arguments, env=reader.env, limit=15
                        if reader.whole else 5)
    return ended, (ended.code, ended.out, made(attempt, reader))


def truth(world, name, attempt_type):
    """The result of a call if nothing is damaged."""
    if name not in world.truths:
        attempt = attempt_type(world, "undamaged", name)
        attempt.take(*READERS[name].needs)
        ended, world.truths[name] = call(attempt, name)
        if attempt.findings or ended.code not in (0, 10):
            raise SystemExit(f"undamaged, {name}: {attempt.findings} "
                             f"{ended.err}")
    return world.truths[name]
