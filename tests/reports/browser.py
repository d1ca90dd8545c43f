"""Pages in Chromium without a window."""

import os
import re
import subprocess
import tempfile

WIDTHS = (390, 800, 1400)
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic",
         "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]


def asked(chromium, path, width, d, expression, change=lambda page: page):
    """An integer of the page, as it is changed, once it is loaded."""
    probe = os.path.join(d, "probe.html")
    with open(path) as f:
        page = change(f.read())
    with open(probe, "w") as f:
        f.write(page + "<script>addEventListener('load', () => setTimeout(() => {"
                f"document.body.innerHTML = 'is ' + ({expression}) + ' end'"
                "}))</script>")
    p = subprocess.run([chromium, *FLAGS, "--dump-dom",
                        "--user-data-dir=" + tempfile.mkdtemp(dir=d),
                        f"--window-size={width},900", "file://" + probe],
                       capture_output=True, text=True, timeout=120)
    found = re.search(r"is (-?\d+) end", p.stdout)
    return int(found[1]) if found else None


def too_wide(chromium, path, width, d):
    """Pixels by which the page is wider than the window."""
    return asked(chromium, path, width, d,
                 "document.documentElement.scrollWidth - innerWidth")


def elements(chromium, path, d):
    """Of the page, its script's included: what loading takes goes with them."""
    return asked(chromium, path, 1400, d,
                 "document.getElementsByTagName('*').length")


def load_ms(chromium, path, d):
    """From the start of navigation to the end of the load event, the least of
    three."""
    times = [asked(chromium, path, 1400, d,
                   "Math.round(performance.getEntriesByType('navigation')[0]"
                   ".loadEventEnd)") for _ in range(3)]
    return min(t for t in times if t is not None)


SHEET = 680  # pixels of A4 between margins of 15 mm


def cut_in_print(chromium, path, d):
    """Tables that are wider than a sheet of paper."""
    return asked(chromium, path, SHEET, d,
                 "[...document.querySelectorAll('.scroll')].filter(e => "
                 "e.firstElementChild.scrollWidth > e.clientWidth + 1).length",
                 lambda page: page.replace("@media print{", "@media all{"))


def printed_pages(chromium, path, d):
    """Sheets of paper."""
    out = os.path.join(d, "printed.pdf")
    subprocess.run([chromium, *FLAGS, "--no-pdf-header-footer",
                    "--user-data-dir=" + tempfile.mkdtemp(dir=d),
                    "--print-to-pdf=" + out, "file://" + path],
                   capture_output=True, timeout=120)
    with open(out, "rb") as f:
        return len(re.findall(rb"/Type\s*/Page\b(?!s)", f.read()))
