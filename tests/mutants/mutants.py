#!/usr/bin/env python3
"""Faults drawn at random and put into the library one at a time, to see which of them the unit tests notice (make mutants).

  tests/mutants/mutants.py [--check]      environment: SEED=1 COUNT=200 ROOM= JOBS= MUTANT_SECONDS=300 HIMC_BUILD=build, COMPILE of the Makefile

A draw goes through the rooms of lib/src in turn; in a room through the operators below, in an order that the seed gives; of an operator's
places the seed chooses one. What does not compile, or compiles to the same machine code, is drawn again. Places are ordered by a
hash of the seed and the line's own text, so a change elsewhere leaves most draws as they were.

All happens in a copy of the repository (build/mutants/tree), so that it can be worked on meanwhile. The mutated object is linked before the
library with one test after the other: those that run the changed line (gcov), nearest by name and quickest first. A test that fails
kills it, if it passes once more without the fault; one that runs five times as long as usual fails. MUTANT_SECONDS (of CPU) a mutant are spent at most.

A mutant that no test can tell apart from the program is excused, one by one, in tests/mutants/excused.txt:
  FILE: OLD LINE ==> NEW LINE ## why
Results are added to build/mutants/SEED.log; a run that is started again goes on after them, and tries what has survived again if a test has changed.
--check only asks whether what is excused still stands in its file. Fails if less than 92 of 100 that are not excused are killed.
"""
import concurrent.futures
import functools
import glob
import hashlib
import itertools
import json
import os
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import time

BUILD = os.path.abspath(os.environ.get("HIMC_BUILD", "build"))
OUT = BUILD + "/mutants"
TREE = OUT + "/tree"
SHARED = os.path.abspath("../shared")  # where tests look for captures
ROOMS = "system base body capture track plan midi control bank head drum performance osc".split()
QUICK = ["-fuse-ld=gold"] if shutil.which("ld.gold") else []
GENERATED = ("air_table.c", "posture_regression_table.c")  # numbers that a program has written
EXCUSED = "tests/mutants/excused.txt"
LEAST = 0.92  # share of the mutants that tests notice
SLOW, GRACE = 5, 10  # a test has that many times its CPU time, and that many seconds more
SECONDS = float(os.environ.get("MUTANT_SECONDS") or 300)
JOBS = int(os.environ.get("JOBS") or os.cpu_count())

# name, what is looked for, what takes its place; \1 is the first group
REPLACED = [
    ("less, or equal", r" < ", " <= "), ("less, not equal", r" <= ", " < "),
    ("greater, or equal", r" > ", " >= "), ("greater, not equal", r" >= ", " > "),
    ("less, greater", r" < ", " > "), ("greater, less", r" > ", " < "),
    ("equal, unequal", r" == ", " != "), ("unequal, equal", r" != ", " == "),
    ("and, or", r" && ", " || "), ("or, and", r" \|\| ", " && "),
    ("plus, minus", r"(?<=[\w)\]]) \+ ", " - "), ("minus, plus", r"(?<=[\w)\]]) - ", " + "),
    ("times, divided", r"(?<=[\w)\]]) \* (?=[\w(!-])", " / "), ("divided, times", r"(?<=[\w)\]]) / ", " * "),
    ("added, subtracted", r" \+= ", " -= "), ("subtracted, added", r" -= ", " += "),
    ("scaled, divided", r" \*= ", " /= "), ("up, down", r"\+\+", "--"), ("down, up", r"--", "++"),
    ("not removed", r"!(?=[\w(])", ""), ("sign removed", r"(?<=[(,=?:] )-(?=[\w(])|(?<=\()-(?=[\w(])", ""),
    ("least, most", r"\bfmin\(", "fmax("), ("most, least", r"\bfmax\(", "fmin("),
    ("sine, cosine", r"\bsin\(", "cos("), ("cosine, sine", r"\bcos\(", "sin("), ("size removed", r"\bfabs\(", "("),
    ("true, false", r"\btrue\b", "false"), ("false, true", r"\bfalse\b", "true"),
    ("jump removed", r"\b(?:break|continue);", ";"), ("index one more", r"\[(\w+)\](?! = \{)", r"[\1 + 1]"),
    ("left, right", r"\bHIMC_LEFT\b", "HIMC_RIGHT"),
]
NUMBER = r"(?<![\w.])%s(?![\w.])"
NUMBERS = [
    ("one more", NUMBER % r"(\d+)", lambda x: str(int(x) + 1)), ("one less", NUMBER % r"([1-9]\d*)", lambda x: str(int(x) - 1)),
    ("doubled", NUMBER % r"(\d+\.\d*(?:e-?\d+)?|\d+e-?\d+)", lambda x: "(2 * %s)" % x),
    ("halved", NUMBER % r"(\d+\.\d*(?:e-?\d+)?|\d+e-?\d+)", lambda x: "(%s / 2)" % x),
]
RUNNING = set()  # process groups, which end with this program
WORDS = r"return|if|while|for|switch|sizeof|else|do|case"


