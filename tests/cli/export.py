"""What `himc export` writes, against the skeleton of the library; with mujoco also against its mass matrix and its inverse dynamics."""

import ctypes
import glob
import math
import os
import random
import subprocess
import sys
import tempfile
from xml.etree import ElementTree

import report

try:
    import mujoco
    import numpy as np
except ImportError:
    mujoco = None

BUILD = os.environ["HIMC_BUILD"]
SEGMENTS, JOINTS = 20, 19
Vector, Quaternion = ctypes.c_double * 3, ctypes.c_double * 4


class Config(ctypes.Structure):
    _fields_ = [("size", ctypes.c_double * 2), ("anthropometry", ctypes.c_int), ("rest", ctypes.c_double * (7 + SEGMENTS))]


class Segment(ctypes.Structure):
    _fields_ = [("parent", ctypes.c_int), ("joint", ctypes.c_int)] + [(n, ctypes.c_double) for n in ("mass", "length", "radius")] + \
        [(n, Vector) for n in ("origin", "axis", "center", "inertia")]


class Skeleton(ctypes.Structure):
    _fields_ = [("segment", Segment * SEGMENTS), ("tip", Vector)] + [(n, ctypes.c_double) for n in ("mallet_radius", "height", "mass")]


class State(ctypes.Structure):
    _fields_ = [("orientation", Quaternion * SEGMENTS), ("rotation", ctypes.c_double * 9 * SEGMENTS), ("rest", Vector * (2 * SEGMENTS + 5))]


lib = ctypes.CDLL(os.path.abspath(glob.glob(os.path.join(BUILD, "libhimc.so.*.*"))[0]))
lib.himc_skeleton_default.restype = Config
lib.himc_segment_name.restype = lib.himc_joint_name.restype = ctypes.c_char_p
folder = tempfile.TemporaryDirectory(prefix="himc-export-")


def himc(*words):
    done = subprocess.run([os.path.join(BUILD, "bin/himc"), *words], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def path(name, text=None):
    where = os.path.join(folder.name, name)
    if text:
        with open(where, "w") as file:
            file.write(text)
    return where


def skeleton(height=1.75, mass=75):
    body, config = Skeleton(), lib.himc_skeleton_default()
    config.size[:] = height, mass
    assert lib.himc_skeleton_init(ctypes.byref(body), ctypes.byref(config), None)
    return body


def numbers(element, name):
    return [float(word) for word in element.get(name).split()]


def segments(root):
    return {b.get("name"): b for b in root.iter("body")}


def test_the_model_has_the_numbers_of_the_skeleton():
    root, body = ElementTree.fromstring(himc("export", "-o", "-")), skeleton()
    found, mass = segments(root), 0
    parents = {child: parent for parent in root.iter("body") for child in parent.findall("body")}
    assert len(found) == SEGMENTS
    for i, segment in enumerate(body.segment):
        element = found[lib.himc_segment_name(i).decode()]
        inertial, joint = element.find("inertial"), element.find("joint")
        assert numbers(element, "pos") == list(segment.origin) and numbers(inertial, "pos") == list(segment.center)
        inertia = numbers(inertial, "diaginertia")
        assert inertia == list(segment.inertia) and min(inertia) > 0 and 2 * max(inertia) <= sum(inertia)
        mass += float(inertial.get("mass"))
        if i == 0:
            assert joint is None and element.find("freejoint") is None
            continue
        assert joint.get("name") == lib.himc_joint_name(i - 1).decode() and joint.get("type") == "ball" and joint.get("pos") is None
        assert parents[element].get("name") == lib.himc_segment_name(segment.parent).decode()
    for hand in ("left", "right"):
        site = found[hand + "-stick"].find("site")
        assert site.get("name") == hand + "-tip" and numbers(site, "pos") == list(body.tip)
    assert abs(mass - 75.09) < 1e-12, mass


def test_player_and_drums_are_those_of_the_setup():
    setup = path("setup.txt", "stance seated;\nplayer 1.625 60;\ndrum near 29;\nnear place 0.5 0.4 0.8 0.2;\ndrum far;\nfar shape rectangle 0.5 0.4;\n")
    assert "freejoint" not in himc("export", setup, "--stance", "fixed", "-o", "-")
    himc("export", setup, "-o", path("setup.xml"))
    root = ElementTree.parse(path("setup.xml")).getroot()
    found, body = segments(root), skeleton(1.625, 60)
    assert found["pelvis"].find("freejoint").get("name") == "root" and len(numbers(root.find("keyframe/key"), "qpos")) == 7 + 4 * JOINTS
    assert abs(sum(float(i.get("mass")) for i in root.iter("inertial")) - 60.09) < 1e-9
    assert numbers(found["left-forearm"], "pos") == list(body.segment[6].origin)
    drums = {g.get("name"): g for g in root.find("worldbody").findall("geom") if g.get("name")}
    assert set(drums) == {"near", "far"} and drums["far"].get("type") == "box", drums
    ends, radius = numbers(drums["near"], "fromto"), float(drums["near"].get("size"))
    down = [b - a for a, b in zip(ends[:3], ends[3:])]
    assert ends[:3] == [0.5, 0.4, 0.8] and abs(radius - 29 * 0.0254 / 2) < 1e-5 and abs(math.hypot(*down) - radius) < 1e-5
    assert abs(down[2] / radius + math.cos(0.2)) < 1e-4 and down[0] > 0 and down[1] > 0


def model(*options):
    if not mujoco:
        raise report.Ignored("no python3 with mujoco")
    m = mujoco.MjModel.from_xml_string(himc("export", "-o", "-", *options))
    return m, mujoco.MjData(m)


def joint_ids(m):
    return [mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_JOINT, lib.himc_joint_name(j).decode()) for j in range(JOINTS)]


