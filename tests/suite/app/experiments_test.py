"""The first command of every experiment in README's table: the program over its
folder, which ./bench would build, runs its smoke profile and writes its page.

    experiments_test.py SOURCES BUILD [ROW...]

Without ROWs all of the table, whose programs are built first, where PHYSINV_FULL
is set, else status 77."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCES, BUILD = (pathlib.Path(p).resolve() for p in sys.argv[1:3])


def table():
    text = (SOURCES / "README.md").read_text()
    part = text.split("\n## The experiments\n")[1].split("\n## ")[0]
    return re.findall(r"^\| `([a-z/-]+)` \|", part, re.M)


def chosen(row, folder):
    """Folder and filter that ./bench takes for --filter=ROW."""
    script = ('root=$1; source "$root/cmake/folder_of.sh"; set -euo pipefail; '
              'find_folder --profile=smoke --filter="$2"; echo "$folder $filter"')
    done = subprocess.run(["bash", "-c", script, "-", SOURCES, row], text=True,
                          cwd=folder, check=True, capture_output=True)
    return done.stdout.rstrip("\n").split(" ", 1)


def program_of(folder):
    name = "physinv-" + folder.replace("/", "-") if folder else "physinv-bench"
    if not sys.argv[3:]:
        subprocess.run(["cmake", "--build", BUILD, "--target", name],
                       check=True, stdout=subprocess.DEVNULL)
    return BUILD / name


def first_command(row):
    with tempfile.TemporaryDirectory() as d:
        folder, expression = chosen(row, d)
        program = program_of(folder)
        arguments = ["--profile=smoke", "--filter=" + expression]
        done = subprocess.run([program, *arguments], cwd=d, text=True,
                              capture_output=True, timeout=600)
        if done.returncode != 0 or done.stderr:
            return [(row, arguments, done.returncode, done.stderr[:500])]
        page = pathlib.Path(d, "results/smoke/report/index.html")
        return [] if row.split("/")[-1] in page.read_text() else [(row, page)]


def main():
    rows = sys.argv[3:]
    if not rows and not os.environ.get("PHYSINV_FULL"):
        print("two minutes and a program for each row: ./check --full")
        sys.exit(77)
    assert len(table()) > 15 and set(rows) <= set(table()), table()
    wrong = [w for row in rows or table() for w in first_command(row)]
    sys.exit("\n".join(map(str, wrong)) if wrong else 0)


main()
