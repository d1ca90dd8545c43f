#!/usr/bin/env python3
"""docs_test.py PROGRAM SOURCES: what the pages say of files and commands.

README is short, every link leads to a file and place, commands have the verbs and
flags of the program, counts are the program's and verdicts those of RESULTS.md,
where what is not reproduced has a cause. Prose, help texts and what sources print
have short sentences and usual words, comments of sources usual words.
Pages of papers have no measured numbers:
those are on pages that the program writes. The table of features has a sign of
each suite. The baseline of CI has all cases of its profile. A source that a page or
a comment names is there.
"""

import functools
import json
import os
import re
import subprocess
import sys

from documented import commands, pages
from literals import comments, printed

PROGRAM, SOURCES = sys.argv[1:3]
LINES_OF_README = 150


def read(name):
    with open(os.path.join(SOURCES, name)) as f:
        return f.read()


@functools.cache
def output(*arguments):
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)
    return done.stdout


def dead_links(name, text):
    for target, place in re.findall(r"\]\(([^)#]*)(?:#([^)]*))?\)", text):
        if re.match(r"https?:", target):
            continue
        path = os.path.join(SOURCES, os.path.dirname(name), target) \
            if target else os.path.join(SOURCES, name)
        if not os.path.exists(path):
            yield f"{name}: the link '{target}' leads nowhere"
        elif place and path.endswith(".md") and place not in places_of(path):
            yield f"{name}: '{target}' has no '#{place}'"


# Of Google Benchmark, and examples.
OTHER_SOURCES = {"compare.py", "first.py", "x.h", "x.cpp"}


@functools.cache
def ends_of_paths():
    """Of each source all that a page may call it: c.h, b/c.h, a/b/c.h."""
    ends = set(OTHER_SOURCES)
    for top in ("suite", "problems", "optimizers", "baselines", "reports",
                "tests", "python", "examples", "cmake"):
        for folder, _, names in os.walk(os.path.join(SOURCES, top)):
            parts = os.path.relpath(folder, SOURCES).split(os.sep)
            ends |= {"/".join([*parts[k:], name]) for name in names
                     for k in range(len(parts) + 1)}
    return ends


def lost_sources(name, text):
    for source in re.findall(
            r"(?<![\w/.*<-])((?:\w+/)*[a-z_]\w*\.(?:h|cpp|py|cmake))\b", text):
        if source not in ends_of_paths():
            yield f"{name}: there is no '{source}'"


def lost_in_comments():
    for top in ("suite", "problems", "optimizers", "baselines", "reports"):
        for folder, _, names in os.walk(os.path.join(SOURCES, top)):
            for name in names:
                if name.endswith((".h", ".cpp")):
                    path = os.path.relpath(os.path.join(folder, name), SOURCES)
                    comments = re.findall(r"//.*", read(path))
                    yield from lost_sources(path, "\n".join(comments))


@functools.cache
def places_of(path):
    """Headings as GitHub links to them."""
    with open(path) as f:
        heads = re.findall(r"^#+ (.*)$", f.read(), re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-")
            for head in heads}


def measured(name, text):
    """Numbers with a unit of what is measured, where the program writes them."""
    if not re.match(r"README|docs/papers/|docs/(numerics|clusters|gate)\.md", name):
        return
    prose = re.sub(r"```.*?```|`[^`]*`", "", text, flags=re.S)
    for found in re.finditer(
            r"(?<![\w.])\d+\.\d+ (?:%|ms|us|ns|s|min|h)\b|"
            r"(?<![\w.])\d+ (?:ms|us|ns|MB|kB|GB|hours|GFLOP)\b", prose):
        yield f"{name}: '{found[0]}' is written by hand"


# Pages whose prose is held to plain English.
PLAIN = {"README.md", "CONTRIBUTING.md", *(f"docs/{name}.md" for name in (
    "architecture", "claims", "clusters", "compare", "data", "extending",
    "features", "gate", "methods", "numerics", "output", "performance",
    "processors", "python", "running", "solvers", "tutorial", "verdicts"))}
LONGEST_SENTENCE = 35  # words
# What these say has a usual word: next to, running, saves, resumes, prints, ...
UNUSUAL = re.compile(
    r"\b(besides?(?!\()|whoever|nobody|under way|anew|all else|one's own|"
    r"lays? down|(?:takes?|taken|took) up|c[ao]mes? to(?! rest)|goe?s? by|"
    r"hangs? on|goe?s? along(?! the)|"
    r"all the same|stands? (?:in|at|apart|below|on|beside)|held against|"
    r"(?:is|are) told|tells|holds? (?:it|them )?against)\b", re.I)


