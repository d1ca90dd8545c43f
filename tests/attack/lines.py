"""Hostile command lines, environments and limits."""

import os
import resource
import signal

import sandbox

SMALL = ["--profile=smoke", "--filter=physgrad/comparison/gd/"]
# Cheap calls of the verbs, to which one more flag is added.
BASE = {
    "run": (["run", *SMALL, "--out=out"], ()),
    "list": (["list", *SMALL], ()),
    "plan": (["plan", *SMALL], ()),
    "report": (["report", "done"], ("done",)),
    "results": (["results", "--campaigns=campaigns"], ("campaigns",)),
    "verify": (["verify", "done"], ("done",)),
    "merge": (["merge", "joined", "part1", "part2"], ("part1", "part2")),
    "baseline": (["baseline", "done"], ("done",)),
    "gate": (["gate", "--baseline=base.txt", "--results=done", "--no-count"],
             ("base.txt", "done")),
    "compare": (["compare", "done", "part1"], ("done", "part1")),
    "export": (["export", "done"], ("done",)),
    "submit": (["submit", "--slurm=cluster", *SMALL], ()),
    "status": (["status", "cluster"], ("cluster",)),
    "completion": (["completion", "bash"], ()),
}
BOOLEAN = ("help", "resume", "fresh", "dry-run", "trace", "json", "methods",
           "claims", "allow-work", "count", "no-count", "strict", "update",
           "check", "workers", "benchmark_list_tests")
BOMBS = ["(.*)*(.*)*(.*)*QQ", "(" * 10_000, "((((a*)*)*)*)*b", "[", "\\",
         "a{1000000}", "((a{100}){100}){100}", "(?=x)", "(?<n>x)", "*", "+",
         "[z-a]", "\\x", "(" * 10_000 + ")" * 10_000, "x" * 100_000,
         "(x|" * 5000, "[[:alpha:", "(?i)", "a**", "{", "\udcff\udcfe",
         "(.+)+(.+)+(.+)+(.+)+$", "|" * 50_000, ".*" * 20_000]
VALUES = ["-", "--", "nan", "inf", "-1", "0", "1e999", "9" * 25, "\n", "a\nb",
          "\udcff\udcfe", "x" * 100_000, " ", "\t", "true", "0x10", "1/0",
          "%s%n", "$(touch home)", "a=b", "=", "==", "{}", "{0}", "'", '"',
          "missing/folder/file", "done/journal.jsonl/x", "home", "\x1b[2J",
          "1e-999", "-0", "+1", "1.5", "1,2,,3", "3-1", "x" * 300]
