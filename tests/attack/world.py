"""What attempts share: the program, the sandbox, stores made once; and an
attempt, which collects what went wrong."""

import json
import os
import random
import shutil

import sandbox
from program import Running

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(
    os.path.abspath(__file__))))
TIMES = ("time", "date", "seconds", "_ms", "finished", "rss", "crowded",
         "family_index", "clocks", "warmup", "setup", "revision", "repetition")


def without_times(value):
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items()
                if not any(name in k for name in TIMES)}
    if isinstance(value, list):
        return [without_times(v) for v in value]
    return value


def results(store):
    """The results of a campaign; nothing if it did not end."""
    path = os.path.join(store, "results.json")
    if not os.path.isfile(path):
        return None
    with open(path) as f:
        return without_times(json.load(f)["benchmarks"])


class World:
    def __init__(self, program, root, short=False, fake_program=""):
        self.short = short
        self.program = os.path.abspath(program)
        self.fake_program = fake_program and os.path.abspath(fake_program)
        self.scratch, self.golden, self.bin, box = (
            os.path.join(root, name)
            for name in ("scratch", "golden", "bin", "sandbox"))
        for path in (self.scratch, self.golden, self.bin, box):
            os.makedirs(path)
        self.sandbox = sandbox.Sandbox(box)
        self.truths = {}

    def environment(self, cwd, more=None):
        """A small one; {here} in it stands for the folder."""
        more = {k: v.replace("{here}", cwd) for k, v in (more or {}).items()}
        own = {"PATH": f"{self.bin}:/usr/bin:/bin", "LC_ALL": "C.UTF-8",
               "HOME": self.sandbox.home, "CI": "1", "TMPDIR": self.scratch}
        return {**own, **more}

    def start(self, arguments, cwd, env=None, program=None, **kwargs):
        program = program or self.program
        return Running([program, *arguments], self.scratch, cwd=cwd,
                       env=self.environment(cwd, env), **kwargs)

    def fake(self, name, script):
        """A program of this name, found before all others."""
        path = os.path.join(self.bin, name)
        sandbox.write(path, f"#!/bin/sh\n{script}\n")
        os.chmod(path, 0o755)

    def take(self, name, to):
        """A copy of something made once."""
        origin, copy = os.path.join(self.golden, name), os.path.join(to, name)
        if os.path.isdir(origin):
            shutil.copytree(origin, copy, symlinks=True)
        else:
            os.makedirs(os.path.dirname(copy), exist_ok=True)
            shutil.copy2(origin, copy)
        return copy


class Attempt:
    """One of a kind, the same for the same seed."""

    def __init__(self, world, kind, seed):
        self.world, self.kind, self.seed = world, kind, seed
        self.rng = random.Random(f"{kind} {seed}")
        self.folder = world.sandbox.folder(f"{kind}-{seed}")
        self.hits, self.skipped = 0, ""
        self.findings, self.log = [], []
        self.owned = lambda path: False  # of home and outside

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def take(self, *names):
        for name in names:
            self.world.take(name, self.folder)

    def expect(self, condition, what):
        if not condition:
            self.findings.append(what)
        return condition

    def note(self, text):
        self.log.append(text)

    def start(self, *arguments, **kwargs):
        kwargs.setdefault("cwd", self.folder)
        return self.world.start(arguments, **kwargs)

    def ended(self, ended, sent=0):
        """What holds for every end of the program, but by a signal sent."""
        words = [a if isinstance(a, str) else repr(a) for a in ended.arguments]
        line = " ".join(w if len(w) < 200 else w[:80] + "..."
                        for w in words[1:])
        said = [s for s in ended.err.splitlines() if s.startswith("physinv")]
        self.note(f"{line} -> {ended.code} {' '.join(said)[:300]}")
        for what in ended.wrong() if not sent or ended.code != -sent else ():
            self.findings.append(f"{what}: {line}: {' '.join(said)[:200]}")
        return ended

    def run(self, *arguments, limit=5.0, **kwargs):
        return self.ended(self.start(*arguments, **kwargs).wait(limit))

    def same_results(self, store, whole):
        """Bit by bit, as merge compares; and in results.json."""
        joined = self.path("joined-to-compare")
        shutil.rmtree(joined, ignore_errors=True)
        p = self.run("merge", joined, whole, store)
        return self.expect(
            p.code == 0 and results(store) == results(whole),
            f"other results than without the accident: {p.err[:200]}")

    def close(self):
        for line in self.world.sandbox.touched(self.owned):
            self.findings.append("outside of the store: " + line)


def say(text):
    print(text, flush=True)
