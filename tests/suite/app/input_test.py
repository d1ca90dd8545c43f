"""What command line and environment say: values that are empty, expressions
that never end, numbers of other kinds, flags against variables, file names of
any bytes, and a hundred wrong lines.

  input_test.py PROGRAM
"""

import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

from program import BENCH, FAILED, check, crc32c, expect, run

CODES = {0, 2, 3, 4, 5, 6, 7, 8, 9, 10}


def names_in(d):
    return sorted(os.listdir(d))


def empty_values(d):
    """A variable that is not set never chooses another action."""
    before = names_in(d)
    for flag in ("out", "filter", "profile", "set", "seeds", "shard", "cases",
                 "jobs", "threads", "time-budget", "checkpoint", "trace",
                 "dry-run", "benchmark_filter", "benchmark_out"):
        for verb in ([], ["run"]):
            expect(2, [*verb, f"--{flag}=", "--dry-run"], d, f"--{flag}= is")
    for args in (["list", "--edit="], ["plan", "--against="],
                 ["report", "x", "--out="], ["results", "--campaigns="],
                 ["baseline", "x", "--count="], ["gate", "--baseline="],
                 ["compare", "a", "b", "--by="], ["export", "x", "--format="],
                 ["submit", "--slurm="], ["kernels", "--benchmark_filter="],
                 ["no-such-verb", "--x="]):
        expect(2, args, d, "is empty")
    for args in ([""], ["--out", "", "--dry-run"], ["--filter", ""],
                 ["verify", ""], ["merge", "", "x"], ["status", ""],
                 ["completion", ""]):
        expect(2, args, d, "an argument is empty")
    check(names_in(d) == before, "nothing was written")


def long_names(d):
    """No file has a name of 300 characters, which is said like of any other."""
    name = "x" * 300
    for args in ([f"--cases={name}"], ["plan", f"--against={name}"],
                 ["report", name], ["compare", name, name], ["verify", name],
                 ["gate", f"--baseline={name}"], ["export", name],
                 ["results", f"--campaigns={name}"], [f"--plugin={name}"],
                 ["report", name, f"--published={name}"]):
        p = run(*args, cwd=d)
        check(p.returncode == 2, f"{args[0]} of a long name: {p.returncode}")
        check("filesystem error" not in p.stderr, p.stderr)


def expressions(d):
    """Linear in time, limited in length; what the README says stays right."""
    slow = "(.*)*(.*)*(.*)*QQ"
    deep = "(" * 10000 + ")" * 10000
    begin = time.time()
    for flag in ("--filter=", "--benchmark_filter=", "--filter=-"):
        want = 0 if flag.endswith("-") else 3
        expect(want, ["list", flag + slow] if "bench" not in flag
               else ["--benchmark_list_tests", flag + slow], d,
               "cases" if want == 0 else "nearest")
        expect(2, ["--benchmark_list_tests", flag + deep], d, "characters")
    expect(3, [], d, "nearest", env={"BENCHMARK_FILTER": slow})
    expect(2, [], d, "BENCHMARK_FILTER is a regular expression of 20000",
           env={"BENCHMARK_FILTER": deep})
    expect(2, [], d, "BENCHMARK_FILTER='(x'", env={"BENCHMARK_FILTER": "(x"})
    expect(0, ["list", "--filter=" + "(" * 2000 + ")" * 2000], d, "18 cases")
    expect(2, ["--filter=((((x{100}){100}){100}){100})"], d,
           "regular expression")
    expect(2, ["--filter=(?=x)"], d, "regular expression")
    expect(2, ["kernels", "--benchmark_filter=(x"], d, "--benchmark_filter=")
    check(time.time() - begin < 20, "none takes long")
    for pattern, cases in (("walk/n=4/seed=0", 1), ("^fake/.*/(walk|stroll)/", 2),
                           ("-walk", 3), ("seed=[1-9]", None), (r"n=\d+/", 4)):
        p = run("list", "--json", "--profile=smoke", "--filter=" + pattern,
                cwd=d)
        found = len(json.loads(p.stdout)) if p.returncode == 0 else None
        check(found == cases, f"{pattern} finds {found}")


