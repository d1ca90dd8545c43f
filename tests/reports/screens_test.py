"""screens_test.py PROGRAM STORE SCREENS: three pages of a report in Chromium, at
1280 and 400 pixels, light and dark.

Writes a picture of each to SCREENS. Nothing but tables in their frames scrolls
sideways, every text has a contrast of 4.5 with its background (3 if it is large;
WCAG 2.1, AA), and every picture says in words what it shows. Skipped where
there is no Chromium.
"""

import os
import subprocess
import sys
import tempfile

from browser import Browser, installed

PROGRAM, STORE, SCREENS = (os.path.abspath(p) for p in sys.argv[1:4])
PAGES = ("index.html", "jpo-billiards/index.html", "hig-poisson/index.html")
HIGHEST = 6000  # pixels of a picture
SKIPPED = 77
FAILED = []

# Elements that can be scrolled sideways and are no frame of a table.
SCROLLING = """[...document.querySelectorAll('body *')].filter(e =>
  e.clientWidth > 0 && e.scrollWidth > e.clientWidth + 1 &&
  !e.closest('.scroll, .hidden, svg, pre') &&
  !['visible', 'clip'].includes(getComputedStyle(e).overflowX))
  .map(e => e.outerHTML.slice(0, 80))"""

# Texts whose contrast is too low: (L1 + 0.05) / (L2 + 0.05) of WCAG 2.1.
FAINT = """(() => {
  const parts = (color) => {
    const of = color.match(/[\\d.]+/g).map(Number);
    const unit = color.startsWith('color(') ? 1 : 255;
    return [...of.slice(0, 3).map(v => v / unit), of[3] ?? 1];
  };
  const luminance = ([r, g, b]) => {
    const f = v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    return 0.2126 * f(r) + 0.7152 * f(g) + 0.0722 * f(b);
  };
  const behind = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const color = parts(getComputedStyle(e).backgroundColor);
      if (color[3] > 0.99) return color;
    }
    return [1, 1, 1, 1];
  };
  const faint = new Set();
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; (node = texts.nextNode());) {
    const e = node.parentElement;
    if (!node.textContent.trim() || e.closest('script, style, title, desc') ||
        !e.getClientRects().length || e.closest('.hidden')) continue;
    const css = getComputedStyle(e);
    const ink = parts(e.closest('svg') ? css.fill : css.color);
    const [a, b] = [luminance(ink), luminance(behind(e))];
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    const size = parseFloat(css.fontSize);
    const large = size >= 24 || (size >= 18.66 && css.fontWeight >= 600);
    if (contrast < (large ? 3 : 4.5))
      faint.add(`${contrast.toFixed(2)} ${e.tagName}.${e.getAttribute('class')} `
                + node.textContent.trim().slice(0, 40));
  }
  return [...faint];
})()"""

# Pictures without words for readers who do not see them.
NAMELESS = """[...document.querySelectorAll('img, svg')].filter(e =>
  !e.closest('[aria-hidden=true]') && !(e.getAttribute('alt') ||
  e.getAttribute('aria-label') || e.querySelector('title')?.textContent))
  .map(e => e.outerHTML.slice(0, 80))"""

# Pictures that were not loaded.
BROKEN = """(async () => {
  const all = [...document.images];
  for (const i of all) i.loading = 'eager';
  await Promise.all(all.map(i => i.decode().catch(() => 0)));
  return all.filter(i => !i.naturalWidth).map(i => i.src);
})()"""


def check(found, what):
    if found:
        print("FAIL", what, *found[:5], sep="\n  ")
        FAILED.append(what)


def look(browser, out, page, width, dark):
    name = "-".join([page.replace("/index.html", "").replace(".html", ""),
                     str(width), "dark" if dark else "light"])
    browser.open(os.path.join(out, page), width, dark)
    wide = browser.value("document.documentElement.scrollWidth - innerWidth")
    check([wide] if wide > 0 else [], f"{name}: wider than the window by")
    for expression, what in ((BROKEN, "a picture is missing"),
                             (SCROLLING, "scrolls sideways"),
                             (FAINT, "too faint"),
                             (NAMELESS, "a picture without words")):
        check(browser.value(expression), f"{name}: {what}")
    path = os.path.join(SCREENS, name + ".png")
    browser.picture(path, HIGHEST)
    print(path)


def main():
    if not installed():
        print("Chromium is not installed: no pictures of pages")
        sys.exit(SKIPPED)
    os.makedirs(SCREENS, exist_ok=True)
    with tempfile.TemporaryDirectory() as out, Browser() as browser:
        p = subprocess.run([PROGRAM, "report", STORE, "--out=" + out],
                           capture_output=True, text=True)
        check([] if p.returncode == 0 else [p.stderr], "report")
        for page in PAGES:
            for width in (1280, 400):
                for dark in (False, True):
                    look(browser, out, page, width, dark)
    sys.exit(f"{len(FAILED)} failed" if FAILED else 0)


main()
