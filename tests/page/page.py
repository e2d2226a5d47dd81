"""The page that plays by itself, build/himc.html, opened as a file in a real Chromium.

No test depends on the speed of the machine: each waits for what must come.
"""

import json
import os
import shutil
import subprocess
import sys

sys.path.insert(0, "tests/viewer")
import report
from browser import Browser, Firefox

BUILD, MADE = os.environ["HIMC_BUILD"], os.environ["HIMC_MADE"]
PAGE = os.path.abspath(os.path.join(BUILD, "himc.html"))
LONG = bool(os.environ.get("HIMC_LONG"))
LARGEST = 1.5e6  # bytes of the page
# what the page tells, kept by START
START = """
window.heard = { strikes: [], told: [] };
const { studio } = viewer, on = studio.on.frame, event = on.event;
on.event = (e, time) => (e.event === "strike" && heard.strikes.push(e), event(e, time));
const tell = studio.tell.bind(studio);
studio.tell = (text, wrong) => (heard.told.push([text, !!wrong]), tell(text, wrong));
viewer.view.camera.layers.set(7); // without a graphics card a picture takes long, and most tests need none
"""
HASH = """
const names = arguments[0];
const source = himcScripts.get("worker.js") + arguments[1], files = [...himcFiles],
    worker = new Worker(URL.createObjectURL(new Blob([`${source}
onmessage = e => {
    const module = new WebAssembly.Module(e.data.wasm);
    postMessage(e.data.pieces.map(([name, bytes]) => hashOf(module, name, bytes)));
};`])));
return new Promise(done => {
    worker.onmessage = e => done(e.data);
    worker.onerror = e => done([{ line: e.message }]);
    const pieces = names.map(name => files.find(([n]) => n === name));
    worker.postMessage({ wasm: files[0][1], pieces });
});
"""
EDITS = """
const [name, code, edits] = arguments;
const source = [himcScripts.get("worker.js"), "onmessage = null;", himcScripts.get("workshop.js"), code].join("\\n"),
    files = [...himcFiles],
    worker = new Worker(URL.createObjectURL(new Blob([`${source}
onmessage = ({ data: [wasm, name, bytes, edits] }) => postMessage(editsOf(new WebAssembly.Module(wasm), name, bytes, edits, 7));`])));
return new Promise(done => {
    worker.onmessage = e => done(e.data);
    worker.onerror = e => done({ failed: e.message });
    worker.postMessage([files[0][1], name, files.find(([n]) => n === name)[1], edits]);
});
"""
DROP = """
const all = new DataTransfer();
for (const [name, letters] of arguments[0])
    all.items.add(new File([Uint8Array.from(atob(letters), c => c.charCodeAt(0))], name));
heard.strikes.length = 0;
heard.told.length = 0;
dispatchEvent(new DragEvent("drop", { dataTransfer: all, cancelable: true }));
"""
browser = None


def open_page(hash=""):
    """After an opening that fails, the tests that follow have a browser of their own."""
    global browser
    try:
        browser.open("about:blank")
        browser.open(f"file://{PAGE}{hash}")
    except (OSError, RuntimeError):
        browser.close()
        browser = type(browser)(800, 600)
        raise
    assert browser.wait("return !!(window.viewer && viewer.studio?.ready)"), browser.log()
    browser.run(START)


def tidy():
    """As each test finds it; where no page has opened there is no storage."""
    browser.run("if (location.protocol === 'file:') localStorage.clear()")


def click(name):
    browser.run(
        "const b = document.getElementById(arguments[0]);"
        "b.dispatchEvent(new PointerEvent('pointerdown', { bubbles: true })); b.click();",
        name,
    )


def drop(*files):
    import base64

    browser.run(DROP, [[name, base64.b64encode(bytes).decode()] for name, bytes in files])


def say(line):
    browser.run("heard.told.length = 0; viewer.studio.say(arguments[0])", line)


def told(seconds=60):
    """All lines, once there is one."""
    assert browser.wait("return heard.told.length", seconds), "no line"
    return browser.run("return heard.told")


