/// table.c: the default performer's segments and joints, from lib/src/body/skeleton.c, for programs
/// that do not link the library: `table c` prints a C header, `table js` a JavaScript module.
///
/// make runs it when the viewer is built (build/viewer/skeleton.h and skeleton.js), so the names,
/// their order and the parents stand in skeleton.c alone. `origin` is the joint in the parent's
/// frame, `center` the centre of mass in the segment's; lengths in metres, to a thousandth of a
/// millimetre.
#include "himc/body.h"

#include <stdio.h>
#include <string.h>

static void print_c(void)
{
    printf("// made by tools/research/skeleton/table.c from lib/src/body/skeleton.c: do not edit\n"
           "#ifndef VIEWER_SKELETON_H\n#define VIEWER_SKELETON_H\n\n"
           "#define SKELETON_SEGMENTS %d\n#define SKELETON_SEGMENT_NAMES",
           HIMC_SEGMENTS);
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        printf("%s \\\n    \"%s\"", i ? "," : "", himc_segment_name(i));
    printf("\n\n#endif\n");
}

static void print_segment(const himc_skeleton *k, int i)
{
    const himc_segment *s = &k->segment[i];
    printf("    { name: \"%s\", joint: \"%s\", parent: %d,\n"
           "      length: %.6f, origin: [%.6f, %.6f, %.6f], center: [%.6f, %.6f, %.6f] },\n",
           himc_segment_name(i), i ? himc_joint_name(i - 1) : "", s->parent, s->length, s->origin.x,
           s->origin.y, s->origin.z, s->center.x, s->center.y, s->center.z);
}

static void print_js(const himc_skeleton *k)
{
    printf("// made by tools/research/skeleton/table.c from lib/src/body/skeleton.c: do not edit\n"
           "export const segments = [\n");
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        print_segment(k, i);
    printf("];\n");
    printf("export const tip = %.6f; // of the stick, below its joint\n", -k->tip.z);
    printf("export const malletRadius = %.6f;\n", k->mallet_radius);
}

int main(int count, char **word)
{
    himc_skeleton k;
    himc_skeleton_config config = himc_skeleton_default();
    const char *format = count == 2 ? word[1] : "";
    bool c = !strcmp(format, "c"), js = !strcmp(format, "js");
    if (!(c || js) || !himc_skeleton_init(&k, &config, NULL)) {
        fprintf(stderr, "usage: table c|js\n");
        return 1;
    }
    if (c)
        print_c();
    else
        print_js(&k);
    return 0;
}