def kernels(d):
    """Google Benchmark gets names, and not an expression that never ends."""
    home = os.path.join(d, "bin")
    os.mkdir(home)
    bench = os.path.join(home, "physinv-bench")
    shutil.copy(BENCH, bench)
    with open(os.path.join(home, "physinv-kernels"), "w") as f:
        f.write("""#!/bin/sh
for a; do
  [ "$a" != --benchmark_list_tests ] || { printf 'a<b>/1\\na+b\\nc\\n'; exit; }
done
printf '%s\\n' "$@"
""")
    os.chmod(f.name, 0o755)

    def ask(*args, env=None):
        return subprocess.run([bench, "kernels", *args], text=True,
                              capture_output=True, timeout=20,
                              env={**os.environ, **(env or {})})

    flag = "--benchmark_filter="
    check(ask(flag + "^a", "--v=1").stdout ==
          f"--v=1\n{flag}^a<b>/1$|^a\\+b$\n", "names that match")
    check(ask(flag + "-^a").stdout == flag + "^c$\n", "a leading - negates")
    check(ask(env={"BENCHMARK_FILTER": "c"}).stdout == flag + "^c$\n",
          "the variable")
    check(ask(flag + "a<", env={"BENCHMARK_FILTER": "c"}).stdout
          == flag + "^a<b>/1$\n", "gives way to the flag")
    p = ask(flag + "(.*)*(.*)*(.*)*QQ")
    check(p.returncode == 3 and len(p.stderr.splitlines()) == 1,
          "nothing matches: " + p.stderr)


def switches_and_numbers(d):
    """What CLI11 reads as something else is refused."""
    for value in ("-1", "7", "maybe", "2"):
        expect(2, ["--dry-run=" + value], d, "not a boolean")
    expect(2, ["--resume=-3"], d, "not a boolean")
    expect(0, ["--profile=smoke", "--dry-run=true"], d, "6 stages to run")
    for number in ("010", "0x2", "1.5", "1e3", "-1", "0", "1025", "inf", "nan",
                   "99999999999999999999", "١", " 1"):
        expect(2, ["--jobs=" + number, "--dry-run"], d,
               "is not a whole number from 1 to 1024")
        expect(2, ["--benchmark_repetitions=" + number, "--dry-run"], d)
    expect(2, ["--benchmark_repetitions=2", "--share-cores", "--dry-run"], d,
           "use one of the two")
    for number in ("nan", "inf", "-1", "0", "1e999", "0x10", "1,5", "one"):
        expect(2, ["gate", "--against=x", "--budget=" + number], d,
               "is not positive and finite")


def variables(d):
    """They give way to flags of the same name, whatever they hold; empty ones
    are as if they were not set."""
    smoke = ["--profile=smoke", "--benchmark_list_tests"]
    names = run(*smoke, cwd=d).stdout.split()
    p = run(*smoke, "--benchmark_filter=walk", cwd=d,
            env={"BENCHMARK_FILTER": "descend"})
    check(len(p.stdout.split()) == 1, "BENCHMARK_FILTER gives way")
    p = run(*smoke, "--filter=walk", cwd=d, env={"BENCHMARK_FILTER": "descend"})
    check(len(p.stdout.split()) == 1, "and to --filter")
    bad = {"BENCHMARK_REPETITIONS": "few", "BENCHMARK_FORMAT": "xml",
           "BENCHMARK_OUT_FORMAT": "xml", "BENCHMARK_FILTER": "(",
           "BENCHMARK_OUT": os.path.join(d, "not", "there"),
           "BENCHMARK_LIST_TESTS": "1", "GTEST_TOTAL_SHARDS": "few"}
    flags = ["--benchmark_repetitions=1", "--benchmark_format=console",
             "--benchmark_out_format=json", "--benchmark_filter=walk",
             "--benchmark_out=" + os.path.join(d, "out.json"), "--shard=1/1",
             "--benchmark_list_tests=false"]
    expect(0, ["--profile=smoke", "--out=v", *flags], d, "results: v", env=bad)
    check(os.path.exists(os.path.join(d, "out.json")), "--benchmark_out")
    for name, value in bad.items():
        if value != "1":
            p = run("--profile=smoke", "--out=w", cwd=d, env={name: value})
            check(p.returncode in (2, 9), f"{name} alone counts")
    empty = dict.fromkeys((*bad, "GTEST_SHARD_INDEX", "PHYSINV_COUNT",
                           "GTEST_SHARD_STATUS_FILE", "COLUMNS", "CI",
                           "GITHUB_STEP_SUMMARY", "GITHUB_ACTIONS"), "")
    p = expect(0, ["--profile=smoke", "--dry-run"], d, "6 stages to run",
               env=empty)
    check(run(*smoke, cwd=d, env=empty).stdout.split() == names,
          "empty variables")
    expect(0, ["--profile=smoke", "--dry-run"], d,
           env={"COLUMNS": "9" * 30})
    kept = os.path.join(d, "kept")
    with open(kept, "w") as f:
        f.write("mine")
    run(*smoke, cwd=d, env={"GTEST_TOTAL_SHARDS": "2", "GTEST_SHARD_INDEX": "1",
                            "GTEST_SHARD_STATUS_FILE": kept})
    with open(kept) as f:
        check(f.read() == "mine", "a status file that was there is kept")
    os.mkfifo(os.path.join(d, "fifo"))
    p = run(*smoke, cwd=d, env={"GTEST_TOTAL_SHARDS": "1",
                                "GTEST_SHARD_INDEX": "0",
                                "GTEST_SHARD_STATUS_FILE": d + "/fifo"})
    check(p.returncode == 0, "a status file that is a pipe")


