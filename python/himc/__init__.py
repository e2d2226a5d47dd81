"""A virtual timpanist in Python.

``render`` plays a score or a take offline; ``Performance`` plays step by step, with live targets; ``Take`` is a motion capture as
arrays; ``modes`` lists a drum's modes; ``evaluate`` compares the controllers on own captures. All units are SI; docs/data.md of the
repository has frames and conventions. ``joint_names`` and ``segment_names`` are the names of the 19 joints and 20 segments, in the order
of the rows' arrays.

Arrays of sound, motion and takes are the library's own memory, not copies. They stay valid as long as Python has them.
"""
from __future__ import annotations

import json
import math
import os
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Iterable, Mapping, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from ._himc import ffi, lib

__all__ = ["Error", "Performance", "Rendering", "Take", "evaluate", "joint_names", "modes", "render", "segment_names"]
__version__ = ffi.string(lib.himc_version()).decode()

_HANDS = ("left", "right")
_CHANNELS = 8  # HIMC_PICKUPS
_LISTENER = "listener usual"  # where `himc render` listens unless the score says
_CELL = 0.2  # s; the end of a piece is looked for so often, as in `himc render`
_REST = 2.5  # s after the last contact, until the sticks are at rest
_TAIL = 8.0  # s; a drum rings no longer
_SILENCE = 1e-4  # of the peak

joint_names: list[str] = [ffi.string(lib.himc_joint_name(j)).decode() for j in range(19)]
segment_names: list[str] = [ffi.string(lib.himc_segment_name(i)).decode() for i in range(20)]


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


class Error(ValueError):
    """The library's one line: what was wrong, the value, what is allowed."""


def _check(good: bool, error) -> None:
    if not good:
        raise Error(ffi.string(error.text).decode(errors="replace"))


def _text(value: Union[None, str, Path]) -> bytes:
    text = b"" if value is None else str(value).encode()
    if b"\0" in text:
        raise Error(f"{value!r}: has a zero byte, which no command or name may have")
    return text


def _finite(name: str, value: float, least: float = -math.inf) -> float:
    try:
        number = math.nan if isinstance(value, (str, bytes)) else float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number) or number < least:
        raise Error(f"{name}: {value!r}, expected a finite number{'' if least < 0 else f', {least:g} or more'}")
    return number


def _hand(hand: Union[str, int]) -> int:
    if isinstance(hand, str) and hand in _HANDS:
        return _HANDS.index(hand)
    if isinstance(hand, (int, np.integer)) and 0 <= hand <= 1:
        return int(hand)
    raise Error(f"hand: {hand!r}, expected \"left\", \"right\", 0 or 1")


def _channels(channels: int, least: int) -> int:
    if not isinstance(channels, (int, np.integer)) or not least <= channels <= _CHANNELS:
        raise Error(f"channels: {channels!r}, expected {least} .. {_CHANNELS}")
    return int(channels)


def _up(up: Optional[str]) -> bytes:
    if up not in (None, "", "y", "z"):
        raise Error(f"up: {up!r}, expected \"y\" or \"z\"")
    return _text(up)


def _tip(side: str, name: Optional[str]) -> bytes:
    text = _text(name)
    if len(text) > 63:
        raise Error(f"{side}_tip: a name of {len(text)} bytes, expected 63")
    return text


def _filled(out: NDArray, channels: int) -> NDArray[np.float32]:
    """`out` if sound can be written into it."""
    wanted = f"expected a writeable float32 array, C order, shape (samples, {channels})"
    if not isinstance(out, np.ndarray):
        raise Error(f"out: {type(out).__name__}, {wanted}")
    if out.dtype != np.float32 or out.ndim != 2 or out.shape[1] != channels:
        raise Error(f"out: {out.dtype} of shape {out.shape}, {wanted}")
    if not out.flags.carray:
        kind = "read-only" if not out.flags.writeable else "unaligned" if not out.flags.aligned else "not in C order"
        raise Error(f"out: {kind}, {wanted}")
    return out


