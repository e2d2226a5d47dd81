"""Drives `himc edit` as himc-viewer does: lines in, frames out."""

import json
import os
import struct
import subprocess
import zlib


class Piece:
    """What is played of a piece under edit: the hash of each part's exact samples, the rows."""

    def __init__(self, himc, source, *options, **environment):
        self.process = subprocess.Popen(
            [himc, "edit", source, *options],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=dict(os.environ, **environment),
        )
        self.parts, self.chunks, self.text, self.files = {}, [], None, {}
        self.said = {}  # the last text of each event
        self.stem = os.path.splitext(os.path.basename(source))[0]
        self.came_from = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.stdout.close()
        self.process.wait(60)

    def say(self, line):
        self.process.stdin.write(line.encode() + b"\n")
        self.process.stdin.flush()

    def frame(self):
        head = self.process.stdout.read(8)
        assert len(head) == 8, "the process has ended"
        size = struct.unpack("<I", head[4:])[0]
        return head[:4].decode(), self.process.stdout.read(size)

    def take(self, kind, data):
        if kind == "from":
            self.came_from = struct.unpack("<d", data)[0]
            first = round(48000 * self.came_from)
            self.parts = {at: v for at, v in self.parts.items() if at < first}
            self.chunks = [(at, *c) for at, *c in self.chunks if at < self.came_from]
        elif kind == "pcm ":
            self.parts[struct.unpack_from("<I", data)[0]] = data[4:]
        elif kind in ("rows", "json", "head"):
            at = max(self.parts, default=-9600) / 48000 + 0.2
            if kind == "json" and b'"event":"scene"' in zlib.decompress(data):
                at = -1  # it comes once, and stays
            self.chunks.append((at, kind, data))
        elif kind == "file":
            self.files[data[:64].rstrip(b"\0").decode()] = data[64:]
        elif kind == "edit":
            event = json.loads(data)
            self.said[event["event"]] = event.get("text", "")
            if event["event"] == "text":
                self.text = event
            return event
        return None

    def until(self, wanted):
        """Takes frames up to one of that kind, or an event of that name."""
        while True:
            kind, data = self.frame()
            event = self.take(kind, data)
            if kind == wanted or (event and event["event"] == wanted):
                return event or data
            if event and event["event"] in ("refused", "failed"):
                return event
            if event and event["event"] == "undone":  # what was before is played again
                self.until("over")
                return event

    def play(self, line):
        """The line is obeyed and all is played; the event if it is refused."""
        self.say(line)
        event = self.until("text")
        if event["event"] != "text":
            return event
        event = self.until("over")
        return event if isinstance(event, dict) else None

    def score(self):
        self.say("save")
        self.until("file")
        return self.files[f"{self.stem}.txt"]
