"""himc-viewer without a browser: sockets only."""

import json
import os
import random
import resource
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time

import report

VIEWER = os.path.join(os.environ["HIMC_BUILD"], "bin/himc-viewer")


class Viewer:
    """A running bridge on free ports."""

    def __init__(self, *options):
        self.process = subprocess.Popen(
            [VIEWER, "--no-browser", "--osc", "0", "--http", "0", *options],
            stdout=subprocess.PIPE,
            text=True,
        )
        line = self.process.stdout.readline()
        self.http = int(line.split("/")[2].split(":")[1])
        self.osc = int(line.split()[-1])
        self.udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.udp.bind(("127.0.0.1", 0))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.code = self.process.wait(10)

    def send(self, *packets):
        for packet in packets:
            self.udp.sendto(packet, ("127.0.0.1", self.osc))

    def cpu(self):
        fields = open(f"/proc/{self.process.pid}/stat").read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory(self):
        return (
            int(open(f"/proc/{self.process.pid}/statm").read().split()[1]) * resource.getpagesize()
        )

    def get(self, path, host=None, method="GET", extra=""):
        with socket.create_connection(("127.0.0.1", self.http), 5) as s:
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

    def __init__(self, viewer, origin="", host=None):
        self.s = socket.create_connection(("127.0.0.1", viewer.http), 5)
        host = host or f"127.0.0.1:{viewer.http}"
        origin = f"http://{host}" if origin == "" else origin
        line = f"Origin: {origin}\r\n" if origin else ""
        self.s.sendall(
            (
                f"GET / HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\n"
                f"Connection: Upgrade\r\n{line}"
                "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
                "Sec-WebSocket-Protocol: scene\r\n\r\n"
            ).encode()
        )
        self.rest = b""
        while b"\r\n\r\n" not in self.rest:
            piece = self.s.recv(4096)
            if not piece:
                break
            self.rest += piece
        head, _, self.rest = self.rest.partition(b"\r\n\r\n")
        self.status = int(head.split()[1]) if head else 0

    def frame(self):
        """(opcode, payload) of the next one; None if the other side is gone."""

        def take(n):
            while len(self.rest) < n:
                piece = self.s.recv(65536)
                if not piece:
                    raise EOFError
                self.rest += piece
            out, self.rest = self.rest[:n], self.rest[n:]
            return out

        try:
            a, length = take(2)
            if length == 126:
                length = struct.unpack(">H", take(2))[0]
            elif length == 127:
                length = struct.unpack(">Q", take(8))[0]
            return a & 15, take(length)
        except (EOFError, ConnectionError):
            return None

    def blocks(self, seconds):
        """(kind, bytes) of all that comes within that time."""
        end, out = time.time() + seconds, []
        while time.time() < end:
            self.s.settimeout(max(0.01, end - time.time()))
            try:
                got = self.frame()
            except TimeoutError:
                break
            if not got:
                break
            at, payload = 0, got[1]
            while got[0] == 2 and at < len(payload):
                kind, size = struct.unpack_from("<II", payload, at)
                out.append((kind, payload[at + 16 : at + 16 + size]))
                at += 16 + size
        return out

    def events(self, seconds):
        return [json.loads(b) for kind, b in self.blocks(seconds) if kind == 3]

    def say(self, payload):
        mask = b"\x00\x00\x00\x00"
        head = (
            struct.pack(">BBH", 0x82, 0x80 | 126, len(payload))
            if len(payload) < 65536
            else struct.pack(">BBQ", 0x82, 0xFF, len(payload))
        )
        try:
            self.s.sendall(head + mask + payload)
        except ConnectionError:
            pass


def string(s):
    b = s.encode() + b"\0"
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


def bundle(*messages):
    return (
        b"#bundle\0"
        + struct.pack(">Q", 1)
        + b"".join(struct.pack(">I", len(m)) + m for m in messages)
    )


SEGMENTS = ["pelvis", "trunk", "neck", "head"] + [
    f"{side}-{part}"
    for part in ("upper-arm", "forearm", "hand", "stick", "upper-leg", "lower-leg", "foot", "toes")
    for side in ("left", "right")
]


