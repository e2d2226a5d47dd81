/// planner_transport.c: beats and seconds.
///
/// While playing, beat b is at time origin + S(b), S being the sum of 60/bpm over the tempo map. A
/// change of tempo at beat b replaces what the map says up to b and moves the origin so that b
/// stays where it is; the hands are then planned anew from there. In a loop of length L, beat b of
/// round k is at origin + k S(L) + S(b); the round under way becomes round 0 when tempo or score
/// change. Invariant: S grows strictly, so every time has one beat.
#include "plan/planner_state.h"

#include <string.h>

#define RETURN_TIME 2.5 // from the last touch to rest (s)
#define PREPARATION 1.0 // in which a score that follows late can be begun (s)

double himc_planner_time_of(const himc_planner *planner, double beat)
{
    return planner->origin + himc_score_seconds(planner->tempi, planner->tempo_count, beat);
}

static double last_beat(const himc_planner *planner)
{
    double beat = -1;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const planner_hand *h = &planner->hand[hand];
        if (h->count > 0)
            beat = fmax(beat, h->list[h->count - 1].stroke.beat);
    }
    return beat;
}

double himc_planner_length(const himc_planner *planner)
{
    return floor(last_beat(planner)) + 1;
}

double himc_planner_turn(const himc_planner *planner)
{
    return himc_score_seconds(planner->tempi, planner->tempo_count, himc_planner_length(planner));
}

double himc_planner_next_start(const himc_planner *planner, double t)
{
    double length = himc_planner_length(planner);
    return planner->playing ? fmax(length, ceil(himc_planner_beat_at(planner, t + PREPARATION)))
                            : length;
}

static void cut_both(himc_planner *planner, double t)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        himc_planner_cut(planner, (himc_hand)hand, t);
}

/// The round of the loop at a time, 0 before it begins.
static int round_at(const himc_planner *planner, double t)
{
    double turn = himc_planner_turn(planner);
    bool turns = planner->loop || planner->rounds > 0;
    if (!turns || !(turn > 0) || t < planner->origin)
        return 0;
    double round = fmin(floor((t - planner->origin) / turn + 1e-12), 1e9);
    return planner->loop ? (int)round : (int)fmin(round, planner->rounds);
}

double himc_planner_beat_at(const himc_planner *planner, double t)
{
    double begun = planner->origin + round_at(planner, t) * himc_planner_turn(planner);
    return himc_score_beat(planner->tempi, planner->tempo_count, t - begun);
}

/// Makes the round at `t` the first.
void himc_planner_rebase(himc_planner *planner, double t)
{
    int round = round_at(planner, t);
    planner->beginning += round != 0;
    planner->origin += round * himc_planner_turn(planner);
    planner->rounds -= round;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        planner_hand *h = &planner->hand[hand];
        h->round -= round;
        for (int i = 0; i < h->hits; i++)
            h->hit[i].round -= round;
        for (int i = 0; i < h->touches; i++)
            h->touch[i].round -= round;
    }
}

const planner_stroke *himc_planner_next(const himc_planner *planner, const planner_hand *h,
                                        int ahead, int *index, int *round, double *t)
{
    if (!planner->playing || h->count == 0)
        return NULL;
    long at = (long)h->next + ahead;
    *round = h->round + (int)(at / h->count);
    *index = (int)(at % h->count);
    if (!planner->loop && *round > planner->rounds)
        return NULL;
    double begun = *round == 0 ? 0 : *round * himc_planner_turn(planner);
    *t = begun + himc_planner_time_of(planner, h->list[*index].stroke.beat);
    return &h->list[*index];
}

void himc_planner_loop(himc_planner *planner, double t, bool on)
{
    if (!isfinite(t) || planner->loop == on)
        return;
    cut_both(planner, t);
    planner->rounds = on || !planner->playing ? 0 : round_at(planner, t);
    // a stroke of the next round that can no longer be taken back brings that round with it
    for (int hand = 0; hand < HIMC_HANDS && !on; hand++)
        for (int i = 0; i < planner->hand[hand].touches; i++)
            if (planner->hand[hand].touch[i].round > planner->rounds)
                planner->rounds = planner->hand[hand].touch[i].round;
    planner->loop = on;
    himc_planner_replan(planner, t);
}

