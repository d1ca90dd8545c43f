"""pages_test.py PROGRAM STORE: the pages of a real campaign, and in Chromium if
there is one.

The index is small, links and fragments lead somewhere, each figure is also
Vega-Lite, no two entries of a legend look alike, and what the papers print of their
curves is next to ours. Nothing is wider than the window at 390, 800 and 1400 pixels, a
page has few elements, loads within a second on a machine that is not busy, and fits 30
sheets that cut no table.
"""

import glob
import json
import os
import re
import subprocess
import sys
import tempfile

from browser import WIDTHS, Browser, installed

PROGRAM, STORE, SOURCES = (os.path.abspath(p) for p in sys.argv[1:4])
LARGEST_INDEX = 150_000
LARGEST_PICTURES = 200_000  # of an experiment
MOST_ELEMENTS = 5_000
LONGEST_LOAD_MS = 1_000
MOST_SHEETS = 30
FAILED = []


def check(condition, what):
    if not condition:
        print("FAIL", what)
        FAILED.append(what)


def read(path):
    with open(path) as f:
        return f.read()


def links(path):
    """Files and fragments that are there."""
    text = read(path)
    ids = set(re.findall(r' id="([^"]+)"', text))
    count = 0
    for target in re.findall(r'<a[^>]* href="([^"]+)"', text):
        count += 1
        if target.startswith("#"):
            check(target[1:] in ids, f"{path}: no {target}")
        elif not target.startswith("https://"):
            name, _, fragment = target.partition("#")
            there = os.path.join(os.path.dirname(path), name)
            check(os.path.exists(there), f"{path}: no {name}")
            check(not fragment or f' id="{fragment}"' in read(there),
                  f"{path}: no {target}")
    return count


def cards(index):
    """Each card of the index has its picture, which says what it shows."""
    pictures = re.findall(r'<img src="([^"]+)" alt="([^"]*)"', read(index))
    for target, alt in pictures:
        there = os.path.join(os.path.dirname(index), target)
        check(os.path.exists(there), f"{index}: no {target}")
        check(len(alt) > 10, f"{index}: {target} is called {alt!r}")
    return len(pictures)


def legends(path):
    """Samples next to the names differ."""
    count = 0
    for legend in re.findall(r'<ul class="legend">.*?</ul>', read(path), re.S):
        entries = re.findall(r"<li[^>]*>(.*?</svg>)(.*?)</li>", legend, re.S)
        samples = [sample for sample, _ in entries]
        names = [name for _, name in entries]
        check(len(set(samples)) == len(samples), f"{path}: alike in {names}")
        count += len(entries)
    return count


def drawn(pages):
    """Pictures of what problems are about: light, and each with its words."""
    count = 0
    for path in pages:
        found = re.findall(r'<figure id="[^"]+" class="picture">.*?</figure>',
                           read(path), re.S)
        size = sum(len(figure) for figure in found)
        check(size <= LARGEST_PICTURES, f"{path}: pictures of {size} bytes")
        for figure in found:
            panels = re.findall(r'<svg (?!class="sample")[^>]*role="img".*?</svg>',
                                figure, re.S)
            check(panels or "not stored" in figure, f"{path}: an empty picture")
            check(all("<title>" in panel for panel in panels),
                  f"{path}: a picture without a name")
            count += len(panels)
    return count


def vega_lite(out):
    """Each figure has a specification next to it, with its data inside."""
    figures = glob.glob(os.path.join(out, "*", "figures", "*.svg"))
    for path in figures:
        with open(path[:-len("svg")] + "vl.json") as f:
            spec = json.load(f)
        check(spec["$schema"].endswith("vega-lite/v5.json"), path)
        layers = [layer for panel in spec["concat"] for layer in panel["layer"]]
        check(all("mark" in layer and "values" in layer["data"]
                  for layer in layers), f"{path}: a layer without data")
    return len(figures)


def printed_curves(out):
    """Those of the papers' files are in the figures that they name."""
    drawn = 0
    for path in glob.glob(os.path.join(SOURCES, "reports", "published",
                                       "*.json")):
        with open(path) as f:
            curves = json.load(f).get("curves", [])
        for curve in curves:
            folder = os.path.join(out, curve["experiment"].replace("/", "-"))
            name = os.path.join(folder, "figures", curve["figure"] + ".json")
            if not os.path.isdir(folder):
                continue
            check(os.path.exists(name), f"no {name}")
            with open(name) as f:
                figure = json.load(f)
            panels = {panel["title"] or panel["x_label"]: panel
                      for panel in figure["panels"]}
            for title in curve.get("panels", []):
                check(title in panels or title == "seconds by the paper's clock",
                      f"{name}: no panel {title}")
            drawn += any(series["label"] == curve["label"]
                         for panel in figure["panels"]
                         for series in panel["series"])
    check(drawn > 20, f"{drawn} printed curves are drawn")
    return drawn


def in_chromium(index, pages, d):
    largest = sorted(pages, key=os.path.getsize)[-3:]
    with Browser() as browser:
        for path in [index, *largest]:
            for width in WIDTHS:
                wide = browser.too_wide(path, width)
                check(wide <= 0, f"{path} is {wide} too wide for {width}")
            count, ms = browser.elements(path), browser.load_ms(path)
            sheets = browser.printed_pages(path)
            print(f"{os.path.relpath(path, d)}: {os.path.getsize(path)} bytes, "
                  f"{count} elements, loaded in {ms} ms, {sheets} sheets")
            check(count <= MOST_ELEMENTS, f"{path} has {count} elements")
            quiet = os.getloadavg()[0] <= os.cpu_count()
            check(ms <= LONGEST_LOAD_MS or not quiet, f"{path} takes {ms} ms")
            check(0 < sheets <= MOST_SHEETS, f"{path} takes {sheets} sheets")
            cut = browser.cut_in_print(path)
            check(cut == 0, f"{path}: print cuts {cut} tables")


def main():
    with tempfile.TemporaryDirectory() as d:
        out = os.path.join(d, "report")
        for flags in ([], ["--one-file"]):
            p = subprocess.run([PROGRAM, "report", STORE, "--out=" + out,
                                *flags], capture_output=True, text=True)
            check(p.returncode == 0, p.stderr)
            index = os.path.join(out, "index.html")
            pages = sorted(glob.glob(os.path.join(out, "*", "index.html")))
            if not flags:
                check(os.path.getsize(index) < LARGEST_INDEX,
                      f"the index has {os.path.getsize(index)} bytes")
            if not flags:
                check(len(pages) > 40, f"{len(pages)} pages")
                panels = drawn(pages)
                check(panels > 60, f"{panels} panels of pictures")
                print(f"{panels} panels of pictures")
                check(cards(index) > 40, f"{cards(index)} cards with a picture")
            looked_at = [index] + ([] if flags else pages)
            found = sum(links(path) for path in looked_at)
            entries = sum(legends(path) for path in looked_at)
            check(found > 500 and entries > 100,
                  f"{found} links, {entries} entries of legends")
            print(f"{len(looked_at)} pages, {found} links, {entries} entries "
                  f"of legends, {os.path.getsize(index)} bytes of index")
            if flags:
                continue
            print(f"{vega_lite(out)} figures are Vega-Lite, too, and "
                  f"{printed_curves(out)} printed curves are drawn")
            if not installed() or not os.environ.get("PHYSINV_FULL"):
                print("widths are not looked at: ./check --full does, with "
                      "chromium")
                continue
            in_chromium(index, pages, d)
    sys.exit(f"{len(FAILED)} failed" if FAILED else 0)


main()