def refused():
    """The one line of a refusal."""
    assert browser.wait("return heard.told.some(([, wrong]) => wrong)", 60), browser.run("return heard.told")
    wrong = [text for text, wrong in browser.run("return heard.told") if wrong]
    assert len(wrong) == 1 and "\n" not in wrong[0], wrong
    return wrong[0]


def strikes(count, seconds=60):
    assert browser.wait(f"return heard.strikes.length >= {count}", seconds), browser.run(
        "return [heard.strikes.length, heard.told]"
    )
    return browser.run("return heard.strikes")


def test_all_of_it_fits_into_one_small_file():
    size = os.path.getsize(PAGE)
    assert size < LARGEST, size
    return f"{size / 1e6:.2f} MB"


def test_it_opens_as_a_file_without_a_request_or_a_console_line():
    open_page()
    asked = browser.run(
        "return performance.getEntriesByType('resource').map(r => r.name.slice(0, 40))"
    )
    assert all(name.startswith(("blob:", "data:")) for name in asked), asked
    assert not browser.log(), browser.log()


def test_it_tells_nobody_to_send_it_a_performer():
    """Which the viewer's page does until one comes."""
    assert browser.run("document.body.classList.add('empty'); return getComputedStyle(document.getElementById('wait')).display") == "none"


def test_the_improvisation_is_that_of_the_program_bit_by_bit():
    pieces = ["improvisation.txt"]
    paths = ["patches/improvisation.txt"]
    if LONG:
        browser.be_patient(1500)
        for name in sorted(os.listdir("patches/pieces")):
            if name.endswith((".txt", ".mid")):
                pieces.append(name)
                paths.append("patches/pieces/" + name)
    with open("tests/page/hash.js") as file:
        got = browser.run(HASH, pieces, file.read())

    def native(program):
        return subprocess.run(
            [os.path.join(MADE, program), *paths], capture_output=True, text=True, check=True
        ).stdout.splitlines()

    usual = [line.split() for line in native("play")]
    for name, one, own in zip(pieces, got, usual, strict=True):
        samples, strikes, _, coarse = one["line"].split()
        assert [samples, strikes] == own[:2], (name, one, own)
        # docs/page.md: where the last bit of a libm grows
        assert coarse == own[3] or name in ("kit.txt", "grain.txt", "stations.txt"), (name, one, own)
    said = ", ".join(f"{name} {one['speed']:.1f} x" for name, one in zip(pieces, got))
    if not os.path.exists(os.path.join(MADE, "play-musl")):
        return f"{said}; floats not compared, without musl-tools"
    for name, one, line in zip(pieces, got, native("play-musl"), strict=True):
        assert one["line"] == line, (name, one, line)
    return said


def test_a_click_plays_the_improvisation():
    click("p-play")
    assert browser.wait(
        "const told = viewer.liveSound.nodes.get('page')?.told; return told?.playing && told.peak > 0.001"
    ), browser.run("return heard.told")
    strikes(3)
    assert browser.run("return viewer.joints()?.length") == 22
    assert browser.run("return document.getElementById('p-play').textContent").startswith("■")
    # the device plays what the Worker has made, and both have the same count
    waits = browser.run("return viewer.liveSound.nodes.get('page').told.waits")
    assert 0 <= waits < 0.4, waits
    click("p-play")
    assert browser.wait("return document.getElementById('p-play').textContent.startsWith('▶')")


def test_a_score_that_is_dropped_plays():
    score = b"drum low 29; drum high 23;\n" + b"".join(
        f"stroke {i / 2} {'right' if i % 2 else 'left'} legato f {'high' if i % 2 else 'low'};\n".encode()
        for i in range(6)
    )
    drop(("two.txt", score))
    got = strikes(6)
    assert [s["drum"] for s in got[:4]] == ["low", "high", "low", "high"], got
    assert browser.wait("return [...viewer.drums.values()].every(d => d.name !== 'kettle')"), "the old drum stays"
    assert browser.run("return [...document.getElementById('p-drum').options].map(o => o.value)") == ["low", "high"]


