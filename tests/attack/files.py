"""Files of every kind, damaged: by flips and cuts, and behind their seals."""

import os

import damage
import sandbox
import seals
import stores
from world import Attempt

KINDS = list(stores.TARGETS)
REFUSED = (2, 3, 9, 10)
# Words of a call that continues without what is damaged.
TOLD = ("warning", "measuring", "damaged")
# What a journal line or a plan cannot do without: other types are refused.
NEEDED = {
    "journal": {"info", "record", "file", "data_hash", "arrays_hash", "name",
                "experiment", "method", "profile", "n", "seed", "precision",
                "stages", "keys", "case", "stage", "key", "position", "stop",
                "message", "iterations", "finished", "revision", "trajectory",
                "crowded", "buffer_bytes", "rss_bytes"},
    "plan": {"cases", "profile", "fingerprint", "schema_version"},
}


def prepare(attempt, kind):
    """A file of the kind and the call that reads it, in the folder."""
    name = attempt.rng.choice(stores.TARGETS[kind][1])
    stores.truth(attempt.world, name, Attempt)
    attempt.folder = attempt.world.sandbox.folder(f"{attempt.seed}")
    attempt.take(*stores.READERS[name].needs)
    path = attempt.rng.choice(stores.files(attempt.folder, kind))
    return name, path


def nothing_lost(attempt, before):
    """A run that refuses leaves arrays and lines as they were."""
    now = sandbox.snapshot(attempt.folder)
    for name, state in before.items():
        if name.endswith((".h5", "journal.jsonl")):
            attempt.expect(now.get(name, ())[:3] == state[:3],
                           f"{name} is lost or another after a refusal")


def read_it(attempt, name, path, strict):
    """Calls the reader; good is only what equals the truth."""
    before = sandbox.snapshot(attempt.folder)
    ended, came = stores.call(attempt, name)
    reader = stores.READERS[name]
    if reader.whole:
        if ended.code == 0:
            if strict:
                attempt.same_results(
                    attempt.path(reader.store),
                    os.path.join(attempt.world.golden, reader.whole))
        elif ended.code in (2, 9):
            nothing_lost(attempt, before)
    elif came != stores.truth(attempt.world, name, Attempt) and strict:
        told = any(word in ended.said() for word in TOLD)
        attempt.expect(ended.code != 0 or told,
                       f"damaged and read as good by {name}: {path_of(path)}")
    return ended


def path_of(path):
    return "/".join(path.split("/")[-3:])


def flips(attempt):
    kind = KINDS[attempt.seed % len(KINDS)]
    name, path = prepare(attempt, kind)
    data = sandbox.read(path)
    # What has no seal may be read as other good JSON.
    sealed = stores.form_of(kind) in seals.SEALS or b'"checksum"' in data
    data, words = damage.damage(attempt.rng, data)
    sandbox.write(path, data)
    attempt.note(f"{path_of(path)}: {words}")
    attempt.hits += 1
    read_it(attempt, name, path, strict=sealed)


def reseal(attempt):
    """Text instead of JSON, a changed member, or changed bytes."""
    kind = KINDS[attempt.seed % len(KINDS)]
    name, path = prepare(attempt, kind)
    form, rng = stores.form_of(kind), attempt.rng
    seal = seals.seal_of(form)
    data = sandbox.read(path)
    if kind == "names":
        data, words = damage.damage(rng, data)
        must = False
    else:
        parts = seal.parts(data)
        at = rng.randrange(len(parts))
        parts[at], words, must = changed(rng, parts[at], form, at)
        data = seal.join(parts)
    sandbox.write(path, data)
    attempt.note(f"{path_of(path)}: {words}")
    attempt.hits += 1
    # Arrays are held by the hashes of their journal lines, too; a digest by the results
    # in its folder.
    ended = read_it(attempt, name, path, strict=form in ("case", "campaign"))
    if must:
        attempt.expect(ended.code in REFUSED,
                       f"ill-typed and read as good by {name}: {words}")
    if kind == "checkpoint":
        attempt.expect(ended.code in (0, 9),
                       f"a forged checkpoint ends {ended.code}: {words}")


def changed(rng, part, form, at):
    if isinstance(part, bytes):
        how = rng.choice((damage.flip, damage.word, damage.word, damage.cut,
                          damage.grow))
        return (*how(rng, part), False)
    if rng.random() < 0.03:
        text = damage.deepened(rng, seals.dump(part))
        return text.encode(), f"part {at}: {damage.DEEP} levels", False
    value, path, before, after = damage.change(rng, part)
    words = f"part {at}: {'/'.join(map(str, path))}: {before} -> {after}"
    typed = after not in ("doubled", "one more", before)
    deepest = {"journal": 2, "plan": 1}.get(form, 0)
    needed = path[-1] in NEEDED.get(form, ()) and len(path) <= deepest
    if form == "journal" and at == 0:
        needed = path[-1] == "schema_version"
    return value, words, typed and needed
