"""Pages in Chromium without a window, which is asked over its pipe (DevTools
protocol: messages of JSON that end with NUL on the descriptors 3 and 4)."""

import base64
import json
import os
import re
import select
import shutil
import subprocess
import tempfile
import time

WIDTHS = (390, 800, 1400)
SHEET = 680  # pixels of A4 between margins of 15 mm
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic",
         "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--hide-scrollbars",
         "--remote-debugging-pipe"]
LONGEST = 120  # seconds until an answer


def installed():
    return shutil.which("chromium")


class Browser:
    def __enter__(self):
        self.profile = tempfile.mkdtemp()
        reads, to = os.pipe()
        self.answers, writes = os.pipe()
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{reads} 4>&{writes}', "bash",
             installed(), *FLAGS, "--user-data-dir=" + self.profile],
            pass_fds=(reads, writes), stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(reads)
        os.close(writes)
        self.to, self.pending, self.last, self.session = to, b"", 0, None
        page = self.call("Target.createTarget", url="about:blank")
        self.session = self.call("Target.attachToTarget", flatten=True,
                                 targetId=page["targetId"])["sessionId"]
        self.call("Page.enable")
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(LONGEST)
        os.close(self.to)
        os.close(self.answers)
        shutil.rmtree(self.profile, ignore_errors=True)

    def message(self):
        end = time.monotonic() + LONGEST
        while b"\0" not in self.pending:
            if not select.select([self.answers], [], [],
                                 max(0, end - time.monotonic()))[0]:
                raise TimeoutError("Chromium does not answer")
            self.pending += os.read(self.answers, 1 << 20)
        text, self.pending = self.pending.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, until=None, **parameters):
        """What the method returns, after an event if one is named."""
        self.last += 1
        call = {"id": self.last, "method": method, "params": parameters}
        if self.session:
            call["sessionId"] = self.session
        os.write(self.to, json.dumps(call).encode() + b"\0")
        answer = None
        while answer is None or until:
            message = self.message()
            if message.get("method") == until:
                until = None
            if message.get("id") == self.last:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                answer = message["result"]
        return answer

    def open(self, path, width=1400, dark=False, media="screen"):
        """Loads the page in a window of this width."""
        self.call("Emulation.setDeviceMetricsOverride", width=width,
                  height=900, deviceScaleFactor=1, mobile=False)
        scheme = "dark" if dark else "light"
        self.call("Emulation.setEmulatedMedia", media=media, features=[
            {"name": "prefers-color-scheme", "value": scheme}])
        self.call("Page.navigate", until="Page.loadEventFired",
                  url="file://" + os.path.abspath(path))

    def value(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression,
                           awaitPromise=True,
                           returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"])
        return answer["result"].get("value")

    def too_wide(self, path, width):
        """Pixels by which the page is wider than the window."""
        self.open(path, width)
        return self.value("document.documentElement.scrollWidth - innerWidth")

    def elements(self, path):
        """Of the page, its script's included: what loading takes goes with
        them."""
        self.open(path)
        return self.value("document.getElementsByTagName('*').length")

    def load_ms(self, path):
        """From the start of navigation to the end of the load event, the least
        of three."""
        times = []
        for _ in range(3):
            self.open(path)
            times.append(self.value(
                "Math.round(performance.getEntriesByType('navigation')[0]"
                ".loadEventEnd)"))
        return min(times)

    def cut_in_print(self, path):
        """Tables that are wider than a sheet of paper."""
        self.open(path, SHEET, media="print")
        return self.value(
            "[...document.querySelectorAll('.scroll')].filter(e => "
            "e.firstElementChild.scrollWidth > e.clientWidth + 1).length")

    def printed_pages(self, path):
        """Sheets of paper."""
        self.open(path)
        pdf = self.call("Page.printToPDF", preferCSSPageSize=True)
        return len(re.findall(rb"/Type\s*/Page\b(?!s)",
                              base64.b64decode(pdf["data"])))

    def picture(self, path, highest):
        """Of the open page as PNG, from its top. The window is made as high, so
        that it has what is laid out only where it is seen."""
        for _ in range(2):  # what was not laid out may be less high
            width, height = self.value(
                "[innerWidth, document.documentElement.scrollHeight]")
            height = min(height, highest)
            self.call("Emulation.setDeviceMetricsOverride", width=width,
                      height=height, deviceScaleFactor=1, mobile=False)
        clip = {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}
        png = self.call("Page.captureScreenshot", format="png", clip=clip,
                        captureBeyondViewport=True)
        with open(path, "wb") as f:
            f.write(base64.b64decode(png["data"]))