static void seek_hand(planner_hand *h, double beat)
{
    int low = 0, high = h->count;
    while (low < high) {
        int middle = (low + high) / 2;
        if (h->list[middle].stroke.beat < beat - 1e-9)
            low = middle + 1;
        else
            high = middle;
    }
    h->next = low;
    h->round = 0;
}

/// How much too late the hands would be for their first strokes (s).
static double lateness(himc_planner *planner)
{
    double late = 0;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        planner_hand *h = &planner->hand[hand];
        int index, round;
        double at;
        const planner_stroke *s = himc_planner_next(planner, h, 0, &index, &round, &at);
        if (!s)
            continue;
        himc_goal goal = himc_planner_goal(planner, &s->stroke, s->drum, at);
        late = fmax(late, h->plan.end + himc_hand_time(&h->plan, &goal) - at);
    }
    return late;
}

/// Begins at planner->beat; the hands have been cut.
static void start(himc_planner *planner, double t)
{
    planner->playing = true;
    planner->beginning++;
    planner->rounds = 0;
    planner->origin = t - himc_score_seconds(planner->tempi, planner->tempo_count, planner->beat);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        seek_hand(&planner->hand[hand], planner->beat);
    double late = lateness(planner);
    planner->origin += late;
    if (late > 0.001)
        himc_planner_say(planner, PLANNER_LATE,
                         "beat %g is %.2g s late: the first stroke must be prepared", planner->beat,
                         late);
    himc_planner_replan(planner, t);
}

void himc_planner_play(himc_planner *planner, double t)
{
    if (!isfinite(t) || (planner->playing && t < himc_planner_end(planner)))
        return;
    if (planner->playing || planner->beat > last_beat(planner))
        planner->beat = 0;
    himc_planner_forget_said(planner);
    cut_both(planner, t);
    start(planner, t);
}

void himc_planner_stop(himc_planner *planner, double t)
{
    if (!isfinite(t) || !planner->playing)
        return;
    planner->beat = himc_planner_beat(planner, t);
    planner->playing = false;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        planner->hand[hand].hits = 0;
    cut_both(planner, t);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        planner->hand[hand].hits = 0;
    himc_planner_replan(planner, t);
}

void himc_planner_seek(himc_planner *planner, double t, double beat)
{
    if (!isfinite(t) || !isfinite(beat))
        return;
    planner->beat = fmax(beat, 0);
    if (!planner->playing)
        return;
    cut_both(planner, t);
    start(planner, t);
}

void himc_planner_tempo(himc_planner *planner, double t, double bpm)
{
    if (!isfinite(t) || !(bpm >= 1 && bpm <= 1000))
        return;
    double beat = planner->playing ? himc_planner_beat_at(planner, t) : planner->beat;
    himc_planner_rebase(planner, t);
    int past = 1;
    while (past < planner->tempo_count && planner->tempi[past].beat <= beat)
        past++;
    planner->tempo_count -= past - 1;
    memmove(planner->tempi + 1, planner->tempi + past,
            (size_t)(planner->tempo_count - 1) * sizeof *planner->tempi);
    planner->tempi[0] = (himc_tempo_change){0, bpm};
    if (!planner->playing)
        return;
    planner->origin = t - himc_score_seconds(planner->tempi, planner->tempo_count, beat);
    himc_planner_replan(planner, t);
}

double himc_planner_beat(const himc_planner *planner, double t)
{
    if (!planner->playing)
        return -1;
    double beat = himc_planner_beat_at(planner, t);
    return t < planner->origin + himc_planner_turn(planner) ? fmax(beat, planner->beat) : beat;
}

double himc_planner_end(const himc_planner *planner)
{
    if (!planner->playing || (planner->loop && last_beat(planner) >= 0))
        return HUGE_VAL;
    double end = planner->origin,
           begun = planner->rounds ? planner->rounds * himc_planner_turn(planner) : 0;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const planner_hand *h = &planner->hand[hand];
        if (h->count > 0)
            end =
                fmax(end, begun + himc_planner_time_of(planner, h->list[h->count - 1].stroke.beat) +
                              RETURN_TIME);
        for (int i = 0; i < h->hits; i++)
            end = fmax(end, h->hit[i].goal.time + RETURN_TIME);
        if (h->touches > 0)
            end = fmax(end, h->touch[h->touches - 1].goal.time + RETURN_TIME);
    }
    return end;
}
