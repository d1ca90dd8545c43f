"""What is in a store or next to a target and is not the suite's: links that
lead elsewhere, and a user's files with names like those of leftovers."""

import glob
import itertools
import os
import shutil

import sandbox
import stores

SMALL = [*stores.SMALL, "--trace"]
# Call -> arguments, what it needs.
CALLS = {
    "run": (["run", *SMALL, "--out=done"], ("done",)),
    "fresh": (["run", *SMALL, "--fresh", "--out=done"], ("done",)),
    "times": (["run", *SMALL, "--benchmark_repetitions=2", "--out=done",
               "--benchmark_out=done/out.json"], ("done",)),
    "resume": (["run", *stores.SHORT, "--trace", "--jobs=1",
                "--checkpoint=0.01", "--out=half"], ("half",)),
    "report": (["report", "done", "--publish=done/p"], ("done",)),
    "merge": (["merge", "done", "part1", "part2"], ("part1", "part2")),
    "export": (["export", "done", "--out=done/out.json"], ("done",)),
    "compare": (["compare", "done", "part1", "--out=done/page"],
                ("done", "part1")),
    "gate": (["gate", "--baseline=base.txt", "--out=done", "--no-count",
              "--json=done/found.json"], ("base.txt",)),
    "plan": (["plan", "--exact", *stores.SMALL], ()),
    "verify": (["verify", "done"], ("done",)),
}
LINKS = {  # entry of the folder -> what it leads to
    "{s}/journal.jsonl": "home/precious.txt", "{s}/plan.json":
    "home/precious.txt", "{s}/results.json": "home/precious.txt",
    "{s}/lock": "outside/lock", "{s}/repetitions.json": "home/precious.txt",
    "{s}/journal.jsonl.tmp": "home/precious.txt",
    "{s}/plan.json.tmp": "home/precious.txt",
    "{s}/results.json.tmp": "outside/data.h5",
    "{s}/repetitions.json.tmp": "home/precious.txt",
    "{s}/out.json.tmp": "home/precious.txt",
    "{s}/found.json.tmp": "home/precious.txt",
    "{s}/cases": "outside/notes", "{s}/checkpoints": "outside/notes",
    "{s}/repetition": "outside/notes", "{s}/repetition/cases":
    "outside/notes", "{s}/report": "outside/notes",
    "{s}/report/index.html": "home/precious.txt",
    "{s}/report/index.html.tmp": "home/precious.txt",
    "{s}/report/report.md.tmp": "outside/empty",
    "{s}/report/claims.json": "outside/data.h5",
    "{s}/report/jpo-billiards": "outside/notes",
    "{s}/page/index.html.tmp": "home/precious.txt",
    "{s}/p/digest.json.tmp": "home/precious.txt",
    "{s}/p/results.json.gz.tmp": "home/precious.txt",
    "{s}/cases/*.h5": "home/cases/a+b.h5",
    "{s}/cases/*.h5.tmp": "home/cases/a+b.h5",
    "{s}/checkpoints/*": "outside/data.h5",
    "{s}/checkpoints/*.tmp": "outside/data.h5",
    "cache/physinv": "outside/notes",
    "cache/physinv/*.json": "outside/data.h5",
    "cache/physinv/*.json.tmp": "outside/data.h5",
}
FILES = ["notes.txt", "x.tmp", "journal.jsonl.tmp", "plan.json.tmp",
         "results.json.tmp", "results.json.bak", "cases/mine.h5",
         "cases/mine.tmp", "cases/a.h5.tmp", "checkpoints/readme",
         "checkpoints/x.tmp", "checkpoints/" + "f" * 32 + ".tmp",
         "repetition/thesis.tex", "repetition/cases/x.h5", "report/my.css",
         "report/index.html.tmp", "p/mine.json", "page/mine.html",
         "folder.tmp/x", "cases/folder.tmp/x", "out.json.tmp"]
ALL_LINKS = list(itertools.product(LINKS, CALLS))


def target_of(call):
    """The folder that the call writes to."""
    return "half" if call == "resume" else "done"


def names_of(attempt, entry):
    """An entry with a star stands for those of the store made once."""
    if "*" not in entry:
        return [attempt.path(entry)]
    ending = ".tmp" if entry.endswith(".tmp") else ""
    found = glob.glob(attempt.path(entry.removesuffix(".tmp")))
    return [path + ending for path in found]


def replace(path, target):
    if os.path.isdir(path) and not os.path.islink(path):
        shutil.rmtree(path)
    elif os.path.lexists(path):
        os.remove(path)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    os.symlink(target, path)


def links(attempt):
    entry, call = ALL_LINKS[attempt.seed * 101 % len(ALL_LINKS)]
    arguments, needs = CALLS[call]
    attempt.take(*needs, "cache")
    store = target_of(call)
    os.makedirs(attempt.path(store), exist_ok=True)
    for path in names_of(attempt, entry.replace("{s}", store)):
        replace(path, attempt.world.sandbox.path(LINKS[entry]))
        attempt.hits = 1
    attempt.note(f"{entry} -> {LINKS[entry]}")
    ended = attempt.run(*arguments, env=stores.CACHE, limit=15)
    attempt.expect(ended.code in (0, 2, 3, 5, 9, 10), f"exit {ended.code}")


def strangers(attempt):
    """A user's files in the folder that is written to stay as they are."""
    rng = attempt.rng
    call = list(CALLS)[attempt.seed % len(CALLS)]
    arguments, needs = CALLS[call]
    attempt.take(*needs, "cache")
    store = target_of(call)
    mine = rng.sample(FILES, rng.randrange(1, 6))
    for name in mine:
        sandbox.write(attempt.path(store, name), f"mine: {name}\n")
    before = sandbox.snapshot(attempt.path(store))
    attempt.hits = 1
    attempt.note(f"in {store}: {', '.join(mine)}")
    ended = attempt.run(*arguments, env=stores.CACHE, limit=15)
    after = sandbox.snapshot(attempt.path(store))
    for name in mine:
        attempt.expect(before[name] == after.get(name),
                       f"{name} of the user is gone or another after {call}")
    # A folder of somebody's own may be refused, but not for what is in it.
    attempt.expect(ended.code in (0, 2, 9, 10), f"exit {ended.code}")
    if call in ("run", "verify", "export", "compare", "plan"):
        attempt.expect(ended.code == 0, f"{call} ends {ended.code} for "
                       f"{', '.join(mine)}: {ended.err[:200]}")
