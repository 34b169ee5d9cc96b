"""Headless Chromium with one page, controlled by the DevTools protocol over a pipe.

Needs nothing but Python and Chromium; WebGL2 comes from Mesa's llvmpipe or from SwiftShader, which blend 32-bit floats.
"""
import argparse
import base64
import json
import os
import pathlib
import select
import shutil
import subprocess
import tempfile
import time

FLAGS = [
    "--headless", "--remote-debugging-pipe", "--no-sandbox", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    # Mesa's OpenGL in software draws a volume in a sixth of SwiftShader's time, which stands in where Mesa is absent.
    "--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist", "--enable-unsafe-swiftshader", "--hide-scrollbars",
    "--disable-dev-shm-usage", "--disable-gpu-compositing",
]


HOUSE = pathlib.Path(__file__).resolve().parents[2]


def find_chromium():
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if path := shutil.which(name):
            return path
    return None


class Browser:
    """Browser with one page, closed at the end of a `with` block."""

    def __init__(self, timeout_s=120):
        self.timeout_s = timeout_s
        self.profile = tempfile.TemporaryDirectory(prefix="vog-web-", ignore_cleanup_errors=True)
        to_browser, self.out = os.pipe()
        self.into, from_browser = os.pipe()

        def place():  # file descriptors 3 and 4, where Chromium expects the pipe
            # Moved away first, so that neither end overwrites the other.
            ends = [os.dup2(fd, 100 + n) for n, fd in enumerate((to_browser, from_browser))]
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.process = subprocess.Popen(
            [find_chromium(), *FLAGS, f"--user-data-dir={self.profile.name}", "about:blank"],
            preexec_fn=place, close_fds=False, env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer = b""
        self.number = 0
        self.session = None
        self.blank = True     # no page is open
        self.complaints = []  # exceptions, errors and warnings of the page's console
        self.requests = []    # URLs that the page requests
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.session = None
            self.call("Browser.close")
            self.process.wait(10)
        except Exception:
            self.process.kill()
            self.process.wait()
        os.close(self.out)
        os.close(self.into)
        self.profile.cleanup()

    def _receive(self, deadline):
        while b"\0" not in self.buffer:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.into], [], [], left)[0]:
                raise TimeoutError(f"the browser did not answer within {self.timeout_s} s")
            data = os.read(self.into, 1 << 20)
            if not data:
                raise ConnectionError("the browser has gone")
            self.buffer += data
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def _note(self, event):
        method, params = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.complaints.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
            self.complaints.append(" ".join(str(a.get("value", a)) for a in params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            # With --disable-gpu-compositing the browser reads every picture back. The page's own reads are counted (web_test.py, half floats).
            if "GPU stall due to ReadPixels" not in params["entry"]["text"]:
                self.complaints.append(params["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"])

    def call(self, method, **params):
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + self.timeout_s
        while True:
            answer = self._receive(deadline)
            if answer.get("id") != self.number:
                self._note(answer)
            elif "error" in answer:
                raise RuntimeError(f"{method}: {answer['error']['message']}")
            else:
                return answer["result"]

    def evaluate(self, expression):
        """Value of a JavaScript expression; promises are awaited."""
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True,
                           returnByValue=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return answer["result"].get("value")

    def viewport(self, width, height, scale=1, phone=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=scale, mobile=phone)
        self.call("Emulation.setTouchEmulationEnabled", enabled=phone, maxTouchPoints=5)

    def prefer(self, **features):
        """Sets media features, as in prefer(prefers_color_scheme="light")."""
        listed = [{"name": k.replace("_", "-"), "value": v} for k, v in features.items()]
        self.call("Emulation.setEmulatedMedia", features=listed)

    def leave(self):
        """Leaves the page, which would draw again for every other size of the window."""
        if not self.blank:
            self.call("Page.navigate", url="about:blank")
        self.blank = True

    def open(self, path, fragment=""):
        """Opens a file or a URL and waits until its module has run."""
        self.leave()  # a change of the fragment alone does not reload a page
        self.complaints.clear()
        self.requests.clear()
        url = str(path) if str(path).startswith("http://") else f"file://{os.path.abspath(path)}"
        self.blank = False
        answer = self.call("Page.navigate", url=url + fragment)
        if "errorText" in answer:
            raise RuntimeError(answer["errorText"])
        deadline = time.monotonic() + self.timeout_s
        while self.evaluate("document.readyState") != "complete":
            if time.monotonic() > deadline:
                raise TimeoutError(f"{path} does not load")

    def settle(self):
        """Waits for the whole picture; fails with the message of a page that gives up."""
        self.evaluate("""(() => {
          const box = document.getElementById('failure');
          return Promise.race([vog.settled(), new Promise((_, fail) => {
            const look = () => box.hidden || fail(new Error(`the page gives up: ${box.textContent.trim()}`));
            new MutationObserver(look).observe(box, { attributes: true });
            look();
          })]);
        })()""")

    def picture(self, path):
        """Saves the complete picture, without the page around it, as a PNG."""
        data = self.evaluate("vog.picture()")
        with open(path, "wb") as out:
            out.write(base64.b64decode(data.split(",", 1)[1]))

    def colors(self, window="window"):
        """Number of colours of the settled picture of a page, or of one in an iframe: a blank one has one."""
        return self.evaluate(f"""(async () => {{
          const image = new Image();
          image.src = await {window}.vog.picture();
          await image.decode();
          const canvas = document.createElement('canvas'), context = canvas.getContext('2d');
          [canvas.width, canvas.height] = [image.width, image.height];
          context.drawImage(image, 0, 0);
          const bytes = context.getImageData(0, 0, image.width, image.height).data;
          return new Set(Array.from({{ length: bytes.length / 4 }}, (_, k) => bytes[4 * k] + 256 * bytes[4 * k + 1])).size;
        }})()""")

    def screenshot(self, path):
        data = self.call("Page.captureScreenshot", format="png")["data"]
        with open(path, "wb") as out:
            out.write(base64.b64decode(data))

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def drag(self, x0, y0, x1, y1, steps=4, button="left", modifiers=0):
        mask = {"left": 1, "right": 2, "middle": 4}[button]
        held = dict(button=button, buttons=mask, modifiers=modifiers)
        self.mouse("mousePressed", x0, y0, clickCount=1, **held)
        for n in range(1, steps + 1):
            self.mouse("mouseMoved", x0 + (x1 - x0) * n / steps, y0 + (y1 - y0) * n / steps, **held)
        self.mouse("mouseReleased", x1, y1, clickCount=1, button=button, modifiers=modifiers)

    def wheel(self, x, y, delta):
        self.mouse("mouseWheel", x, y, deltaX=0, deltaY=delta)

    def touch(self, *places):
        """Touch gesture: a sequence of positions [(x, y), ...], one per finger."""
        for n, fingers in enumerate(places):
            points = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(fingers)]
            self.call("Input.dispatchTouchEvent", type="touchMove" if n else "touchStart",
                      touchPoints=points)
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def key(self, key, code="", modifiers=0):
        code = code or (f"Key{key.upper()}" if key.isalpha() and len(key) == 1 else key)
        for kind in ("keyDown", "keyUp"):
            # Buttons act on the text of Enter.
            text = {"text": "\r"} if key == "Enter" and kind == "keyDown" else {}
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=code, modifiers=modifiers, **text)


def main():
    """Screenshot of a page with a complete picture; used for docs/images."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("page")
    parser.add_argument("picture", help="PNG to write")
    parser.add_argument("--size", default="1200x750", help="of the window, CSS pixels")
    parser.add_argument("--scale", type=float, default=1, help="device pixels to a CSS pixel")
    parser.add_argument("--phone", action="store_true")
    parser.add_argument("--fragment", default="", help="the address from # on")
    arguments = parser.parse_args()
    with Browser() as browser:
        browser.viewport(*map(int, arguments.size.split("x")), arguments.scale, arguments.phone)
        browser.open(arguments.page, arguments.fragment)
        browser.settle()
        browser.screenshot(arguments.picture)


if __name__ == "__main__":
    main()