def _dtype(ctype: str) -> np.dtype:
    """The NumPy type of a C struct of numbers, vectors, names and arrays of these."""
    def of(kind):
        if kind.kind == "array":
            if kind.item.cname == "char":
                return np.dtype(f"S{kind.length}")
            inner = of(kind.item)
            base, shape = inner.subdtype or (inner, ())
            return np.dtype((base, (kind.length,) + shape))
        if kind.cname in ("himc_vec3", "himc_quat"):
            return np.dtype((np.float64, (len(kind.fields),)))
        if kind.kind == "struct":
            return np.dtype({"names": [n for n, _ in kind.fields], "formats": [of(f.type) for _, f in kind.fields],
                             "offsets": [f.offset for _, f in kind.fields], "itemsize": ffi.sizeof(kind)})
        return np.dtype({"double": np.float64, "int": np.int32, "long": np.int64}[kind.cname])
    return of(ffi.typeof(ctype))


_ROW, _STRIKE, _MODE = _dtype("himc_motion_row"), _dtype("himc_strike"), _dtype("mode_row")
_TAKE_STRIKE = _dtype("himc_take_strike")


class _Memory:
    """Memory of the library for NumPy, with what owns it."""
    def __init__(self, owner, pointer, size: int):
        self.owner = owner
        self.__array_interface__ = {"data": (int(ffi.cast("uintptr_t", pointer)), True), "shape": (size,), "typestr": "|u1",
                                    "version": 3}


def _array(owner, pointer, count: int, dtype: np.dtype) -> NDArray:
    """The library's memory as a read-only array, which keeps `owner` alive."""
    if count == 0:
        return np.empty(0, dtype)
    return np.asarray(_Memory(owner, pointer, count * dtype.itemsize)).view(dtype)


