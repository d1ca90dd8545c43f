"""The pages of the sources, and the commands that they show."""

import glob
import os
import re

PAGES = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "RESULTS.md",
         "docs/**/*.md"]


def pages(sources):
    """Name and text of each."""
    for pattern in PAGES:
        for path in glob.glob(os.path.join(sources, pattern), recursive=True):
            with open(path) as f:
                yield os.path.relpath(path, sources), f.read()


def commands(text):
    """Arguments of each ./bench line of the fenced blocks."""
    for block in re.findall(r"^```(?:sh|yaml)\n(.*?)^```", text, re.S | re.M):
        for line in block.splitlines():
            found = re.search(r"(?:^|\s)\S*/bench\s+(.*)", line)
            if found:  # up to a comment, another program's flags, the shell's own
                yield re.split(r"#| -- | [|&>]", found[1])[0].split()