def masked(text):
    """The text with comments, strings and directives blank, of the same length; the numbers of #define remain."""
    def blank(m):
        return re.sub(r"[^\n]", " ", m.group(0)) if m.group(0)[0] in "/#" else '"' + " " * (len(m.group(0)) - 2) + '"'
    text = re.sub(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])+'", blank, text, flags=re.S)
    return re.sub(r"^#[ ]*(?:define \w+(?:\([^)]*\))?|(?!define)(?:[^\n]*\\\n)*[^\n]*)", blank, text, flags=re.M)


def closing(text, at):
    """The place of the bracket that closes the one at `at`."""
    depth = 0
    for i in range(at, len(text)):
        depth += (text[i] in "([{") - (text[i] in ")]}")
        if depth == 0:
            return i
    return len(text) - 1


def conditions(text, body):
    for m in re.finditer(r"\bif \(", text):
        end = closing(text, m.end() - 1)
        yield "condition negated", m.end(), end, "!(" + body[m.end():end] + ")"
        yield "condition always", m.end(), end, "1 || (" + body[m.end():end] + ")"
        yield "condition never", m.end(), end, "0 && (" + body[m.end():end] + ")"


def statements(text, body):
    for m in re.finditer(r"(?<=[;{})e:])\n( +)(?!(?:%s)\b)([*a-z_][\w.>\[\]-]*(\(| [-+*/|&]?= )[^;{}]*;)" % WORDS, text):
        kind = "call removed" if m.group(3) == "(" else "assignment removed"
        yield kind, m.start(2), m.end(2), ";" + "\n" * m.group(2).count("\n")
    for m in re.finditer(r"\breturn ([^;{}]+);", text):
        yield "return negated", m.start(1), m.end(1), "!(" + body[m.start(1):m.end(1)] + ")"
    for m in re.finditer(r"^(?:static |HIMC_RT )*void \w+\([^;{}]*\)\n\{\n", text, re.M):
        yield "returns at once", m.start(), m.end() - 1, body[m.start():m.end() - 1] + " return;"


def arguments(text, body):
    for m in re.finditer(r"(?<!\w)(?!(?:%s)\b)[a-z]\w+\(" % WORDS, text):
        end, depth, commas = closing(text, m.end() - 1), 0, []
        for i in range(m.end(), end):
            depth += (text[i] in "([{") - (text[i] in ")]}")
            commas += [i] if text[i] == "," and depth == 0 else []
        if commas:
            second = (commas + [end])[1]
            a, b = body[m.end():commas[0]], body[commas[0] + 1:second].strip()
            if a != b:
                yield "arguments swapped", m.end(), second, b + ", " + a
    for m in re.finditer(r" \? ([^?:;{}]+?) : ([^?:;{},()]+)(?=[;,)])", text):
        if m.group(1).count("(") == m.group(1).count(")"):
            yield "choices swapped", m.start(1), m.end(2), body[m.start(2):m.end(2)] + " : " + body[m.start(1):m.end(1)]


