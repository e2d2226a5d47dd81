"""What the viewer draws: measured in the scene, and where it is on the screen."""

import math
import os
import subprocess
import sys

import report
from bridge import Viewer
from browser import Browser
from scene import Scene

BUILD, MADE = os.environ["HIMC_BUILD"], os.environ["HIMC_MADE"]  # by prepare.sh
PLAY, FOUR, COMPARED, SEATED, PEDAL, STANDING = (
    os.path.join(MADE, f"{f}.himc") for f in ("play", "four", "compared", "seated", "pedal", "standing")
)
RESTS, PUSHED, LANDED = 4.5, 2.73, 2.98  # times in tests/viewer/seated.txt (s): his seat is left at the second
WEIGHT = 736.4  # (N)
WIDTH, HEIGHT = 1280, 720
STICKS = range(10, 12)  # of the segments
browser = bridge = None

# vertices of a mesh in the scene, a skinned one as its bones have it
VERTICES = """
const [first] = viewer.performers.values(), { figure } = first, make = () => figure.scale.clone();
function vertices(mesh) {
    const { position, skinIndex, skinWeight } = mesh.geometry.attributes, out = [];
    figure.skeleton.update();
    mesh.updateWorldMatrix(true, false);
    for (let i = 0; i < position.count; i++) {
        const at = make().fromBufferAttribute(position, i), sum = make().set(0, 0, 0);
        if (!skinIndex) { out.push(at.applyMatrix4(mesh.matrixWorld)); continue; }
        for (let k = 0; k < 4; k++) {
            const bone = skinIndex.array[4 * i + k], weight = skinWeight.array[4 * i + k],
                m = mesh.matrixWorld.clone().fromArray(figure.skeleton.boneMatrices, 16 * bone);
            if (weight) sum.addScaledVector(at.clone().applyMatrix4(m), weight);
        }
        out.push(sum);
    }
    return out;
}
const body = figure.group.children.find(c => c.isSkinnedMesh);
"""


def show(scene, seconds):
    """The viewer plays that scene, and stands at that time."""
    global bridge
    if bridge:
        bridge.__exit__(None)
    bridge = Viewer("--play", scene)
    browser.open(f"http://127.0.0.1:{bridge.http}/")
    assert browser.wait("return !!window.viewer?.ready"), browser.log()
    browser.run(
        "viewer.held = true; viewer.playback.play(false); viewer.playback.seek(1000 * arguments[0]);"
        "viewer.step(1, false); viewer.step(1, false)",
        seconds,
    )


def on_screen(camera, what):
    """Where points are, from the left and the top (pixels), seen by that camera."""
    return browser.run(
        f"""
        viewer.actions.camera(arguments[0]); viewer.view.settle(); viewer.step(1, false);
        viewer.view.settle(), viewer.step(1, false);
        const {{ camera }} = viewer.view;
        camera.updateMatrixWorld();
        const points = {what};
        return points.map(p => p.project(camera)).map(p => [(1 + p.x) / 2 * innerWidth, (1 - p.y) / 2 * innerHeight]);
        """,
        camera,
    )


def test_he_sits_on_the_seat_which_stands_on_the_floor():
    show(PLAY, 20)
    gap, sunk, post, top = browser.run(
        VERTICES
        + """
        const { stool } = first, high = stool.cushion.position.z, { x, y } = stool.position,
            on = vertices(body).filter(p => Math.hypot(p.x - x, p.y - y) < 0.1 && p.z < high + 0.2),
            least = Math.min(...on.map(p => p.z)), column = vertices(stool.post).map(p => p.z);
        return [least - high, high - least, Math.min(...column), high - Math.max(...column)];
        """
    )
    assert -0.012 < gap < 0.004, gap
    assert post < 0.05 and 0 <= top < 0.068, (post, top)
    return f"{1000 * sunk:.0f} mm into the cushion"


