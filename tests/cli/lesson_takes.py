"""Takes for tests of `himc lesson`, made without the planner: tips on parabolas, minimum-jerk rises and cubic contacts, with planted faults.

A player has an own tempo and offset, a clock that wanders and is corrected, motor delays, and spreads of loudness and place. Times in s, lengths in m.
"""

import bisect
import math
import random

HANDS = ("left", "right")
BASE = {"normal": -0.2476, "rim": -0.3038}  # of a 26-inch head, measured in `himc render --strokes`


def score():
    """(text, strokes): strokes are dicts of beat, hand, dB over mf, spot, run; a roll has `roll`, its length in beats."""
    lines, strokes = ["tempo 112;"], []

    def stroke(beat, hand, nuance="legato", spot="normal", run=False):
        lines.append(f"stroke {beat:g} {hand} {nuance} mf {spot};")
        strokes.append(dict(beat=beat, hand=hand, nuance=nuance, spot=spot, run=run))

    for i in range(24):
        stroke(1 + i / 2, HANDS[(i + 1) % 2], "accent" if i % 4 == 0 else "legato")
    for i in range(8):
        stroke(13 + i / 2, HANDS[(i + 1) % 2], spot="rim")
    lines.append("roll 17 4 single mf mf;")
    strokes.append(dict(beat=17, roll=4))
    for i in range(16):
        stroke(22 + i / 4, HANDS[(i + 1) % 2], run=True)
    for i in range(8):
        stroke(26.5 + i / 2, HANDS[(i + 1) % 2])
    return "\n".join(lines) + "\n", strokes


def speed_of(stroke):
    """About the model's impact speed (m/s)."""
    return {"accent": 3.03, "legato": 2.9}[stroke["nuance"]]


FAULTS = ("early", "late", "single", "soft", "spot", "rim", "drag", "rush", "roll", "missing", "extra", "wait")


def plan(strokes, fault, draw):
    """Strikes of a player: lists of (time, speed, x, y) for each hand, and what has been planted."""
    beat, start = 60 / 112 * draw.uniform(0.87, 1.15), draw.uniform(0.8, 2)
    length = strokes[-1]["beat"]
    plain = [s for s in strokes if "roll" not in s and not s["run"] and 3 < s["beat"] < length - 2 and s["beat"] not in (16.5, 26.5)]
    chosen, clock, planted, shift = draw.choice(plain), 0, {"fault": fault}, 0
    if fault == "extra":
        chosen = draw.choice([s for s in plain if s["beat"] < 15])
    wander, phase = draw.uniform(0, 0.0007), draw.uniform(0, 6)
    strikes = {hand: [] for hand in HANDS}

    def time(b):
        drift = {"drag": 0.07, "rush": -0.07}.get(fault, 0) * 0.5 * b * b / length
        return start + beat * (b + drift + wander * length * math.sin(phase + 6.28 * b / length)) + shift

    def strike(t, hand, speed, spot):
        x, y = BASE[spot], 0.015 if hand == "left" else -0.015
        if fault == "rim":
            x = BASE["normal"]
        if fault == "spot" and hand == "left":
            x += 0.055
        if fault == "soft" and hand == "left":
            speed *= 10 ** (-5 / 20)
        t += {("early", "left"): -0.024, ("late", "right"): 0.024}.get((fault, hand), 0)
        speed *= 10 ** (draw.gauss(0, 0.9) / 20)
        strikes[hand].append((t, speed, x + draw.gauss(0, 0.007), y + draw.gauss(0, 0.006)))

    for s in strokes:
        if "roll" in s:
            rate = draw.uniform(10, 12)
            count = int(s["roll"] * beat * rate)
            gallop, random_ = draw.choice(((0.016, 0.003), (0.0, 0.016))) if fault == "roll" else (0, 0.003)
            for k in range(count):
                t = time(s["beat"]) + (k + 0.2) / rate + gallop * (k % 2) + max(-0.03, min(0.03, draw.gauss(0, random_)))
                strike(t, HANDS[(k + 1) % 2], 2.6, "normal")
            continue
        if fault == "wait" and s is chosen:
            shift = draw.uniform(0.2, 0.35)
            planted["beat"] = s["beat"]
        quick = 0.6 if s["run"] else 1
        clock = 0.8 * clock + draw.gauss(0, 0.0045) * quick
        late = clock + draw.gauss(0, 0.003) * quick
        if s is chosen and fault in ("single", "missing", "extra"):
            planted.update(beat=s["beat"], hand=s["hand"])
            late += draw.choice((-0.08, 0.08)) if fault == "single" else 0
            if fault == "missing":
                continue
            if fault == "extra":
                strike(time(s["beat"] + 0.42), s["hand"], 2, s["spot"])
        strike(time(s["beat"]) + late, s["hand"], speed_of(s), s["spot"])
    return {hand: sorted(list_) for hand, list_ in strikes.items()}, planted