class Performance:
    """A performer with drums, played as far as one asks.

    >>> p = Performance()
    >>> p.add_drum("kettle")
    >>> p.command("stroke 0 right accent f")
    >>> p.command("play")
    >>> sound = p.process(1.0)
    """

    def __init__(self, rate: float = 48000, physics: float = 0, task: float = 0, channels: int = 2, motion: bool = True):
        """`rate` of the sound, `physics` and `task` rates (Hz, 0: 10000 and 250); `motion`: keep rows."""
        error = ffi.new("himc_error *")
        self._channels = _channels(channels, 0)
        made = lib.session_new(_finite("rate", rate), _finite("physics", physics, 0), _finite("task", task, 0), error)
        _check(made != ffi.NULL, error)
        self._session = ffi.gc(made, lib.session_free)
        ## Sample rate of the sound (Hz).
        self.rate = rate
        lib.session_keep_rows(self._session, motion)
        if 1 <= channels <= 2:
            self.command(_LISTENER)

    def command(self, text: str, word: Union[None, str, Path] = None) -> list[str]:
        """Carries out a command of the manual: ``"tempo 90"``, or a name and one word that may have spaces: ``("take", path)``.

        Returns the lines that ``info`` and ``dump`` answer, which are in ``notes``, too. After ``"reset"``, time is 0, and rows and
        strikes are those since.
        """
        before = len(self.notes)
        error = ffi.new("himc_error *")
        name = ffi.NULL if word is None else ffi.new("char[]", _text(word))
        _check(lib.session_command(self._session, _text(text), name, error), error)
        if 1 <= self._channels <= 2 and text.split()[:1] == ["reset"]:
            self.command(_LISTENER)
        return self.notes[before:]

    def add_drum(self, name: str = "kettle", inches: float = 0) -> None:
        """Adds a drum of that diameter (0: 26 inches)."""
        error = ffi.new("himc_error *")
        _check(lib.session_add_drum(self._session, _text(name), _finite("inches", inches), error), error)

    def drum_command(self, drum: str, text: str) -> list[str]:
        """Carries out a command to a drum: ``drum_command("kettle", "tune A2")``. Returns as ``command``."""
        before = len(self.notes)
        error = ffi.new("himc_error *")
        _check(lib.session_drum_command(self._session, _text(drum), _text(text), error), error)
        return self.notes[before:]

    def take_options(self, left_tip: Optional[str] = None, right_tip: Optional[str] = None, up: Optional[str] = None) -> None:
        """Names of the tips and the upward axis ("y", "z") of takes to come."""
        lib.session_take_options(self._session, _tip("left", left_tip), _tip("right", right_tip), _up(up))

    def target(self, hand: Union[str, int], xyz: Sequence[float]) -> None:
        """A live target of a drumstick's tip (m, world frame), for now."""
        if np.shape(xyz) != (3,):
            raise Error(f"target: {xyz!r}, expected three numbers x, y, z (m)")
        lib.himc_performance_target(self._session.performance, _hand(hand), [_finite("target", c) for c in xyz])

    def drive(self, rotations: Optional[NDArray] = None, torques: Optional[NDArray] = None, rates: Optional[NDArray] = None) -> None:
        """Drives joints from outside, until the next call: ``rotations`` (19, 4), unit quaternions w x y z in the parent's frame, are the
        joints' targets in ``mode id``, with ``rates`` (19, 3) rad/s; ``torques`` (19, 3) N m, on the child about its own axes, take the
        place of the controller's. A row of NaN leaves its joint to the performer; without rotations and torques all are."""
        drive, error = ffi.new("himc_drive *"), ffi.new("himc_error *")
        for rows, width, chosen, field in ((rotations, 4, drive.aimed, drive.rotation), (torques, 3, drive.turned, drive.torque),
                                           (rates, 3, None, drive.rate)):
            if rows is None:
                continue
            rows = np.ascontiguousarray(rows, np.float64)
            if rows.shape != (19, width):
                raise Error(f"drive: an array of shape {rows.shape}, expected (19, {width})")
            given = ~np.isnan(rows).all(axis=1)
            if chosen:
                ffi.memmove(chosen, given, given.nbytes)
            ffi.memmove(field, rows, rows.nbytes)
        _check(lib.session_drive(self._session, drive, error), error)

    def process(self, seconds: float, out: Optional[NDArray[np.float32]] = None) -> NDArray[np.float32]:
        """Plays on; the sound, (samples, channels) float32. `out` is filled instead, as long as it is (no copy)."""
        if out is None:
            out = np.empty((round(_finite("seconds", seconds, 0) * self.rate), self._channels), np.float32)
        _filled(out, self._channels)
        lib.session_process(self._session, len(out), self._channels, ffi.cast("float *", out.ctypes.data))
        if self._session.failed:
            raise MemoryError("no memory for rows or strikes")
        return out

    @property
    def time(self) -> float:
        """Seconds played since the start or a reset."""
        return (self._session.samples - self._session.zero) / self.rate

    @property
    def done(self) -> bool:
        """The score or the take is played to its end."""
        return self._session.done

    @property
    def motion(self) -> NDArray:
        """Rows of motion so far, a structured array: ``motion["torque"]`` is (rows, 19, 3). A copy, since more may come."""
        return _array(self._session, self._session.rows, self._session.row_count, _ROW).copy()

    @property
    def strikes(self) -> NDArray:
        """Contacts so far, a structured array; ``hand`` 0 is left."""
        return _array(self._session, self._session.strikes, self._session.strike_count, _STRIKE).copy()

    @property
    def missed(self) -> NDArray:
        """Strokes that were not played so far, as ``strikes``: ``time`` and place as planned, ``beat`` NaN of a hit."""
        return _array(self._session, self._session.missed, self._session.missed_count, _STRIKE).copy()

    @property
    def notes(self) -> list[str]:
        """Lines for the user so far."""
        return ffi.string(self._session.notes).decode().splitlines() if self._session.notes_size else []

    @property
    def stats(self) -> dict[str, float]:
        """The figures of ``himc render``, in SI units."""
        s = lib.himc_performance_measure(self._session.performance)
        return {name: getattr(s, name) for name, _ in ffi.typeof("himc_performance_stats").fields}


