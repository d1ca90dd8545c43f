"""What is not the suite's stays as it is: files of users in and next to a store,
links, FIFOs, sockets and directories in place of files, forged shards."""

import glob
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

from program import BENCH, FAILED, check, crc32c, expect, run

SMOKE = ["--profile=smoke", "--filter=/descend/", "--jobs=1"]


def write(path, text="kept"):
    with open(path, "w") as f:
        f.write(text)


def read(path):
    with open(path) as f:
        return f.read()


def store(d, name="store"):
    """A finished campaign."""
    out = os.path.join(d, name)
    expect(0, [*SMOKE, "--trace", "--out=" + out], d, "stages run")
    return out


def reseal(path, change):
    """Changes the last line of a journal, with a good checksum."""
    with open(path, "rb") as f:
        lines = f.read().splitlines()
    entry = json.loads(lines[-1][9:])
    change(entry)
    text = json.dumps(entry, separators=(",", ":")).encode()
    lines[-1] = crc32c(text) + b" " + text
    with open(path, "wb") as f:
        f.write(b"\n".join(lines) + b"\n")


def forged_shards(d):
    """A key that is a path of somebody's file."""
    write(os.path.join(d, "precious"))
    for key in (os.path.join(d, "precious"), "../../precious"):
        shard = store(d, "shard")

        def change(entry):
            entry["record"]["key"] = entry["info"]["keys"][0] = key
        reseal(os.path.join(shard, "journal.jsonl"), change)
        for args in (["verify", shard], ["report", shard],
                     ["merge", os.path.join(d, "merged"), shard],
                     [*SMOKE, "--out=" + shard]):
            expect(9, args, d, "journal.jsonl")
        check(read(os.path.join(d, "precious")) == "kept", "it is still there")
        shutil.rmtree(shard)


def files_of_users(d):
    """None of them is deleted, whatever runs."""
    out = store(d)
    os.makedirs(os.path.join(out, "repetition", "x"))
    os.makedirs(os.path.join(out, "pair"))
    os.makedirs(os.path.join(out, "cases", "y.tmp"))
    os.makedirs(os.path.join(out, "checkpoints"))
    mine = [os.path.join(out, name) for name in
            ("a.tmp", "cases/a.tmp", "cases/a.h5", "repetition/notes",
             "repetition/x/notes", "checkpoints/a.tmp", "pair/notes",
             "checkpoints/" + "0" * 32, "index.html.tmp")]
    for path in mine:
        write(path)
    leftover = os.path.join(out, "cases", ".physinv-0123456789abcdef.tmp")
    write(leftover)
    expect(0, [*SMOKE, "--out=" + out], d, "reused")
    expect(0, [*SMOKE, "--out=" + out, "--fresh"], d, "stages run")
    expect(0, [*SMOKE, "--out=" + out, "--benchmark_repetitions=3"], d, "")
    expect(0, ["report", out], d, "report:")
    check(all(read(p) == "kept" for p in mine), "files of users stay")
    check(not os.path.exists(leftover), "a leftover goes")
    check(len(json.load(open(os.path.join(out, "repetitions.json")))["times"])
          == 1, "repetitions are kept")
    check(not glob.glob(os.path.join(out, ".physinv-*")),
          "nothing is left of the repetitions")


def killed_repetitions(d):
    """What a kill leaves of them goes with the next run."""
    out = os.path.join(d, "repeated")
    process = subprocess.Popen(
        [BENCH, *SMOKE, "--benchmark_repetitions=9", "--out=" + out],
        env={**os.environ, "PHYSINV_FAKE_PACE_MS": "20"}, cwd=d,
        stdout=subprocess.DEVNULL)
    end = time.time() + 60
    while time.time() < end and not glob.glob(
            os.path.join(out, ".physinv-*", "journal.jsonl")):
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    process.wait()
    check(glob.glob(os.path.join(out, ".physinv-*")), "killed inside of one")
    expect(0, [*SMOKE, "--out=" + out], d, "reused")
    check(not glob.glob(os.path.join(out, ".physinv-*")), "it is gone")


def snapshot(folder):
    return sorted((os.path.relpath(p, folder), os.lstat(p).st_mode,
                   read(p) if os.path.isfile(p) else "")
                  for p in glob.glob(os.path.join(folder, "**"),
                                     recursive=True))