def test_what_plays_goes_on_while_another_piece_loads():
    browser.run("document.body.dispatchEvent(new PointerEvent('pointerdown', { bubbles: true }))")  # opens the device
    browser.run("heard.strikes.length = 0; viewer.studio.choose('improvisation.txt')")
    strikes(3)
    assert browser.wait("return viewer.liveSound.nodes.get('page')?.told?.playing")
    seen = browser.run(
        """
        const { studio } = viewer, seen = [];
        studio.choose("tide.txt");
        return new Promise(done => {
            const look = setInterval(() => {
                const { playing, played } = viewer.liveSound.nodes.get("page").told;
                if (studio.coming) return seen.push([studio.name, playing, played]);
                clearInterval(look);
                done(seen);
            }, 10);
        });
        """
    )
    assert all(name == "improvisation.txt" for name, _, _ in seen), seen
    assert seen[-1][2] > seen[0][2], seen
    assert browser.wait("return viewer.studio.name === 'tide.txt' && [...viewer.drums.values()].some(d => d.name === 'low')")
    return f"{(seen[-1][2] - seen[0][2]) / 48000:.2f} s of sound meanwhile"


def test_a_midi_file_that_is_dropped_plays():
    with open("patches/pieces/zarathustra.mid", "rb") as file:
        drop(("zarathustra.mid", file.read()))
    strikes(2)


def test_what_cannot_be_played_is_one_line_and_what_was_there_plays_on():
    cases = {
        "bad.txt": b"stroke 0 left legto f;",
        "page.html": b"<img src=x onerror=\"window.pwned = 1\">",
        "noise.mid": b"MThd\0\0\0\6\0\1\xff\xff\0\0",
        "empty.bvh": b"",
        "sound.wav": b"RIFF\0\0\0\0WAVE",
        '<b onclick="pwned=1">.txt': b"<script>window.pwned = 1</script>;",
        "deep.xml": b'<?xml version="1.0"?><!DOCTYPE a [<!ENTITY a "&a;&a;">]><score-partwise>&a;</score-partwise>',
    }
    for name, bytes in cases.items():
        drop((name, bytes))
        line = refused()
        assert len(line) < 400, (name, line)
    assert browser.run("return window.pwned") is None
    assert browser.run("return document.querySelectorAll('#p-said b, #p-said img, #p-said script').length") == 0
    say("info")
    assert any("drum third" in text for text, _ in told()), told()
    assert not browser.log(), browser.log()


def test_a_message_is_answered_as_in_pure_data():
    browser.run("viewer.studio.load('improvisation.txt')")
    assert browser.wait("return viewer.studio.name === 'improvisation.txt'")
    cases = {
        "hit left legto f": "hit: NUANCE: legto, expected legato tenuto accent vertical-accent staccato",
        "engine ode": "engine: ode: the Open Dynamics Engine is not built in here, expected tree",
        "kettle tune 5": "kettle: tune:",
        "subscribe 127.0.0.1 9000 pose": "subscribe: only as a message to [himc~] or over OSC",
        "score none.txt": "none.txt",
    }
    for line, why in cases.items():
        say(line)
        assert why in refused(), (line, refused())
    say("kettle info")
    assert len(told()) >= 1 and not any(wrong for _, wrong in told()), told()


def test_keys_and_presses_and_a_keyboard_are_hits():
    def hit(act):
        browser.run("heard.strikes.length = 0;" + act)
        return strikes(1)[0]

    key = "dispatchEvent(new KeyboardEvent('keydown', { key: '%s', bubbles: true }))"
    assert hit(f"document.body.{key % 'z'}")["hand"] == "left"
    assert hit(f"document.body.{key % 'x'}")["hand"] == "right"
    assert hit("viewer.studio.note([0x90, 60, 100])")["drum"] == "kettle"
    at = hit(
        """
        viewer.actions.camera("top"), viewer.view.settle();
        const drum = [...viewer.drums.values()][0], place = drum.tilted.localToWorld(drum.head.position.clone().set(-0.1, 0.08, 0)),
            p = place.project(viewer.view.camera);
        viewer.view.camera.updateMatrixWorld();
        document.getElementById("stage").dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0, pointerId: 1,
            clientX: ((p.x + 1) * innerWidth) / 2, clientY: ((1 - p.y) * innerHeight) / 2 }));
        """
    )
    assert abs(at["x"] + 0.1) < 0.03 and abs(at["y"] - 0.08) < 0.03, at


