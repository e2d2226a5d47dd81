"""himc-viewer without a browser: sockets only.

No test depends on the speed of the machine: each waits for the event it needs. A mark is a message
that comes back as an event of the stream; all that was sent before it has been heard by then.
"""

import contextlib
import json
import os
import random
import resource
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

import report

BUILD = os.environ["HIMC_BUILD"]
VIEWER = os.path.join(BUILD, "bin/himc-viewer")
STATES = tempfile.TemporaryDirectory(prefix="himc-states-")  # of pieces that were dropped
WAIT = 300  # longest wait for an event (s): only a test that fails waits so long


class Viewer:
    """A running bridge on free ports."""

    def __init__(self, *options, home="/tmp", browser=("--no-browser",), program=VIEWER, **environment):
        self.process = subprocess.Popen(
            [program, *browser, "--osc", "0", "--http", "0", *options],
            stdout=subprocess.PIPE,
            text=True,
            # memory is measured: the address sanitizer, if there, keeps less of what was freed
            env=dict(
                os.environ,
                ASAN_OPTIONS="quarantine_size_mb=1",
                TMPDIR=home,
                XDG_STATE_HOME=STATES.name,
                **environment,
            ),
        )
        line = self.process.stdout.readline()
        self.http = int(line.split("/")[2].split(":")[1])
        self.key = re.search("#([0-9a-f]{32}) ", line)[1]
        self.osc = int(line.split()[-1])
        self.udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.udp.bind(("127.0.0.1", 0))
        self.sent = self.marks = 0

    def __enter__(self):
        return self

    def __exit__(self, trouble, *_):
        self.process.terminate()
        self.code = self.process.wait(WAIT)
        # another status is that of a signal or of a sanitizer
        assert trouble or self.code == 0, self.code

    def send(self, *packets):
        for packet in packets:
            self.udp.sendto(packet, ("127.0.0.1", self.osc))
            self.sent += 1

    def state(self):
        with open(f"/proc/{self.process.pid}/stat") as file:
            return file.read().rsplit(")", 1)[1].split()

    @contextlib.contextmanager
    def stopped(self):
        """Packets sent meanwhile wait in the socket and are heard together."""
        self.process.send_signal(signal.SIGSTOP)
        while self.state()[0] != "T":
            time.sleep(0.001)
        try:
            yield
        finally:
            self.process.send_signal(signal.SIGCONT)

    def cpu(self):
        fields = self.state()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory(self):
        return (
            int(open(f"/proc/{self.process.pid}/statm").read().split()[1]) * resource.getpagesize()
        )

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def connect(self, receive=None):
        """A connection to the page; `receive` is the size of its buffer (bytes)."""
        s = socket.socket()
        if receive:
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive)
        s.settimeout(WAIT)
        s.connect(("127.0.0.1", self.http))
        return s

    def get(self, path, host=None, method="GET", extra=""):
        with self.connect() as s:
            s.sendall(
                f"{method} {path} HTTP/1.1\r\nHost: {host or f'127.0.0.1:{self.http}'}\r\n"
                f"Connection: close\r\n{extra}\r\n".encode()
            )
            answer = b""
            while True:
                piece = s.recv(65536)
                if not piece:
                    break
                answer += piece
                head, _, body = answer.partition(b"\r\n\r\n")
                length = [
                    int(l.split(b":")[1])
                    for l in head.lower().split(b"\r\n")
                    if l.startswith(b"content-length")
                ]
                if length and len(body) >= length[0]:
                    break
        head, _, body = answer.partition(b"\r\n\r\n")
        return int(head.split()[1]) if head else 0, head.decode().lower(), body


class Stream:
    """A web socket, as a page has it."""

    def __init__(
        self,
        viewer,
        origin="",
        host=None,
        protocol="scene",
        upgrade="websocket",
        key="AA==",
        receive=None,
        path="/",
    ):
        self.s = viewer.connect(receive)
        host = host or f"127.0.0.1:{viewer.http}"
        origin = f"http://{host}" if origin == "" else origin
        lines = [
            f"GET {path} HTTP/1.1",
            f"Host: {host}",
            f"Upgrade: {upgrade}",
            "Connection: Upgrade",
            f"Sec-WebSocket-Key: {key}" if key else None,
            "Sec-WebSocket-Version: 13",
            "HTTP2-Settings: AAMAAABkAAQCAAAAAAIAAAAA",
            f"Origin: {origin}" if origin else None,
            f"Sec-WebSocket-Protocol: {protocol}" if protocol is not None else None,
        ]
        self.s.sendall("".join(f"{line}\r\n" for line in lines if line).encode() + b"\r\n")
        self.rest, self.times = b"", {}
        while b"\r\n\r\n" not in self.rest:
            piece = self.s.recv(4096)
            if not piece:
                break
            self.rest += piece
        head, _, self.rest = self.rest.partition(b"\r\n\r\n")
        self.status = int(head.split()[1]) if head else 0

    def frame(self):
        """(opcode, payload) of the next one; None if the other side is gone. After a time-out
        what has come of a frame is kept."""

        def need(n):
            while len(self.rest) < n:
                piece = self.s.recv(65536)
                if not piece:
                    raise EOFError
                self.rest += piece

        try:
            need(2)
            opcode, length, at = self.rest[0] & 15, self.rest[1], 2
            if length >= 126:
                form, at = (">H", 4) if length == 126 else (">Q", 10)
                need(at)
                (length,) = struct.unpack(form, self.rest[2:at])
            need(at + length)
        except (EOFError, ConnectionError):
            return None
        payload, self.rest = self.rest[at : at + length], self.rest[at + length :]
        return opcode, payload

    def ended(self):
        """True when the other side has closed; waits for it."""
        self.s.settimeout(WAIT)
        while self.frame():
            pass
        return True

    def blocks(self, seconds):
        """(kind, bytes) of the next frame; none if nothing comes within that time. `times` (s) are those
        of the last block of each kind."""
        self.s.settimeout(seconds)
        try:
            opcode, payload = self.frame() or (0, b"")
        except TimeoutError:
            return []
        at, out = 0, []
        while opcode == 2 and at < len(payload):
            kind, size, time_ms = struct.unpack_from("<IId", payload, at)
            self.times[kind] = time_ms / 1000
            out.append((kind, payload[at + 16 : at + 16 + size]))
            at += 16 + size
        return out

    def until(self, wanted, again=None):
        """All blocks up to the frame after which `wanted(blocks)` is true; `again` is called ten
        times a second meanwhile."""
        begin, repeated, out = time.time(), 0, []
        while not wanted(out):
            waited = time.time() - begin
            assert waited < WAIT, f"no such frame within {WAIT} s"
            if again and waited > repeated + 0.1:
                repeated = waited
                again()
            out += self.blocks(0.1)
        return out

    def until_mark(self, viewer):
        """All blocks of what was sent before."""
        viewer.marks += 1
        mark = {"event": "view", "what": "mark", "values": [viewer.marks]}
        packet = osc("/viewer/mark", viewer.marks)
        viewer.send(packet)
        # sent again only where a flood before it has filled the socket
        return self.until(lambda blocks: mark in events(blocks), lambda: viewer.send(packet))

    def say(self, payload, opcode=2):
        mask = b"\x00\x00\x00\x00"
        head = (
            struct.pack(">BBH", 0x80 | opcode, 0x80 | 126, len(payload))
            if len(payload) < 65536
            else struct.pack(">BBQ", 0x80 | opcode, 0xFF, len(payload))
        )
        try:
            self.s.sendall(head + mask + payload)
        except ConnectionError:
            pass