def prose(text):
    """Paragraphs and items of lists, without code, tables and headings."""
    text = re.sub(r"```.*?```", "", text, flags=re.S)
    for block in re.split(r"\n\s*\n|\n(?=[-*] |\d+\. )", text):
        if not block.lstrip().startswith(("|", "#", "!")):
            yield re.sub(r"\]\([^)]*\)|`[^`]*`", "x", " ".join(block.split()))


def unusual_words(name, words, unusual):
    for found in unusual.finditer(words):
        yield (f"{name}: '{found[0]}' in "
               f"'{words[max(0, found.start() - 30):found.end() + 30]}'")


def not_plain(name, text, unusual=UNUSUAL):
    """Words that have a usual one, and sentences that are too long."""
    for words in prose(text):
        yield from unusual_words(name, words, unusual)
        for sentence in re.split(r"(?<=[.!?:;])\s+", words):
            count = len(sentence.split())
            if count > LONGEST_SENTENCE:
                yield f"{name}: {count} words: {sentence[:60]}..."


def help_not_plain():
    """The same of what --help prints, a line of each option."""
    verbs = set(output("--list-verbs").split()) - {"kernels"}
    for verb in [(), *((verb,) for verb in sorted(verbs))]:
        text = output(*verb, "--help")
        if len(text) < 100:
            yield f"--help of {verb} says nothing"
        words = re.sub(r"\n {10,}", " ", text)  # lines that continue
        words = re.sub(r"\s*\n\s*", "\n\n", re.sub(r"`.*?`", "x", words))
        name = " ".join(["--help of", *verb])
        yield from not_plain(name, words.replace("  ", ": "))


# The same of texts in sources: is not a, known values, expected, continues, ...
UNUSUAL_PRINTED = re.compile(
    UNUSUAL.pattern + r"|(?<!there )\bis no\b(?! longer)|\b(?:known|nearest) are\b|"
    r"\b(?:is|are) right\b|\blaid\b|\bstands?\b (?:twice|still|for)|"
    r"\bgo(?:es|ing)? on\b|\bwant of\b|\bmakes? up for\b|\basked? for\b|"
    r"\bof (?:its|their) own\b|\bnumbers? from \d+ on\b|\bis of\b", re.I)
# Titles and names that published campaigns store.
STORED = {"Small batches, and Gauss-Newton beside HIG",
          "Sizes and seeds stand below the table of each experiment.",
          "motions that nobody observes"}


def not_plainly_printed():
    """The same of what programs print, and that their sources are found."""
    count = 0
    for place, words in printed(SOURCES):
        count += 1
        if words not in STORED:
            yield from not_plain(place, words, UNUSUAL_PRINTED)
    if count < 1000:
        yield f"only {count} texts found in the sources"


# The same of comments, whose sentences may be long: continues, saves, says, ...
UNUSUAL_IN_COMMENTS = re.compile(
    UNUSUAL.pattern + r"|\bgo(?:es|ing)? on\b|\blaid\b(?! out)", re.I)


def comments_not_plain():
    count = 0
    for place, words in comments(SOURCES):
        count += 1
        yield from unusual_words(place, words, UNUSUAL_IN_COMMENTS)
    if count < 1000:
        yield f"only {count} comments found in the sources"


SUITES = 17
FEATURES = 47


def features():
    """Rows of docs/features.md: here and elsewhere, one sign each."""
    text = read("docs/features.md")
    named = re.search(r"^Columns: (.*?)\n\n", text, re.S | re.M)[1]
    suites = re.findall(r"(\d+)\s+\[", named)
    if suites != [str(k + 1) for k in range(SUITES)]:
        yield f"docs/features.md: {len(suites)} suites"
    rows = re.findall(r"^\| [a-z].*\|$", text, re.M | re.I)
    if len(rows) != FEATURES:
        yield f"docs/features.md: {len(rows)} features"
    for row in rows:
        signs = [cell.strip() for cell in row.split("|")[2:-1]]
        if len(signs) != 1 + SUITES or not set(signs) <= set("+o–?"):
            yield f"docs/features.md: {row}"


def unknown_words(name, text):
    verbs = set(re.findall(r"^physinv-bench (\w+) ", output("--help"), re.M))
    for arguments in commands(text):
        verb = arguments[0] if arguments and arguments[0][0] != "-" else "run"
        if verb not in verbs | {"run"}:
            yield f"{name}: './bench {' '.join(arguments)}' names no verb"
            continue
        flags = [a.split("=")[0] for a in arguments if a.startswith("--")]
        for flag in flags:
            known = output(verb, "--help") + ("--help --version" if verb == "run" else "")
            if not re.search(re.escape(flag) + r"(?![\w-])", known):
                yield f"{name}: './bench {verb}' has no flag {flag}"


