"""Stored files altered behind checksums that are right: a verb that reads them names
the file, or says the same as before; no forged number is published."""

import copy
import gzip
import json
import os
import shutil
import struct
import sys
import tempfile

from program import FAILED, check, expect, run

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                "..", "..", "attack"))
import seals  # noqa: E402

SMOKE = ["--profile=smoke", "--filter=walk|descend", "--jobs=1"]
CASE = "cases/fake+cubic+walk+n=4+seed=0.h5"


def read(path):
    with open(path, "rb") as f:
        return f.read()


def write(path, data):
    with open(path, "wb") as f:
        f.write(data)


class Ordered:
    """A file whose keys stay in order; the checksum is in the part `where`."""

    def __init__(self, *where):
        self.where = where

    def parts(self, data):
        return [seals.load(data)]

    def join(self, parts):
        value = copy.deepcopy(parts[0])
        part = value
        for key in self.where:
            part = part[key]
        part.pop("checksum", None)
        part["checksum"] = seals.digits(compact(value).encode()).decode()
        return compact(value).encode()


def compact(value):
    """As seals.dump, with the keys in their order."""
    if isinstance(value, seals.Number):
        return str(value)
    if isinstance(value, dict):
        return "{" + ",".join(json.dumps(k) + ":" + compact(v)
                              for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(compact, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


SEALS = {"journal.jsonl": seals.Lines(), "plan.json": seals.Json(),
         "repetitions.json": seals.Json(), "results.json": Ordered("context", "physinv"),
         CASE: seals.Trailer()}


def other(value):
    """Of the same type and another value."""
    if isinstance(value, seals.Number):
        return seals.Number("2.5" if value != "2.5" else "3.5")
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, str):
        digit = value[-1:] if value[-1:].isalnum() else "a"
        return value[:-1] + ("1" if digit == "0" else "0") if value else "0"
    return None


def leaves(value, at=()):
    """Paths of all numbers, words and flags."""
    items = value.items() if isinstance(value, dict) else \
        enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        if isinstance(inner, (dict, list)):
            yield from leaves(inner, (*at, key))
        elif other(inner) is not None and key != "checksum":
            yield (*at, key)


def altered(value, path):
    value = copy.deepcopy(value)
    inner = value
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = other(inner[path[-1]])
    return value


def forgeries(name, data):
    """The file with one thing altered each, and what it is."""
    seal = SEALS[name]
    parts = seal.parts(data)
    if name == CASE:
        image = parts[0]
        for at in range(0, len(image), max(1, len(image) // 150)):
            changed = image[:at] + bytes([image[at] ^ 4]) + image[at + 1:]
            yield seal.join([changed]), f"byte {at}"
        return
    for i, part in enumerate(parts):
        if i not in (0, len(parts) - 1):
            continue  # the first and the last line of a journal
        for path in leaves(part):
            changed = [*parts[:i], altered(part, path), *parts[i + 1:]]
            yield seal.join(changed), "/".join(map(str, path))


def numbers(text):
    """Entries of an export by name; errors have none."""
    results = json.loads(text)
    own = {(b["name"], b.get("repetition_index")): b
           for b in results["benchmarks"] if "error_occurred" not in b}
    for b in own.values():
        b.pop("family_index")
    return results["context"], own


def harmless(p, truth):
    """Is the file named, or what is exported as before, errors apart?"""
    if p.returncode:
        lines = p.stderr.splitlines()
        if len(lines) != 1 or p.returncode not in (2, 9, 10):
            return False
        if p.returncode != 10:
            return any(os.path.basename(n) in lines[0] for n in SEALS)
    context, own = numbers(p.stdout)
    return context == truth[0] and all(truth[1].get(k) == b
                                       for k, b in own.items())


def every_leaf(d):
    out = os.path.join(d, "store")
    expect(0, [*SMOKE, "--trace", "--benchmark_repetitions=2", "--out=" + out],
           d, "stages run")
    truth = numbers(run("export", out, cwd=d).stdout)
    check(len(truth[1]) == 3 * 6, "three stages, two runs and their spread")
    for name in SEALS:
        path = os.path.join(out, name)
        before = read(path)
        named = same = 0
        write(path, SEALS[name].join(SEALS[name].parts(before)))
        check(run("export", out, cwd=d).returncode == 0, f"{name} sealed again")
        for data, what in forgeries(name, before):
            write(path, data)
            p = run("export", out, cwd=d)
            if not harmless(p, truth):
                check(False, f"{name} {what}: {p.returncode} {p.stderr[:200]}")
            named += p.returncode != 0
            same += p.returncode == 0
        write(path, before)
        check(named > 3 and named > same / 4,
              f"{name}: {named} forgeries named, {same} without a trace")


def change(path, seal, edit):
    parts = seal.parts(read(path))
    edit(parts)
    write(path, seal.join(parts))


def worse(entry):
    if "error_occurred" not in entry:
        for key in ("loss_mean", "loss_median", "loss_max"):
            entry[key] = seals.Number("1e-30")


def losses(parts):
    for entry in parts[0]["benchmarks"]:
        worse(entry)


def counts(parts):
    parts[-1]["record"]["counts"]["vjp"] += 7


def faster(parts):
    parts[-1]["record"]["clocks"]["solve"][0] = seals.Number("1e-9")


def processor(parts):
    parts[0]["context"]["cpu_model"] = "a faster one"


def spread(parts):
    for times in parts[0]["times"].values():
        times[0][0] = seals.Number("1e-9")


def loss_of(out):
    """Makes a loss in the file of a case another."""
    entries = json.loads(read(os.path.join(out, "results.json")))["benchmarks"]
    loss = next(b["loss_max"] for b in entries if "/walk/" in b["name"])

    def array(parts):
        at = parts[0].index(struct.pack("<d", loss))
        parts[0] = (parts[0][:at] + struct.pack("<d", 1e-30) +
                    parts[0][at + 8:])
    return array


def every_verb(d):
    """One forgery of each kind before every verb that reads a store."""
    table = []
    for name, edit in (("results.json", losses), ("journal.jsonl", counts),
                       ("journal.jsonl", faster), ("plan.json", processor),
                       ("repetitions.json", spread), (CASE, None)):
        out = os.path.join(d, "forged")
        expect(0, [*SMOKE, "--trace", "--benchmark_repetitions=2",
                   "--out=" + out], d, "stages run")
        shutil.copytree(out, os.path.join(d, "true"))
        edit = edit or loss_of(out)
        change(os.path.join(out, name), SEALS[name], edit)
        verbs = (["verify", out], ["report", out, "--publish=published-here"],
                 ["export", out], ["export", out, "--format=github"],
                 ["export", out, "--format=bencher"],
                 ["export", out, "--format=csv"], ["compare", "true", out],
                 ["compare", out, "true"], ["merge", "merged", out],
                 ["baseline", out, "--out=base.txt"], [*SMOKE, "--out=" + out])
        codes = []
        for args in verbs:
            p = run(*args, cwd=d)
            codes.append(f"{args[0]} {p.returncode}")
            rewritten = args is verbs[-1] and name == "plan.json"
            check(p.returncode == (0 if rewritten else 9) and
                  (rewritten or len(p.stderr.splitlines()) == 1 and
                   ("results.json" in p.stderr or
                    os.path.basename(name) in p.stderr)),
                  f"{name} {edit.__name__}: {args[0]} {p.returncode} "
                  f"{p.stderr[:200]}")
        check(not os.path.exists(os.path.join(d, "published-here")) and
              not os.path.exists(os.path.join(d, "base.txt")),
              f"{name} {edit.__name__}: nothing is published")
        table.append(f"{name} {edit.__name__}: {', '.join(codes)}")
        for folder in ("forged", "true", "merged"):
            shutil.rmtree(os.path.join(d, folder), ignore_errors=True)
    print("\n".join(table))


def published(d):
    """What report --publish keeps is made from journal and case files."""
    out = os.path.join(d, "store")
    expect(0, [*SMOKE, "--out=" + out], d, "stages run")
    expect(0, ["report", out, "--publish=kept/one"], d, "report")
    with gzip.open(os.path.join(d, "kept", "one", "results.json.gz")) as f:
        kept = json.load(f)["benchmarks"]
    own = json.loads(read(os.path.join(out, "results.json")))["benchmarks"]
    check(kept == own, "the same entries")


def published_altered(d):
    """Of what report --publish keeps, no file is altered alone."""
    out, one = os.path.join(d, "store"), os.path.join(d, "kept", "one")
    expect(0, [*SMOKE, "--out=" + out], d, "stages run")
    expect(0, ["report", out, "--publish=kept/one"], d, "report")
    expect(0, ["results", "--campaigns=kept", "--out=page.md"], d, "page.md")

    def digest(data, edit):
        seal = Ordered()
        parts = seal.parts(data)
        edit(parts[0])
        return seal.join(parts)

    def results(data, edit):
        seal = Ordered("context", "physinv")
        parts = seal.parts(gzip.decompress(data))
        edit(parts[0])
        return gzip.compress(seal.join(parts))

    def verdict(value):
        claim = value["sections"][0]["claims"][0]
        claim["verdict"] = "not reproduced" \
            if claim["verdict"] == "reproduced" else "reproduced"

    def loss(value):
        value["benchmarks"][0]["loss_median"] = 1e-9

    def nothing(value):
        pass

    for name, sealed, edit, code in (
            ("digest.json", digest, nothing, 0),
            ("digest.json", digest, verdict, 9),
            ("digest.json", digest, lambda v: v.pop("results"), 9),
            ("digest.json", lambda data, _: compact(
                {k: v for k, v in seals.load(data).items()
                 if k != "checksum"}).encode(), nothing, 9),
            ("results.json.gz", results, nothing, 0),
            ("results.json.gz", results, loss, 9),
            ("results.json.gz", lambda data, _: data[:-9], nothing, 9),
            ("results.json.gz", lambda *_: b"", nothing, 9)):
        path = os.path.join(one, name)
        kept = read(path)
        write(path, sealed(kept, edit))
        if os.path.exists(os.path.join(d, "page.md")):
            os.remove(os.path.join(d, "page.md"))
        p = run("results", "--campaigns=kept", "--out=page.md", cwd=d)
        check(p.returncode == code and
              os.path.exists(os.path.join(d, "page.md")) == (code == 0) and
              len(p.stderr.splitlines()) == (code != 0),
              f"{name} {edit.__name__}: {p.returncode} {p.stderr[:200]}")
        write(path, kept)


def main():
    for test in (every_leaf, every_verb, published,
                 published_altered):
        with tempfile.TemporaryDirectory() as d:
            os.mkdir(os.path.join(d, "published"))
            test(d)
    sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)


main()