def events(blocks):
    return [json.loads(b.decode()) for kind, b in blocks if kind == 3]


def clients(blocks):
    """The counts of streams, one for each second of the bridge."""
    return [e["clients"] for e in events(blocks) if e["event"] == "bridge"]


def at_end(s, say=b""):
    """True if the other side has closed the connection, on which `say` is sent first."""
    try:
        s.sendall(say)
        while s.recv(65536):
            pass
        return True
    except BlockingIOError:
        return False
    except ConnectionError:
        return True


def poses(blocks):
    return [b for kind, b in blocks if kind == 1]


def sender_of(block):
    return block[:80].rstrip(b"\0").decode()


def listen(viewer):
    """A stream that has begun: it gets each event from now on."""
    stream = Stream(viewer)
    stream.until_mark(viewer)
    return stream


def string(s):
    """An OSC string; a byte 0xNN that is not UTF-8 is written \\udcNN."""
    b = s.encode(errors="surrogateescape") + b"\0"
    return b + b"\0" * (-len(b) % 4)


def osc(address, *atoms):
    types, data = ",", b""
    for a in atoms:
        if isinstance(a, str):
            types, data = types + "s", data + string(a)
        elif isinstance(a, int):
            types, data = types + "i", data + struct.pack(">i", a)
        else:
            types, data = types + "f", data + struct.pack(">f", a)
    return string(address) + string(types) + data


def bundle(*messages, told=None):
    """With a time tag: `told` (s since 1970), or "immediately"."""
    tag = 1 if told is None else int((told + 2208988800) * 2**32)
    return (
        b"#bundle\0"
        + struct.pack(">Q", tag)
        + b"".join(struct.pack(">I", len(m)) + m for m in messages)
    )


def skeleton():
    """The library's table of segments as it prints it now, a JavaScript module."""
    table = os.path.join(BUILD, "tools/research/skeleton/table")
    return subprocess.run([table, "js"], capture_output=True, check=True).stdout


SEGMENTS = re.findall(r'name: "([^"]*)"', skeleton().decode())


def pose(shift=0.0):
    return [
        osc("/himc/body", name, shift + 0.01 * i, 0.5, 1.0, 1.0, 0.0, 0.0, 0.0)
        for i, name in enumerate(SEGMENTS)
    ]


STRIKE = osc("/himc/strike", 1.5, "left", "kettle", -0.2, 0.015, 2.0, 25.0, 0.007, "legato")


def counts(viewer):
    """The viewer's counters when each packet that was sent has been counted."""

    def found(blocks):
        last = [e for e in events(blocks) if e["event"] == "bridge"][-1:]
        return [e for e in last if e["packets"] == viewer.sent]

    return found(Stream(viewer).until(found))[0]


def test_every_page_file_is_served_and_nothing_else():
    with Viewer() as v:
        names = ["/", "/style.css", "/three.js", "/skeleton.js"] + [
            "/" + f for f in os.listdir("viewer/page") if f.endswith((".js", ".svg"))
        ]
        for name in names:
            status, head, body = v.get(name)
            assert status == 200 and len(body) > 100, (name, status)
            assert "content-security-policy: default-src 'none'" in head and "nosniff" in head, name
        for name in [
            "/../main.c",
            "/..%2f..%2fetc/passwd",
            "//etc/passwd",
            "/etc/passwd",
            "/viewer/page/main.js",
            "/main.js/",
            "/play.himc",
            "/%2e%2e/%2e%2e/etc/passwd",
            "/index.html~",
            "/.git/config",
        ]:
            assert v.get(name)[0] in (400, 403, 404), (name, v.get(name)[0])
        assert v.get("/", method="POST", extra="Content-Length: 0\r\n")[0] in (0, 400, 404, 405)
        with open("viewer/page/main.js", "rb") as file:
            assert v.get("/main.js")[2] == file.read()