def pose(shift=0.0):
    return [
        osc("/himc/body", name, shift + 0.01 * i, 0.5, 1.0, 1.0, 0.0, 0.0, 0.0)
        for i, name in enumerate(SEGMENTS)
    ]


STRIKE = osc("/himc/strike", 1.5, "left", "kettle", -0.2, 0.015, 2.0, 25.0, 0.007, "legato")


def counts(viewer):
    """The bridge's counters once what was sent has been heard."""
    stream = Stream(viewer)
    found = [e for e in stream.events(2.2) if e["event"] == "bridge"]
    return found[-1]


def test_every_page_file_is_served_and_nothing_else():
    with Viewer() as v:
        names = ["/", "/style.css", "/three.js"] + [
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
            "/play.csv",
            "/%2e%2e/%2e%2e/etc/passwd",
            "/index.html~",
            "/.git/config",
        ]:
            assert v.get(name)[0] in (400, 403, 404), (name, v.get(name)[0])
        assert v.get("/", method="POST", extra="Content-Length: 0\r\n")[0] in (0, 400, 404, 405)
        with open("viewer/page/main.js", "rb") as file:
            assert v.get("/main.js")[2] == file.read()


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


def test_whoever_speaks_to_the_stream_is_shown_out():
    with Viewer() as v:
        for size in (1, 300, 70000, 2000000):
            stream = Stream(v)
            stream.say(b"x" * size)
            stream.s.settimeout(3)
            got = (0, b"")
            while got and got[0] != 8:
                got = stream.frame()
            assert got is None or got[0] == 8
        assert Stream(v).status == 101


def test_a_pose_reaches_the_stream_whole():
    with Viewer() as v:
        stream = Stream(v)
        time.sleep(0.1)
        v.send(bundle(*pose(0.25)))
        poses = [b for kind, b in stream.blocks(0.4) if kind == 1]
        assert len(poses) == 1
        assert poses[0][:80].rstrip(b"\0").decode() == "127.0.0.1:%d" % v.udp.getsockname()[1]
        assert struct.unpack_from("<I", poses[0], 80)[0] == 0xFFFFF
        body = struct.unpack_from("<140f", poses[0], 88)
        assert all(abs(body[7 * i] - 0.25 - 0.01 * i) < 1e-6 for i in range(20))


def test_a_pose_split_over_two_bundles_is_one_pose():
    with Viewer() as v:
        stream = Stream(v)
        time.sleep(0.1)
        parts = pose()
        v.send(bundle(*parts[:11]), bundle(*parts[11:]))
        assert len([1 for kind, _ in stream.blocks(0.4) if kind == 1]) == 1


def test_a_name_in_the_address_makes_another_performer():
    with Viewer() as v:
        stream = Stream(v)
        time.sleep(0.1)
        v.send(
            bundle(*pose()),
            bundle(*[m.replace(string("/himc/body"), string("/himc/ann/body")) for m in pose()]),
        )
        keys = {b[:80].rstrip(b"\0").decode() for kind, b in stream.blocks(0.4) if kind == 1}
        assert len(keys) == 2 and any(k.endswith("/ann") for k in keys), keys


def test_strike_beat_status_and_view_become_events():
    with Viewer() as v:
        stream = Stream(v)
        time.sleep(0.1)
        v.send(
            STRIKE,
            osc("/himc/beat", 4),
            osc("/himc/status", "load", 0.25),
            osc("/viewer/camera", "top"),
        )
        events = {e["event"]: e for e in stream.events(0.4)}
        assert (
            events["strike"]["force"] == 25
            and events["strike"]["hand"] == "left"
            and events["beat"]["beat"] == 4
        )
        assert events["status"]["values"] == ["load", 0.25] and events["view"] == {
            "event": "view",
            "what": "camera",
            "values": ["top"],
        }


def test_text_from_the_network_stays_text():
    with Viewer() as v:
        stream = Stream(v)
        time.sleep(0.1)
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
                "\x01\x7f",
            )
        )
        strike = [e for e in stream.events(0.4) if e["event"] == "strike"][0]
        assert strike["drum"] == "a?b?c?<script>" and strike["nuance"] == "??"


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
        stream = Stream(v)
        v.send(*packets)
        before, sent, end = v.memory(), 0, time.time() + (60 if long else 3)
        while time.time() < end:
            v.send(*packets)
            sent += len(packets)
        stream.s.close()
        time.sleep(0.5)
        assert v.process.poll() is None
        assert v.memory() - before < 4 << 20, v.memory() - before
        stream = Stream(v)
        v.send(bundle(*pose()))
        assert counts(v)["packets"] > 1000 and [
            1 for kind, _ in stream.blocks(0.5) if kind in (1, 3)
        ]
        return f"{sent} packets"