def test_a_link_carries_a_short_score():
    text = "drum only 26;\nstroke 0 left staccato mf; stroke 1 right staccato mf;\n"
    drop(("short.txt", text.encode()))
    strikes(2)
    click("p-link")
    assert browser.wait("return location.hash.startsWith('#s=')")
    hash = browser.run("return location.hash")
    open_page(hash)
    assert browser.run("return viewer.studio.name") == "link.txt"
    click("p-play")
    assert strikes(2)[0]["drum"] == "only"
    for wrong in ("#s=", "#s=%3Cscript%3E", "#s=AAAA" + "A" * 3000):
        open_page(wrong)
        assert browser.wait("return viewer.studio.said.some(s => s.text === 'this link holds no score')")
        assert not browser.log(), browser.log()


def test_a_text_that_is_changed_is_heard_and_a_reload_loses_nothing():
    open_page()
    browser.run("document.getElementById('p-piece').value = 'rudiments.txt'")
    browser.run("document.getElementById('p-piece').dispatchEvent(new Event('change'))")
    assert browser.wait("return viewer.studio.name === 'rudiments.txt'")
    text = "drum mine 28;\nstroke 0 left legato f;\nstroke 8 left legato f;\n"
    write = """
    const area = document.getElementById("p-text");
    area.value = arguments[0];
    area.dispatchEvent(new Event("input"));
    heard.strikes.length = 0;
    """
    browser.run(write, text)
    click("p-use")
    assert browser.wait("return heard.strikes.some(s => s.drum === 'mine')", 60), browser.run("return heard.told")
    browser.run(write, text + "stroke 1 right legto f;\n")
    click("p-use")
    assert "legto" in refused()
    open_page()  # with a text that cannot be played: it waits, and something plays
    assert browser.run("return document.getElementById('p-text').value").endswith("legto f;\n")
    assert "legto" in " ".join(one["text"] for one in browser.run("return viewer.studio.said"))
    browser.run(write, text)
    click("p-use")
    assert browser.wait("return heard.strikes.some(s => s.drum === 'mine')", 60), browser.run("return heard.told")
    open_page()
    assert browser.run("return document.getElementById('p-text').value") == text
    tidy()


def test_a_page_around_it_gives_commands_and_hears_the_answers():
    frame = os.path.join(MADE, "around.html")
    with open(frame, "w") as file:
        file.write(
            f"""<iframe id=f src="file://{PAGE}?embed" width=400 height=300></iframe>
            <script>said = []; onmessage = e => said.push(e.data.himc); tell = what =>
            document.getElementById("f").contentWindow.postMessage({{ himc: what }}, "*");</script>"""
        )
    browser.open(f"file://{os.path.abspath(frame)}")
    assert browser.wait("return said.length", 60)
    browser.run("tell({ name: 'one.txt', score: 'drum solo 26; stroke 0 left legato f;' })")
    assert browser.wait("return said.some(one => one.text.startsWith('one.txt'))", 60)
    browser.run("tell('solo tune nonsense')")
    assert browser.wait("return said.some(one => one.wrong && one.text.includes('tune'))", 60)