def test_skeleton_of_the_page_is_the_librarys():
    with Viewer() as v:
        assert v.get("/skeleton.js")[2] == skeleton()
    assert len(SEGMENTS) == 20 and SEGMENTS[0] == "pelvis" and SEGMENTS[-1] == "right-toes"


def test_no_list_of_segments_is_written_in_the_viewer():
    """Single names are allowed, where a part of the figure belongs to a segment: one a line."""
    for folder in ("viewer", "viewer/page"):
        for name in os.listdir(folder):
            path = os.path.join(folder, name)
            if not name.endswith((".c", ".h", ".js")):
                continue
            with open(path) as file:
                for number, line in enumerate(file, 1):
                    found = [s for s in SEGMENTS if f'"{s}"' in line]
                    assert len(found) < 2, (path, number, found)


def test_each_segment_of_the_library_is_known():
    with Viewer() as v:
        stream = listen(v)
        for i, message in enumerate(pose()):
            v.send(message)
            got = poses(stream.until(poses))
            assert struct.unpack_from("<I", got[-1], 80)[0] == (2 << i) - 1, SEGMENTS[i]
        assert counts(v)["malformed"] == 0


def test_foreign_origins_and_rebound_names_are_refused():
    with Viewer() as v:
        assert Stream(v).status == 101
        assert Stream(v, host=f"localhost:{v.http}").status == 101
        for origin in [
            "http://evil.example",
            "null",
            None,
            f"https://127.0.0.1:{v.http}",
            f"http://127.0.0.1:{v.http + 1}",
        ]:
            assert Stream(v, origin=origin).status == 403, origin
        assert Stream(v, host=f"evil.example:{v.http}").status == 403
        assert v.get("/", host="evil.example")[0] == 403


def test_an_upgrade_to_anything_but_the_stream_is_refused():
    with Viewer() as v:
        for origin in ("http://evil.example", ""):
            for protocol in ("http", None, "", "other", "http, scene", "scene, http"):
                stream = Stream(v, origin, protocol=protocol)
                assert stream.status == 403, (origin, protocol, stream.status)
                stream.say(b"x" * 300)
                assert stream.ended(), (origin, protocol)
            for upgrade in ("h2c", "other", "websocket, h2c"):
                assert Stream(v, origin, upgrade=upgrade).status == 403, (origin, upgrade)
        with v.connect() as s:
            s.sendall(b"CONNECT other:80 HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
            assert s.recv(1) == b""
        assert counts(v)["clients"] == 1


def test_refused_upgrades_leave_the_limit_of_streams():
    with Viewer() as v:
        streams = [listen(v)]
        for _ in range(100):
            assert Stream(v, origin="http://evil.example").status == 403
            assert Stream(v, key=None).status == 0
        assert counts(v)["clients"] == 2  # the second is that of counts()
        streams[0].until(lambda blocks: clients(blocks)[-1:] == [1])
        streams += [Stream(v) for _ in range(31)]
        assert all(s.status == 101 for s in streams[1:])
        for _ in range(100):
            assert Stream(v).status == 503
        streams.pop().s.close()
        streams[0].until(lambda blocks: clients(blocks)[-1:] == [31])
        streams.append(Stream(v))
        assert streams[-1].status == 101 and Stream(v).status == 503


def test_a_client_that_sends_data_is_disconnected():
    with Viewer() as v:
        for size in (1, 300, 70000, 2000000):
            stream = Stream(v)
            stream.say(b"x" * size)
            stream.s.settimeout(WAIT)
            got = (0, b"")
            while got and got[0] != 8:
                got = stream.frame()
            assert got is None or got[0] == 8
        assert Stream(v).status == 101


class Editing(Stream):
    """The stream of a page that edits: messages of `himc edit`, in pieces as they come."""

    def __init__(self, viewer, key=None, **options):
        super().__init__(
            viewer, protocol="edit", path=f"/edit/{viewer.key if key is None else key}", **options
        )
        self.told = b""
        self.begun = None  # what was said when the program began

    def next(self):
        """(kind, bytes) of the next message; None at the end. What himc-viewer itself says is "edit"."""
        while True:
            size = struct.unpack_from("<I", self.told, 4)[0] if len(self.told) >= 8 else 0
            if len(self.told) >= 8 + size:
                kind, data = self.told[:4].decode(), self.told[8 : 8 + size]
                self.told = self.told[8 + size :]
                return kind, data
            got = self.frame()
            if not got or got[0] == 8:
                return None
            if got[0] == 2:
                self.told += got[1]
                continue
            event = json.loads(got[1])
            if event["event"] != "begun":
                return "edit", got[1]
            self.told, self.begun = b"", event

    def next_event(self):
        """The next message, which is an event."""
        kind, data = self.next()
        assert kind == "edit", kind
        return json.loads(data)

    def closed_with(self):
        """The status of the close frame."""
        while got := self.frame():
            if got[0] == 8:
                return struct.unpack(">H", got[1][:2])[0]
        return None

    def until(self, wanted):
        """Takes messages up to one of that kind, or an event of that name."""
        while got := self.next():
            event = json.loads(got[1]) if got[0] == "edit" else {"event": got[0]}
            if event["event"] == wanted:
                return event if got[0] == "edit" else got[1]
        raise AssertionError(f"the stream ends without {wanted}")


def score_of(*strokes):
    return "".join(f"stroke {s};\n" for s in strokes).encode()


def test_only_a_page_that_knows_the_key_edits():
    with Viewer() as v:
        wrong = ("0" if v.key[0] != "0" else "1") + v.key[1:]
        for key in ("", "0", wrong, v.key[:-1], v.key + "0", v.key.upper() + "x", "../" + v.key):
            assert Editing(v, key).status == 403, key
        assert Editing(v, origin="http://evil.example").status == 403
        assert Stream(v, protocol="scene", path=f"/edit/{v.key}").status == 101
        assert Stream(v, protocol="edit").status == 403
        assert Editing(v).status == 101
        assert v.key not in v.get("/")[2].decode() + v.get("/session.json")[2].decode()


def test_a_piece_is_edited_over_the_stream():
    with tempfile.TemporaryDirectory() as home:
        path = os.path.join(home, "piece.txt")
        with open(path, "wb") as file:
            file.write(score_of("0 right legato mf", "1 left legato mf"))
        with Viewer("--edit", path) as v:
            page = Editing(v)
            assert len(page.until("text")["statements"]) == 2
            page.until("over")
            page.say(b"set 1 stroke 1 left accent ff", 1)
            assert page.until("text")["statements"][1]["nuance"] == "accent"
            page.until("pcm ")
            page.say(b"set 1 boing", 1)
            assert "boing" in page.until("refused")["text"]
            page.say(b"undo", 1)
            assert page.until("text")["statements"][1]["nuance"] == "legato"
            # another page takes over, with all that was changed, and this one is told so
            page.say(b"set 0 stroke 0 right legato ff", 1)
            page.until("text")
            newer = Editing(v)
            text = newer.until("text")
            assert text["begun"] and (text["undo"], text["redo"]) == (1, 0), text
            assert "1 change" in newer.until("restored")["text"]
            newer.until("over")
            assert page.closed_with() == 4001


def test_what_cannot_be_edited_ends_the_program_at_once():
    """In the line of `himc edit`, with no address; the same line for all that it refuses."""
    with tempfile.TemporaryDirectory() as home:
        for name, contents in (("a.wav", b"RIFF\0\0\0\0WAVE"), ("bad.txt", b"stroke 0 right boing f;")):
            path = os.path.join(home, name)
            with open(path, "wb") as file:
                file.write(contents)
            said = [
                subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=WAIT)
                for command in (
                    [os.path.join(BUILD, "bin/himc"), "edit", path],
                    [VIEWER, "--no-browser", "--osc", "0", "--http", "0", "--edit", path],
                )
            ]
            assert [s.returncode for s in said] == [1, 1], said
            assert said[1].stdout == b"" and said[1].stderr == said[0].stderr, said
            assert said[1].stderr.count(b"\n") == 1 and name.encode() in said[1].stderr, said
        assert sorted(os.listdir(home)) == ["a.wav", "bad.txt"]