def wrong_counts():
    """The table of profiles: | `smoke` | 233, 165 | ..."""
    rows = re.findall(r"^\| `(\w+)`[^|]*\| (\d+), (\d+) \|", read("README.md"),
                      re.M)
    if not rows:
        yield "README.md: no table of profiles"
    for profile, *said in rows:
        names = re.findall(r"^\S+/\S+", output("list", "--profile=" + profile),
                           re.M)
        papers = [n for n in names if not re.match("matrix/|numerics/", n)]
        found = [str(len(names)), str(len(papers))]
        if found != said:
            yield f"README.md: profile {profile} has {', '.join(found)} cases"


def baseline():
    """The baseline that CI gates by has the cases of its profile, all of them."""
    listed = {case["name"] for case in json.loads(
        output("list", "--all", "--profile=smoke", "--json"))}
    kept = {name.rsplit("/", 1)[0] for name in re.findall(
        r"^(\S+) trajectory=", read("reports/baselines/smoke.txt"), re.M)}
    if kept != listed:
        yield (f"reports/baselines/smoke.txt lacks {len(listed - kept)} of "
               f"{len(listed)} cases and has {len(kept - listed)} others")


def wrong_verdicts():
    rows = re.findall(r"^\| (?:hig|jpo|physgrad|sip) (?:\| \d+ ){5}\|$",
                      read("RESULTS.md"), re.M)
    for row in rows or ["(none)"]:
        if row not in read("README.md"):
            yield f"README.md lacks the verdicts of RESULTS.md: {row}"


FAILING = r"not reproduced|differs \((?:stronger|weaker)\)|depends|contradiction"
OPEN = FAILING + "|partly judged|not judged|reported"


def results_rows():
    """Claim, verdict and cause of each row of RESULTS.md."""
    return re.findall(
        rf"^\| \[(\S+)\]\(\S+\) (\S+) \| .* \| ({OPEN}) \| (.*) \|$",
        read("RESULTS.md").replace("\\|", "/"), re.M)


def page_rows():
    """Claim, verdict and all that was measured, of the experiments' pages."""
    for name, text in pages(SOURCES):
        if not name.startswith("docs/results/"):
            continue
        if name.endswith("/regression-checks.md"):
            continue
        experiment = re.search(r"^# .* \(`(.*)`\)$", text, re.M)[1]
        for row in re.findall(
                rf"^\| (\S+) \| .* \| ({OPEN}|reproduced) \| (.*) \| "
                r"[^|]+ \|$", text.replace("\\|", "/"), re.M):
            yield f"{experiment} {row[0]}", row[1], row[2]


def registered():
    """Every claim of a paper that the program lists."""
    for claim in json.loads(output("list", "--claims", "--format=json")):
        if claim["origin"] == "paper":
            yield claim["of"] + " " + claim["id"]


def unexplained():
    """Claims without a cause, in RESULTS.md and in the experiments' pages."""
    stated = results_rows()
    found = [f"{experiment} {claim}" for experiment, claim, _, _ in stated]
    for name in {name for name in found if found.count(name) > 1}:
        yield f"RESULTS.md has {name} more than once"
    for experiment, claim, verdict, cause in stated:
        if cause in ("", "unknown"):
            yield f"RESULTS.md has no cause of {experiment} {claim}"
    rows = list(page_rows())
    for name, verdict, words in rows:
        if re.fullmatch(OPEN, verdict) and "Cause: " not in words:
            yield f"docs/results has no cause of {name}, {verdict}"
        if "its cause is stale" in words:
            yield f"docs/results: {name} holds, its cause is stale"
    judged = dict((name, verdict) for name, verdict, _ in rows)
    for name in registered():
        if name not in judged:
            yield f"docs/results lacks {name}"
        elif judged[name] not in ("reproduced", "reported") and name not in found:
            yield f"RESULTS.md lacks {name}, {judged[name]}"
    if len(rows) < 200 or len(found) < 50:
        yield f"{len(found)} claims in RESULTS.md, {len(rows)} in docs/results"


def main():
    wrong = [*wrong_counts(), *wrong_verdicts(), *unexplained(), *features(),
             *baseline(), *lost_in_comments(), *help_not_plain(),
             *not_plainly_printed(), *comments_not_plain()]
    lines = read("README.md").count("\n")
    if lines > LINES_OF_README:
        wrong.append(f"README.md has {lines} lines, of {LINES_OF_README}")
    checked = 0
    for name, text in pages(SOURCES):
        wrong += [*dead_links(name, text), *unknown_words(name, text),
                  *measured(name, text)]
        if name in PLAIN:
            wrong += not_plain(name, text)
        if name != "CHANGELOG.md":  # names what was
            spans = re.findall("`[^`\n]*`", text)
            wrong += lost_sources(name, "\n".join(spans))
        checked += len(list(commands(text)))
    if checked < 20:
        wrong.append(f"only {checked} commands found")
    print("\n".join(wrong) or f"{checked} commands: all right")
    sys.exit(1 if wrong else 0)


main()
