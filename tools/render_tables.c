/// render_tables.c: rows and numbers as text. Columns carry their unit; a number that is not known
/// is `nan` in a table and `null` in JSON, which has no NaN.
#include "render_tables.h"
#include "himc/body.h"

#include <math.h>
#include <string.h>

/// A name in a table: in quotes, quotes doubled, if it would break the row (RFC 4180).
static void put_name(FILE *stream, const char *name)
{
    if (!strpbrk(name, ",\"\r\n")) {
        fputs(name, stream);
        return;
    }
    fputc('"', stream);
    for (; *name; name++) {
        if (*name == '"')
            fputc('"', stream);
        fputc(*name, stream);
    }
    fputc('"', stream);
}

void render_stroke_header(FILE *stream)
{
    fputs("time_s,hand,drum,nuance,x_m,y_m,velocity_m_s,peak_force_n,impulse_ns,duration_s\n",
          stream);
}

void render_stroke_row(FILE *stream, const himc_strike *strike)
{
    fprintf(stream, "%.6f,%s,", strike->time, himc_hand_name(strike->hand));
    put_name(stream, strike->drum);
    fputc(',', stream);
    put_name(stream, strike->nuance);
    fprintf(stream, ",%.6f,%.6f,%.5f,%.4f,%.7f,%.6f\n", strike->x, strike->y, strike->velocity,
            strike->force, strike->impulse, strike->duration);
}

static void name_vector(FILE *stream, const char *name, const char *what, const char *unit)
{
    for (char axis = 'x'; axis <= 'z'; axis++)
        fprintf(stream, ",%s%s_%c_%s", name, what, axis, unit);
}

static void put_vector(FILE *stream, himc_vec3 v)
{
    fprintf(stream, ",%.8f,%.8f,%.8f", v.x, v.y, v.z);
}

void render_motion_header(FILE *stream)
{
    fputs("time_s", stream);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        name_vector(stream, himc_hand_name((himc_hand)hand), "_target", "m");
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        name_vector(stream, himc_hand_name((himc_hand)hand), "_tip", "m");
    for (int joint = 0; joint < HIMC_JOINTS; joint++)
        name_vector(stream, himc_joint_name(joint), "", "rad");
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        fprintf(stream, ",%s_force_n", himc_hand_name((himc_hand)hand));
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        name_vector(stream, himc_hand_name((himc_hand)hand), "_elbow", "m");
    for (int joint = 0; joint < HIMC_JOINTS; joint++)
        fprintf(stream, ",%s_limit", himc_joint_name(joint));
    fputc('\n', stream);
}

void render_motion_row(void *stream, const himc_motion_row *row)
{
    FILE *out = stream;
    fprintf(out, "%.6f", row->time);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        put_vector(out, row->target[hand]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        put_vector(out, row->tip[hand]);
    for (int joint = 0; joint < HIMC_JOINTS; joint++)
        put_vector(out, row->joint[joint]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        fprintf(out, ",%.4f", row->force[hand]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        put_vector(out, row->elbow[hand]);
    for (int joint = 0; joint < HIMC_JOINTS; joint++)
        fprintf(out, ",%.4f", row->limit[joint]);
    fputc('\n', out);
}

static void put_json(const char *key, double value, const char *after)
{
    if (isfinite(value))
        printf("\"%s\": %.6g%s", key, value, after);
    else
        printf("\"%s\": null%s", key, after);
}

// what the errors of the tips do not show
static void put_measures(const himc_performance_stats *s)
{
    printf("\"unplanned_contacts\": %d, ", s->unplanned_contacts);
    put_json("longest_contact_s", s->longest_contact, ", ");
    put_json("captured_rms_mm", 1e3 * s->captured_rms, ", ");
    put_json("captured_rms_percent", s->captured_rms_percent, ", ");
    put_json("captured_max_mm", 1e3 * s->captured_most, ", ");
    put_json("captured_max_percent", s->captured_most_percent, ", ");
    put_json("peak_rate_rad_s", s->peak_rate, ", ");
    printf("\"peak_rate_joint\": \"%s\", ", himc_joint_name(s->peak_rate_joint));
    put_json("peak_torque_n_m", s->peak_torque, ", ");
    printf("\"peak_torque_joint\": \"%s\"}\n", himc_joint_name(s->peak_torque_joint));
}

void render_report(const himc_performance_stats *stats, double seconds, double realtime_factor)
{
    double rms_mm = stats->tip_rms * 1e3;
    if (stats->strokes)
        printf("strokes   %d of %d landed within 5 ms and 2 cm\n", stats->played, stats->strokes);
    if (stats->strokes && isfinite(stats->tip_rms_percent))
        printf("accuracy  sticks %.3g mm RMS off their targets, %.2g %% of the strokes' height\n",
               rms_mm, stats->tip_rms_percent);
    printf("force     up to %.1f N\n", stats->peak_force);
    printf("speed     %.1f s played, %.1f x real time\n", seconds, realtime_factor);
    if (stats->recoveries)
        printf("trouble   %ld times a non-finite state was met and the last good one restored\n",
               stats->recoveries);
    printf("{");
    put_json("seconds", seconds, ", ");
    printf("\"strokes\": %d, \"played\": %d, \"missed\": %d, ", stats->strokes, stats->played,
           stats->missed);
    put_json("tip_rms_mm", rms_mm, ", ");
    put_json("tip_rms_percent", stats->tip_rms_percent, ", ");
    put_json("peak_force_n", stats->peak_force, ", ");
    put_json("realtime_factor", realtime_factor, ", ");
    put_measures(stats);
}