def test_a_piece_that_was_edited_sounds_as_its_text_from_the_start():
    """Bit by bit; and with all changes taken back as at first."""
    open_page()
    with open("tests/page/edits.js") as file:
        code = file.read()
    said = []
    if LONG:
        browser.be_patient(1500)
    for name, edits in [("improvisation.txt", 200), ("tide.txt", 40)] if LONG else [("improvisation.txt", 12)]:
        got = browser.run(EDITS, name, code, edits)
        assert "failed" not in got, got
        assert all(e["text"].startswith("nothing to ") for e in got["events"]), got["events"]
        assert got["first"] != got["edited"] and got["edited"] == got["fresh"] and got["reverted"] == got["first"], got
        took = got["took"]
        said.append(f"{name} {len(took)} edits, {took[len(took) // 2]} ms, {got['size']}")
    return ", ".join(said)


# opens the editor, and chooses a stroke
CHOSEN = """
const { piece } = viewer.editor;
viewer.playback.play(false);
viewer.editor.choose(piece.scene.strikes.find(s => s.beat === arguments[0]));
return viewer.editor.chosen.statement.words;
"""


def choose(beat):
    assert browser.wait(f"return viewer.editor.piece.scene.strikes.some(s => s.beat === {beat})")
    return browser.run(CHOSEN, beat)


def open_editor():
    if not browser.run("return viewer.studio.edits"):
        click("p-edit")
    assert browser.wait("return viewer.editor?.piece.sound?.arrived > 5"), browser.run("return heard.told")


def change(beat, dynamic):
    """Changes a stroke, and waits until it is heard."""
    choose(beat)
    browser.run("viewer.editor.heard.length = 0; viewer.editor.commit({ dynamic: arguments[0] })", dynamic)
    assert browser.wait("return viewer.editor.heard.length"), browser.run("return document.getElementById('note').textContent")
    return browser.run("return viewer.editor.chosen.statement.words")


def test_the_editor_in_the_page_changes_a_stroke_that_the_score_then_has():
    tidy()
    open_page()
    before = browser.run("return document.getElementById('p-text').value")
    open_editor()
    words = change(4, 0.91)
    assert " 0.91" in words, words
    click("e-undo")
    assert browser.wait("return viewer.editor.chosen.statement.words.includes(' mp')"), browser.run("return viewer.editor.chosen.statement.words")
    click("e-redo")
    assert browser.wait("return viewer.editor.chosen.statement.words.includes(' 0.91')")
    browser.run("return viewer.actions.live()")
    assert browser.wait("return document.getElementById('p-text').value.includes(' 0.91')")
    after = browser.run("return document.getElementById('p-text').value")
    changed = [pair for pair in zip(before.split(";"), after.split(";"), strict=True) if pair[0] != pair[1]]
    assert len(changed) == 1 and " ".join(changed[0][1].split()) == words, changed
    open_editor()  # and undo still goes back from there
    click("e-undo")
    assert browser.wait("return viewer.editor.piece.text.undo === 0")


def test_reload_second_tab_and_crash_lose_no_edit():
    tidy()
    open_page()
    open_editor()
    words = change(4, 0.83)
    open_page()
    open_editor()
    assert choose(4) == words
    # another tab takes over, with all that was changed
    first = browser.call("GET", browser.session + "/window")
    second = browser.call("POST", browser.session + "/window/new", {"type": "tab"})["handle"]
    browser.call("POST", browser.session + "/window", {"handle": second})
    open_page()
    open_editor()
    assert choose(4) == words
    other = change(6, 0.37)
    browser.call("POST", browser.session + "/window", {"handle": first})
    assert browser.wait("return document.getElementById('e-said').textContent.startsWith('Another page edits')")
    click("e-here")
    assert browser.wait("return viewer.editor.piece.text?.undo === 2 && viewer.editor.piece.sound?.arrived > 5")
    assert [choose(beat) for beat in (4, 6)] == [words, other]
    # the Worker ends while a change is on its way
    choose(2)
    browser.run("viewer.editor.commit({ dynamic: 0.29 }); setTimeout(() => viewer.editor.piece.socket.end(0), arguments[0])", 30)
    assert browser.wait("return document.getElementById('e-said').textContent.startsWith('The editor has stopped')")
    click("e-here")
    assert browser.wait("return viewer.editor.piece.text?.undo >= 2 && viewer.editor.piece.sound?.arrived > 5")
    assert [choose(beat) for beat in (4, 6)] == [words, other]
    browser.call("POST", browser.session + "/window", {"handle": second})
    browser.call("DELETE", browser.session + "/window")
    browser.call("POST", browser.session + "/window", {"handle": first})
    tidy()


