/// take_write.h: what the writers of takes share; private.
#ifndef HIMC_TAKE_WRITE_H
#define HIMC_TAKE_WRITE_H

#include "capture/take_data.h"

#include <stdio.h>

/// Points as floats of an Intel processor, in millimetres, z up.
bool himc_c3d_write(FILE *file, const himc_take *take, himc_error *error);

#endif
