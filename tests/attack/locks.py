"""File systems without locks: flock fails as on NFS or Lustre without them."""

import ctypes
import errno
import os
import platform
import signal

import kills
import stores

ERRORS = ("ENOLCK", "ENOSYS", "EOPNOTSUPP")
FLOCK = 73  # number of the call on x86-64
NO_NEW_PRIVILEGES, SECCOMP, FILTER = 38, 22, 2


class Step(ctypes.Structure):
    _fields_ = [("code", ctypes.c_ushort), ("yes", ctypes.c_ubyte),
                ("no", ctypes.c_ubyte), ("k", ctypes.c_uint)]


class Program(ctypes.Structure):
    _fields_ = [("length", ctypes.c_ushort), ("steps", ctypes.POINTER(Step))]


def without_flock(error):
    """What makes a process see flock fail, and those that it starts."""
    steps = (Step * 4)((0x20, 0, 0, 0),              # the call's number
                       (0x15, 0, 1, FLOCK),          # is it flock?
                       (0x06, 0, 0, 0x50000 | error),
                       (0x06, 0, 0, 0x7fff0000))     # else it is made
    program = Program(len(steps), steps)
    libc = ctypes.CDLL(None, use_errno=True)

    def prepare():
        libc.prctl(NO_NEW_PRIVILEGES, 1, 0, 0, 0)
        if libc.prctl(SECCOMP, FILTER, ctypes.byref(program)) != 0:
            os._exit(77)
    return prepare


def locks(attempt):
    if platform.machine() != "x86_64":
        attempt.skipped = "the number of flock is that of x86-64"
        return
    name = ERRORS[attempt.seed % len(ERRORS)]
    prepare = without_flock(getattr(errno, name))
    store = attempt.path("store")
    line = ["run", *stores.SHORT, "--trace", "--jobs=1", "--out", store]
    process = attempt.start(*line, "--set=iterations=200000", prepare=prepare)
    at_work = kills.trains(process)
    if not at_work and process.process.returncode == 77:
        attempt.skipped = "no calls can be filtered"
        process.end()
        return
    attempt.hits = 1
    attempt.note(name)
    if attempt.expect(at_work, f"{name} ends a run"):
        ended = attempt.run(*line, prepare=prepare)
        attempt.expect(ended.code == 9, f"two write at once: {ended.code}")
    process.signal(signal.SIGKILL)
    process.end()
    ended = attempt.run(*line, "--break-lock", prepare=prepare, limit=20)
    if attempt.expect(ended.code == 0, f"{name}, nothing goes on: {ended.err}"):
        attempt.same_results(store, os.path.join(attempt.world.golden, "whole"))
