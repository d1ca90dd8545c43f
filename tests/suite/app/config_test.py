"""The file of --config: TOML and JSON as their standards have them, and what is
wrong with one is said with its line. In every file that a user gives a byte order
mark is skipped.

    config_test.py PROGRAM
"""

import json
import os
import sys
import tempfile

from program import FAILED, check, expect, run

MARK = b"\xef\xbb\xbf"
WALK, DESCEND = "fake/cubic/walk/n=4/seed=0", "fake/cubic/descend/n=4/seed=0"
BOTH = [DESCEND, WALK]
SMOKE = 'profile = "smoke"\n'

GOOD = {  # file -> what it chooses
    SMOKE + 'filter = [ # all of "these"]\n  "walk",\n  "desc\\u0065nd",\n]': BOTH,
    'profile = """\\\n   smoke"""\nfilter = "walk"': [WALK],
    SMOKE + "filter = '''\nwalk'''": [WALK],
    SMOKE + "filter = '^fake/cubic/walk/n=\\d+/'  # a # comment": [WALK],
    SMOKE + 'filter = "^fake/cubic/walk/n=\\\\d+/"': [WALK],
    SMOKE + 'filter = "\\u005e.*/w\\U00000061lk/"': [WALK],
    SMOKE + "filter = 'walk'\r\njobs = 0x2\r\ntrace = true\r\n": [WALK],
    SMOKE + 'filter = "walk"\nseeds = [0, 1]': [WALK, WALK[:-1] + "1"],
    SMOKE + 'filter = "walk"\nset = ["seeds=0,1", "n=4"]':
        [WALK, WALK[:-1] + "1"],
    '"profile" = "smoke"\n"filter" = "walk"\nj = 2': [WALK],
    '{"profile": "smoke",\n "filter": ["w\\u0061lk"], "seeds": [0]}': [WALK],
}
BAD = {  # file -> what is said
    SMOKE + 'filter = "wal#k"': (3, "matches 'wal#k'"),
    "\n\nprofil = 'smoke'": (2, "{}:3: unknown key 'profil'; did you mean prof"),
    SMOKE + "[run]\njobs = 1": (2, "{}:2: run must be text, a number"),
    SMOKE + "a.b = 1": (2, "{}:2: a must be text, a number"),
    SMOKE + "out = 1979-05-27": (2, "{}:2: out must be text, a number"),
    "filter = [['walk']]": (2, "{}:1: filter must be text, a number"),
    "filter = []": (2, "{}:1: filter is an empty list"),
    "filter = ['walk', '']": (2, "{}:1: --filter= is empty"),
    'out = "a\\u0000b"': (2, "{}:1: --out= contains a null character"),
    "\nprofile = ['smoke', 'quick']": (2, "{}:2: profile: takes one value"),
    "\njobs = 1.5": (2, "{}:2: jobs: 1.5 is not a whole number"),
    "\ntrace = 7": (2, "{}:2: --trace=7 is not a boolean"),
    "help = true": (2, "{}:1: unknown key 'help'"),
    "config = 'x'": (2, "{}:1: unknown key 'config'"),
    "FILTER = 'walk'": (2, "{}:1: unknown key 'FILTER'"),
    SMOKE + SMOKE: (2, "{}:2: the file of --config is not valid TOML"),
    SMOKE + "out = \"a": (2, "{}:2: the file of --config is not valid TOML"),
    '{"profile": "smoke",\n"profile": "quick"}': (2, "{}:2: 'profile' appears tw"),
    '{"profile":\n"smoke",,}': (2, "{}:2: the file of --config is not valid JSON"),
    '{"jobs": 1e400}': (2, "{}:1: the file of --config is not valid JSON"),
    '{"jobs": null}': (2, "{}:1: jobs must be text, a number"),
    '{\n"filte": "walk"}': (2, "{}:2: unknown key 'filte'; did you mean filter"),
}


def write(d, name, data):
    with open(os.path.join(d, name), "wb") as f:
        f.write(data if isinstance(data, bytes) else data.encode())


def name_of(text):
    return "c.json" if text.startswith("{") else "c.toml"


def what_is_chosen(d):
    for text, names in GOOD.items():
        for mark in (b"", MARK):
            write(d, name_of(text), mark + text.encode())
            p = run("run", "--benchmark_list_tests", "--config=" +
                    name_of(text), cwd=d)
            check(p.returncode == 0 and p.stdout.split() == names,
                  f"{text!r}: {p.stdout} {p.stderr}")


def what_is_wrong(d):
    for text, (code, says) in BAD.items():
        name = name_of(text)
        write(d, name, text)
        expect(code, ["run", "--benchmark_list_tests", "--config=" + name], d,
               says.replace("{}", name))
    for name, text, says in (("c.json", SMOKE, "valid JSON"), ("c.json", "", "valid J"),
                             ("c.json", "[1]", "is not a JSON object"),
                             ("c.toml", '{"profile": "smoke"}', "valid TOML"),
                             ("c.toml", b'out = "\xff"', "valid TOML")):
        write(d, name, text)
        expect(2, ["--config=" + name], d, says)


def results_go_where_it_says(d):
    folder = 'run#1 "\\x"'
    text = f"profile = 'smoke'\nfilter = 'walk'\nout = '{folder}' # here\n"
    write(d, "c.toml", MARK + text.encode())
    expect(0, ["--config=c.toml"], d, "stages run")
    with open(os.path.join(d, folder, "results.json")) as f:
        check(json.load(f)["context"]["options"]["config"] == text,
              "its text is recorded, without the mark")


def byte_order_marks(d):
    write(d, "names.txt", MARK + WALK.encode() + b"\r\n")
    p = run("list", "--profile=smoke", "--cases=names.txt", cwd=d)
    check(p.returncode == 0 and WALK in p.stdout, "a list of cases " + p.stderr)
    expect(0, ["--profile=smoke", "--trace", "--filter=walk", "--out=r"], d)
    expect(0, ["baseline", "r", "--out=b.txt"], d, "2 stages")
    gate = ["gate", "--results=r", "--no-count"]
    with open(os.path.join(d, "b.txt"), "rb") as f:
        baseline = f.read()
    write(d, "marked.txt", MARK + baseline)
    expect(0, [*gate, "--baseline=marked.txt"], d)
    write(d, "crlf.txt", baseline.replace(b"\n", b"\r\n"))
    expect(9, [*gate, "--baseline=crlf.txt"], d,
           "crlf.txt has lines that end with CR and LF")


with tempfile.TemporaryDirectory() as directory:
    os.mkdir(os.path.join(directory, "published"))
    for test in (what_is_chosen, what_is_wrong, results_go_where_it_says,
                 byte_order_marks):
        test(directory)
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
