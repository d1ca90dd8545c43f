"""docs/data.md against the files of a campaign: which there are, and the keys of
those that are JSON."""

import glob
import gzip
import json
import os
import re


def table(section, first):
    """Rows of the table whose head begins so, as lists of cells."""
    body = section.split(f"| {first} |", 1)[1].split("\n\n")[0]
    return [row.split("|")[1:-1] for row in body.splitlines()[2:]]


def names(section, first):
    return {name for row in table(section, first)
            for name in re.findall(r"`([^`]+)`", row[0])}


def differences(section, store, published):
    """Files that are there and not named, or named and not there."""
    told = {name: re.compile("".join(
        r"[^/.]+" if part == "<id>"
        else r"[^/]+" if part.startswith("<") else re.escape(part)
        for part in re.split(r"(<\w+>)", name)))
        for name in names(section, "file in `results/<profile>`")}
    passing = {"lock.owner", "checkpoints/<key>"}
    seen, wrong = set(), []
    for folder in (store, published):
        for path in glob.glob(folder + "/**", recursive=True):
            own = os.path.relpath(path, folder)
            if os.path.isdir(path):
                continue
            match = {n for n, like in told.items() if like.fullmatch(own)}
            seen |= match
            if not match:
                wrong.append(f"{own} is not told")
    return wrong + [f"{n} is not there" for n in set(told) - seen - passing]


def children(value, path="", found=None):
    """Keys by the path of what has them; [] is each element of a list."""
    found = {} if found is None else found
    if isinstance(value, dict):
        found.setdefault(path, set()).update(value)
        for key, inner in value.items():
            children(inner, f"{path}.{key}" if path else key, found)
    elif isinstance(value, list):
        for inner in value:
            children(inner, path + "[]", found)
    return found


def key_differences(what, said, documents, besides=()):
    """Of all objects of which the page names a key, the other keys."""
    found, told = {}, {}
    for document in documents:
        children(document, "", found)
    for name in set(said) | set(besides):
        parts = name.split(".")
        # `a[].b` names `a` as well.
        for k, part in enumerate(parts):
            parent = ".".join(parts[:k])
            told.setdefault(parent, set()).add(part.removesuffix("[]"))
    wrong = []
    for parent, keys in told.items():
        for key in sorted(keys ^ found.get(parent, set())):
            side = "is not there" if key in keys else "is not told"
            wrong.append(f"docs/data.md, {what}: {parent}.{key} {side}")
    return wrong


def read(path):
    opening = gzip.open if path.endswith(".gz") else open
    with opening(path, "rt") as file:
        return json.load(file)


def all_keys(sections, store, published):
    """What is wrong with the keys of every JSON file but those of results.json
    and plan.json."""
    claims = names(sections["`claims.json` and `digest.json`"], "key")
    shown = sections["Tables and figures as JSON"]
    with open(store + "/journal.jsonl") as file:
        header, *lines = [json.loads(line[9:]) for line in file]
    report = store + "/report/"
    return (
        key_differences("journal.jsonl", {"schema_version", "created"},
                        [header]) +
        key_differences("journal.jsonl",
                        names(sections["`journal.jsonl`"], "key of a line"),
                        lines) +
        key_differences("repetitions.json",
                        names(sections["`repetitions.json`"],
                              "key of the file"),
                        [read(store + "/repetitions.json")]) +
        key_differences("claims.json", claims, [read(report + "claims.json")]) +
        key_differences("digest.json", claims,
                        [read(published + "/digest.json")],
                        {"results", "checksum", "sections[].tables",
                         "sections[].figures[].file",
                         "sections[].figures[].title",
                         "sections[].figures[].note"}) +
        key_differences("tables", names(shown, "key of a table"),
                        map(read, glob.glob(report + "*/tables/*.json"))) +
        key_differences("figures", names(shown, "key of a figure"),
                        [read(path) for path in
                         glob.glob(report + "*/figures/*.json")
                         if not path.endswith(".vl.json")]))