def test_the_drum_stands_and_its_hoop_is_below_its_head():
    low, above, hub = browser.run(
        VERTICES
        + """
        const [drum] = viewer.drums.values(), [, , z, , a] = drum.place, legs = vertices(drum.legs),
            trim = vertices(drum.trim).filter(p => Math.hypot(p.x - drum.place[0], p.y - drum.place[1]) < 1.05 * a);
        const inner = legs.filter(p => Math.hypot(p.x - drum.place[0], p.y - drum.place[1]) < 0.02);
        return [Math.min(...legs.map(p => p.z)), Math.max(...trim.map(p => p.z)) - z, Math.min(...inner.map(p => p.z))];
        """
    )
    assert abs(low) < 0.002 and above < -0.005 and hub < 0.1, (low, above, hub)
    return f"hoop {-1000 * above:.0f} mm below the head"


def test_thumb_and_fingers_stay_on_the_stick():
    """As far from the stick's axis as flesh on wood, at all times, also as the stick turns."""
    worst = 0
    for seconds in (5, 12.5, 20.1, 20.3, 25.9):
        browser.run("viewer.playback.seek(1000 * arguments[0]); viewer.step(1, false)", seconds)
        for thumb, fingers in browser.run(
            VERTICES
            + """
            const all = vertices(body);
            return arguments[0].map((bone, right) => {
                const back = figure.bones[bone].matrixWorld.clone().getInverse(figure.bones[bone].matrixWorld),
                    near = all.map(p => p.clone().applyMatrix4(back)).filter(p => Math.abs(p.z) < 0.035),
                    out = right ? -1 : 1,
                    least = list => Math.min(...list.map(p => Math.hypot(p.x, p.y)));
                return [least(near.filter(p => out * p.y < 0 && p.z < 0)), least(near.filter(p => out * p.y > 0 && p.x < 0))];
            });
            """,
            list(STICKS),
        ):
            worst = max(worst, thumb, fingers)
            assert 0.003 < thumb < 0.011 and 0.003 < fingers < 0.011, (seconds, thumb, fingers)
    return f"at most {1000 * worst:.1f} mm from its axis"


def test_his_eyes_look_at_the_next_stroke():
    show(FOUR, 0)
    worst = 0
    for strike in browser.run("return viewer.playback.scene.strikes.map(s => s.time)"):
        off = browser.run(
            VERTICES
            + """
            viewer.playback.seek(1000 * arguments[0] - 150), viewer.step(1, false);
            const eye = figure.eyes[0], at = make().setFromMatrixPosition(eye.matrixWorld),
                to = figure.look.clone().sub(at).normalize(),
                front = make().set(1, 0, 0).transformDirection(eye.matrixWorld),
                head = make().set(1, 0, 0).transformDirection(figure.bones[3].matrixWorld);
            return [front.angleTo(to), head.angleTo(to)];
            """,
            strike,
        )
        # as near as eyes turn, and never farther than the head
        assert off[0] < max(0.01, off[1] - 0.3), off
        worst = max(worst, off[0])
    return f"within {worst:.2f} rad of it"


def test_four_drums_leave_the_player_large_and_are_all_seen():
    said = []
    for camera in ("stage", "front", "side"):
        feet, head = on_screen(camera, "[[0, 0, 0], [0, 0, 1.5]].map(p => viewer.view.now.target.clone().set(...p))")
        said.append((feet[1] - head[1]) / HEIGHT)
        assert said[-1] > 0.6 and head[1] > 0, (camera, feet, head)
    edges = on_screen(
        "top",
        "[...viewer.drums.values()].flatMap(({ place: [x, y, z, , a] }) =>"
        " [[a, 0], [-a, 0], [0, a], [0, -a]].map(([u, v]) => viewer.view.now.target.clone().set(x + u, y + v, z)))",
    )
    across, down = ([p[k] for p in edges] for k in (0, 1))
    assert min(across) > 0 and max(across) < WIDTH and min(down) > 0, edges
    wide = (max(across) - min(across)) / WIDTH
    assert wide > 0.6 and max(down) < HEIGHT, (wide, edges)
    return ", ".join(f"{v:.2f}" for v in said) + f" of the height; drums {wide:.2f} of the width"