def sites(path, body):
    """All places of a file: operator, begin, end, new text."""
    text = masked(body)
    inside = [(m.start(), m.end()) for m in re.finditer(r"^\{.*?^\}", text, re.S | re.M)]
    found = []
    for name, pattern, new in REPLACED:
        found += [(name, m.start(), m.end(), m.expand(new)) for m in re.finditer(pattern, text)]
    for producer in conditions, statements, arguments:
        found += producer(text, body)
    found = [f for f in found if f[0] == "returns at once" or any(a <= f[1] < b for a, b in inside)]
    for name, pattern, new in NUMBERS:
        found += [(name, m.start(), m.end(), new(m.group(1))) for m in re.finditer(pattern, text)]
    return found


def one_line(text):
    return " ".join(text.split())


class Mutant:
    def __init__(self, path, body, operator, begin, end, new):
        self.path, self.operator = path, operator
        first = body.rfind("\n", 0, begin) + 1
        last = body.find("\n", max(end - 1, begin))
        self.text = body[:begin] + new + body[end:]
        self.lines = (body.count("\n", 0, begin) + 1, body.count("\n", 0, max(end - 1, begin)) + 1)
        self.old = one_line(body[first:last])
        self.new = one_line(body[first:begin] + new + body[end:last])
        self.key = "%s: %s ==> %s" % (path, self.old, self.new)


def mutants_of(room, seed):
    """The mutants of a room in the order of the draw."""
    by_operator = {}
    for path in sorted(glob.glob("lib/src/%s/*.[ch]" % room)):
        if os.path.basename(path) in GENERATED:
            continue
        with open(path) as f:
            body = f.read()
        for site in sites(path, body):
            by_operator.setdefault(site[0], []).append(Mutant(path, body, *site))
    rank = lambda text: hashlib.sha256(("%s %s" % (seed, text)).encode()).digest()
    names = sorted(by_operator, key=lambda name: rank(room + name))
    queues = [sorted(by_operator[name], key=lambda m: rank(m.operator + m.key)) for name in names]
    return [m for turn in itertools.zip_longest(*queues) for m in turn if m]


def run(command, seconds=None, **more):
    """Exit status and CPU time (s); a status that is not 0 for one that was stopped."""
    def limits():
        if seconds:
            resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 2))
            resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))
        os.setpgid(0, 0)
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=limits, **more) as p:
        RUNNING.add(p.pid)
        end = time.monotonic() + 20 * (seconds or 1e6)
        while True:
            done, status, used = os.wait4(p.pid, os.WNOHANG)
            if done:
                break
            if time.monotonic() > end:
                os.killpg(p.pid, signal.SIGKILL)
            time.sleep(0.01)
        RUNNING.discard(p.pid)
        p.returncode = status
    return status, used.ru_utime + used.ru_stime


def stop(*_):
    for group in list(RUNNING):
        try:
            os.killpg(group, signal.SIGKILL)
        except ProcessLookupError:
            pass
    os._exit(1)


def make(*arguments):
    os.environ.pop("MAKEFLAGS", None)
    subprocess.run(["make", "-C", TREE, "--no-print-directory", "-j%d" % JOBS, *arguments], check=True, stdout=subprocess.DEVNULL)


def tests():
    return ["build/tests/" + name for name in sorted(os.path.basename(path)[:-2] for path in glob.glob(TREE + "/tests/*/test_*.c")
                                                     if not re.search("/(long|realtime)/", path))]


def copy_tree():
    """Brings the copy of the repository up to date, builds its tests and its library with counters."""
    names = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], check=True, capture_output=True, text=True).stdout.split("\n")
    kept = {n for n in names if n and os.path.isfile(n)}
    for name in kept:
        to = TREE + "/" + name
        os.makedirs(os.path.dirname(to), exist_ok=True)
        if not os.path.exists(to) or open(name, "rb").read() != open(to, "rb").read():
            shutil.copy(name, to)
    for folder in "lib", "tests", "mocap", "tools":
        for at, _, files in os.walk(TREE + "/" + folder):
            for name in files:
                if os.path.relpath(at + "/" + name, TREE) not in kept:
                    os.remove(at + "/" + name)
    shutil.copytree("build/unity", TREE + "/build/unity", dirs_exist_ok=True)
    make("build/tests/watch.so", *tests(), "BUILD=build")
    make("build/count/libhimc.a", "BUILD=build/count", "SANITIZE=--coverage", "CFLAGS=-O1")