def test_the_mass_matrix_is_that_of_mujoco():
    m, d = model("--stance", "seated")
    body, state, ids, worst = skeleton(), State(), joint_ids(m), 0
    draw = random.Random(1)
    for _ in range(100):
        pose = (Quaternion * JOINTS)()
        d.qpos[:7] = [0, 0, 1, 1, 0, 0, 0]
        for j, at in enumerate(ids):
            q = np.array([draw.gauss(0, 1) for _ in range(4)])
            pose[j][:] = q / np.linalg.norm(q)
            d.qpos[m.jnt_qposadr[at]:][:4] = pose[j][:]
        lib.himc_pose_to_state(ctypes.byref(body), pose, None, ctypes.byref(state))
        turn, dof = np.zeros((3 * JOINTS, 3 * JOINTS)), np.zeros(3 * JOINTS, int)
        for j, at in enumerate(ids):  # rates of a ball joint are in the child's frame there, in the world's here
            turn[3 * j:3 * j + 3, 3 * j:3 * j + 3] = np.reshape(state.rotation[j + 1], (3, 3))
            dof[3 * j:3 * j + 3] = m.jnt_dofadr[at] + np.arange(3)
        ours = np.zeros_like(turn)
        torque = (Vector * JOINTS)()
        weights = None
        for k in range(-1, 3 * JOINTS):
            rates = (Vector * JOINTS)()
            if k >= 0:
                rates[k // 3][k % 3] = 1
            lib.himc_inverse_dynamics(ctypes.byref(body), ctypes.byref(state), rates, ctypes.c_bool(True), torque)
            now = np.array(torque).ravel()
            weights = now if k < 0 else weights
            if k >= 0:
                ours[:, k] = now - weights
        theirs = np.zeros((m.nv, m.nv))
        mujoco.mj_forward(m, d)
        mujoco.mj_fullM(m, d, theirs) if mujoco.__version__ >= "3.9" else mujoco.mj_fullM(m, theirs, d.qM)
        assert abs(theirs[0, 0] - 75.09) < 1e-9
        theirs = theirs[np.ix_(dof, dof)]
        worst = max(worst, np.abs(turn.T @ ours @ turn - theirs).max() / np.abs(theirs).max())
    assert worst < 1e-9, worst
    return f"within {worst:.1e} in 100 poses"


def test_the_wrench_of_the_pelvis_is_that_of_mujoco():
    m, d = model("--stance", "seated")
    score = path("piece.txt", "stroke 1 right accent f;\nstroke 2 left tenuto mf;\n")
    himc("render", score, "-o", path("piece.wav"), "--motion", path("piece.npz"), "--columns", "all", "--quiet",
         "--set", "rate physics 2000", "--set", "rate task 2000")
    rows, hips, worst = np.load(path("piece.npz")), list(skeleton().segment[0].origin), 0
    tips = rows["tips_m"]
    mujoco.mj_resetDataKeyframe(m, d, 0)
    mujoco.mj_forward(m, d)
    assert np.abs([d.site(hand + "-tip").xpos - tips[0, i] for i, hand in enumerate(("left", "right"))]).max() < 1e-6
    for k in range(0, len(tips), 20):
        d.qvel[:], d.qacc[:], d.qpos[:7] = 0, 0, [*hips, 1, 0, 0, 0]
        for j, at in enumerate(joint_ids(m)):
            d.qpos[m.jnt_qposadr[at]:][:4] = rows["quaternions"][k, j]
        mujoco.mj_kinematics(m, d)
        spin = np.zeros((SEGMENTS, 3))
        for j, at in enumerate(joint_ids(m)):
            rate, turn = rows["rates_rad_s"][k, j], d.xmat[m.jnt_bodyid[at]].reshape(3, 3)
            spin[j + 1] = spin[skeleton_parent[j + 1]] + rate
            d.qvel[m.jnt_dofadr[at]:][:3] = turn.T @ rate
            d.qacc[m.jnt_dofadr[at]:][:3] = turn.T @ (rows["accelerations_rad_s2"][k, j] - np.cross(spin[j + 1], rate))
        wanted = d.qacc.copy()
        mujoco.mj_inverse(m, d)
        assert (d.qacc == wanted).all()
        force = rows["tip_forces_n"][k]
        ours = np.r_[rows["root_force_n"][k] + force.sum(0), rows["root_moment_n_m"][k] + np.cross(tips[k] - hips, force).sum(0)]
        worst = max(worst, np.abs(d.qfrc_inverse[:6] - ours).max())
    assert worst < 0.5, worst
    return f"within {worst:.2g} N and N m"


skeleton_parent = [segment.parent for segment in skeleton().segment]

if __name__ == "__main__":
    code = report.run("tests/cli/export.py", [f for name, f in list(globals().items()) if name.startswith("test_")])
    folder.cleanup()
    sys.exit(code)
