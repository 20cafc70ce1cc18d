"""A page in headless Chromium, driven as a user does it: keys, mouse, files dropped; over the browser's own pipe.

The DevTools protocol goes over two pipes, a JSON message up to each NUL byte, so that the distribution's Chromium is
all that is needed.
"""

from __future__ import annotations

import atexit
import base64
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
PATIENCE = 90.0
"""Seconds until something must have happened; machines are loaded."""
_KEYS = {
    "Enter": 13,
    "Tab": 9,
    "Escape": 27,
    "Backspace": 8,
    "ArrowDown": 40,
    "ArrowUp": 38,
    "F2": 113,
    "F8": 119,
    "Home": 36,
    "End": 35,
}
_START = """\
import os, sys
ends = [os.dup(int(one)) for one in sys.argv[1:3]]
for end, number in zip(ends, (3, 4)):
    os.dup2(end, number)
    os.set_inheritable(number, True)
os.execv(sys.argv[3], sys.argv[3:])
"""
"""The browser reads from 3 and writes to 4."""
_MODIFIERS = {"Alt": 1, "Control": 2, "Meta": 4, "Shift": 8}


@cache
def chromium() -> str:
    """The program, or skip the test with the reason."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip(f"no headless browser to look at pages with: {', '.join(NAMES)} are not installed")
    return found


class Browser:
    """The program, started once per process: each page has a context of its own, with its own storage and cache."""

    def __init__(self, room: Path) -> None:
        into, out = os.pipe(), os.pipe()
        options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--disable-dev-shm-usage"]
        options += ["--remote-debugging-pipe", f"--user-data-dir={room / 'user'}", "--no-first-run", "about:blank"]
        self._process = subprocess.Popen(
            [sys.executable, "-c", _START, str(into[0]), str(out[1]), chromium(), *options],
            pass_fds=(into[0], out[1]), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            env={**os.environ, "HOME": str(room)}, start_new_session=True,
        )  # fmt: skip
        os.close(into[0])
        os.close(out[1])
        self._write, self._read = into[1], out[0]
        self._number, self._rest = 0, b""

    def close(self) -> None:
        """End the program."""
        os.close(self._write)
        os.close(self._read)
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait(10)

    def send(self, method: str, session: str, parameters: dict[str, Any]) -> int:
        """Ask for something, in the browser itself or in a page; returns the number of the answer."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        os.write(self._write, json.dumps(message | ({"sessionId": session} if session else {})).encode() + b"\0")
        return self._number

    def next(self) -> dict[str, Any]:
        """What comes next: an answer or an event, of any page."""
        while b"\0" not in self._rest:
            piece = os.read(self._read, 1 << 20)
            assert piece, "the browser has ended"
            self._rest += piece
        text, _, self._rest = self._rest.partition(b"\0")
        found: dict[str, Any] = json.loads(text)
        return found


@cache
def _browser() -> Browser:
    """The browser of this process, which ends with it."""
    room = Path(tempfile.mkdtemp(prefix="plcgen-browser-"))
    atexit.register(shutil.rmtree, room, ignore_errors=True)
    found = Browser(room)
    atexit.register(found.close)
    return found


