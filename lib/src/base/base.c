/// base.c: errors are text for a person, written once, where the fault is found.
#include "himc/base.h"

#include "base/format.h"
#include "base/line.h"

#include <math.h>
#include <string.h>

bool himc_error_set(himc_error *error, const char *format, ...)
{
    if (!error)
        return false;
    va_list args;
    va_start(args, format);
    himc_line_print(error->text, sizeof error->text, format, args);
    va_end(args);
    return false;
}

bool himc_error_prefix(himc_error *error, const char *format, ...)
{
    if (!error)
        return false;
    char old[sizeof error->text];
    memcpy(old, error->text, sizeof old);
    va_list args;
    va_start(args, format);
    himc_line_print(error->text, sizeof error->text, format, args);
    va_end(args);
    size_t used = strlen(error->text);
    himc_format(error->text + used, sizeof error->text - used, ": %s", old);
    himc_line_clean(error->text); // a character may be cut in two
    return false;
}

bool himc_check_range(const char *name, double value, double low, double high, const char *unit,
                      himc_error *error)
{
    if (isfinite(value) && value >= low && value <= high)
        return true;
    const char *space = unit[0] ? " " : "";
    return himc_error_set(error, "%s: %g%s%s, expected %g .. %g%s%s", name, value, space, unit, low,
                          high, space, unit);
}

const char *himc_version(void)
{
    return HIMC_VERSION;
}
