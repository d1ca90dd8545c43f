"""Threads of OpenMP (PyTorch, SciPy's BLAS, ...) where methods run in workers,
which are forks: the threads of the parent are not in a child, and code that waits for
them there waits for ever."""

import ctypes
import os
import sys

_HARD = 2  # omp_pause_hard: threads end, settings are lost
_ended = True


def _runtimes():
    """OpenMP as it is loaded, once for each file."""
    with open("/proc/self/maps", encoding="utf-8", errors="replace") as maps:
        paths = {line.split(maxsplit=5)[-1].strip() for line in maps
                 if "omp" in line}
    for path in sorted(paths):
        if os.path.basename(path).startswith(("libgomp", "libomp", "libiomp")):
            try:
                yield ctypes.CDLL(path)
            except OSError:
                pass  # it was replaced since


def before_fork():
    """Ends the threads of GNU's OpenMP in the parent, which starts them again
    when it next needs them; others see to forks themselves. If they do not end,
    children have one thread."""
    global _ended
    _ended = True
    for runtime in _runtimes():
        if "libgomp" not in runtime._name:
            continue
        most = runtime.omp_get_max_threads()
        try:
            _ended &= runtime.omp_pause_resource_all(_HARD) == 0
        except AttributeError:  # before OpenMP 5
            _ended = False
        runtime.omp_set_num_threads(most)


def limit(count):
    """Libraries compute with `count` threads from now on. Returns what
    `restore` takes."""
    count = count if _ended else 1
    before = [(runtime.omp_set_num_threads, runtime.omp_get_max_threads())
              for runtime in _runtimes()]
    torch = sys.modules.get("torch")
    if torch is not None:
        before.append((torch.set_num_threads, torch.get_num_threads()))
    variable = os.environ.get("OMP_NUM_THREADS")
    os.environ["OMP_NUM_THREADS"] = str(count)  # of what is imported later
    for set_threads, _ in before:
        set_threads(count)
    return before, variable


def restore(before):
    calls, variable = before
    for set_threads, count in calls:
        set_threads(count)
    if variable is None:
        os.environ.pop("OMP_NUM_THREADS", None)
    else:
        os.environ["OMP_NUM_THREADS"] = variable