def link_commands():
    """How each test is linked, as make says."""
    said = subprocess.run(["make", "-C", TREE, "-n", "V=1", "-W", "build/libhimc.a", *tests(), "BUILD=build"], check=True, capture_output=True, text=True).stdout
    lines = [shlex.split(line) for line in said.split("\n") if re.search(r" -o build/tests/test_\w+$", line)]
    return {os.path.basename(line[-1]): line for line in lines}


def link(commands, test, library, to, more=()):
    line = list(itertools.chain(*(library if word == "build/libhimc.a" else [word] for word in commands[test])))
    line[-1] = to
    subprocess.run(line + ["-Wl,-S", *QUICK, *more], check=True, cwd=TREE)


def folder_to_run(name):
    """A folder in which a test finds the repository, with a build folder of its own."""
    at = "%s/run/%s" % (OUT, name)
    shutil.rmtree(at, ignore_errors=True)
    os.makedirs(at + "/build/tests")
    for entry in os.listdir(TREE):
        if entry != "build":
            os.symlink(TREE + "/" + entry, at + "/" + entry)
    os.symlink(TREE + "/build/tests/watch.so", at + "/build/tests/watch.so")
    return at


def test_in(at, program, seconds, **more):
    return run([program], seconds, cwd=at, env=dict(os.environ, HIMC_BUILD="build", HIMC_SHARED=SHARED, **more))


def count_lines(commands, test):
    """Runs a test once with counters, in OUT/counted/TEST; returns its CPU time (s), None if it fails."""
    at, program = "%s/counted/%s" % (OUT, test), "%s/build/tests/%s" % (TREE, test)
    try:
        if os.path.getmtime(at + "/seconds") > max(os.path.getmtime(program), os.path.getmtime(TREE + "/build/libhimc.a")):
            return json.load(open(at + "/seconds"))
    except OSError:
        pass
    shutil.rmtree(at, ignore_errors=True)
    os.makedirs(at)
    link(commands, test, ["build/count/libhimc.a"], at + "/program", ["--coverage"])
    folder = folder_to_run(test)
    strip = str((TREE + "/build/count").count("/"))
    status, seconds = test_in(folder, at + "/program", 1200, GCOV_PREFIX=at, GCOV_PREFIX_STRIP=strip)
    shutil.rmtree(folder)
    os.remove(at + "/program")
    if status:
        print("left out: %s fails without a fault" % test)
    json.dump(None if status else seconds, open(at + "/seconds", "w"))
    return None if status else seconds


@functools.cache
def lines_run(test, path):
    """The lines of a source that a test runs."""
    data = "%s/counted/%s/lib/%s.gcda" % (OUT, test, path[len("lib/src/"):-2])
    notes = "%s/build/count/lib/%s.gcno" % (TREE, path[len("lib/src/"):-2])
    if not os.path.exists(data):
        return {}
    if not os.path.lexists(data[:-2] + "no"):
        os.symlink(notes, data[:-2] + "no")
    said = subprocess.run(["gcov", "-t", "-j", data], capture_output=True, cwd=TREE).stdout
    return {f["file"]: {line["line_number"] for line in f["lines"] if line["count"]} for f in json.loads(said or '{"files":[]}')["files"]}


@functools.cache
def sources_with(path):
    """The sources that a change of this file compiles anew."""
    if path.endswith(".c"):
        return [path]
    makes = glob.glob(TREE + "/build/lib/*/*.d")
    return sorted("lib/src/" + m[len(TREE + "/build/lib/"):-1] + "c" for m in makes
                  if re.search(r"[ /]%s\b" % re.escape(path), open(m).read()) and os.path.exists(TREE + "/lib/src/" + m[len(TREE + "/build/lib/"):-1] + "c"))


