/// trc.c: takes written as TRC, in millimetres, y up; marker_table.c reads it.
#include "capture/take.h"
#include "capture/take_text.h"

bool himc_trc_write(FILE *file, const himc_take *take, himc_error *error)
{
    (void)error;
    fprintf(file, "PathFileType\t4\t(X/Y/Z)\t%s\n", take->file);
    fputs("DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\t"
          "OrigNumFrames\n",
          file);
    himc_text_put_number(file, take->rate, 6);
    fputc('\t', file);
    himc_text_put_number(file, take->rate, 6);
    fprintf(file, "\t%d\t%d\tmm\t", take->frames, take->points);
    himc_text_put_number(file, take->rate, 6);
    fprintf(file, "\t1\t%d\nFrame#\tTime", take->frames);
    for (int i = 0; i < take->points; i++)
        fprintf(file, "\t%s\t\t", take->names[i]);
    fputs("\n\t", file);
    for (int i = 1; i <= take->points; i++)
        fprintf(file, "\tX%d\tY%d\tZ%d", i, i, i);
    fputc('\n', file);
    for (int frame = 0; frame < take->frames; frame++) {
        fprintf(file, "%d\t", frame + 1);
        himc_text_put_number(file, frame / take->rate, 6);
        for (int i = 0; i < take->points; i++) {
            himc_vec3 x = himc_take_y_up(*himc_take_at(take, frame, i));
            if (himc_vec3_finite(x))
                himc_text_put_vec3(file, himc_vec3_scale(x, 1000), 4, '\t');
            else
                fputs("\t\t\t", file);
        }
        fputc('\n', file);
    }
    return true;
}