def cases_of_windows(d):
    """CRLF, and repeated names."""
    names = run("--profile=smoke", "--benchmark_list_tests", cwd=d
                ).stdout.split()
    path = os.path.join(d, "names.txt")
    with open(path, "wb") as f:
        f.write("\r\n".join([names[2], "", names[0], names[2], ""]).encode())
    p = run("--profile=smoke", "--benchmark_list_tests", "--cases=" + path,
            cwd=d)
    check(p.stdout.split() == [names[2], names[0]], "--cases takes CRLF")


def damaged_speeds(d):
    """A cache of what no trial can measure is measured again; without a place of
    the user's own nothing is kept."""
    cache = os.path.join(d, "speeds")
    env = {"XDG_CACHE_HOME": cache}
    plan = ["plan", "--profile=smoke", "--filter=walk", "--json", "--exact"]
    run(*plan, cwd=d, env=env)
    path = os.path.join(cache, "physinv", os.listdir(cache + "/physinv")[0])
    with open(path) as f:
        good = json.load(f)

    def put(value, at):
        bad = json.loads(json.dumps(good))
        for stages in bad["trials"].values():
            for stage in stages:
                if at < len(stage):
                    stage[at] = value
        with open(path, "w") as f:
            json.dump(bad, f)

    for value in (-1, 1e300, float("inf"), float("nan"), None, "x", [], 1e16):
        for at in (0, 1, 5):
            put(value, at)
            p = run(*plan, cwd=d, env=env)
            if isinstance(value, float) and not math.isfinite(value):  # no JSON
                costs = json.loads(p.stdout)
                check(all(0 < c["seconds"] < 1e3 and
                          0 < c["memory_bytes"] < 1e12 for c in costs) and
                      "measuring" in p.stderr,
                      f"a cache with {value} at {at} is measured anew")
            else:
                check(p.returncode == 9 and not p.stdout and path in p.stderr,
                      f"a cache with {value} at {at} is named")
    for stages in ([], [[1, 1, 1, 1, 1, 1, 1]] * 50, {"a": 1}, 5):
        with open(path, "w") as f:
            json.dump({"trials": dict.fromkeys(good["trials"], stages)}, f)
        p = run(*plan, cwd=d, env=env)
        check(p.returncode == 0 or (p.returncode == 9 and path in p.stderr),
              f"stages {stages}")
    os.remove(path)

    for name in ("tmp", "here"):
        os.mkdir(os.path.join(d, name))
    for home in ({}, {"HOME": ""}, {"HOME": "home"}, {"XDG_CACHE_HOME": "x"}):
        env = {"TMPDIR": os.path.join(d, "tmp"), **home}
        p = subprocess.run([BENCH, *plan], cwd=os.path.join(d, "here"), env=env,
                           text=True, capture_output=True, timeout=60)
        check(p.returncode == 0 and "measured speeds are not saved" in p.stderr and
              not names_in(d + "/tmp") and not names_in(d + "/here"),
              f"no place of one's own: {home} {p.stderr}")


