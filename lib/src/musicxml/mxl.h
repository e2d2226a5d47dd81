/// mxl.h: the score inside a compressed MusicXML file.
#ifndef HIMC_MUSICXML_MXL_H
#define HIMC_MUSICXML_MXL_H

#include "himc/base.h"

bool himc_mxl_is_file(const void *bytes, size_t size);

/// The bytes of the score that the archive's META-INF/container.xml names, else of its first .xml
/// or .musicxml; of at most `most` bytes. NULL with one line if there is none, or the archive is
/// damaged. The caller frees them.
char *himc_mxl_score(const void *bytes, size_t size, size_t most, size_t *length,
                     himc_error *error);

#endif
