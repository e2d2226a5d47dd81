/// take_subject.c: one of several players in a file.
///
/// Capture systems put the subject's name before a marker's: "Ida:RTIP". In a BVH each root is a
/// subject, with all below it. The points of the others are removed before anything is measured.
#include "capture/take.h"

#include "base/format.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

// the subject of a point: letters before the last ':', or the name of its root; "" without one
static void subject_of(const himc_take *take, int point, char subject[TAKE_NAME])
{
    subject[0] = 0;
    if (take->parents) {
        while (take->parents[point] >= 0)
            point = take->parents[point];
        memcpy(subject, take->names[point], TAKE_NAME);
        return;
    }
    const char *colon = strrchr(take->names[point], ':');
    size_t length = colon ? (size_t)(colon - take->names[point]) : 0;
    memcpy(subject, take->names[point], length);
    subject[length] = 0;
}

// the names of subjects in the file, up to 12 that fit, each after a blank; returns their number
static int list_subjects(const himc_take *take, char text[256])
{
    char found[12][TAKE_NAME];
    int count = 0;
    size_t used = 0;
    text[0] = 0;
    for (int i = 0; i < take->points && count < 12; i++) {
        char *subject = found[count];
        subject_of(take, i, subject);
        bool known = !subject[0];
        for (int k = 0; k < count; k++)
            known = known || !strcasecmp(found[k], subject);
        if (known)
            continue;
        count++;
        if (used < 200)
            used += himc_format(text + used, 256 - used, " %s", subject);
    }
    return count;
}

bool himc_take_choose_subject(himc_take *take, const char *wanted, himc_error *error)
{
    char subject[TAKE_NAME], text[256];
    int subjects = list_subjects(take, text), count = 0;
    if (!wanted) {
        if (subjects > 1)
            himc_take_note(take, "subjects: %d in the file, --subject chooses one:%s", subjects,
                           text);
        return true;
    }
    int *kept = malloc((size_t)take->points * sizeof *kept);
    if (!kept)
        return himc_error_set(error, "%s: no memory", take->file);
    for (int i = 0; i < take->points; i++) {
        subject_of(take, i, subject);
        if (!strcasecmp(subject, wanted))
            kept[count++] = i;
    }
    // in place: what is read is never behind what is written
    for (int i = 0; take->parents && i < count; i++) {
        int parent = take->parents[kept[i]], now = 0;
        while (parent >= 0 && kept[now] != parent)
            now++;
        take->parents[i] = parent < 0 ? -1 : now;
        take->offsets[i] = take->offsets[kept[i]];
    }
    for (int i = 0; i < count; i++)
        memmove(take->names[i], take->names[kept[i]], TAKE_NAME);
    for (size_t i = 0; i < (size_t)take->frames * (size_t)count; i++) {
        size_t from = i / (size_t)count * (size_t)take->points + (size_t)kept[i % (size_t)count];
        take->x[i] = take->x[from];
        if (take->rotations)
            take->rotations[i] = take->rotations[from];
    }
    take->points = count > 0 ? count : take->points;
    free(kept);
    return count > 0 || himc_error_set(error, "%s: no subject %s, expected%s", take->file, wanted,
                                       subjects ? text : ": none, the file has one player");
}
