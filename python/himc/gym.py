"""A Gymnasium environment in which a stroke has a sound.

``Drumming(score)`` asks for the strokes of a score, whose drums it has. An episode is the score once; a step is 4 ms (250 Hz), with
forty steps of physics in it. The reference is what himc's own performer makes of the score: its strokes and its sound. All is SI, in the
world frame: x away from the player, y to his left, z up.

>>> import gymnasium, himc.gym
>>> env = gymnasium.make("himc/Drumming-v0", score="stroke 1 right legato mf", control="tips")
>>> observation, info = env.reset(seed=1)
>>> observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
"""
from __future__ import annotations

import functools
import os
from dataclasses import dataclass
from typing import Any, Optional

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from . import Error, _is_take, _loaded, joint_names, render

__all__ = ["ARMS", "CONTROLS", "STEP", "Drumming", "Snapshot"]

STEP = 0.004  # s
SETTINGS = ("strength human",)
RATE = 48000  # Hz, of the sound
SAMPLES = round(STEP * RATE)
ARMS = np.array([j for j, name in enumerate(joint_names) if name.split("-")[-1] in ("shoulder", "elbow", "wrist", "grip")])
CONTROLS = ("tips", "joints", "torques")
"""What an action is: places of the two tips (2, 3) in m; rotation vectors of the arms' eight joints (8, 3) in rad, in the parents' frames;
torques of these joints (8, 3) in N m about their own axes, beside which the performer holds the trunk."""

TIPS_LOW, TIPS_HIGH = (0.0, -1.2, 0.3), (1.2, 1.2, 2.0)  # m: the space before a player
# N m, isometric maxima of a healthy man's shoulder, elbow, wrist and fingers (docs/model.md)
STRENGTH = {"shoulder": 80.0, "elbow": 70.0, "wrist": 12.0, "grip": 5.0}
FASTEST = 160.0  # rad/s: faster than any human joint: the simulation has diverged
OBSERVED = (("joints", (19, 4), 1), ("rates", (19, 3), 1e3), ("tips", (2, 6), 1e2), ("forces", (2,), 1e4), ("strokes", (2, 2, 6), 1e4))
AHEAD = 2  # strokes of each hand in an observation
HEARD_AGAIN = 10  # steps between two comparisons of the sound, 40 ms
BANDS = 2.0 ** np.arange(5, 15)  # Hz, edges of octaves

# rewards: a stroke is worth 1 at most
LATE = 0.02  # s: a stroke so far off in time has half its worth
LOST = 0.15  # s: so far off it is another stroke
LOUDER = 6.0  # dB of impact speed, likewise
ASIDE = 0.05  # m, likewise
UNASKED = 0.1  # lost by each contact that no stroke asked for
EFFORT = 1e-3  # lost by each joule that the joints give or take
EAR = 0.01  # lost each 40 ms by a mean difference of 20 dB and more in the octaves


@dataclass(frozen=True)
class Snapshot:
    """Where an episode is: its seed and actions, which lead there again to the last bit (with motor noise only if it had a seed)."""
    seed: Optional[int]
    actions: tuple


@functools.lru_cache(maxsize=8)
def _reference(score: str, settings: tuple, stamp: Optional[tuple]):
    """Strokes of himc's own performer by hand, with the place of the tip at contact; and the left channel of its sound.
    `stamp` tells a file's versions apart."""
    if _is_take(score):
        raise Error(f"score: {score}: is a take, expected a score")
    r = render(score, rate=RATE, settings=settings)
    if r.stats["task_rate"] != round(1 / STEP):
        raise Error(f"rate task {r.stats['task_rate']:g}: expected 250, the environment's steps in a second")
    strokes = [[], []]
    for s in r.strikes[~np.isnan(r.strikes["planned_time"])]:
        row = min(int(round(s["time"] / STEP)), len(r.motion) - 1)
        strokes[s["hand"]].append((s["time"], *r.motion["tip"][row, s["hand"]], s["velocity"]))
    if not any(strokes):
        raise Error("score: has no stroke that is played, expected one or more")
    return [np.array(hand, np.float64).reshape(-1, 5) for hand in strokes], r.sound[:, 0].astype(np.float64)


def _stamp(score: str) -> Optional[tuple]:
    """When a file was written, and its size; None of a text."""
    if not os.path.exists(score):
        return None
    stat = os.stat(score)
    return stat.st_mtime_ns, stat.st_size


