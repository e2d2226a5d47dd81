/// performance_statistics.c: sums and counts since the performance was made or reset.
#include "performance/performance_statistics.h"

void himc_statistics_clear(performance_statistics *s)
{
    *s = (performance_statistics){.strokes = 0};
}

// the target's largest height between two strikes is the stroke's height
void himc_statistics_height(performance_statistics *s, himc_hand hand, double height, bool touching)
{
    if (touching && s->apex[hand] > 0) {
        s->height_sum += s->apex[hand];
        s->height_count++;
        s->apex[hand] = 0;
    } else if (!touching) {
        s->apex[hand] = fmax(s->apex[hand], height);
    }
}

void himc_statistics_tip(performance_statistics *s, himc_vec3 away)
{
    s->square_sum += himc_vec3_dot(away, away);
    s->square_count++;
}

void himc_statistics_strokes(performance_statistics *s, int strokes, int played)
{
    s->strokes += strokes;
    s->played += played;
}

void himc_statistics_hit(performance_statistics *s, double latency)
{
    s->hit_latency = latency;
    s->longest_latency = fmax(s->longest_latency, latency);
    s->hits++;
}

void himc_statistics_force(performance_statistics *s, double force)
{
    s->peak_force = fmax(s->peak_force, force);
}

long himc_statistics_recovery(performance_statistics *s)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        s->apex[hand] = 0;
    return s->recoveries++;
}

void himc_statistics_read(const performance_statistics *s, himc_performance_stats *out)
{
    out->strokes = s->strokes;
    out->played = s->played;
    out->missed = s->strokes - s->played;
    out->peak_force = s->peak_force;
    out->hits = s->hits;
    out->hit_latency = s->hit_latency;
    out->longest_latency = s->longest_latency;
    out->recoveries = s->recoveries;
    out->tip_rms = s->square_count ? sqrt(s->square_sum / (double)s->square_count) : 0;
    out->stroke_height = s->height_count ? s->height_sum / (double)s->height_count : 0;
    out->tip_rms_percent = out->stroke_height > 0 ? 100 * out->tip_rms / out->stroke_height : NAN;
}
