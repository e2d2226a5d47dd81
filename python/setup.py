"""Builds the library and the program with the repository's Makefile, then the extension on the library."""
import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import setup

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
BUILD = os.environ.get("HIMC_BUILD", "build")

for terms in ("LICENSE", "LIBRARIES.txt"):  # named in pyproject.toml, so they go into the wheel
    shutil.copy2(ROOT / terms, HERE)

COMMANDS = {"bdist_wheel", "build", "build_ext", "editable_wheel", "install"}
if COMMANDS & set(sys.argv):  # not for a mere question about the package
    subprocess.check_call(["make", "-s", "-C", str(ROOT), "-j", str(os.cpu_count() or 1), f"BUILD={BUILD}",
                           f"{BUILD}/libhimc.a", f"{BUILD}/bin/himc"])
    program = HERE / "himc" / "bin" / "himc"
    program.parent.mkdir(exist_ok=True)
    shutil.copy2(ROOT / BUILD / "bin" / "himc", program)
    subprocess.call(["strip", str(program)])

setup(cffi_modules=["build_himc.py:ffi"])
