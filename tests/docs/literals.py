"""Texts of C++ sources: what they print, runs of adjacent literals, and comments."""

import os
import re

FOLDERS = ("suite", "problems", "optimizers", "baselines", "reports",
           "python/module")
COMMENTED = (*FOLDERS, "examples", "tests")
# Comments, raw strings, characters and directives are skipped, so that a quote in
# one of them begins nothing.
TOKEN = re.compile(
    r"""//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|'(?:[^'\\\n]|\\.)+'"""
    r"""|^[ \t]*\#[^\n]*|(?P<run>"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*)""",
    re.S | re.M)
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')


def literals(text):
    """Line and text of each run that has two words."""
    for found in TOKEN.finditer(text):
        if found["run"]:
            words = "".join(LITERAL.findall(found["run"]))
            words = re.sub(r"\\n", " ", re.sub(r'\\(["\\])', r"\1", words))
            if re.search(r"[a-z]{2,} [a-z]{2,}", words):
                yield text.count("\n", 0, found.start()) + 1, words


def comments_of(text):
    """First line and text of each comment: lines that follow each other are one."""
    first, end, words = 0, 0, []
    for found in TOKEN.finditer(text):
        if not found[0].startswith("//"):
            continue
        line = text.count("\n", 0, found.start()) + 1
        if words and line != end + 1:
            yield first, " ".join(words)
            words = []
        if not words:
            first = line
        words.append(found[0].lstrip("/!<").strip())
        end = line
    if words:
        yield first, " ".join(words)


def texts(sources, folders, texts_of):
    """Place and text of what `texts_of` finds in each file of the sources."""
    for folder in folders:
        for path, _, names in os.walk(os.path.join(sources, folder)):
            for name in sorted(names):
                if name.endswith((".h", ".cpp")):
                    file = os.path.join(path, name)
                    with open(file) as f:
                        for line, words in texts_of(f.read()):
                            yield f"{os.path.relpath(file, sources)}:{line}", words


def printed(sources):
    """Place and text of each literal of the sources."""
    return texts(sources, FOLDERS, literals)


def comments(sources):
    """Place and text of each comment of the sources."""
    return texts(sources, COMMENTED, comments_of)
