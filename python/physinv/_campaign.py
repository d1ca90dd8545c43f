"""Campaigns: run by the program physinv-bench, read by the suite's own code."""

import collections.abc
import contextlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from physinv import _core, _methods, _problems


class ProgramError(RuntimeError):
    """The program ended with another status than 0; `status` is its exit code,
    the message its last words, `output` what the verb printed before it ended
    (of `run` with methods in Python nothing: it prints as it goes)."""

    def __init__(self, status, words, output=""):
        super().__init__(words)
        self.status = status
        self.output = output


def program():
    """Where physinv-bench is: what PHYSINV_BENCH names, else the one of this
    build or installation, else the one in PATH."""
    named = os.environ.get("PHYSINV_BENCH")
    if named:
        return named
    for folder in pathlib.Path(_core.__file__).absolute().parents:
        for path in (folder / "physinv-bench", folder / "bin/physinv-bench"):
            if path.is_file():
                return str(path)
    found = shutil.which("physinv-bench")
    if found is None:
        raise FileNotFoundError(
            "there is no program physinv-bench; set PHYSINV_BENCH to its path")
    return found


def main():
    """The program, as what pip installs as physinv-bench."""
    path = program()
    os.execv(path, [path, *sys.argv[1:]])


def published(experiment):
    """The numbers that the paper of an experiment prints, a dict each: quantity,
    value, spread (None where there is none), unit, where (table or figure)."""
    folder = os.environ.get("PHYSINV_PUBLISHED_DIR") or _published_folder()
    paper = pathlib.Path(folder) / f"{experiment.split('/')[0]}.json"
    values = json.loads(paper.read_text())["values"] if paper.is_file() else []
    found = [dict(v) for v in values if v.pop("experiment") == experiment]
    if not found:
        raise ValueError(f"no paper prints numbers of '{experiment}' in {folder}")
    return found


def _published_folder():
    """In the folder of the program, or in the checkout that a build tree links to."""
    installed = pathlib.Path(program()).parent.parent / "share/physinv/published"
    sources = pathlib.Path(__file__).resolve().parents[2] / "reports/published"
    return installed if installed.is_dir() else sources


# A list is one value of these, with commas; other flags repeat.
_LISTS = ("seeds",)


def _texts(value):
    """What flags take of a value, or of several."""
    if hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    if isinstance(value, bool):
        return [str(value).lower()]
    if isinstance(value, (str, bytes, os.PathLike)):
        return [os.fsdecode(value)]
    if isinstance(value, collections.abc.Iterable):
        return [text for one in value for text in _texts(one)]
    return [str(value)]


def _words(arguments, flags):
    """As typed. A flag that is None, or an empty list, is left out."""
    words = [text for one in arguments for text in _texts(one)]
    for key, value in flags.items():
        texts = [] if value is None else _texts(value)
        if key in _LISTS and texts:
            texts = [",".join(texts)]
        words += [f"--{key.replace('_', '-')}={text}" for text in texts]
    return words


def verb(name, *arguments, **flags):
    """Calls a verb of physinv-bench and returns what it prints; flags as
    keywords: verb("compare", "a", "b"), verb("list", profile="smoke",
    seeds=[0, 1]). None leaves a flag out. With methods or problems in Python it runs in
    this process, which knows them. ProgramError where it ends with a status;
    its `output` is what was printed."""
    words = _words(arguments, flags)
    if _in_process():
        with _captured() as printed:
            status, last = _call(name, words)
        output = printed()
    else:
        done = subprocess.run([program(), name, *words], capture_output=True)
        status, output = done.returncode, _decoded(done.stdout)
        lines = _decoded(done.stderr).strip().splitlines()
        last = lines[-1] if lines else f"{name} failed"
    if status != 0:
        raise ProgramError(status, last, output)
    return output


def _in_process():
    """Methods and problems in Python are known here alone."""
    return _methods.registered() or _problems.registered()


def _decoded(printed):
    return printed.decode("utf-8", "surrogateescape")


def _call(name, words):
    """Status and last words of a verb in this process."""
    return _core.call(name, [os.fsencode(word) for word in words])


@contextlib.contextmanager
def _captured():
    """What is written to the standard output meanwhile, by forks, too."""
    with tempfile.TemporaryFile() as file:
        sys.stdout.flush()
        before = os.dup(1)
        os.dup2(file.fileno(), 1)
        text = []
        try:
            yield lambda: text[0]
        finally:
            os.dup2(before, 1)
            os.close(before)
            file.seek(0)
            text.append(_decoded(file.read()))