# Each has to end with 2 and to make nothing.
REFUSED = [
    ["run", "--out=", "--dry-run"], ["run", *SMALL, "--out", "", "--dry-run"],
    ["run", "--filter=", "--dry-run"], ["verify", "done", "x"],
    ["run", *SMALL, "--profile="], ["run", *SMALL, "--out=out", "--set="],
    ["run", *SMALL, "--out=out", "--set=n"], ["", *SMALL], ["nothing"],
    ["run", *SMALL, "--out=out", "--set==8"], ["-"], ["--out"],
    ["run", *SMALL, "--out=a", "--out=b"], ["run", "--=x"], ["run", "-=x"],
    ["run", *SMALL, "--out=out", "--jobs=0"], ["run", *SMALL, "--jobs=1.5"],
    ["run", *SMALL, "--out=out", "--threads=-1"],
    ["run", *SMALL, "--out=out", "--checkpoint=nan"],
    ["run", *SMALL, "--out=out", "--checkpoint=0"],
    ["run", *SMALL, "--out=out", "--time-budget=-1s"],
    ["run", *SMALL, "--out=out", "--time-budget=1e999h"],
    ["run", *SMALL, "--out=out", "--shard=0/3"],
    ["run", *SMALL, "--out=out", "--shard=1/99999999999999999999"],
    ["run", *SMALL, "--out=out", "--seeds=0-18446744073709551615"],
    ["run", *SMALL, "--out=out", "--set=n=0"],
    ["run", *SMALL, "--out=out", "--set=n=1-100000", "--seeds=0-99999"],
    ["run", *SMALL, "--out=out", "--set=methods=" + "x," * 20_000],
    ["run", *SMALL, "--out=out", "--cases=missing.txt"],
    ["run", *SMALL, "--out=out", "--cases=."],
    ["run", *SMALL, "--out=out", "--benchmark_format=xml"],
    ["gate", "--against=missing"],
    ["gate", "--baseline=missing"], ["gate", "--baseline=."],
    ["verify", "missing"], ["verify", ""], ["report", ""], ["merge", ""],
    ["merge", "a"], ["compare", "a"], ["export", "."], ["status", "."],
    ["completion", "tcsh"], ["verify", "--", "x", "y"],
]
ENVIRONMENTS = [
    {"HOME": ""}, {"HOME": "relative"}, {"HOME": "/nowhere"},
    {"XDG_CACHE_HOME": "relative"}, {"XDG_CACHE_HOME": "{box}/outside/pipe"},
    {"XDG_CACHE_HOME": "{box}/outside/data.h5"}, {"COLUMNS": "-1"},
    {"COLUMNS": "9" * 30}, {"COLUMNS": "0"}, {"COLUMNS": "x"},
    {"TERM": "\x1b[2J"}, {"LC_ALL": "xx_YY"}, {"LANG": "\udcff"},
    {"TZ": "../../outside/data.h5"}, {"TMPDIR": "/nowhere"}, {"PATH": ""},
    {"PATH": "{box}/outside/pipe"}, {"NO_COLOR": "1", "CI": ""},
    {"BENCHMARK_FILTER": "["}, {"BENCHMARK_FILTER": "(.*)*(.*)*(.*)*QQ"},
    {"BENCHMARK_FILTER": "(" * 10_000}, {"BENCHMARK_FORMAT": "xml"},
    {"BENCHMARK_OUT": "{box}/outside/notes"}, {"BENCHMARK_OUT": "missing/x"},
    {"BENCHMARK_OUT": "{box}/outside/pipe"},
    {"BENCHMARK_OUT": "{box}/outside/socket"},
    {"BENCHMARK_REPETITIONS": "-1"}, {"BENCHMARK_REPETITIONS": "9" * 20},
    {"BENCHMARK_REPETITIONS": "x"}, {"BENCHMARK_LIST_TESTS": "\udcff"},
    {"BENCHMARK_OUT_FORMAT": "yaml"}, {"GTEST_TOTAL_SHARDS": "0"},
    {"GTEST_TOTAL_SHARDS": "2"}, {"GTEST_SHARD_INDEX": "1"},
    {"GTEST_TOTAL_SHARDS": "2", "GTEST_SHARD_INDEX": "2"},
    {"GTEST_TOTAL_SHARDS": "1", "GTEST_SHARD_INDEX": "0",
     "GTEST_SHARD_STATUS_FILE": "{box}/outside/pipe"},
    {"PHYSINV_PUBLISHED_DIR": "/nowhere"}, {"PHYSINV_COUNT": "/bin/true"},
    {"PHYSINV_PUBLISHED_DIR": "{box}/outside/pipe"},
    {"PHYSINV_PUBLISHED_DIR": "{box}/outside"}, {"HDF5_PLUGIN_PATH": "x"},
    {"HDF5_USE_FILE_LOCKING": "x"}, {"OMP_NUM_THREADS": "0"},
    {"GIT_DIR": "{box}/outside/pipe"}, {"PYTHONPATH": "x" * 100_000},
    {"CXX_" + str(i): "x" * 1000 for i in range(1000)},
]


def soft(what, value):
    return lambda: resource.setrlimit(what, (value, value))


def close(*descriptors):
    return lambda: [os.close(d) for d in descriptors]


def without_folder():
    """The folder that it starts in was deleted."""
    os.makedirs("gone")
    os.chdir("gone")
    os.rmdir("../gone")


LIMITS = {
    # With three the loader itself cannot open a library.
    "4 files": soft(resource.RLIMIT_NOFILE, 4),
    "5 files": soft(resource.RLIMIT_NOFILE, 5),
    "9 files": soft(resource.RLIMIT_NOFILE, 9),
    "stack of 256 kB": soft(resource.RLIMIT_STACK, 256 << 10),
    "files of 0 bytes": soft(resource.RLIMIT_FSIZE, 0),
    "files of 1000 bytes": soft(resource.RLIMIT_FSIZE, 1000),
    "no locked memory": soft(resource.RLIMIT_MEMLOCK, 0),
    "closed input": close(0), "closed output": close(1),
    "closed errors": close(2), "all closed": close(0, 1, 2),
    "no folder": without_folder, "umask 777": lambda: os.umask(0o777),
    "SIGCHLD ignored": lambda: signal.signal(signal.SIGCHLD, signal.SIG_IGN),
    "SIGPIPE ignored": lambda: signal.signal(signal.SIGPIPE, signal.SIG_IGN),
    "signals blocked": lambda: signal.pthread_sigmask(
        signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM, signal.SIGCHLD)),
    "last in line": lambda: os.nice(19),
}