def processes(viewer):
    """Of `himc edit` and those that play, by the process groups' beginning (with their parents)."""
    parents = {}
    for pid in filter(str.isdigit, os.listdir("/proc")):
        with contextlib.suppress(OSError, IndexError):
            with open(f"/proc/{pid}/stat") as file:
                state, parent = file.read().rsplit(")", 1)[1].split()[:2]
            if state != "Z":
                parents[int(pid)] = int(parent)
    found = {viewer.process.pid}
    while more := {p for p, parent in parents.items() if parent in found} - found:
        found |= more
    return found - {viewer.process.pid}


def wait_until_gone(pids):
    end = time.time() + WAIT
    while left := [p for p in pids if os.path.exists(f"/proc/{p}/cwd")]:
        assert time.time() < end, left
        time.sleep(0.01)


def test_the_processes_of_an_edit_end_with_its_page_and_with_the_server():
    with tempfile.TemporaryDirectory() as home:
        path = os.path.join(home, "piece.txt")
        with open(path, "wb") as file:
            file.write(score_of(*(f"{i} right legato mf" for i in range(8))))
        os.mkdir(temporary := os.path.join(home, "tmp"))
        with Viewer("--edit", path, home=temporary) as v:
            page = Editing(v)
            page.until("over")
            running = processes(v)
            assert len(running) > 4, running  # copies to play from
            page.s.close()
            wait_until_gone(running)
            page = Editing(v)
            page.until("pcm ")  # it plays on
            running = processes(v)
            v.process.kill()
            v.process.wait(WAIT)
            wait_until_gone(running)
            assert len(os.listdir(temporary)) == 1
            # what is not ours stays, a folder of a running program too
            os.mkdir(other := os.path.join(temporary, "himc-viewer-mine"), 0o700)
            with open(os.path.join(other, "notes"), "w") as file:
                file.write("mine")
            with Viewer("--edit", path, home=temporary) as next_one:
                Editing(next_one).until("text")
                with Viewer(home=temporary):
                    assert len(os.listdir(temporary)) == 2, os.listdir(temporary)
            assert os.listdir(temporary) == ["himc-viewer-mine"] and os.listdir(other) == ["notes"]
            v.process.returncode = 0  # it was killed on purpose


def test_the_key_is_in_no_argument():
    """xdg-open gets a file that only the user may read, which is gone when the page has come."""
    with tempfile.TemporaryDirectory() as home:
        said = os.path.join(home, "said")
        with open(os.path.join(home, "xdg-open"), "w") as file:
            file.write(f'#!/bin/sh\nstat -c %a "$1" >{said}\ncat "$1" >>{said}\necho "$*" >>{said}\n')
        os.chmod(os.path.join(home, "xdg-open"), 0o755)
        path = os.environ["PATH"]
        with Viewer(home=home, browser=(), PATH=f"{home}:{path}") as v:
            while not os.path.exists(said) or open(said).read().count("\n") < 3:
                time.sleep(0.01)
            mode, *page, arguments = open(said).read().splitlines()
            assert mode == "600" and v.key not in arguments and " " not in arguments, arguments
            assert f"url=http://127.0.0.1:{v.http}/#{v.key}" in "".join(page)
            assert os.path.exists(arguments) and os.stat(os.path.dirname(arguments)).st_mode & 0o77 == 0
            Editing(v)
            while os.path.exists(arguments):
                time.sleep(0.01)


