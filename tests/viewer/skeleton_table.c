/// skeleton_table.c: prints viewer/page/skeleton.js, the default performer's segments, from the
/// library's own table. The page needs them to draw limbs and to play a motion.csv; a test compares
/// the file with what this prints.
#include "himc/body.h"

#include <stdio.h>

static void print_row(const himc_skeleton *k, int i)
{
    const himc_segment *s = &k->segment[i];
    printf("    { name: \"%s\", joint: \"%s\", parent: %d,\n"
           "      length: %.5f, radius: %.5f, origin: [%.6f, %.5f, %.5f], axis: [%g, %g, %g] },\n",
           himc_segment_name(i), i ? himc_joint_name(i - 1) : "", s->parent, s->length, s->radius,
           s->origin.x, s->origin.y, s->origin.z, s->axis.x, s->axis.y, s->axis.z);
}

int main(void)
{
    himc_skeleton k;
    himc_skeleton_config config = himc_skeleton_default();
    if (!himc_skeleton_init(&k, &config, NULL))
        return 1;
    printf(
        "// The default performer, 1.75 m tall, as lib/himc/skeleton.h describes it (m); made by\n"
        "// tests/viewer/skeleton_table.c, do not edit. `origin` is the joint in the parent's "
        "frame.\n"
        "export const segments = [\n");
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        print_row(&k, i);
    printf("];\nexport const height = %g, root = [%.6f, %.6f, %.6f];\n", k.height, k.root.x,
           k.root.y, k.root.z);
    printf("export const tip = %.6f; // of the stick, below its joint\n", -k.tip.z);
    printf("export const malletRadius = %.6f;\n", k.mallet_radius);
    return 0;
}
