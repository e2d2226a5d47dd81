"""MuJoCo's bare mj_step (Euler, 10 kHz, no contacts): our tree of 20 segments with 57 degrees of
freedom and a fixed pelvis, and dm_control's CMU humanoid. Processor time, best of nine runs (us).

PyPI: mujoco, dm_control. Prints `WHAT VALUE LABEL` a line; exit status 77 where it is missing."""
import subprocess
import sys
import time

try:
    import mujoco
except ImportError:
    print("mujoco: not installed (PyPI)", file=sys.stderr)
    sys.exit(77)

STEPS = 4000


def best(step, reset):
    spent = []
    for _ in range(9):
        reset()
        start = time.process_time()
        step()
        spent.append((time.process_time() - start) / STEPS * 1e6)
    return min(spent)


def measure(what, label, model):
    data = mujoco.MjData(model)
    us = best(lambda: mujoco.mj_step(model, data, STEPS), lambda: mujoco.mj_resetData(model, data))
    print(f"{what} {us:.3f} {label}, {model.nv} degrees of freedom", flush=True)


xml = subprocess.run(["build/bin/himc", "export", "-o", "-"], check=True, capture_output=True, text=True).stdout
measure("step_us", "MuJoCo mj_step, the same tree", mujoco.MjModel.from_xml_string(xml))
try:
    from dm_control.suite import humanoid_CMU
except ImportError:
    print("dm_control: not installed (PyPI)", file=sys.stderr)
    sys.exit(0)
xml, assets = humanoid_CMU.get_model_and_assets()
assets = {name: text.encode() if isinstance(text, str) else text for name, text in assets.items()}
measure("cmu_step_us", "MuJoCo mj_step, dm_control's CMU humanoid", mujoco.MjModel.from_xml_string(xml.decode(), assets))