def lost_times(d):
    """A journal whose times are no numbers of seconds is named."""
    expect(0, ["--profile=smoke", "--filter=walk", "--out=t"], d)
    path = os.path.join(d, "t", "journal.jsonl")
    with open(path, "rb") as f:
        lines = [json.loads(line[9:]) for line in f]
    for time in (None, -1, True, "1", []):
        for line in lines[1:]:
            line["record"]["clocks"]["solve"] = [time, time]
        texts = [json.dumps(line, separators=(",", ":"), sort_keys=True)
                 for line in lines]
        with open(path, "w") as f:
            f.writelines(f"{crc32c(t.encode()).decode()} {t}\n" for t in texts)
        for args in (["verify", "t"], ["export", "t"], ["compare", "t", "t"]):
            expect(9, args, d, "a time is not a number of seconds")


def names_of_any_bytes(d):
    """Non-UTF-8 folders work; messages are UTF-8 and one line."""
    out = os.path.join(os.fsencode(d), b"f\xff\x1b[31m")
    smoke = [BENCH, "run", "--profile=smoke", "--filter=walk"]
    p = subprocess.run([*smoke, b"--out=" + out], capture_output=True,
                       timeout=60)
    check(p.returncode == 0, f"a folder of any bytes -> {p.returncode}")
    for args in ([b"verify", out], [b"report", out], [b"export", out],
                 [b"compare", out, b"\xffLABEL=" + out, b"--format=json"],
                 [b"compare", out, b"\xff|LABEL=" + out, b"--out=" + out +
                  b"/page"], [b"plan", b"--filter=walk", b"--profile=smoke",
                              b"--against=" + out, b"--json"]):
        p = subprocess.run([BENCH, *args], capture_output=True, timeout=60,
                           env={**os.environ, "XDG_CACHE_HOME": d,
                                "PHYSINV_PUBLISHED_DIR": d + "/published"})
        check(p.returncode == 0, f"{args[0]} -> {p.returncode} {p.stderr}")
    for args in ([b"\xff\xfe"], [b"--filter=\xff"], [b"--profile=\xc3("],
                 [b"--set=\xf0\x80\x80\x80=1"], [b"verify", b"\xed\xa0\x80"],
                 [b"--\x1b[2J"], [b"run", b"a\nb\rc"], [b"x" * 100000],
                 [b"--" + b"x" * 100000], [b"verify", b"y/" * 60000],
                 [b"--filter=" + b"x" * 100000], [b"--set=n=" + b"1," * 60000],
                 [b"--profile=" + "é".encode() * 50000]):
        p = subprocess.run([BENCH, *args], cwd=d, capture_output=True,
                           timeout=5)
        try:
            text = p.stderr.decode()
        except UnicodeDecodeError:
            text = ""
        check(p.returncode in CODES - {0} and text.count("\n") == 1 and
              len(text) < 3000 and not re.search(r"[\x00-\x09\x0b-\x1f\x7f]",
                                                 text),
              f"{args[-1][:20]} -> {p.returncode} {text[:80]!r}")


def help_of_all(d):
    """The program lists the verbs that it has."""
    text = run("--help", cwd=d).stdout
    verbs = set(re.findall(r"^physinv-bench \[?(\w+)\]? ", text, re.M))
    listed = run("--list-verbs", cwd=d).stdout.split()
    check(set(listed) == verbs - {"VERB"}, f"physinv-bench lists {verbs}")
    for verb in set(listed) - {"kernels"}:
        expect(0, [verb, "--help"], d, "physinv-bench " + verb)


