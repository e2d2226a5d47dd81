/// c3d_parameters.h: the parameter section of a C3D file, and numbers of its three processors;
/// for c3d.c.
#ifndef HIMC_C3D_PARAMETERS_H
#define HIMC_C3D_PARAMETERS_H

#include "himc/base.h"

typedef enum c3d_processor { C3D_INTEL = 84, C3D_DEC = 85, C3D_MIPS = 86 } c3d_processor;

unsigned himc_c3d_word(c3d_processor processor, const unsigned char *at); ///< 16 bits, unsigned
int himc_c3d_integer(c3d_processor processor, const unsigned char *at);   ///< 16 bits, signed
double himc_c3d_real(c3d_processor processor,
                     const unsigned char *at); ///< 32 bits; NaN where reserved

typedef struct c3d_parameter {
    int group;
    char name[24];             ///< upper case, cut to 23 letters
    int type;                  ///< bytes of an element: -1 characters, 1, 2, 4 (real)
    int dimensions;            ///< 0 .. 7
    unsigned char size[7];     ///< of each dimension, the first runs fastest
    int count;                 ///< elements: product of sizes, 1 without dimensions
    const unsigned char *data; ///< into the file's bytes, count x |type| of them
} c3d_parameter;

#define C3D_BLOCK 512  ///< by the format (bytes)
#define C3D_GROUPS 128 ///< most, by the format

typedef struct c3d_parameters {
    c3d_processor processor;
    char groups[C3D_GROUPS][24]; ///< names by number, "" if there is none
    c3d_parameter *list;         ///< owned
    int count;
} c3d_parameters;

/// Reads the section that begins at `offset`; parameters point into `bytes`. False with the reason,
/// without file name.
bool himc_c3d_parameters_read(c3d_parameters *p, const unsigned char *bytes, size_t size,
                              size_t offset, himc_error *error);
void himc_c3d_parameters_free(c3d_parameters *p);
/// NULL if there is none.
const c3d_parameter *himc_c3d_find(const c3d_parameters *p, const char *group, const char *name);
/// Element as a number, whatever its type (2-byte integers unsigned); `fallback` where there is
/// none.
double himc_c3d_number(const c3d_parameters *p, const c3d_parameter *parameter, int index,
                       double fallback);
/// String `index` of a table of characters: its start and length; false if there is none.
bool himc_c3d_string(const c3d_parameter *parameter, int index, const char **text, size_t *length);

#endif
