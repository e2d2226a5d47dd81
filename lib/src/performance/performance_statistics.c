/// performance_statistics.c: sums and counts since the performance was made or reset.
#include "performance/performance_statistics.h"

#include "control/tracking_error.h"

void himc_statistics_clear(performance_statistics *s)
{
    *s = (performance_statistics){.square_sum = 0};
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

void himc_statistics_captured(performance_statistics *s, himc_vec3 away)
{
    double square = himc_vec3_dot(away, away);
    s->captured_sum += square;
    s->captured_count++;
    s->captured_most = fmax(s->captured_most, square);
}

static double peak(const double squares[HIMC_JOINTS], int *joint)
{
    *joint = 0;
    for (int j = 1; j < HIMC_JOINTS; j++)
        if (squares[j] > squares[*joint])
            *joint = j;
    return sqrt(squares[*joint]);
}

// squares, in every step: peaks of a blow are shorter than a tick, and roots would cost more
void himc_statistics_joints(performance_statistics *s, const himc_skeleton *skeleton,
                            const himc_body_state *state, const himc_vec3 *torque)
{
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_vec3 rate = himc_relative_spin(skeleton, state, j);
        double square = himc_vec3_dot(rate, rate);
        s->rate[j] = square > s->rate[j] ? square : s->rate[j];
        square = torque ? himc_vec3_dot(torque[j], torque[j]) : 0;
        s->torque[j] = square > s->torque[j] ? square : s->torque[j];
    }
}

bool himc_statistics_too_fast(performance_statistics *s, int *joint, double *rate)
{
    if (s->told_fast || s->told.recoveries > 0)
        return false;
    *rate = peak(s->rate, joint);
    s->told_fast = *rate > HIMC_FASTEST_JOINT;
    return s->told_fast;
}

void himc_statistics_unplanned(performance_statistics *s)
{
    s->told.unplanned_contacts++;
}

void himc_statistics_contact(performance_statistics *s, double force, double duration)
{
    s->told.peak_force = fmax(s->told.peak_force, force);
    s->told.longest_contact = fmax(s->told.longest_contact, duration);
}

void himc_statistics_strokes(performance_statistics *s, int strokes, int played)
{
    s->told.strokes += strokes;
    s->told.played += played;
}

void himc_statistics_landed(performance_statistics *s, double speed, double captured, double yields)
{
    s->impact_sum += isfinite(captured) ? speed : 0;
    s->captured_impact_sum += isfinite(captured) ? captured : 0;
    s->told.moved += yields > 0;
    s->told.moved_most = fmax(s->told.moved_most, yields);
}

long himc_statistics_aside(performance_statistics *s)
{
    return s->aside++;
}

void himc_statistics_hit(performance_statistics *s, double latency)
{
    s->told.hit_latency = latency;
    s->told.longest_latency = fmax(s->told.longest_latency, latency);
    s->told.hits++;
}

void himc_statistics_contact_work(performance_statistics *s, himc_hand hand, double work,
                                  double own)
{
    s->given -= work;
    s->mallet[hand] += own;
}

bool himc_statistics_recovery(performance_statistics *s, bool fell)
{
    bool tell = fell || !s->told_apart;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        s->apex[hand] = 0;
    s->told_apart |= !fell;
    s->told.recoveries++;
    return tell;
}

himc_performance_stats himc_statistics_told(const performance_statistics *s)
{
    himc_performance_stats out = s->told;
    out.missed = out.strokes - out.played;
    out.tip_rms = s->square_count ? sqrt(s->square_sum / (double)s->square_count) : 0;
    out.stroke_height = s->height_count ? s->height_sum / (double)s->height_count : 0;
    double percent = out.stroke_height > 0 ? 100 / out.stroke_height : NAN;
    out.tip_rms_percent = out.stroke_height > 0 ? 100 * out.tip_rms / out.stroke_height : NAN;
    out.peak_rate = peak(s->rate, &out.peak_rate_joint);
    out.peak_torque = peak(s->torque, &out.peak_torque_joint);
    out.captured_rms = s->captured_count ? sqrt(s->captured_sum / (double)s->captured_count) : NAN;
    out.captured_most = s->captured_count ? sqrt(s->captured_most) : NAN;
    out.captured_rms_percent = percent * out.captured_rms;
    out.captured_most_percent = percent * out.captured_most;
    out.captured_speed_ratio =
        s->captured_impact_sum > 0 ? s->impact_sum / s->captured_impact_sum : NAN;
    return out;
}