def test_a_dropped_file_is_played():
    with tempfile.TemporaryDirectory() as home, Viewer(home=home) as v:
        page = Editing(v)
        page.say(b"my score.txt\0" + score_of("0 right legato mf"))
        text = page.until("text")
        assert len(text["statements"]) == 1 and text["source"] == "my score.txt", text
        page.until("over")
        # what is refused leaves the piece as it is: nothing is computed, nothing of it is told
        page.say(b"none.exe\0MZ")
        assert "none.exe: expected" in (said := page.next_event())["text"] and ".bvh" in said["text"], said
        for reads in (b"take /etc/passwd;", b"\xef\xbb\xbftake /etc/passwd;", b"drum k;\nk shape /etc/passwd;"):
            page.say(b"reads.txt\0" + reads)
            assert "names other files" in page.next_event()["text"]
        page.say("schön ö\u202e.c3d".encode() + b"\0not a capture")
        assert "not a capture" not in page.next_event()["text"]
        page.say(b"set 0 stroke 0 right legato ff", 1)
        assert page.until("text")["undo"] == 1
        page.until("over")
        assert page.begun["before"] == page.begun["after"] == 0
        # there is a way back after a drop, and forth again; each piece has its changes
        page.say(b"other.txt\0" + score_of("0 left legato mf", "1 left legato mf"))
        text = page.until("text")
        assert text["begun"] and text["source"] == "other.txt" and text["undo"] == 0, text
        assert (page.begun["before"], page.begun["after"]) == (1, 0)
        page.until("over")
        page.say(b"set 0 stroke 0 left legato pp", 1)
        page.until("text")
        page.say(b"back", 1)
        text = page.until("text")
        assert text["source"] == "my score.txt" and text["undo"] == 1, text
        assert (page.begun["before"], page.begun["after"]) == (0, 1)
        page.say(b"forth", 1)
        text = page.until("text")
        assert text["begun"] and text["source"] == "other.txt" and text["undo"] == 1, text
        page.say(b"forth", 1)  # there is none
        page.say(b"back", 1)
        assert page.until("text")["source"] == "my score.txt"
        # also for the next page; another drop, in mid-play, takes the place of what followed
        page = Editing(v)
        text = page.until("text")
        assert text["source"] == "my score.txt" and text["undo"] == 1, text
        assert (page.begun["before"], page.begun["after"]) == (0, 1)
        for i in range(10):  # more than are kept
            page.say(b"%d.txt\0" % i + score_of(*(f"{b} right legato mf" for b in range(9))))
            assert page.until("text")["source"] == f"{i}.txt"
        assert (page.begun["before"], page.begun["after"]) == (7, 0), page.begun
        assert len(os.listdir(home)) == 1
        v.process.terminate()
        v.process.wait(WAIT)
        assert not os.listdir(home)


def test_a_name_is_no_sound():
    """What has been heard is known by the kind of a message, not by letters in a name or an error."""
    with tempfile.TemporaryDirectory() as home:
        os.mkdir(os.path.join(home, "my pcm files"))
        own = os.path.join(home, "my pcm files", "b.txt")
        with open(own, "wb") as file:
            file.write(score_of("0 right legato mf"))
        with Viewer("--edit", own, home=home) as v:
            with open(own, "wb") as file:  # it has become a bad one when the page comes
                file.write(b"stroke nonsense;")
            page = Editing(v)
            assert "my pcm files" in page.until("failed")["text"]
            page.s.settimeout(1)
            try:
                assert not page.next(), "it is started again"
            except TimeoutError:
                pass
        with Viewer(home=home) as v:
            page = Editing(v)
            page.say(b"my score.txt\0" + score_of("0 right legato mf"))
            page.until("over")
            page.say(b"pcm bad.txt\0stroke nonsense;")
            assert page.next_event()["text"].startswith("pcm bad.txt:1: stroke: ")
            page.say(b"save", 1)  # the piece before goes on
            assert b"stroke 0 right" in page.until("file")
            page.say(b"pcm good.txt\0" + score_of("1 right legato mf"))
            assert page.until("text")["source"] == "pcm good.txt"
            page.until("over")


def test_a_piece_that_another_one_follows_is_not_called_bad():
    with tempfile.TemporaryDirectory() as home, Viewer(home=home) as v:
        page = Editing(v)
        for i in range(12):
            page.say(b"q%d.txt\0" % i + score_of("0 right legato mf"))
        while True:
            kind, data = page.next()
            event = json.loads(data)["event"] if kind == "edit" else kind
            assert event != "failed", data
            if event == "text":
                source = json.loads(data)["source"]
            if event == "over" and source == "q11.txt":
                break


def test_a_program_that_ends_by_itself_is_started_again_once():
    """A program beside himc-viewer that lets a piece be heard and dies, each time."""
    with tempfile.TemporaryDirectory() as home:
        viewer = shutil.copy(VIEWER, home)
        starts = os.path.join(home, "starts")
        with open(os.path.join(home, "himc"), "w") as file:
            file.write(f"#!/bin/sh\n[ \"$3\" != --check ] || exit 0\necho start >>{starts}\nread line\nprintf 'pcm \\001\\000\\000\\000x'\n")
        os.chmod(os.path.join(home, "himc"), 0o755)
        with open(os.path.join(home, "piece.txt"), "wb") as file:
            file.write(score_of("0 right legato mf"))

        def started():
            with open(starts) as file:
                return len(file.readlines())

        with Viewer("--edit", os.path.join(home, "piece.txt"), home=home, program=viewer) as v:
            page = Editing(v)
            for wanted in (2, 4):  # once more after each line of the page
                assert "has ended twice" in page.until("failed")["text"]
                time.sleep(0.3)  # the next start would come at once
                assert started() == wanted
                page.say(b"undo", 1)
            assert "has ended twice" in page.until("failed")["text"] and started() == 6
            page.s.close()
            assert "has ended twice" in Editing(v).until("failed")["text"] and started() == 8