def test_performers_side_by_side_have_drums_and_no_button_on_them():
    himc = os.path.join(BUILD, "bin/himc")
    take = os.path.join(MADE, "take.bvh")
    with open(os.path.join(MADE, "short.txt"), "w") as file:
        file.write(f"record {take};\ntempo 120;\n" + "".join(f"stroke {1 + i} right legato f normal;\n" for i in range(4)))
    subprocess.run([himc, "render", file.name, "-o", f"{MADE}/short.wav", "--quiet"], check=True, stdout=subprocess.DEVNULL)
    command = [himc, "render", take, "-o", f"{MADE}/take.wav", "--scene", COMPARED, "--quiet"]
    subprocess.run([*command, "--compare", "ik,id,captured"], check=True, stdout=subprocess.DEVNULL)
    show(COMPARED, 2)
    browser.run("viewer.actions.compare('side')")
    at = on_screen(
        "front", "[...viewer.performers.values()].filter(p => p.group.visible).flatMap(p => [3, 0].map(i => p.points()[i]))"
    )
    assert len(at) == 8, at
    lowest = browser.run("return Math.max(...[...document.querySelectorAll('nav button')].map(b => b.getBoundingClientRect().bottom))")
    assert all(0 < x < WIDTH and lowest < y < HEIGHT for x, y in at), (at, lowest)
    owned = browser.run("return [...viewer.performers.keys()].map(k => [...viewer.drums.values()].filter(d => d.key === k && d.group.visible).length)")
    assert owned == [1, 1, 1, 1], owned
    return f"heads from {min(y for _, y in at):.0f} pixels on, buttons to {lowest:.0f}"


def test_help_is_whole_and_a_light_page_is_light():
    browser.run("document.getElementById('help').click()")
    bottom, whole = browser.run(
        "const keys = document.getElementById('keys'); return [keys.getBoundingClientRect().bottom,"
        " keys.scrollHeight <= keys.clientHeight]"
    )
    assert bottom <= HEIGHT and whole, (bottom, whole)
    colors = {}
    for scheme in ("light", "dark"):
        browser.media(prefers_color_scheme=scheme)
        colors[scheme] = browser.run(
            "const s = getComputedStyle(document.getElementById('keys'));"
            "return [s.backgroundColor, s.color].map(c => c.match(/[0-9]+/g).slice(0, 3).reduce((a, b) => a + +b, 0))"
        )
    assert colors["light"][0] > 600 > 300 > colors["light"][1], colors
    assert colors["dark"][0] < 300 < 600 < colors["dark"][1], colors
    # with the system's own colours a pressed button is still another than one that is not
    browser.media(forced_colors="active")
    pressed, other = browser.run(
        "return ['true', 'false'].map(v => getComputedStyle(document.querySelector(`nav [aria-pressed=${v}]`)).backgroundColor)"
    )
    assert pressed != other, pressed
    browser.media()


# the arrows of seat and feet: [length, how far it goes up, number written, where it begins]; and the ring
SUPPORTS = """
const [first] = viewer.performers.values(), { group, arrows, center } = first.supports;
if (arguments.length) viewer.playback.seek(1000 * arguments[0]);
viewer.step(1, false);
group.updateMatrixWorld(true);
const make = () => first.figure.scale.clone(), seen = [];
for (const { group: arrow, shaft, written } of arrows) {
    const [from, to] = [make().set(0, 0, shaft.position.z + shaft.scale.z / 2), make().set(0, 0, 0)].map(p => p.applyMatrix4(arrow.matrixWorld)),
        way = to.clone().sub(from), on = group.visible && arrow.visible;
    seen.push(on ? [way.length(), way.z, parseFloat(written), from.toArray()] : null);
}
return { seen, ring: group.visible && center.getWorldPosition(make()).toArray(), pelvis: viewer.joints()[0],
    stool: [...first.stool.position.toArray(), first.stool.cushion.position.z], feet: [16, 17].map(i => viewer.joints()[i]) };
"""