def exercise(count):
    """(text, strokes) of even strokes, hand to hand"""
    strokes = [dict(beat=1 + i, hand=HANDS[(i + 1) % 2], nuance="legato", spot="normal", run=False) for i in range(count)]
    return "tempo 120;\n" + "".join(f"stroke {s['beat']} {s['hand']} legato mf;\n" for s in strokes), strokes


SHORT = ("pause", "skip", "exchanged", "sticking", "uneven", "very uneven", "loudness", "drag late")


def plan_short(strokes, fault, draw):
    """Strikes of an exercise, and what has been planted."""
    beat, start, shift, middle = 0.5 * draw.uniform(0.9, 1.1), draw.uniform(0.8, 2), 0, len(strokes) // 2
    strikes, planted = {hand: [] for hand in HANDS}, {"fault": fault, "beat": strokes[middle]["beat"]}
    for k, s in enumerate(strokes):
        other = fault == "exchanged" or fault == "sticking" and k == middle
        hand = HANDS[s["hand"] == "left"] if other else s["hand"]
        shift += 2 if fault == "pause" and k == middle else 0
        if fault == "skip" and middle - 2 <= k < middle + 3:
            shift -= 0.7 * beat  # hesitates, then goes on
            continue
        t = start + shift + beat * s["beat"] * (1 + (0.035 * s["beat"] / strokes[-1]["beat"] if "drag" in fault else 0))
        t += draw.gauss(0, {"uneven": 0.045, "very uneven": 0.06}.get(fault, 0.006)) + (0.03 if "late" in fault and hand == "right" else 0)
        speed = 2.9 * 10 ** (draw.gauss(0, 5 if fault == "loudness" else 0.9) / 20)
        strikes[hand].append((t, max(speed, 0.8), BASE["normal"] + draw.gauss(0, 0.007), (0.015 if hand == "left" else -0.015) + draw.gauss(0, 0.006)))
    return {hand: sorted(list_) for hand, list_ in strikes.items()}, planted


def rolls(between, count=8):
    """(text, strokes) of rolls of two beats with so many strokes between them; the first of these closes the roll before it."""
    beat, strokes = 1.0, []
    for i in range(count * between + 1):
        strokes.append(dict(beat=beat, hand=HANDS[(i + 1) % 2], nuance="legato", spot="normal", run=False))
        beat += 0.5
        if i % between == between - 1 and i < count * between:
            strokes.append(dict(beat=beat, roll=2))
            beat += 2
    return "tempo 112;\n" + "".join(f"roll {s['beat']:g} {s['roll']} single mf mf;\n" if "roll" in s else f"stroke {s['beat']:g} {s['hand']} legato mf;\n"
                                    for s in strokes), strokes


ROLLED = ("short roll", "roll", "missing")


