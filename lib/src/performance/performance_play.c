/// performance_play.c: the commands that say what to play: strokes and hits, transport, units of
/// motion, live targets. Scores and takes have files of their own.
///
/// Files are read here and now; what comes of them is given to the planner or the track.
#include "performance/performance_state.h"
#include "base/head_frame.h"
#include "performance/research.h"

#include <string.h>

#define DEEPEST_TARGET 0.01 // of a live target under the head (m)

bool himc_performance_do_loop(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    himc_planner_loop(p->planner, step_time(p), c->atom[0].number != 0);
    p->replan = true;
    return true;
}

bool himc_performance_add_stroke(himc_performance *p, const himc_stroke *stroke, himc_error *error)
{
    int drum;
    return himc_performance_ensure_drum(p, stroke->drum, &drum, error) &&
           himc_planner_add(p->planner, stroke, drum, error);
}

bool himc_performance_do_stroke(himc_performance *p, const himc_command *c, himc_error *error)
{
    p->replan = true;
    return himc_performance_add_stroke(p, &c->stroke, error);
}

bool himc_performance_do_hit(himc_performance *p, const himc_command *c, himc_error *error)
{
    int drum;
    if (!himc_performance_lend_hand(p, c->stroke.hand))
        return himc_error_set(error, "hit: a take has the hands, allowed when it is over");
    if (!himc_performance_ensure_drum(p, c->stroke.drum, &drum, error))
        return false;
    himc_performance_tell_places(p);
    double now = step_time(p), at = himc_planner_hit(p->planner, now, &c->stroke, drum);
    if (isfinite(at)) {
        p->hit_latency = at - now;
        p->longest_latency = fmax(p->longest_latency, p->hit_latency);
        p->hits++;
    }
    p->replan = true;
    return true;
}

bool himc_performance_do_tempo(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    if (c->count > 1)
        return himc_error_set(error,
                              "tempo: BEAT: only in a score file; here a tempo holds from now on");
    himc_planner_tempo(p->planner, step_time(p), c->atom[0].number);
    p->replan = true;
    return true;
}

void himc_performance_drop_track(himc_performance *p)
{
    himc_performance_take_hands_back(p);
    himc_track_free(p->track);
    p->track = NULL;
    p->has_learned = false;
    himc_performance_renew_limits(p);
    if (p->regression_of_take)
        himc_performance_set_posture_regression(p, NULL);
}

bool himc_performance_do_clear(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c, (void)error;
    himc_planner_clear(p->planner);
    p->replan = true;
    return true;
}

static void start_track(himc_performance *p, double t)
{
    double start = t + HIMC_APPROACH;
    himc_track_rewind(p->track);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (himc_track_present(p->track, (himc_hand)hand)) {
            himc_target now = p->reference.tip[hand];
            himc_track_approach(p->track, (himc_hand)hand, &now, HIMC_APPROACH);
        }
    himc_track_approach_posture(p->track, &p->reference.posture);
    p->track_start = start;
}

bool himc_performance_do_play(himc_performance *p, const himc_command *c, himc_error *error)
{
    int index;
    (void)c;
    if (!himc_performance_ensure_drum(p, "", &index, error))
        return false;
    himc_performance_tell_places(p);
    if (!p->track && himc_planner_length(p->planner) <= 0)
        himc_performance_note(p, "play: nothing to play: no strokes, no take");
    p->piece_start = step_time(p);
    if (p->track)
        start_track(p, p->piece_start);
    else
        himc_planner_play(p->planner, p->piece_start);
    p->playing = true;
    p->replan = true;
    return true;
}

bool himc_performance_do_stop(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c, (void)error;
    if (p->track)
        himc_track_stop(p->track, step_time(p) - p->track_start, p->reference.tip);
    himc_planner_stop(p->planner, step_time(p));
    p->playing = false;
    p->replan = true;
    return true;
}

bool himc_performance_do_seek(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    himc_planner_seek(p->planner, step_time(p), c->atom[0].number);
    p->replan = true;
    return true;
}

// a tip is sent no further into a head than this
static himc_vec3 above_heads(const himc_performance *p, himc_vec3 x)
{
    for (int i = 0; i < p->drums; i++) {
        const himc_head_frame *place = himc_drum_head_frame(p->drum[i].drum);
        himc_vec3 local = himc_head_frame_from_world(place, x);
        double under = p->skeleton.mallet_radius - DEEPEST_TARGET - local.z;
        if (hypot(local.x, local.y) < place->radius && under > 0 && under < 0.3)
            return himc_vec3_madd(x, under, himc_head_frame_normal(place));
    }
    return x;
}

void himc_performance_target(himc_performance *p, himc_hand hand, himc_vec3 asked)
{
    if (!himc_vec3_finite(asked))
        return;
    if (!himc_performance_lend_hand(p, hand)) {
        if (!p->beyond[hand])
            himc_performance_note(p, "target %s: a take has the hands, allowed when it is over",
                                  himc_hand_name(hand));
        p->beyond[hand] = true;
        return;
    }
    himc_vec3 x = himc_posture_reachable(&p->posture, hand, asked);
    bool beyond = himc_vec3_length(himc_vec3_sub(x, asked)) > 1e-3;
    if (beyond && !p->beyond[hand]) // one line each time a stream leaves what can be reached
        himc_performance_note(p, "target %s %g %g %g: out of reach, going to %.3f %.3f %.3f",
                              himc_hand_name(hand), asked.x, asked.y, asked.z, x.x, x.y, x.z);
    p->beyond[hand] = beyond;
    himc_planner_reach(p->planner, step_time(p), hand, above_heads(p, x));
    p->replan = true;
}

bool himc_performance_do_target(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    himc_performance_target(
        p, (himc_hand)c->choice[0],
        himc_vec3_make(c->atom[1].number, c->atom[2].number, c->atom[3].number));
    return true;
}

static bool add_units(himc_performance *p, himc_take *take, const himc_command *c,
                      himc_error *error)
{
    himc_unit units[HIMC_UNITS];
    int count = himc_units_cut(take, &p->take_options, units, HIMC_UNITS, error);
    for (int i = 0; i < count && i < HIMC_UNITS; i++) {
        units[i].nuance = (himc_nuance)c->choice[1];
        units[i].grip = p->grip;
        if (c->count > 2 && c->choice[2] >= 0)
            units[i].spot = (himc_spot)c->choice[2];
    }
    if (count < 0 || !himc_planner_add_units(p->planner, units, count, error))
        return false;
    himc_performance_note(p, "%s: %d motion units of %s", c->atom[0].symbol, count,
                          c->atom[1].symbol);
    return true;
}

bool himc_performance_do_units(himc_performance *p, const himc_command *c, himc_error *error)
{
    enum { CLEAR };
    p->replan = true;
    if (c->form == CLEAR) {
        himc_planner_clear_units(p->planner);
        return true;
    }
    himc_take *take = himc_take_load(c->atom[0].symbol, &p->take_options, error);
    bool added =
        take && (add_units(p, take, c, error) || himc_error_prefix(error, "%s", c->atom[0].symbol));
    himc_take_free(take);
    return added;
}