def test_performers_beyond_the_seats_are_refused_and_counted():
    with Viewer() as v:
        for i in range(40):
            v.send(osc(f"/himc/p{i}/targets", "left", 0.0, 0.0, 1.0))
        assert counts(v)["refused"] == 24


def test_a_slow_reader_gets_the_newest_and_stalls_nobody():
    with Viewer() as v:
        slow, quick = Stream(v), Stream(v)
        slow.s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        before = v.memory()
        for i in range(400):
            v.send(bundle(*pose(i / 1000)), STRIKE)
            time.sleep(0.002)
        got = quick.blocks(0.5)
        assert len([1 for kind, _ in got if kind == 3]) >= 400
        assert (
            abs(struct.unpack_from("<f", [b for kind, b in got if kind == 1][-1], 88)[0] - 0.399)
            < 1e-6
        )
        assert v.memory() - before < 4 << 20


def complaint(*options):
    done = subprocess.run(
        [VIEWER, "--no-browser", *options], capture_output=True, text=True, timeout=10
    )
    assert done.returncode == 1 and done.stdout == "" and done.stderr.count("\n") == 1, done
    return done.stderr


def test_trouble_is_one_clear_line():
    with Viewer() as v:
        assert f"port {v.http} is taken" in complaint("--osc", "0", "--http", str(v.http))
        assert f"port {v.osc} (UDP, for OSC) is taken" in complaint(
            "--http", "0", "--osc", str(v.osc)
        )
    assert "allowed 0 .. 65535" in complaint("--osc", "70000")
    assert "wants a value" in complaint("--http")
    assert "unknown option" in complaint("--nonsense", "1")
    assert "not an address" in complaint("--bind", "nowhere")
    assert "cannot be read" in complaint("--play", "/nowhere.csv")
    assert "Makefile:1: not a motion" in complaint("--play", "Makefile")


def test_it_ends_cleanly_when_told():
    with Viewer() as v:
        Stream(v)
    assert v.code == 0


def test_it_runs_as_an_ordinary_user():
    if os.geteuid() != 0:
        return "as we do"
    home = tempfile.mkdtemp(prefix="himc-viewer-")
    try:
        os.chmod(home, 0o755)
        program = shutil.copy(VIEWER, home)
        command = [program, "--no-browser", "--osc", "0", "--http", "0"]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, user=65534, group=65534, extra_groups=[]
        ) as viewer:
            line = viewer.stdout.readline()
            viewer.terminate()
            assert viewer.wait(10) == 0 and "http://127.0.0.1" in line, line
    finally:
        shutil.rmtree(home)


def test_eight_performers_and_drums_cost_less_than_a_twentieth_of_a_core():
    with Viewer() as v:
        stream = Stream(v)
        senders = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(8)]
        seconds, begin, cpu, frames = 6, time.time(), v.cpu(), 0
        packets = [
            (
                bundle(
                    *pose(),
                    osc("/himc/targets", "left", 0.0, 0.0, 1.0),
                    osc("/himc/targets", "right", 0.0, 0.0, 1.0),
                ),
                osc(f"/membrane/kettle{i}/head", *[1e-5 * k for k in range(40)]),
            )
            for i in range(8)
        ]
        while time.time() - begin < seconds:
            for s, (body, head) in zip(senders, packets):
                s.sendto(body, ("127.0.0.1", v.osc))
                s.sendto(head, ("127.0.0.1", v.osc))
            frames += len(stream.blocks(1 / 33))
        load = (v.cpu() - cpu) / (time.time() - begin)
        assert load < 0.05, load
        assert frames > seconds * 8 * 30
        return f"{100 * load:.1f} % of a core"


if __name__ == "__main__":
    sys.exit(
        report.run(
            "tests/viewer/bridge.py",
            [f for name, f in list(globals().items()) if name.startswith("test_")],
        )
    )