def refuse(attempt, arguments, needs=()):
    """Usage: 2, in one line, and nothing is made."""
    attempt.take(*needs)
    before = sandbox.snapshot(attempt.folder)
    ended = attempt.run(*arguments)
    attempt.expect(ended.code == 2, f"{ended.code} instead of 2")
    made = sandbox.differences(before, sandbox.snapshot(attempt.folder))
    attempt.expect(not made, f"did what nobody asked for: {made[:3]}")


def harmless(attempt, arguments, needs=(), codes=None, **kwargs):
    """Ends as documented; after a usage error nothing was made."""
    attempt.take(*needs)
    before = sandbox.snapshot(attempt.folder)
    ended = attempt.run(*arguments, limit=10, **kwargs)
    if codes:
        attempt.expect(ended.code in codes, f"exit {ended.code}")
    if ended.code == 2:
        made = [x for x in sandbox.differences(
            before, sandbox.snapshot(attempt.folder)) if x[0] != " "]
        attempt.expect(not made, f"refused, and yet made {made[:3]}")


def empty(attempt):
    """--flag= of every flag that takes a value."""
    rng = attempt.rng
    verb = rng.choice([v for v in BASE if flags_of(attempt.world, v)])
    flag = rng.choice(flags_of(attempt.world, verb))
    arguments, needs = BASE[verb]
    arguments = [a for a in arguments if not a.startswith(f"--{flag}=")]
    more = ["--dry-run"] if verb == "run" else []
    refuse(attempt, [*arguments, f"--{flag}=", *more], needs)


def flags_of(world, verb):
    if ("flags", verb) not in world.truths:
        text = world.start([verb, "--list-flags"], cwd=world.scratch).wait(10)
        world.truths["flags", verb] = [
            f[2:] for f in text.out.split() if f[2:] not in BOOLEAN]
    return world.truths["flags", verb]


def value(attempt):
    rng = attempt.rng
    verb = rng.choice([v for v in BASE if flags_of(attempt.world, v)])
    flag = rng.choice(flags_of(attempt.world, verb))
    text = rng.choice(VALUES)
    if flag in ("seeds", "set") and text.isdigit():
        text = "x"
    arguments, needs = BASE[verb]
    arguments = [a for a in arguments if not a.startswith(f"--{flag}=")]
    harmless(attempt, [*arguments, f"--{flag}={text}"], needs)


def bomb(attempt):
    text = attempt.rng.choice(BOMBS)
    how = attempt.rng.choice(("--filter=", "--filter=-", "--benchmark_filter=",
                              "BENCHMARK_FILTER", "gate", "count"))
    codes = (0, 2, 3)
    if how == "BENCHMARK_FILTER":
        harmless(attempt, ["run", *SMALL[:1], "--out=out", "--dry-run"],
                 codes=codes, env={how: text})
    elif how == "gate":
        harmless(attempt, ["gate", "--baseline=base.txt", "--results=done",
                           "--filter=" + text], ("base.txt", "done"),
                 codes=codes)
    elif how == "count":
        harmless(attempt, ["baseline", "done", "--out=b", "--count=" + text],
                 ("done",), codes=(0, 2, 3, 9))
    else:
        harmless(attempt, ["run", SMALL[0], "--out=out", "--dry-run",
                           how + text], codes=codes)


def variable(attempt):
    box = attempt.world.sandbox.root
    env = {k: v.replace("{box}", box)
           for k, v in attempt.rng.choice(ENVIRONMENTS).items()}
    attempt.note(str(env)[:200])
    verb = attempt.rng.choice(("run", "run", "run", "list", "plan", "report"))
    arguments, needs = BASE[verb]
    # The protocol of GoogleTest: a program that reads the variables creates the file.
    attempt.owned = lambda path: path == "home/.cache" or path == "home/" or (
        path.startswith("home/.cache/"))
    harmless(attempt, arguments, needs, env=env)


def limit(attempt):
    name = attempt.rng.choice(list(LIMITS))
    attempt.note(name)
    verb = attempt.rng.choice(("run", "run", "run", "list", "report", "export"))
    arguments, needs = BASE[verb]
    harmless(attempt, arguments, needs, prepare=LIMITS[name])


def refused(attempt):
    refuse(attempt, REFUSED[attempt.seed // 6 % len(REFUSED)],
           ("done", "base.txt"))


def lines(attempt):
    attempt.hits = 1
    forms = (refused, empty, value, bomb, variable, limit)
    attempt.owned = lambda path: path.startswith("home/.cache") or (
        path == "home/")
    forms[attempt.seed % len(forms)](attempt)