def test_forces_of_seat_and_feet_are_arrows_where_he_sits_freely():
    show(PLAY, 5)
    browser.run("viewer.actions.show('forces', true)")
    fixed = browser.run(SUPPORTS)
    assert not any(fixed["seen"]) and not fixed["ring"], fixed
    show(SEATED, RESTS)
    unasked = browser.run(SUPPORTS)
    assert not any(unasked["seen"]) and not unasked["ring"], unasked
    browser.run("viewer.actions.show('forces', true)")
    rest = browser.run(SUPPORTS)
    seat, left, right = rest["seen"]
    # at rest they carry the weight together, the seat most of it
    scale = seat[0] / seat[2]
    up = sum(arrow[1] for arrow in rest["seen"]) / scale
    assert abs(up - WEIGHT) < 0.01 * WEIGHT, up
    assert seat[0] > 3 * max(left[0], right[0]) and min(seat[1], left[1], right[1]) > 0, rest
    # each begins where he is pressed
    assert abs(seat[3][2] - rest["stool"][3]) < 0.001 and max(left[3][2], right[3][2]) < 0.001, rest
    for foot, arrow in zip(rest["feet"], (left, right)):
        assert math.dist(foot[:2], arrow[3][:2]) < 0.08, (foot, arrow)
    # the centre of pressure is on the floor, where the arrows balance
    weights = [arrow[1] for arrow in rest["seen"]]
    for k in (0, 1):
        there = sum(w * arrow[3][k] for w, arrow in zip(weights, rest["seen"])) / sum(weights)
        assert abs(rest["ring"][k] - there) < 0.08, (k, rest["ring"], there)
    assert abs(rest["ring"][2]) < 0.01
    # a larger force is a longer arrow, to the same scale
    arrows = [(a[2], a[0]) for t in (1.2, PUSHED, LANDED, RESTS) for a in browser.run(SUPPORTS, t)["seen"] if a]
    assert len(arrows) > 8 and all(abs(length - scale * newtons) < 1e-4 for newtons, length in arrows), arrows
    return f"{up:.1f} N of {WEIGHT} N; {1000 * scale:.2f} mm/N"


def test_a_push_moves_pelvis_and_legs_and_no_stool():
    with open(SEATED, "rb") as file:
        scene = Scene(file.read())
    names = [name for name, _ in scene.of("scene")[0]["columns"]]
    at = [1 + names.index(f"pelvis_position_{axis}_m") for axis in "xyz"]
    rest, pushed = (browser.run(SUPPORTS, t) for t in (RESTS, PUSHED))
    row = min(scene.rows, key=lambda r: abs(r[0] - PUSHED))
    assert math.dist(pushed["pelvis"], [row[k] for k in at]) < 0.002, (pushed["pelvis"], row[:1])
    moved = math.dist(rest["pelvis"], pushed["pelvis"])
    assert moved > 0.01 and rest["stool"] == pushed["stool"], (moved, rest["stool"], pushed["stool"])
    # his seat carries less than his feet while he is thrown forwards
    forces = [arrow[2] if arrow else 0 for arrow in pushed["seen"]]
    assert forces[0] < 200 < forces[1] + forces[2], forces
    return f"{1000 * moved:.0f} mm"


def test_the_foot_is_on_the_pedal_that_turns():
    under = """
        viewer.playback.seek(1000 * arguments[0]);
        viewer.step(1, false), viewer.step(1, false);
        const [drum] = viewer.drums.values(), [first] = viewer.performers.values(), make = () => first.figure.scale.clone(),
            [, foot] = first.feet(), ball = make().set(0.13, 0, -0.075).applyMatrix4(foot);
        drum.pedal.updateWorldMatrix(true, false);
        const world = drum.pedal.matrixWorld,
            plate = ball.clone().applyMatrix4(world.clone().getInverse(world));
        return [drum.pedal.rotation.y, plate.x, plate.y, plate.z];
        """
    show(PEDAL, 0.1)
    _, *away = browser.run(under, 0.5)
    before, *at = browser.run(under, 2.05)
    after, *then = browser.run(under, 3.0)
    assert math.hypot(*away) > 0.2, away
    for x, y, z in (at, then):
        assert -0.22 < x < -0.15 and abs(y) < 0.03 and abs(z) < 0.01, (x, y, z)
    assert before - after > 0.05, (before, after)
    return f"its end goes down by {205 * (before - after):.0f} mm"


