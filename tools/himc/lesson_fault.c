/// lesson_fault.c: the list of faults, the largest first.
///
/// A difference is a fault if it is beyond the threshold with its 99 % bound (single strokes: with
/// 4 standard deviations); `excess` is the difference less that bound, over the threshold.
#include "lesson.h"

#include <math.h>

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
