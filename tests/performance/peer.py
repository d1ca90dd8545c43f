"""peer.py PROGRAM ARGUMENTS: runs a PyTorch program whose JSON then has every time as
{"wall": seconds, "cpu": seconds}. The clock is stopped while training examples are
drawn.
"""

import importlib.util
import json
import os
import runpy
import sys
import time

# Of programs that have no fixed training set: class and function that draw one.
DRAWING = {"sip-fluid_torch.py": ("Flow", "data")}
drawn = [0.0, 0.0]


class Seconds(float):
    """Wall seconds that carry CPU seconds along."""

    def __new__(cls, wall, cpu):
        self = float.__new__(cls, wall)
        self.cpu = cpu
        return self

    def __add__(self, other):
        return Seconds(float(self) + float(other),
                       self.cpu + getattr(other, "cpu", other))

    def __sub__(self, other):
        return Seconds(float(self) - float(other),
                       self.cpu - getattr(other, "cpu", other))

    __radd__ = __add__


def now(clock=time.perf_counter):
    return Seconds(clock() - drawn[0], time.process_time() - drawn[1])


def told(value):
    if isinstance(value, dict):
        return {key: told(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [told(inner) for inner in value]
    if isinstance(value, Seconds):
        return {"wall": float(value), "cpu": value.cpu}
    return value


def beside_the_clock(function):
    def call(*arguments):
        start = now()
        result = function(*arguments)
        taken = now() - start
        drawn[0] += taken
        drawn[1] += taken.cpu
        return result
    return call


def main():
    del sys.argv[0]
    path = sys.argv[0]
    dumps = json.dumps
    json.dumps = lambda value, **how: dumps(told(value), **how)
    time.perf_counter = now
    if os.path.basename(path) not in DRAWING:
        runpy.run_path(path, run_name="__main__")
        return
    spec = importlib.util.spec_from_file_location("peer_program", path)
    program = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(program)
    owner, name = DRAWING[os.path.basename(path)]
    owner = getattr(program, owner)
    setattr(owner, name, beside_the_clock(getattr(owner, name)))
    program.main()


if __name__ == "__main__":
    main()
