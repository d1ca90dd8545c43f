"""Reports say what tests/reports/golden holds: of the smoke profile every claim,
table and figure as JSON, and the sums of all other files; every claim of a
made-up campaign. Long lists of numbers are there as their ends and their sum.

  golden_test.py GOLDEN-REPORT STORE-OF-SMOKE WORK [--update]

--update writes the golden files again; git shows what changed."""

import hashlib
import json
import os
import shutil
import subprocess
import sys

PROGRAM, STORE, WORK = sys.argv[1:4]
UPDATE = "--update" in sys.argv[4:]
GOLDEN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "golden")
WIDTH = 240  # of a value on one line
ENDS = 1  # numbers that are shown at both ends of a longer list


class Number(str):
    """To the letter."""


def read(path):
    with open(path) as f:
        return json.load(f, parse_float=Number, parse_int=Number)


def sum_of(texts):
    digest = hashlib.sha256()
    for text in texts:
        digest.update(text.encode() + b"\0")
    return digest.hexdigest()[:12]


def said(entries):
    """Those that are more than empty, null or false; whether a condition holds
    may be false or not known."""
    return [(k, v) for k, v in entries
            if isinstance(v, Number) or v or (k == "holds" and v is False)]


def compact(value):
    """One line of it; of many numbers their ends and their sum."""
    if isinstance(value, Number):
        return value
    if isinstance(value, dict):
        return "{%s}" % ", ".join(f"{k}: {compact(v)}"
                                  for k, v in said(value.items()))
    if not isinstance(value, list):
        return json.dumps(value, ensure_ascii=False)
    texts = [compact(v) for v in value]
    if len(value) > 2 * ENDS and all(v is None or isinstance(v, Number)
                                     for v in value):
        texts = texts[:ENDS] + [f"... {len(value)} numbers "
                                f"{sum_of(texts)} ..."] + texts[-ENDS:]
    return "[%s]" % ", ".join(texts)


def lines_of(value, name, indent=""):
    line = f"{indent}{name}{compact(value)}"
    if len(line) <= WIDTH or not isinstance(value, (dict, list)) or (
            isinstance(value, list) and "numbers " in line and
            isinstance(value[0], Number)):
        return [line]
    inner = ([(f"{k}: ", v) for k, v in said(value.items())]
             if isinstance(value, dict) else [("- ", v) for v in value])
    out = [f"{indent}{name}".rstrip()] if name else []
    for key, v in inner:
        out += lines_of(v, key, indent + " ")
    return out


def golden_of(report, section, folder):
    """What is said of a section, in lines."""
    own = os.path.join(report, folder)
    lines = lines_of(section, "")
    sums = {}
    for place, _, names in sorted(os.walk(own)):
        for name in sorted(names):
            path = os.path.join(place, name)
            kind = name.split(".", 1)[1]
            if kind == "json":
                lines += ["", *lines_of(read(path), os.path.relpath(path, own))]
            with open(path, encoding="utf-8") as f:
                sums.setdefault(kind, []).append(f.read())
    lines.append("")
    for kind, texts in sorted(sums.items()):
        lines.append(f"{len(texts)} files .{kind}, sum {sum_of(texts)}")
    return lines


def made(report, made_up):
    """Lines by name of the golden file."""
    claims = read(os.path.join(report, "claims.json"))
    whole = {name: open(os.path.join(report, name)).read()
             for name in ("report.md", "index.html")}
    files = {"report": lines_of(claims["provenance"], "provenance: ") + [
        s["experiment"] for s in claims["sections"]] + [
        f"{name}, sum {sum_of([text])}" for name, text in whole.items()]}
    for section in claims["sections"]:
        folder = section["experiment"].replace("/", "-")
        files[folder] = golden_of(report, section, folder)
    for section in read(os.path.join(made_up, "claims.json"))["sections"]:
        folder = "claims-" + section["experiment"].replace("/", "-")
        if section["claims"]:
            files[folder] = lines_of(section, "")
    return files


def first_difference(kept, new):
    """Number and text of the first line that differs."""
    for k in range(max(len(kept), len(new))):
        old = kept[k] if k < len(kept) else "(the end)"
        now = new[k] if k < len(new) else "(the end)"
        if old != now:
            return k + 1, old, now
    return None


def differs(name, new):
    """Says so with the file and its first line that differs."""
    path = os.path.join(GOLDEN, name + ".txt")
    kept = []
    if os.path.exists(path):
        with open(path, encoding="utf-8") as f:
            kept = f.read().splitlines()
    found = first_difference(kept, new)
    if found:
        line, old, now = found
        print(f"{path}:{line}\n  kept: {old}\n  made: {now}")
    return found is not None


def main():
    report = os.path.join(WORK, "report")
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    subprocess.run([PROGRAM, STORE, report], check=True)
    files = made(os.path.join(report, "smoke"),
                 os.path.join(report, "made-up"))
    if UPDATE:
        shutil.rmtree(GOLDEN, ignore_errors=True)
        os.makedirs(GOLDEN)
        for name, lines in files.items():
            with open(os.path.join(GOLDEN, name + ".txt"), "w",
                      encoding="utf-8") as f:
                f.write("\n".join(lines) + "\n")
        return 0
    gone = {n[:-4] for n in os.listdir(GOLDEN)} - files.keys()
    for name in sorted(gone):
        print(f"{GOLDEN}/{name}.txt: no such section is made")
    wrong = [name for name, lines in files.items() if differs(name, lines)]
    if not wrong and not gone:
        return 0
    print(f"{len(wrong) + len(gone)} of {len(files)} sections differ: {report} "
          "has the files that were made; if they are right, the same command "
          "with --update keeps them")
    return 1


sys.exit(main())