def links(d):
    """Links out of a store: nothing behind them changes."""
    away = os.path.join(d, "away")
    os.makedirs(os.path.join(away, "folder"))
    for name in ("a", "folder/a.tmp", "folder/.physinv-0123456789abcdef.tmp",
                 "folder/" + "0" * 32, "folder/index.html"):
        write(os.path.join(away, name))
    before = snapshot(away)
    for name in ("journal.jsonl", "plan.json", "results.json", "lock",
                 "repetitions.json", "cases", "checkpoints", "report",
                 "report/index.html"):
        for target in ("a", "folder", "nowhere"):
            out = store(d, "linked")
            path = os.path.join(out, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            if os.path.isdir(path):
                shutil.rmtree(path)
            elif os.path.exists(path):
                os.remove(path)
            os.symlink(os.path.join(away, target), path)
            for args in ([*SMOKE, "--out=" + out], ["verify", out],
                         [*SMOKE, "--fresh", "--out=" + out],
                         ["report", out], ["export", out]):
                p = run(*args, cwd=d)
                if p.returncode not in (0, 9, 10) or \
                        p.stderr.count("\n") != (p.returncode != 0):
                    check(False, f"{name} -> {target}: {args[0]} "
                          f"{p.returncode} {p.stderr[:200]}")
            if not os.path.islink(path) or snapshot(away) != before:
                check(False, f"{name} -> {target} changes what is there")
            shutil.rmtree(out)
    check(snapshot(away) == before, "nothing behind a link changes")


def put(kind, path):
    if kind == "fifo":
        os.mkfifo(path)
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as s:
            here = os.getcwd()
            os.chdir(os.path.dirname(path))
            s.bind(os.path.basename(path))
            os.chdir(here)
    elif kind == "directory":
        os.mkdir(path)
    elif kind == "huge":
        with open(path, "w") as f:
            f.truncate(8 << 30)
    else:
        os.symlink("/dev/zero", path)


def other_kinds(d):
    """One line and exit 9, at once, for what is not a file."""
    verbs = lambda out: (
        ["verify", out], ["report", out], ["export", out],
        ["compare", out, out], ["merge", "merged", out],
        ["baseline", out, "--out=b.txt"], ["plan", *SMOKE[:2], "--against=" + out, "--measured"],
        [*SMOKE, "--out=" + out])
    case = "cases/fake+cubic+descend+n=4+seed=0.h5"
    for name in ("journal.jsonl", "plan.json", case, "results.json", "lock",
                 "repetitions.json"):
        for kind in ("fifo", "socket", "directory", "device", "huge"):
            out = store(d, "other")
            path = os.path.join(out, name)
            if os.path.exists(path):
                os.remove(path)
            put(kind, path)
            failed = 0
            for args in verbs(out):
                begin = time.time()
                p = run(*args, cwd=d)
                late = time.time() - begin > 5
                failed += p.returncode == 9
                if late or p.returncode not in (0, 2, 9) or \
                        (p.returncode and p.stderr.count("\n") != 1) or \
                        (p.returncode == 9 and name not in p.stderr):
                    check(False, f"{kind} {name}: {args[0]} -> {p.returncode} "
                          f"{p.stderr[:200]}")
                shutil.rmtree(os.path.join(d, "merged"), ignore_errors=True)
            if failed == 0 and not (name == "lock" and kind == "huge"):
                check(False, f"{kind} {name}: nobody minds")
            shutil.rmtree(out)
    check(True, "all kinds of files")
    for kind in ("fifo", "socket", "directory", "device", "huge"):
        out = os.path.join(d, "out-" + kind)
        put(kind, out)
        args = ["verify", "report", "export"]
        if kind != "directory":
            args.append("run")
        for verb in args:
            p = run(*([*SMOKE, "--out=" + out] if verb == "run"
                      else [verb, out]), cwd=d)
            check(p.returncode in (2, 9) and p.stderr.count("\n") == 1,
                  f"a {kind} as a store: {verb} {p.stderr[:100]}")


def outputs(d):
    """What is there and no file is written into as it is."""
    out = store(d)
    p = run("export", out, "--out=/dev/stdout", cwd=d)
    check(p.returncode == 0 and "benchmarks" in json.loads(p.stdout),
          "into a pipe")
    file = os.path.join(d, "stdout")
    with open(file, "w") as f:
        f.write("before\n")
        f.flush()
        subprocess.run([BENCH, "export", out, "--out=/dev/stdout"], stdout=f)
        f.write("after\n")
    text = read(file)
    check(text.startswith("before\n") and text.endswith("after\n") and
          "benchmarks" in text, "into a file that is standard output")
    null = os.path.join(d, "null")
    os.symlink("/dev/null", null)
    expect(0, ["export", out, "--out=" + null], d)
    expect(0, [*SMOKE, "--out=" + out, "--benchmark_out=/dev/null"], d, "")
    check(os.path.islink(null) and not os.path.isfile("/dev/null"),
          "/dev/null is what it was")
    fifo = os.path.join(d, "fifo")
    os.mkfifo(fifo)
    expect(9, ["export", out, "--out=" + fifo], d, "cannot write")
    reader = subprocess.Popen(["cat", fifo], stdout=subprocess.PIPE, text=True)
    end = time.time() + 10
    while time.time() < end and \
            run("export", out, "--out=" + fifo, cwd=d).returncode:
        time.sleep(0.01)  # until it is there
    check("benchmarks" in json.loads(reader.communicate()[0]), "into a FIFO")


def removed_journal(d):
    """No message says that all is well. A run of several journal syncs."""
    for replaced in (False, True):
        out = os.path.join(d, f"removed{replaced}")
        process = subprocess.Popen(
            [BENCH, "--profile=smoke", "--jobs=1", "--out=" + out], cwd=d,
            env={**os.environ, "PHYSINV_FAKE_PACE_MS": "120"},
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        path = os.path.join(out, "journal.jsonl")
        end = time.time() + 60
        while time.time() < end and not (
                os.path.exists(path) and read(path).count("\n") > 1):
            time.sleep(0.002)
        os.remove(path)
        if replaced:
            write(path, "somebody's\n")
        _, errors = process.communicate(timeout=60)
        check(process.returncode == 9 and errors.count("\n") == 1 and
              "removed or replaced" in errors, f"{process.returncode} {errors}")
        check(os.path.exists(path) == replaced and
              (not replaced or read(path) == "somebody's\n"), "it stays so")


def backups(d):
    """A copy made of hard links does not change with the store."""
    out = store(d)
    copy = os.path.join(d, "copy")
    subprocess.run(["cp", "-al", out, copy], check=True)
    os.remove(os.path.join(out, "lock"))
    before = read(os.path.join(copy, "journal.jsonl"))
    expect(0, ["--profile=smoke", "--jobs=1", "--out=" + out], d, "stages run")
    check(read(os.path.join(copy, "journal.jsonl")) == before,
          "a backup keeps its journal")


def reports(d):
    """Several at once into one folder."""
    out = store(d)
    page = os.path.join(d, "page")
    all_of_them = [subprocess.Popen(
        [BENCH, "report", out, "--out=" + page], cwd=d,
        env={**os.environ, "PHYSINV_PUBLISHED_DIR": os.path.join(d, "published")},
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        for _ in range(12)]
    ends = [(p.communicate()[1], p.returncode) for p in all_of_them]
    check(all(code == 0 for _, code in ends), f"all end well {ends[:1]}")
    check(not glob.glob(os.path.join(page, "**", ".*"), recursive=True),
          "and leave nothing aside")


def damaged_json(d):
    """Every verb names the file, and none ends with an internal error."""
    out = store(d)
    for name in ("plan.json", "results.json", "repetitions.json"):
        path = os.path.join(out, name)
        before = read(path) if os.path.exists(path) else None
        for text in ("", "{}", "[]", "7", '{"times":{"a":[[[]]]}}',
                     "[" * 200000, '{"benchmarks":5,"context":{}}',
                     '{"benchmarks":[{"name":7}],"context":{}}'):
            write(path, text)
            p = run("export", out, cwd=d)
            if name != "plan.json":
                check(p.returncode == 9 and name in p.stderr and
                      p.stderr.count("\n") == 1,
                      f"{name} {text[:20]} {p.returncode} {p.stderr[:100]}")
            else:
                expect(9, ["verify", out], d, name)
        os.remove(path) if before is None else write(path, before)
    published = os.path.join(d, "published")
    write(os.path.join(published, "bad.json"), '{"publication":{"key":3}}')
    expect(9, ["report", out], d, "bad.json")
    os.remove(os.path.join(published, "bad.json"))
    cache = os.path.join(d, "cache")
    env = {"XDG_CACHE_HOME": cache}
    plan = ["plan", *SMOKE[:2], "--exact"]
    check(run(*plan, cwd=d, env=env).returncode == 0, "plans")
    speeds = glob.glob(os.path.join(cache, "physinv", "speeds-*.json"))[0]
    kept = read(speeds)
    for text in ("7", '{"trials":7}', '{"trials":{"a":[[1]]}}',
                 kept.replace("[[", "[[-1e30,"), kept.replace("[[", "[[1e300,"),
                 kept.replace("[[", "[[0,")):
        write(speeds, text)
        expect(9, plan, d, os.path.basename(speeds), env=env)
    os.remove(speeds)
    os.mkfifo(speeds)
    expect(9, plan, d, "it is a FIFO", env=env)
    os.remove(speeds)
    write(os.path.join(d, "precious"), kept)
    os.symlink(os.path.join(d, "precious"), speeds)
    expect(9, plan, d, "it is a link", env=env)
    check(read(os.path.join(d, "precious")) == kept, "what it names stays")


for test in (forged_shards, files_of_users, killed_repetitions, links,
             other_kinds, outputs, removed_journal, backups, reports,
             damaged_json):
    with tempfile.TemporaryDirectory() as directory:
        os.mkdir(os.path.join(directory, "published"))
        test(directory)
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