def test_what_is_no_line_ends_the_stream_of_editing():
    with Viewer() as v:
        for said in (b"a\nb", b"x" * 5000, b"a\0b"):
            page = Editing(v)
            page.say(b"x.txt\0" + score_of("0 right legato mf"))
            page.until("text")
            page.say(said, 1)
            assert page.ended()


def test_after_a_close_frame_nothing_comes_and_the_stream_ends():
    """A second is two reports of the bridge, which sends one each second by its own clock."""
    faults = {
        "data": b"\x82\x81\0\0\0\0x",
        "empty data": b"\x82\x80\0\0\0\0",
        "data without a mask": b"\x82\x01x",
        "reserved bits": b"\xf2\x81\0\0\0\0x",
        "more than a frame can hold": b"\x82\xff\x7f" + b"\xff" * 7 + b"\0\0\0\0x",
    }
    with Viewer() as v:
        watcher = listen(v)
        for fault, sent in faults.items():
            stream = listen(v)
            stream.s.sendall(sent)
            codes = []
            while codes[-1:] != [8]:
                v.send(bundle(*pose()))
                codes.append(stream.frame()[0])
            watcher.until_mark(v)
            reports = clients(watcher.until(lambda blocks: 1 in clients(blocks)))
            assert len(reports) <= 2, (fault, reports)
            v.send(bundle(*pose()))
            assert stream.frame() is None, fault


def test_connections_without_a_request_are_bounded_in_number_and_time():
    most = 256  # with the sockets of the program itself a few more
    with Viewer() as v:
        waiting, ended = [v.connect() for _ in range(most + 44)], []
        for s in waiting:
            s.setblocking(False)
        begin = time.time()
        while len(ended) < 44 and time.time() < begin + WAIT:
            assert v.descriptors() < most + 20, v.descriptors()
            ended += [s for s in waiting if s not in ended and at_end(s)]
        request = f"GET /icon.svg HTTP/1.1\r\nHost: 127.0.0.1:{v.http}\r\n"
        starts = {
            "silence": ("", ""),
            "a slow first line": ("GET /", "a"),
            "a slow header": (request + "X: ", "a"),
            "header after header": (request, "A: b\r\n"),
            "silence after a request": (request + "\r\n", ""),
            "a slow second request": (request + "\r\nGET /", "a"),
            "a slow body": (request + "Content-Length: 100000\r\n\r\n", "a"),
            "a body without a length": (request + "Transfer-Encoding: chunked\r\n\r\n", "1\r\n"),
        }
        while not all(at_end(s) for s in waiting):
            assert time.time() < begin + WAIT
            time.sleep(0.05)
        slow = {what: v.connect() for what in starts}
        for what, s in slow.items():
            s.sendall(starts[what][0].encode())
            s.setblocking(False)
        while slow:
            assert time.time() < begin + WAIT, slow.keys()
            time.sleep(0.1)
            slow = {what: s for what, s in slow.items() if not at_end(s, starts[what][1].encode())}
        assert Stream(v).status == 101 and v.get("/")[0] == 200


def test_connections_without_progress_give_way_to_a_page():
    """At any time, not only when the idle ones are closed; a stream never gives way."""
    with Viewer() as v:
        stream = listen(v)
        waiting = [v.connect() for _ in range(300)]
        assert v.get("/icon.svg")[0] == 200
        unread = [v.connect(4096) for _ in range(300)]
        for s in unread:
            with contextlib.suppress(ConnectionError):  # one that has given way to the next
                s.sendall(f"GET /three.js HTTP/1.1\r\nHost: 127.0.0.1:{v.http}\r\n\r\n".encode())
            assert v.descriptors() < 276
        assert v.get("/three.js")[0] == 200
        for _ in range(20):
            waiting += [v.connect() for _ in range(50)]
            assert v.get("/icon.svg")[0] == 200 and Stream(v).status == 101
        stream.until_mark(v)


def test_a_stream_that_takes_nothing_ends():
    if not os.environ.get("HIMC_LONG"):
        raise report.Ignored("waits for the 20 s that such a stream has: HIMC_LONG=1")
    with Viewer() as v:
        watcher, lost = listen(v), Stream(v, receive=4096)
        assert lost.status == 101
        shape = osc("/membrane/k/head", *[1e-5] * 64)

        def fill():
            v.send(bundle(*pose(), shape))

        watcher.until(lambda blocks: clients(blocks)[-1:] == [2])
        watcher.until(lambda blocks: clients(blocks)[-1:] == [1], fill)


def test_a_pose_reaches_the_stream_whole():
    with Viewer() as v:
        stream = listen(v)
        v.send(bundle(*pose(0.25)))
        (got,) = poses(stream.until_mark(v))
        assert sender_of(got) == "127.0.0.1:%d" % v.udp.getsockname()[1]
        assert struct.unpack_from("<I", got, 80)[0] == 0xFFFFF
        body = struct.unpack_from("<140f", got, 88)
        assert all(abs(body[7 * i] - 0.25 - 0.01 * i) < 1e-6 for i in range(20))


def test_what_carries_a_pose_reaches_the_stream_with_it():
    """In one pose, and no more in the next without it; forces and places that cannot be are refused."""
    forces = [0.0, 1.0, 550.0, 2.0, 3.0, 90.0, 4.0, 5.0, 95.0, 0.1, 0.0, 0.65]
    with Viewer() as v:
        stream = listen(v)
        for sent, wanted in ((forces, forces), (None, 12 * [0.0]), (2 * forces, 12 * [0.0]), ([1e7, *forces[1:]], 12 * [0.0])):
            v.send(bundle(*([osc("/himc/support", *sent)] if sent else []), *pose()))
            (got,) = poses(stream.until_mark(v))
            there = struct.unpack_from("<12f", got, 88 + 4 * (140 + 6))
            assert all(abs(a - b) < 1e-4 for a, b in zip(there, wanted, strict=True)), (sent, there)
        assert counts(v)["malformed"] == 2