def tests_for(mutant, seconds):
    """The tests that run the changed lines, nearest by name and quickest first."""
    words = set(re.split(r"[_/.]", mutant.path[len("lib/src/"):]))
    first, last = mutant.lines
    chosen = []
    for test, usual in seconds.items():
        if usual is None:
            continue
        near = len(words & set(test.split("_")[1:]))
        sources = sources_with(mutant.path)
        if len(sources) <= 12:
            ran = set().union(*(lines_run(test, s).get(mutant.path, set()) for s in sources))
            here = any(line in ran for line in range(first - 2, last + 3))
            outside = mutant.text.split("\n")[first - 1][:1] not in (" ", "")  # a constant of the file
            if not here and not (outside and ran) and not near:
                continue
        chosen.append((usual / 8 ** near, test))
    return [test for _, test in sorted(chosen)]


def compile_one(source, text, overlay, to):
    """Compiles a source, its text given, without the debugger's lines, so that equal code is equal."""
    shutil.rmtree(OUT + "/source", ignore_errors=True)
    os.makedirs(OUT + "/source")
    with open(OUT + "/source/source.c", "w") as f:
        f.write(text)
    flags = ["-w", "-g0", "-iquote", overlay, "-I", os.path.dirname(source), "-c", OUT + "/source/source.c", "-o", to, "-MF", OUT + "/source/d"]
    return subprocess.run(shlex.split(os.environ["COMPILE"]) + flags, cwd=TREE, stderr=subprocess.DEVNULL).returncode == 0


def compile_mutant(mutant, to):
    """The mutated objects in the folder `to`; "unbuilt" or "same" if there is nothing to test."""
    overlay, sources, differs = to + "/include", sources_with(mutant.path), False
    os.makedirs(overlay + "/" + os.path.dirname(mutant.path[len("lib/src/"):]))
    if mutant.path.endswith(".h"):
        with open(overlay + mutant.path[len("lib/src"):], "w") as f:
            f.write(mutant.text)
    for source in sources:
        text = open(TREE + "/" + source).read()
        name = to + "/" + source.replace("/", "_")
        good = OUT + "/good/" + hashlib.sha256((source + text).encode()).hexdigest()
        if mutant.path.endswith(".h") or not os.path.exists(good):
            os.makedirs(OUT + "/good", exist_ok=True)
            compile_one(source, text, OUT + "/nothing", good)
        if not compile_one(source, text if mutant.path.endswith(".h") else mutant.text, overlay, name + ".o"):
            return "unbuilt"
        if open(good, "rb").read() == open(name + ".o", "rb").read():
            os.remove(name + ".o")
        else:
            differs = True
    return None if differs else "same"


def judge(mutant, folder, commands, seconds):
    """Runs tests until one fails. Returns the verdict, the test or what was not run, CPU seconds."""
    used, left = 0, tests_for(mutant, seconds)
    at = folder_to_run(os.path.basename(folder))
    verdict, by = "survived", "no test runs it" if not left else "%d tests" % len(left)
    for i, test in enumerate(left):
        if used > SECONDS:
            by = "%d tests, %d not run" % (i, len(left) - i)
            break
        link(commands, test, glob.glob(folder + "/*.o") + ["build/libhimc.a"], folder + "/" + test)
        allowed = SLOW * seconds[test] + GRACE
        status, spent = test_in(at, folder + "/" + test, allowed)
        used += spent
        os.remove(folder + "/" + test)
        if status:
            clean, spent = test_in(at, "%s/build/tests/%s" % (TREE, test), allowed)
            used += spent
            if clean == 0:
                verdict, by = "killed", test
                break
    shutil.rmtree(at)
    shutil.rmtree(folder)
    return verdict, by, used


def read_excused():
    """Reason by key."""
    lines = [line.rstrip("\n").split(" ## ", 1) for line in open(EXCUSED) if " ## " in line and line[0] != "#"]
    return dict(lines)


