"""Signals: to stop, without a reader and while a stage is running; workers
that are killed; the limit on file sizes."""

import fcntl
import glob
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time

from program import BENCH, FAILED, check, expect, results

DESCEND = ["--profile=smoke", "--filter=/descend/", "--set=iterations=400",
           "--jobs=1", "--trace"]


def start(out, *flags, pace="20", stdout=subprocess.PIPE,
          stderr=subprocess.PIPE, **kwargs):
    return subprocess.Popen(
        [BENCH, "run", *flags, "--out", out], stdout=stdout, stderr=stderr,
        env={**os.environ, "PHYSINV_FAKE_PACE_MS": pace}, text=True, **kwargs)


def full_pipe():
    """There is no reader, and nothing fits in any more."""
    reader, writer = os.pipe()
    fcntl.fcntl(writer, 1031, 4096)  # F_SETPIPE_SZ
    os.write(writer, b"." * 4096)
    return reader, writer


def ends(process, seconds):
    begin = time.time()
    try:
        return process.wait(timeout=20), time.time() - begin < seconds
    except subprocess.TimeoutExpired:
        process.kill()
        return "hangs", False


def unread(d):
    """A reader that sleeps does not keep a campaign from ending."""
    for number in (signal.SIGINT, signal.SIGTERM):
        for both in (False, True):
            out = os.path.join(d, f"unread{number}{both}")
            reader, writer = full_pipe()
            p = start(out, "--profile=quick", "--jobs=2", pace="0",
                      stdout=writer,
                      stderr=writer if both else subprocess.DEVNULL)
            time.sleep(1)
            check(p.poll() is None, "it waits for its reader")
            p.send_signal(number)
            code, soon = ends(p, 5)
            check(code == 130 and soon,
                  f"{number.name}, nobody reads, stderr too {both}: {code}")
            os.close(reader), os.close(writer)
            expect(0, ["--profile=quick", "--out=" + out], d)
            expect(0, ["verify", out], d, "0 mismatches")


def children(pid):
    with open(f"/proc/{pid}/task/{pid}/children") as f:
        return [int(word) for word in f.read().split()]


def states(out):
    return glob.glob(os.path.join(out, "checkpoints", "*"))


def laid_down(d, whole):
    """Ctrl-C, to one process or to all of a terminal's: the running stage is kept, and
    the message says how to continue."""
    for number, group in ((signal.SIGINT, False), (signal.SIGINT, True),
                          (signal.SIGTERM, True)):
        out = os.path.join(d, f"down{number}{group}")
        p = start(out, *DESCEND, "--checkpoint=1h", start_new_session=True)
        time.sleep(1)
        (os.killpg if group else os.kill)(p.pid, number)
        text, errors = p.communicate(timeout=20)
        check(p.returncode == 130, f"{number.name} ends it: {p.returncode}")
        check("saved fake/cubic/descend/" in text, "it lays down: " + text)
        check("the same command resumes" in errors and
              errors.count("\n") == 1, "and says how to go on: " + errors)
        check(len(states(out)) == 1, "one state")
        p = start(out, *DESCEND, pace="0")
        text, _ = p.communicate(timeout=60)
        check("resuming fake/cubic" in text and
              "from iteration 0" not in text, "goes on from there")
        check(results(out) == results(whole), "same results as uninterrupted")
    p = start(out, *DESCEND, "--fresh")
    time.sleep(1)
    p.send_signal(signal.SIGINT)
    check("without --fresh resumes" in p.communicate(timeout=20)[1],
          "with --fresh the same command would start again")


def twice(d):
    """A second signal does not wait for stages that cannot save their state."""
    p = start(os.path.join(d, "twice"), "--profile=slow", "--filter=sleep",
              "--jobs=1")
    time.sleep(1)
    p.send_signal(signal.SIGINT)
    time.sleep(0.3)
    p.send_signal(signal.SIGINT)
    code, soon = ends(p, 1.5)
    check(code == 130 and soon, f"the second ends it at once: {code}")


def killed_workers(d, whole):
    """A case whose worker is killed from outside is tried again, and continues from its
    state; one that kills them all fails."""
    for kills, code in ((1, 0), (2, 0), (3, 4)):
        out = os.path.join(d, f"killed{kills}")
        p = start(out, *DESCEND, "--checkpoint=0.01")
        for _ in range(kills):
            time.sleep(0.7)
            for worker in children(p.pid):
                os.kill(worker, signal.SIGKILL)
        text, errors = p.communicate(timeout=60)
        check(p.returncode == code, f"{kills} kills -> {p.returncode} {errors}")
        check(text.count("SIGKILL (out of memory?); trying again")
              == min(kills, 2), "it says so")
        check("resuming fake/cubic/descend" in text, "from its state")
        if code == 0:
            check(results(out) == results(whole), "same results")


def small_files(d):
    """The limit on file sizes is not a full disk."""
    seen = set()
    for size in (1, 512, 2048, 8192, 30000, 1 << 20):
        out = os.path.join(d, f"limit{size}")
        limit = (size, size)
        p = start(out, "--profile=quick", "--jobs=1", pace="0",
                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE,
                                                        limit))
        text, errors = p.communicate(timeout=60)
        seen.add(p.returncode)
        check(p.returncode == 0 or p.returncode == 9 and
              "raise the limit on file sizes (ulimit -f)" in errors and
              errors.count("\n") == 1, f"{size}: {p.returncode} {errors}")
        p = start(out, "--profile=quick", pace="0")
        p.communicate(timeout=60)
        check(p.returncode == 0, "and the next run goes on")
        expect(0, ["verify", out], d, "0 mismatches")
    check(seen == {0, 9}, f"codes {seen}")
    with open(os.path.join(d, "printed"), "w") as f:
        p = start(os.path.join(d, "out"), "--profile=quick", stdout=f, pace="0",
                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE,
                                                        (100, 100)))
        errors = p.communicate(timeout=60)[1]
    check(p.returncode == 9 and "ulimit -f" in errors, errors)


with tempfile.TemporaryDirectory() as directory:
    os.mkdir(os.path.join(directory, "published"))
    complete = os.path.join(directory, "whole")
    start(complete, *DESCEND, pace="0").communicate(timeout=60)
    unread(directory)
    laid_down(directory, complete)
    twice(directory)
    killed_workers(directory, complete)
    small_files(directory)
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
