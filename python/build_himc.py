"""The extension himc._himc: the declarations that the package uses, checked against the library's headers by the compiler."""
import os
from pathlib import Path

from cffi import FFI

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
BUILD = ROOT / os.environ.get("HIMC_BUILD", "build")

ffi = FFI()
ffi.cdef((HERE / "himc" / "declarations.h").read_text())
ffi.set_source(
    "himc._himc",
    (HERE / "himc" / "session.c").read_text(),
    include_dirs=[str(ROOT / "lib"), str(ROOT / "lib" / "src")],
    extra_objects=[str(BUILD / "libhimc.a")],
    depends=[str(BUILD / "libhimc.a")],  # linked anew when the library is
    libraries=["ode", "expat", "z", "stdc++", "pthread", "m"],
    extra_compile_args=["-std=gnu17", "-O2"],
)

if __name__ == "__main__":
    ffi.compile(verbose=True)