def check():
    bad = 0
    for key in read_excused():
        path, rest = key.split(": ", 1)
        old = rest.split(" ==> ")[0]
        if not os.path.exists(path) or old not in one_line(open(path).read()):
            print("%s: no longer there: %s" % (EXCUSED, key))
            bad = 1
    return bad


class Log:
    """Verdicts by key, kept in a file; survivors count only for the tests that they have survived."""
    def __init__(self, path):
        digest = hashlib.sha256()
        for name in sorted(glob.glob("tests/*/*.[ch]")):
            digest.update(open(name, "rb").read())
        self.tests, self.known = digest.hexdigest()[:12], {}
        if os.path.exists(path):
            for line in open(path):
                key, verdict, by, used, tests = line.rstrip("\n").split("\t")
                if verdict != "survived" or tests == self.tests:
                    self.known[key] = verdict, by, float(used)
                else:
                    self.known.pop(key, None)
        self.file = open(path, "a")

    def add(self, mutant, verdict, by, used):
        self.known[mutant.key] = verdict, by, used
        self.file.write("%s\t%s\t%s\t%.1f\t%s\n" % (mutant.key, verdict, by, used, self.tests))
        self.file.flush()


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(__doc__)
    if "--check" in sys.argv:
        return check()
    seed, count, only = os.environ.get("SEED") or "1", int(os.environ.get("COUNT") or 200), os.environ.get("ROOM")
    if only and only not in ROOMS:
        return "ROOM: %s, expected one of %s" % (only, " ".join(ROOMS))
    signal.signal(signal.SIGTERM, stop)
    signal.signal(signal.SIGINT, stop)
    copy_tree()
    excused, log, commands = read_excused(), Log("%s/%s.log" % (OUT, seed)), link_commands()
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        seconds = dict(zip(commands, pool.map(lambda test: count_lines(commands, test), commands)))
    os.chdir(TREE)
    rooms = [only] if only else ROOMS
    queues = {room: iter(mutants_of(room, seed)) for room in rooms}
    totals, spent = {"killed": 0, "excused": 0, "survived": 0}, []

    def tell(mutant, verdict, by, used):
        totals[verdict] += 1
        spent.append(used)
        print("%-8s %s:%d: %s: %s (%s, %.0f s)" % (verdict, mutant.path, mutant.lines[0], mutant.operator, mutant.key.split(": ", 1)[1], by, used), flush=True)

    def finish(futures):
        for future in futures:
            mutant, result = future.result()
            log.add(mutant, *result)
            tell(mutant, *result)

    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        running = set()
        drawn = 0
        for room in itertools.cycle(rooms):
            if drawn == count or not queues:
                break
            for mutant in queues.get(room, ()):
                known = log.known.get(mutant.key)
                if known and known[0] in ("unbuilt", "same"):
                    continue
                if mutant.key in excused:
                    tell(mutant, "excused", excused[mutant.key], 0)
                elif known:
                    tell(mutant, *known)
                else:
                    folder = "%s/objects/%d" % (OUT, drawn)
                    shutil.rmtree(folder, ignore_errors=True)
                    os.makedirs(folder)
                    nothing = compile_mutant(mutant, folder)
                    if nothing:
                        log.add(mutant, nothing, "-", 0)
                        continue
                    running.add(pool.submit(lambda m, f: (m, judge(m, f, commands, seconds)), mutant, folder))
                break
            else:
                queues.pop(room, None)
                continue
            drawn += 1
            finished = {f for f in running if f.done()}
            if len(running) > JOBS:
                finished |= concurrent.futures.wait(running, return_when=concurrent.futures.FIRST_COMPLETED).done
            running -= finished
            finish(finished)
        finish(running)
    tried = totals["killed"] + totals["survived"]
    share = totals["killed"] / tried if tried else 0
    print("seed %s, %.0f s of CPU a mutant" % (seed, sum(spent) / max(len(spent), 1)))
    print("%d killed, %d excused, %d survived, %.1f %%" % (totals["killed"], totals["excused"], totals["survived"], 100 * share))
    return share < LEAST


if __name__ == "__main__":
    sys.exit(main())
