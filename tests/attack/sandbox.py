"""A folder with all that an attack may reach, and what becomes of it.

  home/     a user's home            outside/  what no store has to do with
  work/     where attempts run, each in a folder of its own

Snapshots hold type, mode, size, time and content of every entry; what an
attempt does not own has to be the same afterwards.
"""

import hashlib
import os
import shutil
import socket
import stat

OLD = 1_000_000_000  # seconds; what is written again has another time
LARGEST = 64 << 20   # larger files count by size and time

PLANTED = {
    "home/precious.txt": "written by hand\n",
    "home/.profile": "umask 022\n",
    "home/cases/a+b.h5": "no case of the suite\n",
    "outside/notes/chapter.tex": "\\section{Results}\n",
    "outside/notes/chapter.tmp": "half a sentence\n",
    "outside/data.h5": "measured\n",
    "outside/lock": "1\n",
    "outside/empty": "",
}


def device(path, minor):
    """A character device like /dev/null (3), zero (5) or full (7)."""
    try:
        os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, minor))
    except PermissionError:
        return False
    return True


def listen(path):
    """A socket in the file system, by a short name."""
    with socket.socket(socket.AF_UNIX) as s:
        here = os.getcwd()
        os.chdir(os.path.dirname(path))
        try:
            s.bind(os.path.basename(path))
        finally:
            os.chdir(here)


def write(path, content):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as f:
        f.write(content if isinstance(content, bytes) else content.encode())


def read(path):
    with open(path, "rb") as f:
        return f.read()


def state(path):
    s = os.lstat(path)
    content = ""
    if stat.S_ISLNK(s.st_mode):
        content = os.readlink(path)
    elif stat.S_ISREG(s.st_mode) and s.st_size <= LARGEST:
        content = hashlib.sha256(read(path)).hexdigest()
    size = s.st_size if stat.S_ISREG(s.st_mode) else s.st_rdev
    return (stat.filemode(s.st_mode), size, content, s.st_mtime_ns)


def snapshot(root):
    """Path relative to the root -> state, of everything below it."""
    found = {"": state(root)}
    for folder, folders, files in os.walk(root):
        for name in folders + files:
            path = os.path.join(folder, name)
            found[os.path.relpath(path, root)] = state(path)
    return found


def differences(before, after, owned=lambda path: False):
    """One line for each entry that is gone, new or changed and not owned."""
    lines = []
    for path in sorted(before.keys() | after.keys()):
        a, b = before.get(path), after.get(path)
        if a == b or owned(path):
            continue
        if a is None:
            lines.append(f"{path} is new")
        elif b is None:
            lines.append(f"{path} is gone")
        else:
            names = ("mode", "size", "content", "time")
            what = [n for n, x, y in zip(names, a, b) if x != y]
            lines.append(f"{path} has another {' and '.join(what)}")
    return lines


class Sandbox:
    def __init__(self, root):
        self.root = root
        self.home, self.outside, self.work = (
            os.path.join(root, name) for name in ("home", "outside", "work"))
        self.plant()

    def path(self, name):
        return os.path.join(self.root, name)

    def plant(self):
        """Everything as it was in the beginning."""
        for name in os.listdir(self.root):
            shutil.rmtree(self.path(name))
        os.makedirs(self.work)
        for name, text in PLANTED.items():
            write(self.path(name), text)
        os.symlink("notes/chapter.tex", self.path("outside/link"))
        os.mkfifo(self.path("outside/pipe"))
        listen(self.path("outside/socket"))
        self.has_devices = all(
            device(self.path("outside/" + name), minor)
            for name, minor in (("null", 3), ("zero", 5), ("full", 7)))
        for folder in (self.home, self.outside):
            for path in sorted(snapshot(folder), reverse=True):
                path = os.path.join(folder, path)
                os.utime(path, (OLD, OLD), follow_symlinks=False)
        self.before = self.surroundings()

    def surroundings(self):
        return {**{os.path.join("home", k): v
                   for k, v in snapshot(self.home).items()},
                **{os.path.join("outside", k): v
                   for k, v in snapshot(self.outside).items()}}

    def touched(self, owned=lambda path: False):
        """What changed in home and outside; they are mended by that."""
        now = self.surroundings()
        lines = differences(self.before, now, owned)
        if now != self.before:
            self.plant()
        return lines

    def folder(self, name):
        """A new empty one to work in; the old ones go."""
        shutil.rmtree(self.work)
        path = os.path.join(self.work, name)
        os.makedirs(path)
        return path