def hostile_lines():
    """Verbs that do not fit their arguments, flags that do not fit verbs."""
    verbs = ("run", "list", "plan", "report", "results", "verify", "merge",
             "baseline", "gate", "compare", "export", "completion", "submit",
             "status")
    for verb in verbs:
        yield [verb, "/dev/null"]
        yield [verb, "/proc/self/mem", "/proc/self/mem"]
        yield [verb, "--"]
        yield [verb, "-", "-x", "--=x", "--=", "---"]
        yield [verb, "--out=/proc/x/y", "--out=/proc/x/z"]
        yield [verb, verb, "--help=yes"]
        yield [verb, "{}", "[]", "%%", "@x", "++"]
        yield [verb, "--config=/etc/passwd", "@/etc/passwd"]
    for flags in (["--profile=smoke", "--profile=smoke"],
                  ["--jobs=1", "--jobs=2", "--dry-run"],
                  ["--dry-run", "--dry-run", "--profile=smoke"],
                  ["--filter={}", "--dry-run"], ["--filter=[]", "--dry-run"],
                  ["--filter=%%"], ["--filter=-"], ["--filter=--"],
                  ["--out={}", "--dry-run"], ["--seeds={}"], ["--set={}"],
                  ["--set=n=1", "--set=n=2", "--dry-run"], ["--set==", ],
                  ["--set=n=="], ["--set=methods=,,"], ["--set=seeds=-"],
                  ["--seeds=0-"], ["--seeds=--"], ["--seeds=,"],
                  ["--seeds=18446744073709551615"], ["--seeds=1-2-3"],
                  ["--shard=1/0"], ["--shard=/"], ["--shard=1//2"],
                  ["--shard=2147483648/4294967296"], ["--shard=-1/-1"],
                  ["--time-budget=1e308h"], ["--time-budget=-0"],
                  ["--time-budget=1 m"], ["--checkpoint=1e-400"],
                  ["--cases=/dev/zero"], ["--cases=/"],
                  ["--cases=/proc/self/mem"], ["--benchmark_format=json,csv"],
                  ["--benchmark_out=/", "--profile=smoke", "--out=h"],
                  ["--no-resume"], ["--fresh=maybe"], ["-h", "x"], ["-V"],
                  ["--help", "--help"], ["--version", "--dry-run"]):
        yield flags
    yield ["list", "--seeds=0-99999", "--set=n=1-1000"]
    yield ["list", *["--filter=" + "(a|b)*.{9}" * 400] * 400]
    yield ["list", "--edit=/dev/zero"]
    yield ["compare", "=", "="]
    yield ["compare", "a=b=c", "=d"]
    yield ["compare", ".", ".", "--fail-on=time", "--factor=1e309"]
    yield ["compare", ".", ".", "--lines=99999999999"]
    yield ["gate", "--baseline=/dev/zero"]
    yield ["gate", "--baseline=."]
    yield ["gate", "--seed=18446744073709551616"]
    yield ["gate", "--against=/dev/null"]
    yield ["merge", ".", "."]
    yield ["merge", "/proc/x", "."]
    yield ["export", ".", "--out=/"]
    yield ["results", "--campaigns=/proc", "--out=/proc/x"]
    yield ["plan", "--plot=/proc/x", "--against=."]
    yield ["submit", "--slurm=/proc/x", "--", "--"]


def hostile(d):
    """One line, a documented code, seconds, and nothing written elsewhere."""
    where = os.path.join(d, "hostile")
    count = 0
    for args in hostile_lines():
        shutil.rmtree(where, ignore_errors=True)
        os.makedirs(os.path.join(where, "in"))
        begin = time.time()
        p = run(*args, cwd=os.path.join(where, "in"),
                env={"XDG_CACHE_HOME": os.path.join(d, "cache"),
                     "PATH": d}, stdin=subprocess.DEVNULL)
        good = (p.returncode in CODES and time.time() - begin < 5 and
                names_in(where) == ["in"] and
                (p.returncode == 0 or
                 len(p.stderr.splitlines()) == 1 and
                 "internal" not in p.stderr))
        count += 1
        if not good:
            check(False, f"{args} -> {p.returncode} in "
                  f"{time.time() - begin:.1f} s: {p.stderr[:300]!r}")
    check(count >= 100, f"{count} hostile lines")


with tempfile.TemporaryDirectory() as directory:
    os.mkdir(os.path.join(directory, "published"))
    for test in (empty_values, long_names, expressions, kernels, switches_and_numbers,
                 variables, cases_of_windows, damaged_speeds, lost_times,
                 names_of_any_bytes, help_of_all, hostile):
        test(directory)
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