def test_a_pose_split_over_two_bundles_is_one_pose():
    with Viewer() as v:
        stream = listen(v)
        parts = pose()
        with v.stopped():
            v.send(bundle(*parts[:11]), bundle(*parts[11:]))
        got = stream.until_mark(v)
        time.sleep(0.02)  # more than a pose in pieces is waited for: what is left of it would come
        assert len(poses(got + stream.until_mark(v))) == 1


def test_a_name_in_the_address_makes_another_performer():
    with Viewer() as v:
        stream = listen(v)
        v.send(
            bundle(*pose()),
            bundle(*[m.replace(string("/himc/body"), string("/himc/ann/body")) for m in pose()]),
        )
        keys = {sender_of(b) for b in poses(stream.until_mark(v))}
        assert len(keys) == 2 and any(k.endswith("/ann") for k in keys), keys


def test_strike_beat_status_and_view_become_events():
    with Viewer() as v:
        stream = listen(v)
        v.send(
            STRIKE,
            osc("/himc/beat", 4),
            osc("/himc/status", "load", 0.25),
            osc("/viewer/camera", "top"),
        )
        got = events(stream.until_mark(v))
        heard = {e["event"]: e for e in got if e.get("what") != "mark"}
        assert heard["strike"]["force"] == 25 and heard["strike"]["hand"] == "left"
        assert heard["beat"]["beat"] == 4
        assert heard["status"]["values"] == ["load", 0.25]
        assert heard["view"] == {"event": "view", "what": "camera", "values": ["top"]}


def sound(first, samples, rate=48000, channels=1):
    blob = struct.pack(f">I{len(samples)}h", 2 * len(samples), *samples)
    return (
        string("/himc/sound")
        + string(",iiib")
        + struct.pack(">iii", first, rate, channels)
        + blob
        + b"\0" * (-len(blob) % 4)
    )


def test_sound_reaches_the_stream_in_order():
    with Viewer() as v:
        stream = listen(v)
        v.send(*(sound(240 * i, [i, -i, 32767] * 80) for i in range(5)))
        v.send(sound(0, [0] * 600), sound(0, [0], 1), sound(0, [0], 48000, 3))
        got = [b for kind, b in stream.until_mark(v) if kind == 4]
        assert [struct.unpack_from("<4I", b, 80) for b in got] == [
            (240 * i, 48000, 1, 240) for i in range(5)
        ]
        assert struct.unpack_from("<3h", got[4], 96) == (4, -4, 32767)
        assert counts(v)["malformed"] == 3


def test_the_senders_times_reach_the_stream():
    head, told = osc("/membrane/kettle/head", 1e-5), 1.5e9 + 0.25
    with Viewer() as v:
        stream = listen(v)
        for at in (told, None):
            v.send(*(bundle(*what, told=at) for what in (pose(), [head], [STRIKE], [sound(0, [0])])))
            (strike,) = [e for e in events(stream.until_mark(v)) if e["event"] == "strike"]
            times = [stream.times[kind] for kind in (1, 2, 4)] + [strike["told"] / 1000]
            wanted, most = (told, 1e-5) if at else (time.time(), WAIT)
            assert all(abs(t - wanted) < most for t in times), (times, wanted)


def test_text_from_the_network_stays_text():
    with Viewer() as v:
        stream = listen(v)
        v.send(
            osc(
                "/himc/strike",
                1.5,
                "left",
                'a"b\\c\n<script>',
                0.0,
                0.0,
                2.0,
                25.0,
                0.007,
                "\x01\x7f\udcffé\u2028",
            )
        )
        strike = [e for e in events(stream.until_mark(v)) if e["event"] == "strike"][0]
        assert strike["drum"] == "a?b?c?<script>" and strike["nuance"] == "???é?"


