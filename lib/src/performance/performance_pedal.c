/// performance_pedal.c: which pedal the foot of one who sits is on, and when.
///
/// A pedal that the score moves is foreseen; one that moves without a score (`gliss`) is seen at
/// the next tick. One foot is off the floor at a time: the other one waits until that is back. A
/// player who is thrown about on his stool keeps both on the floor.
#include "performance/performance_state.h"

#include <math.h>

// a foot on a pedal; chosen
#define PEDAL_STAYS 0.15 // after the pedal has come to rest (s) ...
#define PEDAL_AGAIN 3.0  // ... and if it moves again so soon (s)
// measured: with more he fell in wild playing of ff accents
#define STEADY 0.012        // a pelvis so near to its place lets a foot go (m) ...
#define UNSTEADY 0.025      // ... and needs it back so far from it (m)
#define PEDAL_QUICKEST 0.12 // of a foot that tunes at once (s)

// the pedal of that drum moves now, or the score does within `ahead` (s)
static bool pedal_moves(const performance_motion *m, const performance_drums *drums, int index,
                        double t, double ahead)
{
    const himc_drum_heads *heads = drums->slot[index].heads;
    double now = himc_motion_score_beat(m, t - PEDAL_STAYS),
           soon = himc_motion_score_beat(m, t + ahead);
    return t < m->pedal[index].until ||
           (soon < now ? himc_drum_heads_pedal(heads, now, INFINITY) || // a loop begins again
                             himc_drum_heads_pedal(heads, -1, soon)
                       : himc_drum_heads_pedal(heads, now, soon));
}

static double angle_of(const performance_motion *m, int index)
{
    return himc_pedal_angle(m->pedal[index].octaves);
}

static void go(performance_motion *m, const performance_drums *drums, double t, double sways)
{
    himc_pedal_foot *f = &m->foot;
    himc_pedal next, any;
    int drum = -1;
    bool may = !m->track && sways < (f->away ? UNSTEADY : STEADY);
    for (int i = 0; i < drums->count && may; i++)
        if (pedal_moves(m, drums, i, t, HIMC_PEDAL_LEAN + HIMC_PEDAL_WAY + PEDAL_STAYS) &&
            himc_pedal_of(&m->body.posture, himc_drums_frame(drums, i), &any) &&
            (drum < 0 || (f->away && i == m->pedalled))) {
            drum = i;
            next = any;
        }
    if (drum < 0 && f->away && may && m->pedalled < drums->count &&
        pedal_moves(m, drums, m->pedalled, t, PEDAL_AGAIN))
        return;
    if (f->away ? drum == m->pedalled : drum < 0)
        return;
    if (drum >= 0 && (next.foot == f->foot || !himc_pedal_moves(f, f->foot, t))) {
        himc_pedal_go(f, &m->body.posture, &next, t);
        himc_pedal_press(
            f, angle_of(m, drum), t,
            fmax(m->pedal[drum].until - PEDAL_STAYS - t, HIMC_PEDAL_LEAN + HIMC_PEDAL_WAY));
        m->pedalled = drum;
    } else if (f->away) { // the other foot waits
        himc_pedal_go(f, &m->body.posture, NULL, t);
        if (!may) // against what throws him about he sits upright
            f->back = f->aside = 0;
    }
}

void himc_performance_move_foot(himc_performance *p, double t)
{
    performance_motion *m = p->motion;
    himc_pedal_foot *f = &m->foot;
    performance_body *b = p->body;
    if (p->settings.stance != HIMC_STANCE_SEATED)
        return;
    himc_pedal_feel(f, &b->state, b->skeleton.segment[HIMC_PELVIS].origin, t);
    // a foot on a pedal turns with it, and a `gliss` without a score asks for one
    for (int i = 0; i < p->drums.count; i++) {
        seen_pedal *s = &m->pedal[i];
        double octaves, seconds = himc_drum_pedal(p->drums.slot[i].drum, &octaves);
        bool moved = s->known && octaves != s->octaves, on = f->away && m->pedalled == i;
        double takes = fmax(seconds, PEDAL_QUICKEST);
        s->known = true;
        s->octaves = octaves;
        if (seconds > 0 || (moved && on))
            s->until = t + takes + PEDAL_STAYS;
        if (moved && on)
            himc_pedal_press(f, angle_of(m, i), t, takes);
    }
    go(m, &p->drums, t,
       himc_vec3_length(
           himc_vec3_sub(b->state.origin[0], b->skeleton.segment[HIMC_PELVIS].origin)));
    const bool slides[HIMC_HANDS] = {himc_pedal_moves(f, HIMC_LEFT, t),
                                     himc_pedal_moves(f, HIMC_RIGHT, t)};
    himc_support_slide(&b->support, slides);
}
