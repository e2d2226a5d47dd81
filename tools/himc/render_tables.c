/// render_tables.c: rows and numbers as text. Columns carry their unit; a number that is not known
/// is `nan` in a table and `null` in JSON, which has no NaN.
#include "render_tables.h"
#include "cli.h"
#include "himc/body.h"

#include <math.h>
#include <stdlib.h>
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

// a stroke is known when its contact ends, or as soon as it will not be played: a row finds its
// place near the end
void render_strokes_add(render_strokes *s, const himc_strike *strike)
{
    if (s->count == s->room) {
        int room = s->room ? 2 * s->room : 256;
        himc_strike *row = realloc(s->row, (size_t)room * sizeof *row);
        s->full = s->full || !row;
        if (!row)
            return;
        s->row = row;
        s->room = room;
    }
    int at = s->count++;
    for (; at > 0 && s->row[at - 1].time > strike->time; at--)
        s->row[at] = s->row[at - 1];
    s->row[at] = *strike;
}

static void put_stroke(FILE *stream, const himc_strike *strike)
{
    fprintf(stream, "%.6f,%s,", strike->time, himc_hand_name(strike->hand));
    put_name(stream, strike->drum);
    fputc(',', stream);
    put_name(stream, strike->nuance);
    fprintf(stream, ",%.6f,%.6f,%.5f,%.4f,%.7f,%.6f\n", strike->x, strike->y, strike->velocity,
            strike->force, strike->impulse, strike->duration);
}

void render_strokes_write(render_strokes *s, FILE *stream)
{
    fputs("time_s,hand,drum,nuance,x_m,y_m,velocity_m_s,peak_force_n,impulse_n_s,duration_s\n",
          stream);
    for (int i = 0; i < s->count; i++)
        put_stroke(stream, &s->row[i]);
    free(s->row);
    *s = (render_strokes){.count = 0};
}

static void put_json(FILE *out, const char *key, double value, const char *after)
{
    if (isfinite(value))
        fprintf(out, "\"%s\": %.6g%s", key, value, after);
    else
        fprintf(out, "\"%s\": null%s", key, after);
}

// what the errors of the tips do not show
static void put_measures(FILE *out, const himc_performance_stats *s)
{
    fprintf(out, "\"unplanned_contacts\": %d, ", s->unplanned_contacts);
    put_json(out, "longest_contact_s", s->longest_contact, ", ");
    fprintf(out, "\"moved\": %d, ", s->moved);
    put_json(out, "moved_max_mm", 1e3 * s->moved_most, ", ");
    put_json(out, "captured_rms_mm", 1e3 * s->captured_rms, ", ");
    put_json(out, "captured_rms_percent", s->captured_rms_percent, ", ");
    put_json(out, "captured_max_mm", 1e3 * s->captured_most, ", ");
    put_json(out, "captured_max_percent", s->captured_most_percent, ", ");
    put_json(out, "captured_speed_ratio", s->captured_speed_ratio, ", ");
    put_json(out, "peak_rate_rad_s", s->peak_rate, ", ");
    fprintf(out, "\"peak_rate_joint\": \"%s\", ", himc_joint_name(s->peak_rate_joint));
    put_json(out, "peak_torque_n_m", s->peak_torque, ", ");
    fprintf(out, "\"peak_torque_joint\": \"%s\"}\n", himc_joint_name(s->peak_torque_joint));
}

void render_report(const himc_performance_stats *stats, double seconds, double realtime_factor,
                   FILE *out)
{
    double rms_mm = stats->tip_rms * 1e3;
    if (stats->strokes)
        cli_say("strokes   %d of %d landed within 5 ms and 2 cm\n", stats->played, stats->strokes);
    if (stats->moved)
        cli_say("moved     %d strokes by up to %.0f mm, where the hands would have met\n",
                stats->moved, 1e3 * stats->moved_most);
    if (stats->strokes && isfinite(stats->tip_rms_percent))
        cli_say("accuracy  sticks %.3g mm RMS off their targets, %.2g %% of the strokes' height\n",
                rms_mm, stats->tip_rms_percent);
    if (isfinite(stats->captured_speed_ratio))
        cli_say("capture   sticks %.3g mm RMS off the take, strikes at %.0f %% of its speeds\n",
                1e3 * stats->captured_rms, 100 * stats->captured_speed_ratio);
    cli_say("force     up to %.1f N\n", stats->peak_force);
    if (stats->unplanned_contacts)
        cli_say("contacts  %d that no stroke asked for\n", stats->unplanned_contacts);
    if (stats->reserve > 1.05) // 1.0 as printed is none
        cli_say("reserve   %s up to %.1f times its strength\n",
                himc_joint_name(stats->reserve_joint), stats->reserve);
    cli_say("speed     %.1f s played, %.1f x real time\n", seconds, realtime_factor);
    if (stats->recoveries)
        cli_say("trouble   %ld times the player was put back: fallen, or in a state not finite\n",
                stats->recoveries);
    if (!out)
        return;
    fprintf(out, "{");
    put_json(out, "seconds", seconds, ", ");
    fprintf(out, "\"strokes\": %d, \"played\": %d, \"missed\": %d, ", stats->strokes, stats->played,
            stats->missed);
    put_json(out, "tip_rms_mm", rms_mm, ", ");
    put_json(out, "tip_rms_percent", stats->tip_rms_percent, ", ");
    put_json(out, "peak_force_n", stats->peak_force, ", ");
    put_json(out, "realtime_factor", realtime_factor, ", ");
    put_measures(out, stats);
}
