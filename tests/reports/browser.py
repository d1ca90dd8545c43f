"""Pages in Chromium without a window."""

import os
import re
import shutil
import subprocess
import tempfile

WIDTHS = (390, 800, 1400)
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic",
         "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]


def too_wide(chromium, path, width, d):
    """Pixels by which the page is wider than the window."""
    probe = os.path.join(d, "probe.html")
    shutil.copy(path, probe)
    with open(probe, "a") as f:
        f.write("<script>document.body.innerHTML = 'wide ' + "
                "(document.documentElement.scrollWidth - innerWidth) + ' end'"
                "</script>")
    p = subprocess.run([chromium, *FLAGS, "--dump-dom",
                        "--user-data-dir=" + tempfile.mkdtemp(dir=d),
                        f"--window-size={width},900", "file://" + probe],
                       capture_output=True, text=True, timeout=120)
    found = re.search(r"wide (-?\d+) end", p.stdout)
    return int(found[1]) if found else None
