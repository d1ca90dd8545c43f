#!/usr/bin/env python3
"""cached_test.py SOURCES: cmake/cached.sh removes a precompiled header that a
command writes, and leaves one that a command reads."""

import pathlib
import subprocess
import sys
import tempfile

SCRIPT = pathlib.Path(sys.argv[1], "cmake/cached.sh")

with tempfile.TemporaryDirectory() as d:
    header = pathlib.Path(d, "all.hxx.gch")
    for arguments, stays in (
            (["-include-pch", "-Xclang", header, "-o", d + "/a.o"], True),
            (["-x", "c++-header", "-o", header, "-c", d + "/all.hxx"], False)):
        header.write_text("old")
        done = subprocess.run(["sh", SCRIPT, "echo", *arguments], check=True,
                              capture_output=True, text=True)
        assert done.stdout.split() == [str(a) for a in arguments], done
        assert header.exists() == stays, arguments