def plan_rolls(strokes, fault, draw):
    """Strikes of a player whose tempo drifts by up to 5 %, and what has been planted; `missing` is a closing stroke."""
    beat, start, length = 60 / 112 * draw.uniform(0.9, 1.1), draw.uniform(0.8, 2), strokes[-1]["beat"]
    drift = draw.uniform(-0.016, 0.016) / length if fault != "steady" else 0
    chosen = [s for k, s in enumerate(strokes) if ("roll" in s if "roll" in fault else "roll" in strokes[k - 1]) and 6 < s["beat"] < length - 4]
    chosen = draw.choice(chosen)
    strikes, planted = {hand: [] for hand in HANDS}, {"fault": fault, "beat": chosen["beat"]}

    def strike(beats, late, hand, speed):
        t = start + beat * beats * (1 + drift * beats) + late
        x, y = BASE["normal"] + draw.gauss(0, 0.007), 0.015 if hand == "left" else -0.015
        strikes[hand].append((t, speed * 10 ** (draw.gauss(0, 0.9) / 20), x, y + draw.gauss(0, 0.006)))

    for s in strokes:
        if "roll" in s:
            count = int(s["roll"] * beat * draw.uniform(10, 12))
            for k in range(count // 2 if s is chosen and fault == "short roll" else count):
                uneven = 0.018 if s is chosen and fault == "roll" else 0.003
                strike(s["beat"] + (k + 0.2) * s["roll"] / count, max(-0.03, min(0.03, draw.gauss(0, uneven))), HANDS[(k + 1) % 2], 2.6)
        elif not (s is chosen and fault == "missing"):
            strike(s["beat"], draw.gauss(0, 0.005), s["hand"], 2.9)
    return {hand: sorted(list_) for hand, list_ in strikes.items()}, planted


CONTACT, REBOUND = 0.006, 0.45  # (s), share of the speed


def rise(t, duration, speed, height):
    """Quintic from 0 with that speed, unaccelerated, to rest at a height."""
    s = t / duration
    m = speed * duration
    jerk = s**3 * (10 - 15 * s + 6 * s * s)
    return height * jerk + m * (s - 6 * s**3 + 8 * s**4 - 3 * s**5)


class Tip:
    """A tip's path through strikes; z is the height over the head."""

    def __init__(self, strikes):
        self.strikes = strikes
        self.falls = []
        for k, (t, speed, x, y) in enumerate(strikes):
            gap = t - strikes[k - 1][0] - CONTACT if k else 1
            fall = min(2 * 0.045 * speed / 1 if speed < 1 else 0.19, 0.55 * gap)
            self.falls.append((fall, speed * fall / 2))  # a parabola: height = v T / 2
        self.begins = [s[0] for s in strikes]

    def at(self, t):
        k = bisect.bisect_right(self.begins, t) - 1
        if k >= 0 and t - self.begins[k] < CONTACT:
            t0, v, x, y = self.strikes[k]
            s = (t - t0) / CONTACT
            return x, y, CONTACT * (-v * (s - 2 * s * s + s**3) + REBOUND * v * (s**3 - s * s))
        following = self.strikes[k + 1] if k + 1 < len(self.strikes) else None
        fall, height = self.falls[k + 1] if following else (0.2, 0.2)
        before = self.strikes[k] if k >= 0 else None
        end = following[0] if following else before[0] + 1.2
        begin = before[0] + CONTACT if before else end - 0.8 - fall
        here, there = before or following, following or before
        share = min(1, max(0, (t - begin) / max(end - begin, 1e-6)))
        share = share**3 * (10 - 15 * share + 6 * share * share)
        x, y = (a + (b - a) * share for a, b in zip(here[2:], there[2:]))
        if following and t > end - fall:
            s = (t - end + fall) / fall
            z = height * (1 - s * s)
        else:
            up = max(end - fall - begin, 1e-6)
            speed = min(REBOUND * before[1], 2 * height / up) if before else 0
            z = rise(min(max(t - begin, 0), up), up, speed if before else 0, height - (0 if before else 0.1)) + (0 if before else 0.1)
        return x - 0.15 * max(z, 0), y, z


def write(path, strikes, rate, draw, noise=0.0003):
    """A CSV of both tips somewhere in a laboratory, z up."""
    origin = [draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5), draw.uniform(0.6, 0.9)]
    tips = [Tip(strikes[hand]) for hand in HANDS]
    last = max(s[-1][0] for s in strikes.values()) + 0.8
    with open(path, "w") as file:
        print("time," + ",".join(f"{tip}_{axis}_m" for tip in ("LTIP", "RTIP") for axis in "xyz"), file=file)
        phase = draw.random() / rate  # frames do not know about beats
        for k in range(int(last * rate)):
            row = [k / rate]
            for tip in tips:
                row += [a + o + draw.gauss(0, noise) for a, o in zip(tip.at(k / rate + phase), origin)]
            print(",".join(f"{v:.6f}" for v in row), file=file)


ARM = {"SJC": None, "EJC": 0.29, "WJC": 0.26, "Grip": 0.11}  # lengths to the joint centre before it (m)


def add(a, b, scale=1.0):
    return [x + scale * y for x, y in zip(a, b)]


def unit(a):
    return [x / math.sqrt(sum(y * y for y in a)) for x in a]


def arm(shoulder, tip, pitch, swivel, side):
    """Elbow, wrist and grip of a seated player's arm: the stick falls towards the tip by `pitch` (rad), hand and stick are in line, and the elbow
    is turned outwards by `swivel` (rad) from where it hangs."""
    back = [-math.cos(pitch), 0, math.sin(pitch)]
    grip = add(tip, back, 0.26)
    wrist = add(grip, back, ARM["Grip"])
    reach = add(wrist, shoulder, -1)
    far = math.sqrt(sum(x * x for x in reach))
    line = [x / far for x in reach]
    a, b = ARM["EJC"], ARM["WJC"]
    along = (a * a - b * b + far * far) / (2 * far)
    aside = math.sqrt(a * a - along * along)
    hanging = unit(add([0, 0, -1], line, line[2]))
    outwards = unit([-side * x for x in (hanging[1] * line[2] - hanging[2] * line[1], hanging[2] * line[0] - hanging[0] * line[2], hanging[0] * line[1] - hanging[1] * line[0])])
    elbow = add(add(add(shoulder, line, along), hanging, aside * math.cos(swivel)), outwards, aside * math.sin(swivel))
    return elbow, wrist, grip