@dataclass(frozen=True, eq=False)
class Rendering:
    """What a piece sounds and looks like.

    ``sound``: (samples, channels) float32, 1.0 is full scale; ``rate`` (Hz). ``motion``: a structured array (rows,) with the columns of
    docs/data.md, empty unless asked for; ``strikes``: one of (strikes,). ``stats``: the figures of ``himc render``; ``notes``: its lines.
    """
    sound: NDArray[np.float32]
    rate: float
    motion: NDArray
    strikes: NDArray
    stats: Mapping[str, float]
    notes: Sequence[str]


def _is_take(path: str) -> bool:
    return bool(lib.himc_take_is_capture(path.encode()))


def _is_text(score: str) -> bool:
    words = score.split()
    return not os.path.exists(score) and (";" in score or len(words) > 1 and bool(lib.session_is_command(words[0].encode())))


def render(score: Union[str, Path], rate: float = 48000, channels: int = 2, motion: bool = True, settings: Iterable[str] = (),
           left_tip: Optional[str] = None, right_tip: Optional[str] = None, up: Optional[str] = None) -> Rendering:
    """Plays a score, a MIDI file or a take to its end, as ``himc render`` does, to the same bits.

    `score` is a path, or the text of a score: it has a ``;`` or begins with a command, and no file has that name. `settings` are commands: before a take, after a score.
    """
    p = _loaded(score, rate, channels, motion, settings, left_tip, right_tip, up)
    p.command("play")
    return _play_to_the_end(p)


def _loaded(score: Union[str, Path], rate: float, channels: int, motion: bool, settings: Iterable[str], left_tip: Optional[str] = None,
            right_tip: Optional[str] = None, up: Optional[str] = None) -> Performance:
    """A performance that is about to play it, once."""
    if _is_text(str(score)):
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
            file.write(str(score))
            file.flush()
            try:
                return _loaded(file.name, rate, channels, motion, settings, left_tip, right_tip, up)
            except Error as error:  # the name of the file says nothing
                raise Error(str(error).replace(file.name, "score")) from None
    path, take, error = str(score), _is_take(str(score)), ffi.new("himc_error *")
    makes = 0 if take else lib.session_makes_drums(_text(path), error)
    _check(makes >= 0, error)
    p = Performance(rate, channels=0, motion=motion)
    p._channels = _channels(channels, 1)
    p.take_options(left_tip, right_tip, up)
    if not makes:
        p.add_drum()
    p.command(_LISTENER)
    commands = [(text, None) for text in settings]
    whole = [("take" if take else "score", path)]
    for text, word in commands + whole if take else whole + commands:
        p.command(text, word)
    if not take:
        p.command("loop 0")  # one round
    return p


def _play_to_the_end(p: Performance) -> Rendering:
    cells, peak, done_at = [], 0.0, None
    while True:
        cells.append(p.process(_CELL))
        quiet = p._session.peak
        peak = max(peak, quiet)
        if p.done:
            if done_at is None:
                done_at = p.time
            since = p.time - done_at
            if (quiet <= _SILENCE * peak and since >= _REST) or since >= _TAIL:
                break
    s, error = p._session, ffi.new("himc_error *")
    _check(lib.session_end_recording(s, error), error)
    sound = np.concatenate(cells)
    sound.flags.writeable = False
    return Rendering(sound, p.rate, _array(s, s.rows, s.row_count, _ROW),
                     _array(s, s.strikes, s.strike_count, _STRIKE), p.stats, p.notes)


