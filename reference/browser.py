"""Controls a headless Chromium, which opens files and evaluates expressions, by the DevTools protocol over two pipes."""

import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome")
PATIENCE = 60.0
"""Seconds to wait for an answer of the browser."""
READY = "document.documentElement?.dataset.ready"
"""A page of the program sets this when all of it is drawn."""


class NoBrowser(RuntimeError):
    """Chromium is not installed, or it does not answer."""


def found() -> str:
    """Returns the path of Chromium: the environment variable CHROMIUM, or one of its usual names."""
    names = (os.environ["CHROMIUM"],) if "CHROMIUM" in os.environ else NAMES
    for name in names:
        if shutil.which(name):
            return name
    raise NoBrowser("Chromium is not installed; on Debian `apt-get install chromium`, or name it in the variable CHROMIUM")


class Browser:
    """A browser with one page."""

    def __init__(self) -> None:
        # Processes of the browser may still write into the folder while it ends.
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        ours_in, theirs_out = os.pipe()
        theirs_in, ours_out = os.pipe()
        options = [
            "--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--use-gl=angle", "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader", "--no-first-run", "--disable-background-networking", "--disable-extensions",
            "--hide-scrollbars", f"--user-data-dir={self.profile.name}",
        ]  # fmt: skip
        self.process = subprocess.Popen(
            ["sh", "-c", f'exec "$@" 3<&{theirs_in} 4>&{theirs_out}', "sh", found(), *options],
            pass_fds=(theirs_in, theirs_out),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(theirs_in)
        os.close(theirs_out)
        self.to, self.of = os.fdopen(ours_out, "wb", buffering=0), os.fdopen(ours_in, "rb", buffering=0)
        os.set_blocking(self.of.fileno(), False)
        self.left, self.number, self.session, self.events = b"", 0, None, []
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")

    def close(self) -> None:
        self.process.terminate()
        self.process.wait()
        self.to.close()
        self.of.close()
        self.profile.cleanup()

    def __enter__(self) -> "Browser":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def send(self, method: str, **params: Any) -> dict:
        """Sends a command and returns its result. Events that arrive in the meantime are kept."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        self.to.write(json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") != self.number:
                self.events.append(answer)
            elif "error" in answer:
                raise RuntimeError(f"{method}: {answer['error']}")
            else:
                return answer["result"]

    def receive(self) -> dict:
        end = time.monotonic() + PATIENCE
        while b"\0" not in self.left:
            part = self.of.read(1 << 20)
            if part:
                self.left += part
            elif part == b"" or time.monotonic() > end:
                raise NoBrowser("Chromium does not answer")
            else:
                time.sleep(0.002)
        text, self.left = self.left.split(b"\0", 1)
        return json.loads(text)

    def open(
        self, page: Path, size: tuple[int, int] = (1280, 900), scheme: str = "light", fragment: str = "", ready: str = READY
    ) -> float:
        """Opens a page and waits until an expression is true in it. Returns the seconds that this took."""
        self.send("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=size[0] < 600)
        self.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.send("Page.navigate", url="about:blank")
        self.events.clear()
        began = time.monotonic()
        self.send("Page.navigate", url=page.resolve().as_uri() + fragment)
        while not self.ask(f"location.href !== 'about:blank' && !!({ready})"):
            if time.monotonic() > began + PATIENCE:
                raise NoBrowser(f"{page} is not ready: {self.ask('document.body.innerText')[:500]}; {self.faults()}")
            time.sleep(0.01)
        return time.monotonic() - began

    def ask(self, expression: str) -> Any:
        """Evaluates an expression in the page, waits for a promise, and returns the value."""
        result = self.send("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"]["exception"].get("description", "exception"))
        return result["result"].get("value")

    def frame(self) -> None:
        """Waits until all changes are drawn."""
        self.ask("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")

    def picture(self, selector: str | None = None) -> bytes:
        """Returns a picture of the element that a selector names, or of the whole page, as PNG."""
        of = f"document.querySelector({json.dumps(selector)})" if selector else "document.documentElement"
        box = self.ask(f"(() => {{ const b = {of}.getBoundingClientRect(); return [b.x + scrollX, b.y + scrollY, b.width, b.height]; }})()")
        clip = dict(zip(("x", "y", "width", "height"), box, strict=True), scale=1)
        return base64.b64decode(self.send("Page.captureScreenshot", format="png", clip=clip, captureBeyondViewport=True)["data"])

    def faults(self) -> list[str]:
        """Returns all faults since the page was opened: exceptions, errors on the console, network requests."""
        self.ask("0")
        found = []
        for event in self.events:
            params, method = event.get("params", {}), event.get("method")
            if method == "Runtime.exceptionThrown":
                found.append(params["exceptionDetails"].get("exception", {}).get("description", "exception"))
            elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "assert"):
                found.append(str(params["args"]))
            elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
                found.append(params["entry"]["text"])
            elif method == "Network.requestWillBeSent" and not params["request"]["url"].startswith(("file:", "data:", "about:")):
                found.append(f"asks for {params['request']['url']}")
        return found