def run(profile="quick", out=None, **flags):
    """Runs a profile (flags of `run`, such as filter="jpo/billiards", jobs=2,
    seeds=[0, 1]) and opens its results. With methods in Python, in workers of
    this process."""
    out = out or f"results/{profile}"
    flags = dict(profile=profile, out=out, **flags)
    if _in_process():
        status, last = _call("run", _words([], flags))
        if status != 0:
            raise ProgramError(status, last)
    else:
        verb("run", **flags)
    return open(out)


def open(directory):
    """Results of a campaign, which may be running."""
    return Results(directory)


class Results:
    """A campaign's results. `directory` is absolute: another working directory
    makes it no other campaign."""

    def __init__(self, directory):
        self.directory = os.path.abspath(os.fsdecode(directory))
        self._results = _core.load_results(os.fsencode(self.directory))

    def stages(self):
        """A dict for every finished stage: case, experiment, method, n, seed,
        stage, stop, iterations, seconds (None where it has no result)."""
        return self._results._stages()

    def examples(self, case, stage=""):
        """Of a stage (default: the case's last): loss, status, iterations and
        evaluations per example, x (samples, unknowns), the problem's data and
        the method's own arrays (one number each: (n,), else samples, points or
        updates first)."""
        return self._results._examples(case, stage)

    def curve(self, case, stage=""):
        """Along a stage: iteration, seconds, evaluations per point; loss
        (points, examples); x (points, examples, unknowns) of the first
        examples."""
        return self._results._curve(case, stage)

    def tidy(self):
        """A row for every example of every stage that was asked for, as a dict
        of NumPy columns, which pandas.DataFrame takes: case, experiment,
        method, n, seed, profile, precision, stage, example, loss, status,
        iterations, evaluations, seconds (of the stage), ... as of
        `export --format=tidy`. A missing number is NaN. Stages that failed,
        were skipped, diverged or were not run have that as their status, and
        no numbers."""
        import numpy as np
        columns = {}
        for name, values in self._results._tidy().items():
            if any(value is None for value in values):
                values = np.array(values, dtype=float)
            columns[name] = np.asarray(values)
        return columns

    def to_parquet(self, path):
        """Writes the columns of tidy() as a Parquet file, missing numbers as
        nulls; needs pyarrow."""
        try:
            import pyarrow as pa
            from pyarrow import parquet
        except ImportError:
            raise ImportError(
                "to_parquet needs pyarrow (pip install pyarrow); without it, "
                "`physinv-bench export RESULTS --format=tidy` writes the same "
                "table as CSV") from None
        table = pa.table({name: pa.array(values) for name, values
                          in self._results._tidy().items()})
        parquet.write_table(table, str(path))

    def plot(self, figure="learning_curves"):
        """A figure of the report as SVG text, by its id ("fig4a"), or with its
        experiment ("jpo-billiards/fig4a") where several have one; without a
        name the losses of all methods. The report is made if it is not there,
        or older than the results. A wrong id is answered with those there
        are."""
        return _figure(self.directory, figure)


def _figure(directory, name):
    report = pathlib.Path(directory) / "report"
    if not _newer(report / "report.md", report.parent / "results.json"):
        try:
            verb("report", directory)
        except ProgramError as error:
            if error.status not in _REPORTED:
                raise
    figures = {}  # id, and each with its experiment
    for path in sorted(report.rglob("*.svg")):
        where = path.relative_to(report).parts[0]
        figures.setdefault(path.stem, {})[f"{where}/{path.stem}"] = path
    found = {full: path for alike in figures.values()
             for full, path in alike.items() if name in (full, path.stem)}
    if not found:
        raise ValueError(f"there is no figure '{name}'; known figures: "
                         f"{', '.join(sorted(figures))}")
    if len(found) > 1:
        raise ValueError(f"there are several figures '{name}': "
                         f"{', '.join(sorted(found))}")
    path, = found.values()
    return path.read_text(encoding="utf-8")


# The report is written, of runs that say no or are not all there.
_REPORTED = (7, 10)


def _newer(path, other):
    return (path.is_file() and other.is_file() and
            path.stat().st_mtime_ns >= other.stat().st_mtime_ns)
