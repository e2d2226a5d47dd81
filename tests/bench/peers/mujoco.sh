#!/bin/sh
# MuJoCo's bare mj_step: mujoco-step.py with the Python of `make bench-peers`, or else the system's.
here=$(dirname "$0")
python=build/peers/bin/python
[ -x "$python" ] || python=python3
exec "$python" -W ignore "$here/mujoco-step.py"
