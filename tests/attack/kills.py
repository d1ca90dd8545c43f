"""Kills and signals at random moments of campaigns that save checkpoints, each followed
by a run that continues: the end is that of an undisturbed one."""

import fcntl
import os
import re
import signal
import time

import seals
import stores

IN_A_ROW = 5  # accidents of a campaign before it may end
# Enough that a training takes seconds and has checkpoints of a second.
LONG = {"iterations": 12_000, "checkpoint": "1"}
BRIEF = {"iterations": 1_500, "checkpoint": "0.03"}
OWN = re.compile(r"(lock|journal\.jsonl|plan\.json|results\.json|cases"
                 r"|cases/[^/]*\.h5|checkpoints|report(/.*)?)?")
STOPS = (signal.SIGINT, signal.SIGTERM)
OTHERS = (signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1, signal.SIGALRM,
          signal.SIGXFSZ, signal.SIGPIPE, signal.SIGWINCH)


class Campaign:
    """Two trainings and their refinements, run as often as it takes."""

    def __init__(self, attempt, checkpoint=None):
        self.attempt, self.world = attempt, attempt.world
        size = BRIEF if self.world.short else LONG
        self.flags = ["run", *stores.TRAINING, "--trace",
                      f"--set=iterations={size['iterations']}",
                      f"--checkpoint={checkpoint or size['checkpoint']}",
                      f"--jobs={attempt.rng.choice((1, 2))}", "--out"]
        self.store = attempt.path("store")
        self.whole, self.seconds = self.undisturbed()

    def undisturbed(self):
        if "campaign" not in self.world.truths:
            store = os.path.join(self.world.golden, "undisturbed")
            begin = time.monotonic()
            ended = self.world.start([*self.flags, store],
                                     cwd=self.world.golden).wait(300)
            if ended.code != 0:
                raise SystemExit("an undisturbed campaign: " + ended.err)
            self.world.truths["campaign"] = store, time.monotonic() - begin
        return self.world.truths["campaign"]

    def start(self, **kwargs):
        return self.attempt.start(*self.flags, self.store, **kwargs)

    def lines(self):
        """Those of the journal that are whole."""
        try:
            with open(os.path.join(self.store, "journal.jsonl"), "rb") as f:
                lines = f.read().split(b"\n")[:-1]
        except OSError:
            return []
        return [x for x in lines if x[:8] == seals.digits(x[9:])]

    def states(self):
        return stores.checkpoints(self.store)

    def accident(self, happens):
        """Something happens to a running campaign; what was done stays done."""
        before, states = self.lines(), self.states()
        process = self.start()
        ended = happens(process)
        self.attempt.expect(self.lines()[:len(before)] == before,
                            "the journal lost a line")
        # A failed stage may have been handed to another worker first.
        if states and ended.code == 0:
            self.attempt.expect("resuming " in ended.out,
                                "a state that was laid down was not taken up")
        return ended

    def finish(self):
        states = self.states()
        ended = self.attempt.ended(self.start().wait(10 * self.seconds + 10))
        expect = self.attempt.expect
        if not expect(ended.code == 0, f"the campaign does not go on: "
                                       f"{ended.code} {ended.err[:200]}"):
            return
        if states:
            expect("resuming " in ended.out, "nothing goes on from a state")
        expect(not self.states(), "a state is left")
        for folder, folders, files in os.walk(self.store):
            for name in folders + files:
                path = os.path.relpath(os.path.join(folder, name), self.store)
                expect(OWN.fullmatch(path), f"{path} is left")
        self.attempt.same_results(self.store, self.whole)
        self.attempt.run("verify", self.store)


def gone(pids, seconds):
    end = time.monotonic() + seconds
    while any(os.path.exists(f"/proc/{p}") for p in pids):
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True


def moment(campaign):
    """Of a campaign that may have been going for a while already."""
    time.sleep(campaign.attempt.rng.uniform(0, 0.6 * campaign.seconds))


