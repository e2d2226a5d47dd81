/// lesson_fault.c: the list of faults, the largest first.
///
/// A difference is a fault if it is beyond the threshold with its 99 % bound (single strokes: with
/// 4 standard deviations); `excess` is the difference less that bound, over the threshold.
#include "lesson.h"

#include "base/format.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

#define ENTRY 40 // characters of an entry, at most
#define MORE 16  // of " and 12345 more"

lesson_fault *lesson_fault_add(lesson *l, const char *kind, double effect, double u, double bound,
                               double threshold)
{
    double excess = (fabs(effect) - bound * u) / threshold;
    bool full = l->faults == LESSON_FAULTS;
    if (!(excess >= 1) || (full && l->fault[LESSON_FAULTS - 1].excess >= excess))
        return NULL;
    int k = full ? LESSON_FAULTS - 1 : l->faults++; // the smallest goes
    for (; k > 0 && l->fault[k - 1].excess < excess; k--)
        l->fault[k] = l->fault[k - 1];
    l->fault[k] = (lesson_fault){
        .effect = effect, .u = u, .threshold = threshold, .excess = excess, .unit = ""};
    snprintf(l->fault[k].kind, sizeof l->fault[k].kind, "%s", kind);
    return &l->fault[k];
}

void lesson_fault_explain(lesson_fault *f, double spread_, const char *unit, const char *source)
{
    f->spread = spread_, f->unit = unit, f->source = source;
}

void lesson_list_add(lesson_list *list, const char *format, ...)
{
    size_t used = strlen(list->text);
    list->count++;
    if (used + ENTRY + MORE > sizeof list->text)
        return;
    va_list values;
    va_start(values, format);
    if (list->listed++)
        used += (size_t)snprintf(list->text + used, 3, ", ");
    vsnprintf(list->text + used, ENTRY, format, values);
    va_end(values);
}

const char *lesson_list_text(lesson_list *list)
{
    if (list->count > list->listed)
        himc_format(list->text + strlen(list->text), MORE, " and %d more",
                    list->count - list->listed);
    return list->text;
}
