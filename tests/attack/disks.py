"""Disks without space or inodes, limits of file sizes, disks that can only be
read: what was there stays, and with space the same command continues."""

import os
import resource
import subprocess

import sandbox
import stores

MOUNT = ["mount", "-t", "tmpfs", "tmpfs"]


class Disk:
    """A small file system of its own, where that may be had."""

    def __init__(self, path, options):
        self.path = path
        os.makedirs(path)
        self.mounted = self.call(*MOUNT, path, "-o", options)

    def call(self, *arguments):
        return os.geteuid() == 0 and subprocess.run(
            arguments, stderr=subprocess.DEVNULL).returncode == 0

    def remount(self, options):
        return self.call("mount", "-o", "remount," + options, self.path)

    def close(self):
        if self.mounted:
            self.call("umount", "-l", self.path)


def limit(size):
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


# What is written, into the full disk: a call, what it needs, what it makes.
WRITES = [
    (["report", "done", "--out=disk/page"], ("done",), "disk/page/report.md"),
    (["export", "done", "--out=disk/out.json"], ("done",), "disk/out.json"),
    (["merge", "disk/joined", "part1", "part2"], ("part1", "part2"),
     "disk/joined/results.json"),
    (["gate", "--baseline=base.txt", "--results=done", "--no-count",
      "--json=disk/found.json"], ("base.txt", "done"), "disk/found.json"),
    (["results", "--campaigns=campaigns", "--out=disk/page.md"],
     ("campaigns",), "disk/page.md"),
    (["compare", "done", "part1", "--out=disk/page"], ("done", "part1"),
     "disk/page/index.html"),
]


def campaign(attempt, disk, more, prepare):
    """Without space, then with it."""
    store = attempt.path("disk/store")
    line = ["run", *stores.SHORT, "--trace", "--jobs=1", "--checkpoint=0.05",
            "--out", store]
    ended = attempt.run(*line, limit=30, prepare=prepare)
    attempt.expect(ended.code in (0, 9), f"a full disk: {ended.code}")
    attempt.hits += ended.code == 9
    if disk.mounted:
        disk.remount(more)
    ended = attempt.run(*line, limit=30)
    if attempt.expect(ended.code == 0, f"with space: {ended.code}"):
        attempt.same_results(store, os.path.join(attempt.world.golden, "whole"))


def output(attempt, disk, more, prepare):
    """What cannot be written again is as it was; with space it is written."""
    line, needs, makes = attempt.rng.choice(WRITES)
    attempt.take(*needs)
    for _ in range(2):  # where nothing was, and where something was
        path = attempt.path(makes)
        before = sandbox.read(path) if os.path.exists(path) else None
        ended = attempt.run(*line, prepare=prepare)
        attempt.hits += ended.code == 9
        attempt.expect(ended.code in (0, 9, 10), f"a full disk: {ended.code}")
        if before is not None and ended.code == 9:
            attempt.expect(os.path.exists(path) and
                           (makes.endswith("results.json") or
                            sandbox.read(path) == before),
                           f"{makes} is lost to a full disk")
        if disk.mounted:
            disk.remount(more)
        ended = attempt.run(*line)
        attempt.expect(ended.code in (0, 10), f"with space: {ended.code}")
        if disk.mounted:
            full(disk)


def full(disk):
    """Fills what is left."""
    disk.remount("size=4m")
    try:
        with open(os.path.join(disk.path, "filling"), "wb", 0) as f:
            while f.write(bytes(4096)):
                pass
    except OSError:
        pass


def disks(attempt):
    rng = attempt.rng
    size = 4096 * rng.choice((1, 2, 3, 4, 6, 8, 12, 16, 20, 24, 32, 48, 96))
    form = rng.choice(("space", "space", "inodes", "limit"))
    options = {"space": f"size={size}", "limit": "size=200m",
               "inodes": f"size=200m,nr_inodes={rng.randrange(2, 12)}"}[form]
    disk = Disk(attempt.path("disk"), options)
    try:
        if not disk.mounted:
            form = "limit"
            attempt.skipped = "no tmpfs can be mounted: limits of sizes alone"
        attempt.note(f"{form}: {options if form != 'limit' else size}")
        prepare = limit(size) if form == "limit" else None
        what = campaign if rng.random() < 0.6 else output
        what(attempt, disk, "size=200m,nr_inodes=0", prepare)
    finally:
        disk.close()
