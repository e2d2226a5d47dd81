"""A scene (docs/scene.md), read with the standard library alone; its sound with libsndfile, which himc needs too."""

import ctypes
import json
import struct
import tempfile
import zlib


class Scene:
    def __init__(self, data):
        assert data[:8] == b"himcscn\x01", data[:8]
        self.size, self.events, self.rows, self.heads, self.more, self.sound = {}, [], [], [], [], b""
        at = 8
        while at < len(data):
            kind, size = data[at : at + 4].decode(), struct.unpack_from("<I", data, at + 4)[0]
            body = data[at + 8 : at + 8 + size]
            assert len(body) == size, f"{kind} at {at} is cut short"
            self.size[kind] = self.size.get(kind, 0) + size
            if kind == "json":
                self.events += json.loads(zlib.decompress(body))
            elif kind == "rows":
                self.rows += self.read_rows(zlib.decompress(body))
            elif kind == "ring":
                self.heads += self.read_heads(zlib.decompress(body))
            elif kind == "more":
                self.more.append(Scene(body))
            elif kind == "snd ":
                self.sound += body
            at += 8 + size

    def of(self, event):
        return [e for e in self.events if e["event"] == event]

    def heard(self):
        """(rate, samples of the left ear)"""

        class Info(ctypes.Structure):
            _fields_ = [("frames", ctypes.c_int64)] + [
                (name, ctypes.c_int) for name in ("rate", "channels", "format", "sections", "seekable")
            ]

        lib, info = ctypes.CDLL("libsndfile.so.1"), Info()
        lib.sf_open.restype = ctypes.c_void_p
        with tempfile.NamedTemporaryFile() as file:
            file.write(self.sound), file.flush()
            opened = ctypes.c_void_p(lib.sf_open(file.name.encode(), 0x10, ctypes.byref(info)))
            samples = (ctypes.c_float * (info.frames * info.channels))()
            lib.sf_readf_float(opened, samples, ctypes.c_int64(info.frames))
            lib.sf_close(opened)
        return info.rate, samples[:: info.channels]

    def read_rows(self, data):
        """[time, value, ...] of each row."""
        columns = self.of("scene")[0]["columns"]
        start, period, count = struct.unpack_from("<ddI", data)
        rows = [[start + i * period] for i in range(count)]
        at = 20
        for _, step in columns:
            planes = [data[at + p * count : at + (p + 1) * count] for p in range(4)]
            value = slope = 0
            for i in range(count):
                folded = sum(planes[p][i] << 8 * p for p in range(4))
                slope += folded >> 1 ^ -(folded & 1)
                value += slope
                rows[i].append(step * ((value + (1 << 31)) % (1 << 32) - (1 << 31)))
            at += 4 * count
        assert at == len(data)
        return rows

    @staticmethod
    def read_heads(data):
        """(time, drum, [displacement, ...], [velocity over angular frequency, ...]) of each frame."""
        (count,) = struct.unpack_from("<I", data)
        at, frames = 4, []
        for _ in range(count):
            time, scale, drum, modes = struct.unpack_from("<dfHH", data, at)
            values = struct.unpack_from(f"{2 * modes}b", data, at + 16)
            at += 16 + 2 * modes
            values = [scale * v for v in values]
            frames.append((time, drum, values[:modes], values[modes:]))
        return frames
