"""Headless Chromium over its debugging pipe: a page, its screen, its input."""

import fcntl
import json
import os
import shutil
import subprocess
import tempfile

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
BROWSER_ENDS = (3, 4)


def chromium():
    """Path of the browser; none where there is none."""
    return next((path for path in map(shutil.which, NAMES) if path), None)


class Browser:
    def __init__(self):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        (there, self.write), (self.read, back) = os.pipe(), os.pipe()
        # Chromium does not start its sandbox as root; the pages are our own.
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe"]

        def connect():
            # The browser reads from 3 and writes to 4, which may be taken by the pipes themselves.
            ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (there, back)]
            for end, number in zip(ends, BROWSER_ENDS):
                os.dup2(end, number)

        command = [chromium(), *options, f"--user-data-dir={self.profile.name}", "about:blank"]
        self.process = subprocess.Popen(
            command, preexec_fn=connect, pass_fds=BROWSER_ENDS, stderr=subprocess.DEVNULL
        )
        os.close(there)
        os.close(back)
        self.received, self.number, self.session, self.events = b"", 0, None, []
        page = next(t for t in self("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        self("Page.enable")
        self("Runtime.enable")

    def message(self):
        while b"\0" not in self.received:
            more = os.read(self.read, 1 << 20)
            assert more, "the browser has ended"
            self.received += more
        text, self.received = self.received.split(b"\0", 1)
        return json.loads(text)

    def __call__(self, method, **parameters):
        """A command of the DevTools protocol and its answer."""
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            request["sessionId"] = self.session
        os.write(self.write, json.dumps(request).encode() + b"\0")
        while (answer := self.message()).get("id") != self.number:
            self.events.append(answer)
        assert "error" not in answer, (method, answer)
        return answer["result"]

    @property
    def errors(self):
        """What scripts of the page have failed with."""
        return [event["params"] for event in self.events if event["method"] == "Runtime.exceptionThrown"]

    def open(self, path, width=1280, height=900, scheme="light"):
        """A page on a screen of this size; narrow ones are phones."""
        phone = width < 600
        self("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)
        self("Emulation.setTouchEmulationEnabled", enabled=phone)
        self("Emulation.setEmulatedMedia", media="", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.events.clear()
        self("Page.navigate", url=path.resolve().as_uri())
        while not any(event["method"] == "Page.loadEventFired" for event in self.events):
            self.events.append(self.message())

    def evaluate(self, expression):
        answer = self("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def close(self):
        self.process.terminate()
        self.process.wait()
        os.close(self.read)
        os.close(self.write)
        self.profile.cleanup()
