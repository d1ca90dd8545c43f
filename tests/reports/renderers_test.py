"""renderers_test.py PROGRAM STORE: figures of a report in other programs.

Every SVG of the reports that have all kinds of figures is drawn by CairoSVG and
rsvg-convert: it has the colours of its curves and of its fields. With
PHYSINV_FULL, every one of all reports is, and with npm resvg draws them, too,
and Vega-Lite 6 every specification, without a warning. A renderer that is
missing is named.
"""

import glob
import io
import json
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import cairocffi
    import cairosvg
except ImportError as missing:
    print(f"skipped: {missing.name} is missing (python3-cairosvg)")
    sys.exit(77)

PROGRAM, STORE = (os.path.abspath(p) for p in sys.argv[1:3])
FULL = bool(os.environ.get("PHYSINV_FULL"))
KINDS = ("jpo-billiards", "jpo-navier-stokes", "matrix", "matrix-heat",
         "numerics-navier-stokes", "physgrad-scaling", "sip-fluid")
FEWEST_COLORS = 12  # letters have more shades; an empty picture has one
NEAR = 40           # of a colour whose line is thinner than a pixel
FIELD_ENDS = ("#440154", "#fde725")
PACKAGES = ("@resvg/resvg-js@2", "vega@6", "vega-lite@6")


def cairo(path):
    return cairosvg.svg2png(url=path)


def rsvg(path):
    p = subprocess.run(["rsvg-convert", path], capture_output=True, check=True)
    assert not p.stderr, p.stderr
    return p.stdout


RENDERERS = {"CairoSVG": cairo}
if shutil.which("rsvg-convert"):
    RENDERERS["rsvg-convert"] = rsvg


def colors(png):
    """Of a picture, a row of red, green and blue each."""
    surface = cairocffi.ImageSurface.create_from_png(io.BytesIO(png))
    pixels = np.frombuffer(surface.get_data(), np.uint32)
    found = np.unique(pixels)
    return np.stack([found >> 16 & 255, found >> 8 & 255, found & 255], 1)


def rgb(text):
    return [int(text[k:k + 2], 16) for k in (1, 3, 5)]


def wanted(path):
    """Colours that the picture has to show: of the series, and of fields."""
    with open(path) as f:
        text = f.read()
    light = text.split("@media")[0]
    used = {number for name in re.findall(r' class="([^"]+)"', text)
            for number in re.findall(r"\bs(\d+)\b", name)}
    inks = [re.search(rf"\.s{k}{{stroke:(#\w+)}}", light)[1] for k in used]
    return inks + (list(FIELD_ENDS) if "<image" in text else [])


def lacks(found, path):
    """What is wrong with the colours that a renderer found."""
    if len(found) < FEWEST_COLORS:
        return [f"{len(found)} colours"]
    return [color for color in wanted(path)
            if np.abs(found.astype(int) - rgb(color)).max(1).min() > NEAR]


def drawn(path):
    wrong = []
    for name, render in RENDERERS.items():
        try:
            missing = lacks(colors(render(path)), path)
        except Exception as error:  # of a renderer, of whatever kind
            missing = [repr(error)]
        wrong += [f"{name}: {path}: {what}" for what in missing]
    return wrong


def with_npm(paths, d):
    """The same by resvg, and the specifications; None if npm has no packages."""
    install = subprocess.run(["npm", "install", "--no-audit", "--no-fund",
                              *PACKAGES], cwd=d, capture_output=True, text=True)
    if install.returncode != 0:
        return None
    script = os.path.join(d, "render.mjs")
    shutil.copy(os.path.join(os.path.dirname(__file__), "render.mjs"), script)
    node = subprocess.run(["node", script], input="\n".join(paths), cwd=d,
                          capture_output=True, text=True, check=True)
    wrong = []
    for line in node.stdout.splitlines():
        one = json.loads(line)
        found = np.array(one["colors"]).reshape(-1, 3)
        wrong += [f"{one['renderer']}: {one['path']}: {what}"
                  for what in lacks(found, one["path"]) + one["warnings"]]
    return wrong


def main():
    if "rsvg-convert" not in RENDERERS:
        print("rsvg-convert is missing (librsvg2-bin)")
    with tempfile.TemporaryDirectory() as d:
        out = os.path.join(d, "report")
        subprocess.run([PROGRAM, "report", STORE, "--out=" + out], check=True,
                       stdout=subprocess.DEVNULL)
        paths = sorted(path for folder in (["*"] if FULL else KINDS) for path in
                       glob.glob(os.path.join(out, folder, "figures", "*.svg")))
        assert len(paths) > 40, paths
        with multiprocessing.Pool() as pool:
            wrong = sum(pool.map(drawn, paths), [])
        print(f"{len(paths)} figures by {', '.join(RENDERERS)}")
        if not FULL or not shutil.which("npm"):
            print("resvg and Vega-Lite are not asked: ./check --full does, "
                  "with npm")
        else:
            more = with_npm(paths, d)
            print("npm has no packages" if more is None else
                  "the same by resvg and Vega-Lite 6")
            wrong += more or []
    print("\n".join(wrong))
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