def test_malformed_osc_is_counted_and_changes_nothing():
    bad = [
        b"",
        b"/himc",
        b"/himc/body\0\0",
        osc("/himc/body", "pelvis", 1.0),
        osc("/himc/body", "tail", 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
        osc("/himc/body", "head", float("nan"), 0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
        osc("/himc/body", "head", 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0),
        osc("/himc/body", "head", 1e9, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
        osc("/himc/strike", 1.0, "third"),
        osc("/membrane/k/head", "x"),
        osc("/membrane/k/head", float("inf")),
        osc("/himc/beat", "one"),
        osc("/himc/targets", "left", 1.0),
        b"#bundle\0" + b"\0" * 8 + b"\xff" * 4,
        b"#bundle\0" + b"\0" * 12,
        string("/himc/beat") + b",fff\0\0\0\0" + b"\0\0\0\0",
    ]
    with Viewer() as v:
        v.send(*bad, osc("/other", 1), osc("/himc/nothing", 1), STRIKE)
        found = counts(v)
        assert found["packets"] == len(bad) + 3 and found["unknown"] == 2, found
        assert found["malformed"] == len(bad), (found, len(bad))


def test_nested_bundles_end():
    with Viewer() as v:
        deep = STRIKE
        for _ in range(200):
            deep = bundle(deep)
        v.send(deep)
        assert counts(v)["malformed"] == 1


def test_a_storm_of_random_bytes_does_not_disturb():
    random.seed(3)
    packets = [
        bytes(random.randrange(256) for _ in range(random.choice([0, 3, 8, 40, 200])))
        for _ in range(300)
    ]
    for _ in range(300):
        broken = bytearray(bundle(*pose()[:4], STRIKE))
        for _ in range(6):
            broken[random.randrange(len(broken))] = random.randrange(256)
        packets.append(bytes(broken))
    long = bool(os.environ.get("HIMC_LONG"))
    with Viewer() as v:
        stream = listen(v)
        for i in range(10000 if long else 330):
            v.send(*packets)
            if i % 10 == 0:
                stream.until_mark(v)
            if i == 30:  # all that is needed is there
                before = v.memory()
        stream.s.close()
        stream = listen(v)
        assert v.process.poll() is None
        assert v.memory() - before < 4 << 20, v.memory() - before
        v.send(bundle(*pose()), STRIKE)
        got = stream.until_mark(v)
        last = [e for e in events(got) if e["event"] == "strike"][-1]
        assert sender_of(poses(got)[-1]) == last["from"] and last["force"] == 25, last
        return f"{v.sent} packets"


def test_performers_beyond_the_seats_are_refused_and_counted():
    with Viewer() as v:
        # at one time: a performer that is silent for 3 s would give up the seat
        with v.stopped():
            v.send(*(osc(f"/himc/p{i}/targets", "left", 0.0, 0.0, 1.0) for i in range(40)))
        assert counts(v)["refused"] == 24


def test_eight_performers_and_their_drums_reach_the_stream():
    with Viewer() as v:
        stream = listen(v)
        senders = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(8)]
        for i, s in enumerate(senders):
            s.sendto(bundle(*pose()), ("127.0.0.1", v.osc))
            s.sendto(osc(f"/membrane/kettle{i}/head", 1e-5), ("127.0.0.1", v.osc))
        stream.until(
            lambda blocks: len({sender_of(b) for b in poses(blocks)}) == 8
            and len({b[:112] for kind, b in blocks if kind == 2}) == 8
        )


def test_a_slow_reader_gets_the_newest_and_stalls_nobody():
    with Viewer() as v:
        slow, quick = listen(v), listen(v)
        slow.s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        got = []
        for i in range(400):
            v.send(bundle(*pose(i / 1000)), STRIKE)
            got += quick.until_mark(v)
            if i == 40:
                before = v.memory()
        assert len([e for e in events(got) if e["event"] == "strike"]) == 400
        assert abs(struct.unpack_from("<f", poses(got)[-1], 88)[0] - 0.399) < 1e-6
        assert v.memory() - before < 4 << 20


def test_a_slow_client_gets_the_whole_scene():
    """At full length it takes longer than the 20 s after which an idle client is dropped."""
    seconds = 45 if os.environ.get("HIMC_LONG") else 1
    with tempfile.NamedTemporaryFile(suffix=".himc") as scene:
        size = 16 << 20
        scene.write(b"himcscn\x01" + b"none" + struct.pack("<I", size) + bytes(size))
        scene.flush()
        with Viewer("--play", scene.name) as v, v.connect(65536) as s:
            said = json.loads(v.get("/session.json")[2])
            assert said["play"] == os.path.basename(scene.name) and said["osc"] == v.osc, said
            s.sendall(f"GET /play.himc HTTP/1.1\r\nHost: 127.0.0.1:{v.http}\r\n\r\n".encode())
            want, got = os.path.getsize(scene.name), 0
            while got < want:  # and the headers
                piece = s.recv(want // 100)
                assert piece, f"{got} of {want} bytes"
                got += len(piece)
                time.sleep(seconds * len(piece) / want)


def error_line(*options):
    done = subprocess.run(
        [VIEWER, "--no-browser", *options], capture_output=True, text=True, timeout=WAIT
    )
    assert done.returncode == 1 and done.stdout == "" and done.stderr.count("\n") == 1, done
    return done.stderr


def test_trouble_is_one_clear_line():
    with Viewer() as v:
        assert f"port {v.http} is taken" in error_line("--osc", "0", "--http", str(v.http))
        assert f"port {v.osc} (UDP, for OSC) is taken" in error_line(
            "--http", "0", "--osc", str(v.osc)
        )
    assert "expected 0 .. 65535" in error_line("--osc", "70000")
    assert "wants a value" in error_line("--http")
    assert "unknown option" in error_line("--nonsense", "1")
    assert "not an address" in error_line("--bind", "nowhere")
    assert "cannot be read" in error_line("--play", "/nowhere.himc")
    assert "x?[31m?y.himc: cannot" in error_line("--play", "x\033[31m\ny.himc")
    assert "a device, expected a regular file" in error_line("--play", "/dev/zero")
    with tempfile.TemporaryDirectory() as folder:
        os.mkfifo(folder + "/fifo.himc")
        assert "a FIFO, expected a regular file" in error_line("--play", folder + "/fifo.himc")
    assert "Makefile: not a scene" in error_line("--play", "Makefile")
    assert "expected a regular file" in error_line("--play", "viewer")


def test_it_ends_cleanly_when_told():
    with Viewer() as v:
        Stream(v)
    assert v.code == 0


def test_it_runs_as_an_ordinary_user():
    if os.geteuid() != 0:
        return "as this test does"
    home = tempfile.mkdtemp(prefix="himc-user-")
    try:
        os.chmod(home, 0o755)
        program = shutil.copy(VIEWER, home)
        command = [program, "--no-browser", "--osc", "0", "--http", "0"]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, user=65534, group=65534, extra_groups=[]
        ) as viewer:
            line = viewer.stdout.readline()
            viewer.terminate()
            assert viewer.wait(WAIT) == 0 and "http://127.0.0.1" in line, line
    finally:
        shutil.rmtree(home)


if __name__ == "__main__":
    sys.exit(
        report.run(
            "tests/viewer/bridge.py",
            [f for name, f in list(globals().items()) if name.startswith("test_")],
        )
    )