def kills(attempt):
    campaign = Campaign(attempt)

    def parent(process):
        moment(campaign)
        workers = process.workers()
        attempt.hits += process.alive()
        process.signal(signal.SIGKILL)
        while process.alive():
            time.sleep(0.001)
        attempt.expect(gone(workers, 5), "workers outlive their parent")
        attempt.note(f"parent killed, {len(campaign.lines())} lines")
        return process.end()

    def worker(process):
        moment(campaign)
        for pid in process.workers()[:1]:
            attempt.hits += process.signal(signal.SIGKILL, to=pid)
        ended = attempt.ended(process.wait(10 * campaign.seconds + 10))
        attempt.expect(ended.code in (0, 4), f"a worker killed: {ended.code}")
        return ended

    for _ in range(IN_A_ROW):
        ended = campaign.accident(attempt.rng.choice((parent, worker)))
        if ended.code == 0:
            break
    campaign.finish()


def trains(process):
    """A worker that has computed for a while is in a training."""
    def ticks(pid):
        try:
            with open(f"/proc/{pid}/stat") as f:
                return int(f.read().rsplit(")", 1)[1].split()[11])
        except OSError:
            return 0
    while process.alive():
        if any(ticks(p) > 5 for p in process.workers()):
            return True
        time.sleep(0.005)
    return False


def full_pipe():
    """A full pipe without a reader."""
    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)
    os.set_blocking(writer, False)
    try:
        while True:
            os.write(writer, b"x")
    except BlockingIOError:
        os.set_blocking(writer, True)
    return reader, writer


def stopped(attempt, campaign, process, number, unread=False):
    """SIGINT or SIGTERM: ends soon, says how to continue, keeps the state."""
    ended = attempt.ended(process.wait(5, begin=time.monotonic()))
    if not attempt.expect(ended.code == 130,
                          f"{signal.Signals(number).name}: {ended.code}"):
        return ended
    if "before the first case" in ended.err:
        attempt.expect(not campaign.lines(), "something was run")
        return ended
    attempt.expect(campaign.states(), "no state is laid down")
    if not unread:
        attempt.expect(re.search("same command|again|goes? on|continue",
                                 ended.said()), "nothing says how to go on")
    return ended


def signals(attempt):
    rng = attempt.rng
    campaign = Campaign(attempt, checkpoint="1h")
    number = rng.choice(STOPS if rng.random() < 0.6 else OTHERS)
    to = rng.choice(("parent", "parent", "group", "worker"))
    unread = number in STOPS and rng.random() < 0.2
    pipe = full_pipe() if unread else ()
    attempt.note(f"{signal.Signals(number).name} to {to}"
                 + (", nobody reads" if unread else ""))
    process = campaign.start(**({"stdout": pipe[1]} if unread else {}))
    if unread or trains(process):
        time.sleep(rng.uniform(0, 0.3) + unread)
        attempt.hits += process.alive()
        if to == "group":
            os.killpg(process.pid, number)
        else:
            process.signal(number, (process.workers() or [None])[0]
                           if to == "worker" else None)
        if rng.random() < 0.3:
            process.signal(signal.SIGSTOP)
            time.sleep(0.1)
            process.signal(signal.SIGCONT)
        if number in STOPS and to != "worker":
            stopped(attempt, campaign, process, number, unread)
        else:
            limit = 5 if unread else 10 * campaign.seconds + 10
            end_of(attempt, process, limit, number, unread)
    for descriptor in pipe:
        os.close(descriptor)
    if process.usage is None:
        process.end()
    campaign.finish()


def end_of(attempt, process, limit, number, unread):
    """Ends by the signal, or continues; a worker's end is a failed stage."""
    if unread:
        # A worker takes no notice, so that the campaign waits for its reader.
        process.end()
        return
    ended = attempt.ended(process.wait(limit), sent=number)
    attempt.expect(ended.code in (0, 4, -number),
                   f"{signal.Signals(number).name}: {ended.code}")