def _octaves(sound: NDArray) -> NDArray:
    """Levels of octaves (dB) of a piece of sound, from -100 dB re full scale up."""
    power = np.abs(np.fft.rfft(sound * np.hanning(len(sound)))) ** 2 / len(sound) ** 2
    bins = np.searchsorted(np.fft.rfftfreq(len(sound), 1 / RATE), BANDS)
    return 10 * np.log10(np.add.reduceat(power, bins)[:-1] + 1e-10)


class Drumming(gymnasium.Env):
    """Play a score.

    Observation: ``joints`` (19, 4) unit quaternions in the parents' frames; ``rates`` (19, 3) rad/s; ``tips`` (2, 6) place and velocity
    of the left and the right tip; ``forces`` (2,) N, the largest since the last step; ``strokes`` (2, 2, 6): of each hand's next two
    strokes 1, seconds until then (at most 0.15 s ago), the tip's place at contact (m) and the impact speed asked for (m/s), or zeros.

    Reward of a stroke, at its contact: f(dt / 20 ms) f(dL / 6 dB) f(dx / 50 mm), f(u) = 1 / (1 + u^2), dL from the impact speeds; it is
    lost 150 ms after its time. Minus .1 for each contact that nobody asked for, .001 for each joule of the joints' |torque x rate|, and every 40 ms up
    to .01 for the mean difference of the sound's octaves. ``info["reward"]`` has the parts, ``info["strikes"]`` the contacts, and
    ``info["sound"]`` the step's (192, 2) samples.

    Terminated when the last stroke's time is half a second ago, or (with -1) when a joint is faster than 160 rad/s: the body is lost.
    ``settings`` are commands after the score's; by default joints are as strong as a man's.
    ``motor_noise`` is the standard deviation of normal noise on actions, as a share of their range; it is all that `seed` decides.
    """
    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, score: str, control: str = "tips", motor_noise: float = 0.0, settings: tuple = SETTINGS):
        if control not in CONTROLS:
            raise Error(f"control: {control!r}, expected {' '.join(CONTROLS)}")
        if not np.isfinite(motor_noise) or motor_noise < 0:
            raise Error(f"motor_noise: {motor_noise!r}, expected 0 or more")
        self.score, self.control, self.motor_noise, self.settings = str(score), control, motor_noise, tuple(settings)
        self.reference, self._sound = _reference(self.score, self.settings, _stamp(self.score))
        self.seconds = max(hand[-1, 0] for hand in self.reference if len(hand)) + 0.5
        high = np.array([STRENGTH[joint_names[j].split("-")[-1]] for j in ARMS], np.float32)[:, None].repeat(3, axis=1)
        self.action_space = {
            "tips": spaces.Box(np.array([TIPS_LOW] * 2, np.float32), np.array([TIPS_HIGH] * 2, np.float32)),
            "joints": spaces.Box(-np.pi, np.pi, (len(ARMS), 3), np.float32),
            "torques": spaces.Box(-high, high)}[control]
        self.observation_space = spaces.Dict({name: spaces.Box(-high, high, shape, np.float64) for name, shape, high in OBSERVED})

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict] = None):
        super().reset(seed=seed)
        self._seed, self._actions, self._steps = seed, [], 0
        self._struck = [np.zeros(len(hand), bool) for hand in self.reference]
        self._p = _loaded(self.score, RATE, 2, True, self.settings)
        self._p.command("clear")  # its drums and settings remain
        if self.control == "joints":
            self._p.command("mode id")
        self._heard = np.zeros(HEARD_AGAIN * SAMPLES)
        self._p.process(STEP)  # until the first row
        observation = self._observe()
        self._aims = observation["joints"][ARMS]
        return observation, {}

    def step(self, action):
        action = np.asarray(action, np.float64)
        if action.shape != self.action_space.shape or not np.isfinite(action).all():
            raise Error(f"action: of shape {action.shape}, expected finite numbers of shape {self.action_space.shape}")
        space = self.action_space
        if self.motor_noise:
            action = action + self.motor_noise * (space.high - space.low) * self.np_random.standard_normal(space.shape)
        return self._step(np.clip(action, space.low, space.high))

    def snapshot(self) -> Snapshot:
        """Where the episode is."""
        return Snapshot(self._seed, tuple(self._actions))

    def restore(self, snapshot: Snapshot):
        """Goes there, to the last bit, by playing its actions again (at the environment's speed); returns the observation. Motor noise
        goes on as it would have after `snapshot`, if the episode had a seed."""
        observation, _ = self.reset(seed=snapshot.seed)
        for action in snapshot.actions:
            if self.motor_noise:
                self.np_random.standard_normal(self.action_space.shape)  # noise is in the actions
            observation = self._step(action)[0]
        return observation

    def _step(self, action):
        self._actions.append(action)
        self._steps += 1
        if self.control == "tips":
            for hand in range(2):
                self._p.target(hand, action[hand])
        elif self.control == "joints":
            rotations, rates = np.full((19, 4), np.nan), np.zeros((19, 3))
            rotations[ARMS] = _quaternions(action)
            rates[ARMS] = _rates(self._aims, rotations[ARMS])
            self._aims = rotations[ARMS]
            self._p.drive(rotations=rotations, rates=rates)
        else:
            torques = np.full((19, 3), np.nan)
            torques[ARMS] = action
            self._p.drive(torques=torques)
        session = self._p._session
        session.row_count = session.strike_count = 0
        sound = self._p.process(STEP)
        at = self._steps % HEARD_AGAIN
        self._heard[at * SAMPLES:(at + 1) * SAMPLES] = sound[:, 0]
        observation, strikes = self._observe(), self._p.strikes
        lost = self._p.stats["recoveries"] > 0 or bool((np.linalg.norm(observation["rates"], axis=1) > FASTEST).any())
        parts = self._rewards(strikes, at == HEARD_AGAIN - 1)
        if lost:
            parts["lost"] = -1.0
        done = lost or self.time >= self.seconds
        return observation, float(sum(parts.values())), done, False, {
            "reward": parts, "sound": sound, "strikes": [
                {"time": float(s["time"]), "hand": int(s["hand"]), "drum": s["drum"].decode(), "velocity": float(s["velocity"]),
                 "force": float(s["force"])} for s in strikes]}

    def _rewards(self, strikes, whole: bool) -> dict[str, float]:
        row = self._row
        parts = {"strokes": 0.0, "unasked": 0.0, "effort": -EFFORT * STEP * float(np.abs(row["power"]).sum()), "sound": 0.0}
        for s in strikes:
            asked, struck = self.reference[s["hand"]], self._struck[s["hand"]]
            off = np.where(struck, np.inf, np.abs(asked[:, 0] - s["time"])) if len(asked) else np.array([np.inf])
            k = int(off.argmin())
            if not off[k] < LOST:
                parts["unasked"] -= UNASKED
                continue
            struck[k] = True
            louder = 20 * np.log10(max(s["velocity"], 1e-3) / max(asked[k, 4], 1e-3))
            aside = np.linalg.norm(row["tip"][s["hand"]][:2] - asked[k, 1:3])
            parts["strokes"] += float(_near(off[k] / LATE) * _near(louder / LOUDER) * _near(aside / ASIDE))
        if whole:
            end = (self._steps + 1) * SAMPLES  # the reset plays a step
            theirs = self._sound[end - len(self._heard):end]
            if len(theirs) == len(self._heard):
                difference = np.abs(_octaves(self._heard) - _octaves(theirs)).mean()
                parts["sound"] -= EAR * min(float(difference) / 20, 1.0)
        return parts

    def _observe(self) -> dict[str, NDArray]:
        row = self._row = self._p.motion[-1]
        self.time = float(self._p.time)
        strokes = np.zeros((2, AHEAD, 6))
        for hand, asked in enumerate(self.reference):
            if len(asked):
                next_ones = asked[~self._struck[hand] & (asked[:, 0] > self.time - LOST)][:AHEAD]
                strokes[hand, :len(next_ones), 0] = 1
                strokes[hand, :len(next_ones), 1:] = next_ones - (self.time, 0, 0, 0, 0)
        seen = {"joints": row["rotation"], "rates": row["rate"], "forces": row["force"], "strokes": strokes,
                "tips": np.concatenate((row["tip"], row["tip_velocity"]), axis=1)}
        return {name: np.clip(seen[name], -high, high) for name, _, high in OBSERVED}


def _near(u: float) -> float:
    return 1 / (1 + u * u)


def _quaternions(rotation: NDArray) -> NDArray:
    """Unit quaternions of rotation vectors."""
    angle = np.linalg.norm(rotation, axis=-1, keepdims=True)
    return np.concatenate((np.cos(angle / 2), np.sinc(angle / (2 * np.pi)) * rotation / 2), axis=-1)


def _rates(a: NDArray, b: NDArray) -> NDArray:
    """Angular velocities (rad/s) from quaternions a to b in a step."""
    w = (a * b).sum(axis=-1, keepdims=True)
    v = a[..., :1] * b[..., 1:] - b[..., :1] * a[..., 1:] - np.cross(b[..., 1:], a[..., 1:])
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.sign(w) * v * 2 * np.arctan2(length, np.abs(w)) / np.maximum(length, 1e-12) / STEP


gymnasium.register("himc/Drumming-v0", entry_point="himc.gym:Drumming")