def test_lanes_of_seat_and_feet_are_those_of_one_who_sits_freely():
    lanes = "if (!viewer.panel.timeline.all) viewer.actions.lanes(); return viewer.panel.timeline.shown.map(l => l.name)"
    shown = browser.run(lanes)
    assert shown[-2:] == ["support", "friction"], shown
    forces = browser.run(
        "const { scene } = viewer.playback, row = scene.at(arguments[0])[0]; return scene.carried().up.map(all => all[row])", RESTS
    )
    assert abs(sum(forces) - WEIGHT) < 0.01 * WEIGHT, forces
    # each has its colour, in a window as on a phone that lies on its side there is no room
    drawn = browser.run(
        """
        viewer.step(1, false);
        const { lanes, shown } = viewer.panel.timeline, sum = shown.reduce((all, { share }) => all + share, 0),
            top = shown.slice(0, -2).reduce((all, { share }) => all + share, 0) / sum, c = lanes.getContext("2d"),
            part = c.getImageData(0, Math.ceil(top * lanes.height), lanes.width - 220, Math.floor((1 - top) * lanes.height) - 1).data, found = [0, 0, 0];
        for (let i = 0; i < part.length; i += 4)
            [[242, 227, 189], [127, 214, 255], [255, 176, 102]].forEach((rgb, k) => (found[k] += part[i + 3] > 200 && rgb.every((v, n) => Math.abs(v - part[i + n]) < 12)));
        return found;
        """
    )
    assert min(drawn) > 30, drawn
    browser.resize(844, 390)
    phone = browser.run(lanes)
    browser.resize(WIDTH, HEIGHT)
    assert "support" not in phone and "friction" not in phone, phone
    show(PLAY, 5)
    assert browser.run(lanes)[-1] == "spectrum"
    return f"{drawn} pixels"


def test_who_stands_is_seen_to_his_crown():
    show(STANDING, 0.1)
    seen = []
    for camera in ("stage", "front", "side"):
        head, floor = on_screen(camera, "[0.2, -1.6].map(up => { const [p] = viewer.performers.values(), v = p.points()[3].clone();"
                                        " v.z += up; return v; })")
        seen.append(head[1])
        assert 0 < head[1] < 0.15 * HEIGHT and floor[1] < HEIGHT, (camera, head, floor)
    return ", ".join(f"{y:.0f}" for y in seen) + " pixels over his crown"


def test_a_scene_is_kept_in_few_bytes():
    show(PLAY, 1)
    kept, plain, decoded = browser.run(
        """
        const { scene } = viewer.playback, columns = scene.head.columns.length;
        return [scene.blocks.reduce((sum, b) => sum + b.packed.length + b.width.length, 0),
            4 * columns * scene.times.length, scene.blocks.filter(b => b.values.size).length];
        """
    )
    assert kept < 0.45 * plain and decoded <= 24, (kept, plain, decoded)
    # a block that is cut keeps what is before, and no more
    cut = browser.run(
        """
        const { scene } = viewer.playback, value = row => scene.value(row, "left_force_n");
        const row = scene.blocks[2].first + 7, before = value(row - 1);
        scene.cut(scene.times[row]);
        return [scene.blocks.length, scene.blocks[2].count, value(row - 1) === before];
        """
    )
    assert cut == [3, 7, True], cut
    show(SEATED, 1)
    whole, seconds = browser.run(
        """
        const { scene } = viewer.playback, chunks = new Set([...scene.drums.values()].flatMap(d => d.frames.chunks)),
            size = list => list.reduce((sum, part) => sum + part.length, 0), times = scene.times.length;
        return [scene.blocks.reduce((sum, b) => sum + b.packed.length + b.width.length, 0) + size([...chunks]) + size(scene.sounds) + 16 * times, scene.end];
        """
    )
    half_an_hour = whole / seconds * 1800
    assert half_an_hour < 200e6, half_an_hour
    return f"{100 * kept / plain:.0f} % of plain integers; half an hour of one who sits freely {half_an_hour / 1e6:.0f} MB"


if __name__ == "__main__":
    browser = Browser(WIDTH, HEIGHT)
    try:
        browser.resize(WIDTH, HEIGHT)
        code = report.run("tests/viewer/look.py", [f for name, f in list(globals().items()) if name.startswith("test_")])
        if bridge:
            bridge.__exit__(None)
    finally:
        browser.close()
    sys.exit(code)