def raised(shoulder, elbow):
    """of an upper arm, from hanging (degrees)"""
    return math.degrees(math.acos((shoulder[2] - elbow[2]) / ARM["EJC"]))


def write_body(path, strikes, high, rate, draw, noise=0.001):
    """A CSV of a seated player's joint centres and tips, z up; `high` are the hands with a raised elbow. Returns how far each upper arm is raised."""
    origin = [draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5), draw.uniform(0.7, 0.8)]
    fixed = {"MidHip": (-0.75, 0, -0.09), "Neck": (-0.72, 0, 0.44), "Head": (-0.7, 0, 0.51)}
    last, phase = max(s[-1][0] for s in strikes.values()) + 0.8, draw.random() / rate
    rows, angle = [[k / rate] for k in range(int(last * rate))], {}
    names = [f"{name}_{axis}_m" for name in fixed for axis in "xyz"]
    for row in rows:
        row += [a + o + draw.gauss(0, noise) for x in fixed.values() for a, o in zip(x, origin)]
    for hand in HANDS:
        side, tip = (1 if hand == "left" else -1), Tip(strikes[hand])
        shoulder = [-0.72, 0.18 * side, 0.4]
        at = [BASE["normal"], 0.015 * side, 0]
        swivel, wanted = 0.0, draw.uniform(60, 75) if hand in high else draw.uniform(15, 33)
        while swivel < math.pi and raised(shoulder, arm(shoulder, at, 0.2, swivel, side)[0]) < wanted:
            swivel += 0.005
        angle[hand] = min(wanted, raised(shoulder, arm(shoulder, at, 0.2, swivel, side)[0]))  # a long reach raises no elbow so far
        names += [f"{hand[0].upper()}{name}_{axis}_m" for name in (*ARM, "TIP") for axis in "xyz"]
        for row in rows:
            x = list(tip.at(row[0] + phase))
            points = arm(shoulder, x, 0.2 - 1.2 * x[2], swivel, side)
            for point in (shoulder, *points, x):
                row += [a + o + draw.gauss(0, noise if point is not x else 0.0003) for a, o in zip(point, origin)]
    with open(path, "w") as file:
        print("time," + ",".join(names), file=file)
        for row in rows:
            print(",".join(f"{v:.5f}" for v in row), file=file)
    return angle


def is_named(planted, faults):
    """True if one of the three faults named first is the planted one."""
    fault = planted["fault"]
    for f in faults[:3]:
        kind, what, effect = f["kind"], f["what"], f["effect"]
        beat = f"beat {planted.get('beat', -1):g}"
        if fault in ("early", "late") and kind == "time" and "right behind the left" in what:
            return abs(abs(effect) - 24) < 8
        if fault == "soft" and kind == "level" and ("left hand's" in what and "softer" in what or "right hand's" in what and "louder" in what):
            return abs(abs(effect) - 5) < 1.5
        if fault in ("spot", "rim") and kind == "spot" and abs(effect - 55) < 15:
            return True
        if fault in ("drag", "rush") and kind == "tempo" and fault in what:
            return True
        if fault in ("single", "missing", "wait") and beat in what and kind == {"single": "time"}.get(fault, fault):
            return True
        if fault in ("roll", "extra", "skip") and kind == fault:
            return True
        if fault == "short roll" and kind == "roll" and "too short" in what:
            return True
        if fault == "pause" and kind == "wait" and beat in what and abs(effect - 2000) < 60:
            return True
        if fault in ("exchanged", "sticking") and kind == "hand" and (fault in what if fault == "exchanged" else beat in what):
            return True
        if kind == "even" and {"uneven": "in time", "very uneven": "in time", "loudness": "in loudness"}.get(fault, "-") in what:
            return True
        if fault == "high elbow" and kind == "elbow" and planted["hand"] in what:
            return abs(effect - planted["raised"]) < 5
        if fault == "drag late" and kind == "time" and "right behind the left" in what and abs(abs(effect) - 30) < 10:
            return True
    return False


def make(path, fault, rate, seed, short=0, body=False):
    draw = random.Random(f"{fault} {rate} {seed}")
    strikes, planted = plan_short(exercise(short)[1], fault, draw) if short else plan(score()[1], fault, draw)
    if body:
        planted["hand"] = draw.choice(HANDS)
        angle = write_body(path, strikes, [planted["hand"]] if fault == "high elbow" else [], rate, draw)
        planted["raised"] = angle[planted["hand"]]
    else:
        write(path, strikes, rate, draw)
    return planted