class Take:
    """A motion capture: BVH, C3D, TRC, Nexus or Motive CSV, Qualisys TSV, or CSV with NAME_x_m, NAME_y_m, NAME_z_m.

    ``rate`` (Hz); ``names`` of the points; ``points``: (frames, points, 3) in m, z up, facing along x, NaN in gaps. Of a C3D also
    ``analog``: (samples, channels) in the file's units, ``analog_names`` and ``analog_rate`` (Hz, 0 without such channels). Arrays are the
    library's memory, read only.
    """

    def __init__(self, path: Union[str, Path], left_tip: Optional[str] = None, right_tip: Optional[str] = None,
                 up: Optional[str] = None, subject: Optional[str] = None):
        """Reads the file. `subject` chooses one of several players by name; the others as in `take_options`."""
        error = ffi.new("himc_error *")
        made = lib.take_load(_text(path), _text(left_tip), _text(right_tip), _up(up), _text(subject), error)
        _check(made != ffi.NULL, error)
        self._take = ffi.gc(made, lib.himc_take_free)
        self._tips = _text(left_tip), _text(right_tip)
        self.rate: float = lib.himc_take_rate(made)
        self.names: list[str] = [ffi.string(lib.himc_take_point_name(made, i)).decode()
                                 for i in range(lib.himc_take_points(made))]
        frames = lib.himc_take_frames(made)
        self.points: NDArray[np.float64] = _array(self._take, lib.take_points(made), frames * len(self.names) * 3,
                                                  np.dtype(np.float64)).reshape(frames, len(self.names), 3)

        count, channels, rate = ffi.new("int *"), ffi.new("int *"), ffi.new("double *")
        analog = lib.take_analog(made, count, channels, rate)
        self.analog_rate: float = rate[0]
        self.analog_names: list[str] = [ffi.string(lib.take_analog_name(made, i)).decode() for i in range(channels[0])]
        self.analog: NDArray[np.float64] = _array(self._take, analog, count[0] * channels[0],
                                                  np.dtype(np.float64)).reshape(count[0], channels[0])

    def events(self) -> list[tuple[float, str]]:
        """Time from the first frame (s) and label of the file's events."""
        time, label, found = ffi.new("double *"), ffi.new("char **"), []
        while lib.take_event(self._take, len(found), time, ffi.cast("const char **", label)):
            found.append((time[0], ffi.string(label[0]).decode()))
        return found

    def strikes(self) -> NDArray:
        """Strikes seen in the tips, a structured array."""
        error, count = ffi.new("himc_error *"), ffi.new("int *")
        found = lib.take_strikes(self._take, *self._tips, count, error)
        _check(count[0] >= 0, error)
        owner = ffi.gc(found, lib.free)
        return _array(owner, owner, count[0], _TAKE_STRIKE)


def modes(score: Union[None, str, Path] = None) -> NDArray:
    """The modes of the first drum of a score, or of the default one: fields m, n, frequency (Hz), ratio, t60 (s)."""
    error, rows = ffi.new("himc_error *"), np.zeros(8192, _MODE)
    count = lib.modes_of(ffi.NULL if score is None else ffi.new("char[]", _text(score)),
                         ffi.cast("mode_row *", rows.ctypes.data), len(rows), error)
    _check(count >= 0, error)
    return rows[:count]


def evaluate(takes: Iterable[Union[str, Path]], left_tip: Optional[str] = None, right_tip: Optional[str] = None,
             up: Optional[str] = None, jobs: Optional[int] = None) -> list[dict]:
    """Plays each capture under each controller and law (``himc evaluate --take``, the program that the package brings)."""
    program = Path(__file__).parent / "bin" / "himc"
    call = [str(program), "evaluate", "--quiet", "--json"]
    for name, value in (("left-tip", left_tip), ("right-tip", right_tip), ("up", up), ("jobs", jobs)):
        call += [f"--{name}", str(value)] if value is not None else []
    for take in takes:
        call += ["--take", str(take)]
    done = subprocess.run(call, capture_output=True, text=True)
    if done.returncode:
        raise Error(done.stderr.strip())
    return json.loads(done.stdout)
