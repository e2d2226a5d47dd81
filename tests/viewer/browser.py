"""Chromium without a window, controlled over WebDriver with the standard library alone."""

import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
import urllib.error
import urllib.request


class Browser:
    def __init__(self, width=1280, height=720, more=()):
        self.home = tempfile.mkdtemp(prefix="himc-chromium-")
        self.driver = subprocess.Popen(
            ["chromedriver", "--port=0"],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        for line in self.driver.stdout:
            if "successfully on port" in line:
                self.url = "http://127.0.0.1:" + line.split("on port")[1].strip(" .\n")
                break
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
        self.call("POST", self.session + "/timeouts", {"script": 300000})

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(
            self.url + path, data, {"Content-Type": "application/json"}, method=method
        )
        try:
            with urllib.request.urlopen(request, timeout=300) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def open(self, url):
        self.call("POST", self.session + "/url", {"url": url})

    def run(self, script, *args):
        return self.call(
            "POST", self.session + "/execute/sync", {"script": script, "args": list(args)}
        )

    def wait(self, script, seconds=300):
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
        try:
            self.call("DELETE", self.session)
        except (OSError, RuntimeError):
            pass
        self.driver.terminate()
        self.driver.wait(300)
        shutil.rmtree(self.home, ignore_errors=True)
