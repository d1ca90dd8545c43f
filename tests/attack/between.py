"""Kills between two writes: the program ends before one of the calls by which it
changes files, each of them in turn. What is there then is read by all
verbs as complete or incomplete, and the same command makes it whole."""

import math
import os
import shutil
import signal
import subprocess

import sandbox
import stores

RUN = ["run", *stores.SMALL, "--trace", "--jobs=1", "--no-report"]
REPEATED = ["--benchmark_repetitions=2"]
# name -> what is there before, the command that is killed.
SCENES = {
    "new": ((), [*RUN, *REPEATED, "--out=store"]),
    "more": (("traced1",), [*RUN, *REPEATED, "--out=store"]),
    "again": (("done",), [*RUN, "--out=store"]),
    "fresh": (("done",), [*RUN, "--fresh", "--out=store"]),
    "merge": ((), ["merge", "store", "traced1", "traced2"]),
}
# A verb and what it may end with: gate with 5 where stages are missing, compare
# with 3 where no run has finished.
VERBS = {
    "verify": (["verify", "store"], (0, 10)),
    "report": (["report", "store", "--out=page"], (0, 10)),
    "export": (["export", "store"], (0, 10)),
    "tidy": (["export", "store", "--format=tidy"], (0, 10)),
    "compare": (["compare", "store", "done"], (0, 3, 10)),
    "baseline": (["baseline", "store", "--out=base"], (0, 10)),
    "gate": (["gate", "--baseline=base.txt", "--results=store", "--no-count"],
             (0, 5, 10)),
    "merge": (["merge", "joined", "store"], (0, 10)),
}
# Ends the program before its call number KILL_BEFORE that changes a file; says
# in COUNT_FILE how many there were. Workers and other programs do not count.
SHIM = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static pid_t own;
static long last = -1, calls;

