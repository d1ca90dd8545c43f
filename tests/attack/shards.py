"""Shards of strangers: keys and names of cases that are paths."""

import glob
import itertools
import os

import sandbox
import seals

TREE = "../../../"  # from checkpoints/ or cases/ of a store up to the sandbox

KEYS = ["{box}/home/precious.txt", TREE + "../home/precious.txt",
        TREE + "../outside/data.h5", "..", ".", "", "/", "A" * 32, "g" * 32,
        "0" * 31, "0" * 33, "0" * 32 + "\n", "0" * 31 + "\0", "0" * 32 + "/x",
        "../journal.jsonl", "../plan.json", "../" + "0" * 29, " " + "0" * 31]
NAMES = [TREE + "../outside/data", "{box}/outside/data", "..", "", "/",
         "a/../b", "jpo/billiards/bfgs/n=4/seed=0/..", "a\nb", "a\0b",
         "x" * 5000, "<script>alert(1)</script>", "a|b", "a`b`", "\x1b[2J",
         "jpo/billiards/bfgs/n=4/seed=0 ", "physgrad\\comparison", "é"]
STAGES = ["../data", "a/b", "..", "", ".", "\n", "solve/../../data", "<b>"]
FILES = [TREE + "../outside/data.h5", "{box}/outside/data.h5", "cases/../lock",
         "", "cases/x.h5"]


def every(value, old, new):
    """Text by another text, wherever it is in JSON."""
    if isinstance(value, dict):
        return {every(k, old, new): every(v, old, new)
                for k, v in value.items()}
    if isinstance(value, list):
        return [every(v, old, new) for v in value]
    return new if type(value) is str and value == old else value


def rewrite(path, form, change):
    seal = seals.seal_of(form)
    sandbox.write(path, seal.join(change(seal.parts(sandbox.read(path)))))


def fitted(path, length):
    """The same path, as long as asked for if it is shorter."""
    more = length - len(path)
    return path.replace("/", "/" * (more + 1), 1) if more > 0 else path


def forge_everywhere(store, old, new):
    """In journal and plan; in the arrays, too, if it is as long."""
    rewrite(store + "/journal.jsonl", "journal",
            lambda parts: every(parts, old, new))
    rewrite(store + "/plan.json", "plan",
            lambda parts: every(parts, old, new))
    if len(new.encode()) == len(old):
        for path in glob.glob(store + "/cases/*.h5"):
            rewrite(path, "case", lambda parts: [
                parts[0].replace(old.encode(), new.encode())])


def forge_record(store, change):
    """One line of the journal, the plan as it was."""
    def lines(parts):
        change(parts[1])
        return parts
    rewrite(store + "/journal.jsonl", "journal", lines)


def put(value, *path):
    def change(line):
        for name in path[:-1]:
            line = line[name]
        line[path[-1]] = value
    return change


def forgeries():
    """(what, value, how): `how` forges a store."""
    for key in KEYS:
        yield "key", key, lambda s, v, line: forge_everywhere(
            s, line["record"]["key"], fitted(v, 32) if "/" in v else v)
        yield "key of the record", key, lambda s, v, line: forge_record(
            s, put(v, "record", "key"))
        yield "key of the plan", key, lambda s, v, line: rewrite(
            s + "/plan.json", "plan",
            lambda p: every(p, line["record"]["key"], v))
    for name in NAMES:
        yield "name", name, lambda s, v, line: forge_everywhere(
            s, line["info"]["name"], v)
        yield "name of the record", name, lambda s, v, line: forge_record(
            s, put(v, "record", "case"))
        yield "name of the plan", name, lambda s, v, line: rewrite(
            s + "/plan.json", "plan",
            lambda p: every(p, line["info"]["name"], v))
    for stage in STAGES:
        yield "stage", stage, lambda s, v, line: forge_everywhere(
            s, line["record"]["stage"], v)
    for name in FILES:
        yield "file", name, lambda s, v, line: forge_record(s, put(v, "file"))


# Export reads results.json alone.
CALLS = {
    "merge": ["merge", "joined", "part1", "part2"],
    "verify": ["verify", "part1"],
    "report": ["report", "part1", "--out=page"],
    "export": ["export", "part1"],
    "compare": ["compare", "part1", "part2"],
    "again": ["run", "--profile=smoke", "--filter=physgrad/comparison/gd/",
              "--filter=jpo/billiards/bfgs/n=4/", "--out=part1"],
    "fresh": ["run", "--profile=smoke", "--filter=physgrad/comparison/gd/",
              "--fresh", "--out=part1"],
    "baseline": ["baseline", "part1", "--out=base.txt"],
}
ALL = list(itertools.product(forgeries(), CALLS))


def shards(attempt):
    # Coprime to the number of pairs, so that a few seeds see every form.
    (what, value, forge), call = ALL[attempt.seed * 101 % len(ALL)]
    value = value.replace("{box}", attempt.world.sandbox.root)
    attempt.take("part1", "part2")
    store = attempt.path("part1")
    line = seals.SEALS["journal"].parts(
        sandbox.read(store + "/journal.jsonl"))[1]
    forge(store, value, line)
    # Keys lead from there to where they point.
    os.makedirs(attempt.path("joined/checkpoints"))
    attempt.hits += 1
    attempt.note(f"{what}: {value[:80]!r}")
    before = sandbox.snapshot(store)
    ended = attempt.run(*CALLS[call], limit=15 if call == "again" else 5)
    # A plan's name that no line has is a case that is missing: 10.
    allowed = (2, 9, 10) if "plan" in what or what == "file" else (2, 9)
    if call != "export" and what not in ("file", "name of the plan"):
        attempt.expect(ended.code in allowed,
                       f"{what} {value[:60]!r} is read as good by {call}")
    if ended.code in allowed:
        lost = [x for x in sandbox.differences(before, sandbox.snapshot(store))
                if "is gone" in x or "h5" in x]
        attempt.expect(not lost, f"a refusal touched {lost}")