TAB, ENTER, RIGHT = "\ue004", "\ue007", "\ue014"  # keys, as WebDriver has them


def press(*keys):
    down = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
    browser.call("POST", browser.session + "/actions", {"actions": [{"type": "key", "id": "keys", "actions": down}]})


def go_to(name):
    """By the tab key alone."""
    for _ in range(80):
        if browser.run("return document.activeElement.id") == name:
            return
        press(TAB)
    raise AssertionError(f"the tab key does not come to {name}")


def test_keys_alone_play_and_edit():
    browser.resize(1280, 720)
    open_page()
    go_to("p-play")
    press(ENTER)
    strikes(2)
    go_to("p-edit")
    press(ENTER)
    assert browser.wait("return viewer.editor?.piece.sound?.arrived > 5")
    go_to("pause")
    loud = "viewer.editor.piece.scene.strikes.find(s => s.beat === 6).time"  # mf: a key's step leaves that word, too
    browser.run(f"viewer.playback.play(false); viewer.playback.seek(1000 * {loud}); viewer.editor.heard.length = 0")
    go_to("timeline")
    press(ENTER)
    before = browser.run("return viewer.editor.chosen.statement.words")
    go_to("e-dynamic")
    press(RIGHT)
    assert browser.wait("return viewer.editor.heard.length"), browser.run("return document.getElementById('note').textContent")
    assert browser.run("return viewer.editor.chosen.statement.words") != before
    go_to("e-undo")
    press(ENTER)
    assert browser.wait("return viewer.editor.chosen.statement.words === arguments[0]".replace("arguments[0]", json.dumps(before)))
    go_to("live")
    press(ENTER)
    assert browser.wait("return !viewer.playback")
    browser.resize(800, 600)
    tidy()


# what of the inspector of a chosen stroke is not seen, or cut, or under something else
UNSEEN = """
const sheet = document.getElementById("edit").getBoundingClientRect(), found = [];
for (const e of document.querySelectorAll("#edit :is(button, input, select, output)")) {
    const { left, right, top, bottom, width } = e.getBoundingClientRect(), name = e.id || e.textContent;
    if (!width || e.closest("details")) continue;
    if (left < sheet.left || right > sheet.right || top < sheet.top || bottom > sheet.bottom) found.push(`${name} is beyond the sheet`);
    if (e.type === "number" && e.scrollWidth > e.clientWidth) found.push(`${name} is cut`);
    const over = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
    if (over !== e && !e.contains(over) && !over?.contains(e)) found.push(`${name} is under ${over?.id}`);
}
return found;
"""


def test_each_size_of_screen_shows_the_whole_inspector_of_a_stroke():
    try:
        for size in ((390, 844), (844, 390), (1280, 720)):
            browser.resize(*size)
            open_page()
            open_editor()
            choose(4)
            assert browser.wait("return document.getElementById('e-x').value")
            found = browser.run(UNSEEN)
            assert not found, (size, found)
    finally:
        browser.resize(800, 600)
        tidy()


ANSWER = """
const [last, log, sheet] = ["#p-said div:last-child", "#p-said", "#perform"].map(name => document.querySelector(name).getBoundingClientRect());
return last.height > 10 && [log, sheet].every(e => last.top >= e.top - 1 && last.bottom <= e.bottom + 1) && last.bottom <= innerHeight;
"""


def test_an_answer_is_seen_on_each_size_of_screen():
    open_page()
    assert browser.wait("return viewer.studio.ready")
    for size in ((360, 740), (740, 360), (1280, 800)):
        browser.resize(*size)
        say("tempo x")
        refused()
        assert browser.wait(ANSWER), (size, browser.run("return document.getElementById('p-said').textContent"))
    browser.resize(800, 600)
    tidy()