__attribute__((constructor)) static void begin(void) {
  const char* text = getenv("KILL_BEFORE");
  own = getpid();
  if (text != NULL) last = atol(text);
  unsetenv("LD_PRELOAD");
}
static void next(void) {
  if (getpid() != own) return;
  if (calls++ == last) {
    kill(own, SIGKILL);
    for (;;) pause();
  }
}
__attribute__((destructor)) static void end(void) {
  const char* name = getenv("COUNT_FILE");
  if (name == NULL || getpid() != own) return;
  FILE* file = fopen(name, "w");
  if (file != NULL) fprintf(file, "%ld\n", calls), fclose(file);
}
#define WRAP(type, name, formal, actual, changes)            \
  type name formal {                                         \
    static type(*real) formal;                               \
    if (real == NULL) real = dlsym(RTLD_NEXT, #name);        \
    if (changes) next();                                     \
    return real actual;                                      \
  }
WRAP(ssize_t, write, (int f, const void* b, size_t n), (f, b, n), f > 2)
WRAP(int, mkdir, (const char* p, mode_t m), (p, m), 1)
WRAP(int, mkdirat, (int d, const char* p, mode_t m), (d, p, m), 1)
WRAP(int, rename, (const char* a, const char* b), (a, b), 1)
WRAP(int, renameat, (int d, const char* a, int e, const char* b),
     (d, a, e, b), 1)
WRAP(int, unlink, (const char* p), (p), 1)
WRAP(int, unlinkat, (int d, const char* p, int f), (d, p, f), 1)
WRAP(int, rmdir, (const char* p), (p), 1)
WRAP(int, linkat, (int d, const char* a, int e, const char* b, int f),
     (d, a, e, b, f), 1)
WRAP(int, ftruncate, (int f, off_t n), (f, n), 1)
#define WRAP_OPEN(name, formal, actual)                      \
  int name formal {                                          \
    static int (*real)();                                    \
    va_list list;                                            \
    va_start(list, flags);                                   \
    const int mode = flags & O_CREAT ? va_arg(list, int) : 0; \
    va_end(list);                                            \
    if (real == NULL) real = (int (*)())dlsym(RTLD_NEXT, #name); \
    if (flags & (O_CREAT | O_TRUNC)) next();                 \
    return real actual;                                      \
  }
WRAP_OPEN(open, (const char* p, int flags, ...), (p, flags, mode))
WRAP_OPEN(open64, (const char* p, int flags, ...), (p, flags, mode))
WRAP_OPEN(openat, (int d, const char* p, int flags, ...), (d, p, flags, mode))
WRAP_OPEN(openat64, (int d, const char* p, int flags, ...),
          (d, p, flags, mode))
"""


def shim(world):
    """The library that is loaded before all others; "" without a compiler."""
    if "shim" not in world.truths:
        source, library = (os.path.join(world.scratch, "shim" + end)
                           for end in (".c", ".so"))
        sandbox.write(source, SHIM)
        try:
            subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-w", "-o",
                            library, source, "-ldl"], check=True)
        except (OSError, subprocess.CalledProcessError):
            library = ""
        world.truths["shim"] = library
    return world.truths["shim"]


def prepare(attempt, scene):
    """The scene as it is before its command. Gates need traces."""
    world = attempt.world
    for part in ("1", "2"):
        if not os.path.exists(os.path.join(world.golden, "traced" + part)):
            world.start([*RUN, f"--shard={part}/2", f"--out=traced{part}"],
                        cwd=world.golden).wait(60)
    attempt.take("done", "traced1", "traced2", "base.txt")
    for name in SCENES[scene][0]:
        shutil.copytree(attempt.path(name), attempt.path("store"),
                        symlinks=True)


def undisturbed(attempt, scene):
    return os.path.join(attempt.world.golden, "between-" + scene)


def writes(attempt, scene, library):
    """How many calls of an undisturbed run change files."""
    known = attempt.world.truths.setdefault("writes", {})
    if scene not in known:
        counted = attempt.path("count")
        ended = attempt.run(*SCENES[scene][1], limit=60, env={
            "LD_PRELOAD": library, "COUNT_FILE": counted})
        attempt.expect(ended.code == 0, f"{scene}, undisturbed: {ended.code}")
        known[scene] = int(sandbox.read(counted))
        shutil.copytree(attempt.path("store"), undisturbed(attempt, scene))
        shutil.rmtree(attempt.folder)
        os.makedirs(attempt.folder)
        prepare(attempt, scene)
    return known[scene]


def point_of(number, count):
    """Attempt after attempt, every point once, far apart at first."""
    step = max(1, round(0.618 * count))
    while math.gcd(step, count) != 1:
        step += 1
    return number * step % count


def read_by_all(attempt, what):
    begun = os.path.exists(attempt.path("store", "lock"))
    planned = os.path.exists(attempt.path("store", "plan.json"))
    for name, (line, codes) in VERBS.items():
        # Without a plan there is nothing to merge, without a lock no store.
        refused = not begun or (name == "merge" and not planned)
        ended = attempt.run(*line, limit=15)
        attempt.expect(ended.code in codes or (refused and ended.code == 2),
                       f"{name} after a kill {what}: {ended.code} {ended.err}")


def between(attempt):
    library = shim(attempt.world)
    if not library:
        attempt.skipped = "no C compiler"
        return
    scenes = list(SCENES)
    scene = scenes[attempt.seed % len(scenes)]
    line = SCENES[scene][1]
    prepare(attempt, scene)
    count = writes(attempt, scene, library)
    point = point_of(attempt.seed // len(scenes), count)
    what = f"before write {point} of {count}, {scene}"
    attempt.note(what)
    ended = attempt.ended(attempt.start(*line, env={
        "LD_PRELOAD": library, "KILL_BEFORE": str(point)}).wait(60), sent=9)
    attempt.hits = ended.code == -signal.SIGKILL
    attempt.expect(ended.code in (0, -signal.SIGKILL),
                   f"{what}: {ended.code} {ended.err}")
    read_by_all(attempt, what)
    ended = attempt.run(*line, limit=60)
    attempt.expect(ended.code == 0,
                   f"the same command {what}: {ended.code} {ended.err}")
    attempt.same_results(attempt.path("store"), undisturbed(attempt, scene))
