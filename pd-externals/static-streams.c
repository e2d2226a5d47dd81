/* The console's streams for ODE, of which Pd's externals contain a copy.

Debian's static library is position independent but for these two names: code for a program may
take the address of a variable of the C library, code for a shared object may not. So the Makefile
renames them in its copy of the library to the ones below. */
#include <stdio.h>

FILE *himc_static_stdout, *himc_static_stderr;

__attribute__((constructor)) static void begin(void)
{
    himc_static_stdout = stdout;
    himc_static_stderr = stderr;
}
