"""Starts the program under limits and says how it ended.

A call may take `limit` seconds of a quiet machine: the time that its processes
stood ready and waited for a core does not count, and on a loaded machine the
limit is longer, as a loop takes longer by the clock than by its CPU time.
"""

import dataclasses
import os
import resource
import signal
import subprocess
import time

MEMORY = 1 << 30
DOCUMENTED = {0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 130}
OUTPUT = 4 << 20  # bytes of a stream that are looked at


def children(pid):
    try:
        with open(f"/proc/{pid}/task/{pid}/children") as f:
            return [int(word) for word in f.read().split()]
    except OSError:
        return []


def tree(pid):
    return [pid] + [p for child in children(pid) for p in tree(child)]


def waited(pid):
    """Seconds that a process, or one of its descendants, waited for a core:
    most of them."""
    most = 0.0
    for p in tree(pid):
        try:
            with open(f"/proc/{p}/schedstat") as f:
                most = max(most, 1e-9 * int(f.read().split()[1]))
        except (OSError, IndexError):
            pass
    return most


def stretch():
    """How many times longer everything takes, here and now."""
    begin, cpu = time.monotonic(), time.thread_time()
    while time.thread_time() - cpu < 0.02:
        pass
    return max(1.0, (time.monotonic() - begin) / 0.02)


@dataclasses.dataclass
class Ended:
    arguments: list
    code: int  # negative: the signal
    out: str
    err: str
    seconds: float
    memory: int
    hung: bool = False

    def said(self):
        return self.out + self.err

    def wrong(self):
        """What no call may do, whatever it was given."""
        found = []
        own = [line for line in self.err.splitlines()
               if line.startswith("physinv-")]
        if self.hung:
            found.append(f"hangs (ended after {self.seconds:.1f} s)")
        elif self.code < 0:
            found.append(f"crash by {signal.Signals(-self.code).name}")
        elif self.code == 1:
            found.append("exit 1")
        elif self.code not in DOCUMENTED:
            found.append(f"exit {self.code} is not documented")
        elif self.code not in (0, 130) and len(own) != 1:
            found.append(f"exit {self.code} with {len(own)} lines")
        # A killed worker may have been "(out of memory?)"; that asks.
        if self.memory > MEMORY or "out of memory;" in self.said():
            found.append(f"memory: {self.memory >> 20} MB")
        return found


class Running:
    """A running process group."""

    def __init__(self, arguments, scratch, prepare=None, **kwargs):
        self.arguments = arguments
        self.begin = time.monotonic()
        self.files = [open(os.path.join(scratch, name), "w+b")
                      for name in ("stdout", "stderr")]
        self.names = [f.name for f in self.files]

        def before():
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            if prepare is not None:
                prepare()

        own = {"stdin": subprocess.DEVNULL, "stdout": self.files[0],
               "stderr": self.files[1], **kwargs}
        self.process = subprocess.Popen(
            arguments, preexec_fn=before, start_new_session=True, **own)
        self.pid = self.process.pid
        self.usage = None
        self.slow = 1.0

    def alive(self):
        if self.usage is None:
            pid, status, usage = os.wait4(self.pid, os.WNOHANG)
            if pid:
                self.usage = usage
                self.process.returncode = os.waitstatus_to_exitcode(status)
        return self.usage is None

    def workers(self):
        """Its children that are the same program, forked."""
        def image(pid):
            try:
                return os.readlink(f"/proc/{pid}/exe")
            except OSError:
                return None
        own = image(self.pid)
        return [p for p in children(self.pid) if own and image(p) == own]

    def signal(self, number, to=None):
        """True if it was still there."""
        try:
            os.kill(to or self.pid, number)
        except ProcessLookupError:
            return False
        return True

    def late(self, begin, limit):
        spent = time.monotonic() - begin
        if spent <= limit * self.slow or spent - waited(self.pid) <= limit:
            return False
        self.slow = max(self.slow, stretch())
        return spent > limit * self.slow

    def wait(self, limit, begin=None):
        """Until it has ended; killed if that takes longer than the limit."""
        begin = begin or self.begin
        hung = False
        while self.alive():
            if self.late(begin, limit):
                hung = True
                break
            time.sleep(0.002)
        return self.end(hung)

    def end(self, hung=False):
        try:
            os.killpg(self.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        while self.alive():
            time.sleep(0.002)
        texts = []
        for f in self.files:
            f.seek(0)
            texts.append(f.read(OUTPUT).decode(errors="backslashreplace"))
            f.close()
        return Ended(self.arguments, self.process.returncode, *texts,
                     time.monotonic() - self.begin,
                     self.usage.ru_maxrss << 10, hung)