# serious and critical faults by axe-core's rules
FAULTS = """
document.querySelectorAll("details").forEach(d => (d.open = true));
return axe.run(document).then(({ violations }) => violations.filter(v => ["serious", "critical"].includes(v.impact))
    .map(v => `${v.help}: ${v.nodes.map(n => n.target.join(" ")).join(", ")}`));
"""


def test_axe_core_finds_no_serious_fault():
    """Playing, with the sheet of keys, and editing, on three sizes of screen in both colour schemes."""
    try:
        with open(os.path.join(BUILD, "axe", "axe.min.js")) as file:
            axe = file.read()
    except OSError:
        raise report.Ignored("make axe brings axe-core, from npm") from None
    found = {}

    def look(*where):
        browser.run(axe)
        if faults := browser.run(FAULTS):
            found[where] = faults

    try:
        for size in ((390, 844), (844, 390), (1280, 720)):
            for scheme in ("dark", "light"):
                browser.resize(*size)
                browser.media(prefers_color_scheme=scheme)
                open_page()
                look(size, scheme, "play")
                browser.run("document.body.classList.add('open', 'help')")
                look(size, scheme, "keys")
                browser.run("document.body.classList.remove('open', 'help')")
                open_editor()
                choose(4)
                look(size, scheme, "edit")
    finally:
        browser.resize(800, 600)
        browser.media()
        tidy()
    assert not found, found


# the colours of a drawing at places in the scene: his chest and the middle of a head
DRAWN = """
const [one] = viewer.performers.values(), [drum] = viewer.drums.values(), { view, stage } = viewer,
    at = [one.figure.place(1, [0, 0, 0.2]), drum.head.getWorldPosition(one.figure.place(1, [0, 0, 0]))];
viewer.held = true;
viewer.actions.camera("front"), view.settle(), viewer.step(1);
return at.map(p => {
    p.project(view.camera);
    const { width, height } = stage.renderer.domElement;
    return [...stage.renderer.pen.getImageData(((p.x + 1) * width) / 2, ((1 - p.y) * height) / 2, 1, 1).data].slice(0, 3);
});
"""


def test_firefox_plays_and_edits_without_webgl_too():
    """Without a graphics card it has no WebGL: a drawing takes the picture's place, and one line says so."""
    global browser
    if not shutil.which("firefox-esr"):
        raise report.Ignored("no Firefox")
    chromium, browser = browser, Firefox(800, 600)
    try:
        open_page()
        flat = browser.run("return viewer.stage.flat")
        said = browser.run("return viewer.studio.said.filter(s => s.text.includes('WebGL')).length")
        assert said == flat, said
        click("p-play")
        struck = [s["time"] for s in strikes(4)]
        assert struck == sorted(struck) and struck[0] < struck[3], struck
        if flat:
            shirt, head = browser.run(DRAWN)
            assert shirt[2] > shirt[0] + 20 and min(head) > 150, (shirt, head)  # blue; parchment
        browser.run("viewer.resume()")
        open_editor()
        words = change(4, 0.83)
        open_page()
        open_editor()
        assert choose(4) == words
    finally:
        browser.close()
        browser = chromium
    return "a drawing" if flat else "with WebGL"


# apart, by tests/page/test_page_seen.sh
SEEN = [
    test_keys_alone_play_and_edit,
    test_each_size_of_screen_shows_the_whole_inspector_of_a_stroke,
    test_axe_core_finds_no_serious_fault,
    test_firefox_plays_and_edits_without_webgl_too,
]

if __name__ == "__main__":
    browser = Browser(800, 600)
    try:
        words = [w for w in sys.argv[1:] if w != "seen"]
        mine = SEEN if "seen" in sys.argv[1:] else [f for name, f in list(globals().items()) if name.startswith("test_")]
        tests = [f for f in mine if all(w in f.__name__ for w in words) and (words or mine is SEEN or f not in SEEN)]
        code = report.run("tests/page/page.py", tests)
    finally:
        browser.close()
    sys.exit(code)
