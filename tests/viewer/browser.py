"""Chromium without a window, controlled over WebDriver with the standard library alone; Firefox likewise."""

import base64
import json
import os
import re
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request


signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # a test that is ended ends its browser


def stop(process, home):
    """Ends it, in the end by force, and every process that was given the folder `home`."""
    process.terminate()
    try:
        process.wait(20)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    for one in os.listdir("/proc"):
        try:
            with open(f"/proc/{one}/cmdline", "rb") as file:
                left = one.isdigit() and home.encode() in file.read()
            if left:
                os.kill(int(one), signal.SIGKILL)
        except OSError:
            pass
    shutil.rmtree(home, ignore_errors=True)


PATIENCE = 120  # (s) until a page is there, or what a test waits for; chosen: ten times what the slowest needed
SCRIPT = 300  # (s) for one script


class Browser:
    patience = SCRIPT

    def __init__(self, width=1280, height=720, more=()):
        self.home = tempfile.mkdtemp(prefix="himc-chromium-")
        self.driver = subprocess.Popen(
            ["chromedriver", "--port=0"],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        self.url = f"http://127.0.0.1:{self.port()}"
        flags = [
            "--headless=new",
            "--no-sandbox",
            "--enable-unsafe-swiftshader",
            "--use-angle=swiftshader",
            "--disable-dev-shm-usage",
            f"--window-size={width},{height}",
            f"--user-data-dir={self.home}",
            "--hide-scrollbars",
            "--autoplay-policy=no-user-gesture-required",
            *more,
        ]
        answer = self.call(
            "POST",
            "/session",
            {
                "capabilities": {
                    "alwaysMatch": {
                        "goog:chromeOptions": {"args": flags},
                        "goog:loggingPrefs": {"browser": "ALL"},
                    }
                }
            },
        )
        self.session = "/session/" + answer["sessionId"]
        self.be_patient(SCRIPT)

    def port(self):
        """Of chromedriver, which may end before, or hang."""
        end, said = time.time() + PATIENCE, b""
        while not (found := re.search(rb"successfully on port (\d+)", said)):
            ready, _, _ = select.select([self.driver.stdout], [], [], max(0, end - time.time()))
            more = os.read(self.driver.stdout.fileno(), 4096) if ready else b""
            if not more:
                stop(self.driver, self.home)
                raise RuntimeError(f"chromedriver does not start: {said.decode(errors='replace')}")
            said += more
        return int(found[1])

    def be_patient(self, seconds):
        """How long a script may take."""
        self.patience = seconds
        self.call("POST", self.session + "/timeouts", {"script": 1000 * seconds, "pageLoad": 1000 * PATIENCE})

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(
            self.url + path, data, {"Content-Type": "application/json"}, method=method
        )
        try:
            with urllib.request.urlopen(request, timeout=self.patience + 30) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def open(self, url):
        self.call("POST", self.session + "/url", {"url": url})

    def run(self, script, *args):
        return self.call(
            "POST", self.session + "/execute/sync", {"script": script, "args": list(args)}
        )

    def wait(self, script, seconds=PATIENCE):
        """The first true answer of `script`; the last answer if none is true within `seconds`."""
        end = time.time() + seconds
        while True:
            answer = self.run(script)
            if answer or time.time() > end:
                return answer
            time.sleep(0.1)

    def downloads(self, folder):
        """Files that the page saves go into `folder`."""
        self.call(
            "POST",
            self.session + "/goog/cdp/execute",
            {
                "cmd": "Browser.setDownloadBehavior",
                "params": {"behavior": "allow", "downloadPath": folder},
            },
        )

    def log(self):
        return [
            entry["message"]
            for entry in self.call("POST", self.session + "/se/log", {"type": "browser"})
        ]

    def resize(self, width, height):
        self.call(
            "POST",
            self.session + "/goog/cdp/execute",
            {
                "cmd": "Emulation.setDeviceMetricsOverride",
                "params": {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False},
            },
        )

    def media(self, **features):
        """What the page is told of the user's wishes: prefers_color_scheme="dark"."""
        told = [{"name": k.replace("_", "-"), "value": v} for k, v in features.items()]
        self.call(
            "POST",
            self.session + "/goog/cdp/execute",
            {"cmd": "Emulation.setEmulatedMedia", "params": {"features": told}},
        )

    def shot(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("GET", self.session + "/screenshot")))

    def close(self):
        self.patience = 0  # it may hang
        try:
            self.call("DELETE", self.session)
        except (OSError, RuntimeError):
            pass
        stop(self.driver, self.home)


class Firefox(Browser):
    """Firefox without a window, controlled over its own protocol, Marionette: what the tests ask of both."""

    def __init__(self, width=1280, height=720):
        self.home = tempfile.mkdtemp(prefix="himc-firefox-")
        with open(os.path.join(self.home, "user.js"), "w") as file:
            file.write('user_pref("marionette.port", 0);\nuser_pref("media.autoplay.default", 0);\n')
        command = ["firefox-esr", "--headless", "--no-remote", "--marionette", "--profile", self.home]
        self.driver = subprocess.Popen(
            [*command, "--width", str(width), "--height", str(height)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        port, end = os.path.join(self.home, "MarionetteActivePort"), time.time() + 120
        while not (os.path.exists(port) and os.path.getsize(port)):
            if self.driver.poll() is not None or time.time() > end:
                stop(self.driver, self.home)
                raise RuntimeError("Firefox does not start")
            time.sleep(0.1)
        with open(port) as file:
            self.socket = socket.create_connection(("127.0.0.1", int(file.read())), SCRIPT + 30)
        self.stream, self.number = self.socket.makefile("rb"), 0
        self.answer()  # who it is
        self.ask("WebDriver:NewSession", {"capabilities": {"alwaysMatch": {"timeouts": {"script": 1000 * SCRIPT, "pageLoad": 1000 * PATIENCE}}}})

    def answer(self):
        size = b""
        while (letter := self.stream.read(1)) != b":":
            if not letter:
                raise OSError("Firefox has ended")
            size += letter
        return json.loads(self.stream.read(int(size)))

    def ask(self, command, parameters):
        self.number += 1
        message = json.dumps([0, self.number, command, parameters]).encode()
        self.socket.sendall(b"%d:%s" % (len(message), message))
        _, _, error, result = self.answer()
        if error:
            raise RuntimeError(error["message"])
        return result

    def open(self, url):
        self.ask("WebDriver:Navigate", {"url": url})

    def run(self, script, *args):
        return self.ask("WebDriver:ExecuteScript", {"script": script, "args": list(args)})["value"]

    def shot(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.ask("WebDriver:TakeScreenshot", {"full": False})["value"]))

    def close(self):
        self.socket.settimeout(30)
        try:
            self.ask("Marionette:Quit", {"flags": ["eForceQuit"]})
        except (OSError, RuntimeError):
            pass
        self.socket.close()
        stop(self.driver, self.home)
