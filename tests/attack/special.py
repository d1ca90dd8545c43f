"""FIFOs, sockets, devices, folders and huge files in place of files."""

import itertools
import os
import shutil

import sandbox
import stores
from world import Attempt

SPARSE = 8 << 30


def fifo(attempt, path):
    os.mkfifo(path)


def socket(attempt, path):
    sandbox.listen(path)


def device(minor):
    def make(attempt, path):
        if not sandbox.device(path, minor):
            attempt.skipped = "no device can be made without root"
            os.mkfifo(path)
    return make


def folder(attempt, path):
    os.makedirs(path)


def loop(attempt, path):
    os.symlink(path, path)


def dangling(attempt, path):
    os.symlink("nowhere", path)


def sparse(attempt, path):
    with open(path, "wb") as f:
        f.truncate(SPARSE)


FORMS = {"fifo": fifo, "socket": socket, "null": device(3), "zero": device(5),
         "full": device(7), "folder": folder, "loop": loop,
         "dangling": dangling, "sparse": sparse}
READ = [(kind, reader) for kind, (_, readers) in stores.TARGETS.items()
        for reader in readers]
# Further entries of stores, and calls that meet them.
MORE = {"done/lock": ("again",), "done/cases": ("again", "verify"),
        "half/checkpoints": ("resume",), "half/lock": ("resume",),
        "joined": ("merge",), "joined/journal.jsonl": ("merge",),
        "joined/plan.json": ("merge",), "joined/cases": ("merge",),
        "page": ("report",), "page/index.html": ("report",),
        "page.md": ("results",), "cache": ("plan",), "cache/physinv":
        ("plan",), "done": ("again", "verify", "export")}
INPUTS = list(itertools.product(
    READ + [(entry, r) for entry, readers in MORE.items() for r in readers],
    FORMS))


def entry_of(attempt, kind):
    if kind in stores.TARGETS:
        return attempt.rng.choice(stores.files(attempt.folder, kind))
    return attempt.path(kind)


def inputs(attempt):
    (kind, name), form = INPUTS[attempt.seed * 101 % len(INPUTS)]
    truth = stores.truth(attempt.world, name, Attempt)
    attempt.folder = attempt.world.sandbox.folder(str(attempt.seed))
    attempt.take(*stores.READERS[name].needs)
    path = entry_of(attempt, kind)
    if os.path.isdir(path):
        shutil.rmtree(path)
    elif os.path.lexists(path):
        os.remove(path)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    FORMS[form](attempt, path)
    attempt.hits = 1
    attempt.note(f"{os.path.relpath(path, attempt.folder)} is a {form}")
    ended, came = stores.call(attempt, name)
    reader = stores.READERS[name]
    if ended.code == 0 and reader.whole:
        attempt.same_results(attempt.path(reader.store),
                             os.path.join(attempt.world.golden, reader.whole))
        return
    # A folder may take the place of one, what is missing is made again, and
    # devices are written into.
    written = form in ("null", "zero") and kind.startswith("page")
    good = ended.code == 0 and (came == truth or form in ("folder", "dangling")
                                or written
                                or "measuring" in ended.err)
    attempt.expect(good or ended.code in (2, 3, 9, 10),
                   f"a {form} ends {ended.code}")


# Flags that name a file to write: call, needs, name.
WRITES = [
    (["run", *stores.SMALL, "--out=done", "--benchmark_out=target"],
     ("done",)),
    (["gate", "--baseline=base.txt", "--results=done", "--no-count",
      "--json=target"], ("base.txt", "done")),
    (["baseline", "done", "--out=target"], ("done",)),
    (["export", "done", "--out=target"], ("done",)),
    (["results", "--campaigns=campaigns", "--out=target"], ("campaigns",)),
    (["plan", *stores.SMALL, "--against=done", "--plot=target"],
     ("done", "cache")),
]
OUTPUTS = list(itertools.product(range(len(WRITES)), FORMS))


def outputs(attempt):
    """What is not a regular file is written into or refused; it stays."""
    number, form = OUTPUTS[attempt.seed * 101 % len(OUTPUTS)]
    arguments, needs = WRITES[number]
    attempt.take(*needs)
    path = attempt.path("target")
    FORMS[form](attempt, path)
    before = sandbox.state(path)
    attempt.hits = 1
    ended = attempt.run(*arguments, env=stores.CACHE, limit=15)
    after = sandbox.state(path)
    if form not in ("dangling", "loop", "sparse"):
        attempt.expect(before[:2] == after[:2],
                       f"a {form} became {after[0]}, {arguments[0]}")
    codes = {"null": (0,), "zero": (0,), "full": (9,), "folder": (2, 9),
             "socket": (2, 9), "fifo": (2, 9), "loop": (0, 2, 9)}
    attempt.expect(ended.code in codes.get(form, (0, 2, 9)),
                   f"{arguments[0]} into a {form}: {ended.code}")