class Page:
    """One tab. ``problems`` are exceptions and refusals of the browser (policy, missing files) so far."""

    def __init__(self) -> None:
        self._browser = _browser()
        self._session = ""
        self.problems: list[str] = []
        self._context = self._call("Target.createBrowserContext")["browserContextId"]
        target = self._call("Target.createTarget", url="about:blank", browserContextId=self._context)["targetId"]
        self._session = self._call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self._call(f"{domain}.enable")

    def close(self) -> None:
        """Close the tab, and forget what it has stored."""
        self._session = ""
        self._call("Target.disposeBrowserContext", browserContextId=self._context)

    def _call(self, method: str, **parameters: Any) -> dict[str, Any]:
        number = self._browser.send(method, self._session, parameters)
        while True:
            found = self._browser.next()
            if found.get("id") == number:
                assert "error" not in found, (method, found["error"])
                result: dict[str, Any] = found["result"]
                return result
            if found.get("sessionId") == self._session:
                self._happened(found)

    def _happened(self, event: dict[str, Any]) -> None:
        """Keep what went wrong."""
        if event.get("method") == "Runtime.exceptionThrown":
            detail = event["params"]["exceptionDetails"]
            self.problems.append(detail.get("exception", {}).get("description", detail["text"]))
        elif event.get("method") == "Log.entryAdded" and event["params"]["entry"]["level"] == "error":
            self.problems.append(event["params"]["entry"]["text"])
        elif event.get("method") == "Page.javascriptDialogOpening":
            self.problems.append(f"dialog: {event['params']['message']}")

    # --- what a user does ------------------------------------------------------------------------------------

    def size(self, width: int, height: int = 900) -> None:
        """Size of the window."""
        self._call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def open(self, address: str) -> None:
        """Go to an address."""
        self._call("Page.navigate", url=address)

    def evaluate(self, script: str) -> Any:
        """What an expression gives; promises are awaited."""
        done = self._call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in done, (script, done["exceptionDetails"].get("exception"))
        return done["result"].get("value")

    def wait(self, script: str, why: str = "") -> Any:
        """Wait until an expression is true, and return it."""
        end = time.monotonic() + PATIENCE
        while not (found := self.evaluate(script)):
            assert time.monotonic() < end, (why or script, self.problems, self.text("body")[-1500:])
            time.sleep(0.05)
        return found

    def text(self, selector: str) -> str:
        """Text of an element as it is seen."""
        return str(self.evaluate(f"document.querySelector({json.dumps(selector)})?.innerText ?? ''"))

    def sees(self, selector: str, text: str) -> None:
        """Wait until an element has a text."""
        place, wanted = json.dumps(selector), json.dumps(text)
        self.wait(
            f"[...document.querySelectorAll({place})].some((one) => one.innerText.includes({wanted}))",
            f"{text} in {selector}",
        )

    def point(self, selector: str, text: str = "") -> tuple[float, float]:
        """The middle of the first such element that is seen and has the text; the mouse goes there."""
        find = f"""(() => {{
          const all = [...document.querySelectorAll({json.dumps(selector)})];
          const one = all.find((each) => each.getClientRects().length && each.innerText.includes({json.dumps(text)}));
          if (!one) return null;
          one.scrollIntoView({{ block: "center", inline: "nearest" }});
          const box = one.getBoundingClientRect();
          return [box.x + Math.min(box.width / 2, 200), box.y + box.height / 2];
        }})()"""
        x, y = self.wait(find, f"{selector} with {text!r}")
        self._call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        return x, y

    def click(self, selector: str, text: str = "") -> None:
        """Click on the first element of that kind with that text."""
        x, y = self.point(selector, text)
        for kind in ("mousePressed", "mouseReleased"):
            self._call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def press(self, key: str, *modifiers: str) -> None:
        """Press a key."""
        held = sum(_MODIFIERS[one] for one in modifiers)
        code = _KEYS.get(key, ord(key.upper()[0]))
        more = {"key": key, "windowsVirtualKeyCode": code, "modifiers": held}
        if len(key) == 1:
            more["code"] = f"Digit{key}" if key.isdigit() else f"Key{key.upper()}"
        else:
            more["code"] = key
        if key == "Enter":
            more["text"] = "\r"
        self._call("Input.dispatchKeyEvent", type="keyDown", **more)
        self._call("Input.dispatchKeyEvent", type="keyUp", **{k: v for k, v in more.items() if k != "text"})

    def type(self, text: str) -> None:
        """Type where the cursor is, a character at a time."""
        for one in text:
            if one == "\n":
                self.press("Enter")
            else:
                self._call("Input.dispatchKeyEvent", type="char", text=one)

    def fill(self, selector: str, text: str) -> None:
        """Put a text into a field and leave it, as pasting does."""
        self.wait(f"!!document.querySelector({json.dumps(selector)})", selector)
        self.evaluate(f"""(() => {{
          const one = document.querySelector({json.dumps(selector)});
          one.focus(); one.value = {json.dumps(text)};
          for (const kind of ["input", "change"]) one.dispatchEvent(new Event(kind, {{ bubbles: true }}));
        }})()""")

    def picture(self, target: Path) -> None:
        """A screenshot as PNG."""
        target.write_bytes(base64.b64decode(self._call("Page.captureScreenshot", format="png")["data"]))

    def print(self, target: Path) -> None:
        """The page as PDF, on the paper that its style names."""
        printed = self._call("Page.printToPDF", preferCSSPageSize=True, printBackground=True)
        target.write_bytes(base64.b64decode(printed["data"]))


@contextmanager
def page() -> Iterator[Page]:
    """A tab that is closed with the test."""
    found = Page()
    try:
        yield found
    finally:
        found.close()
