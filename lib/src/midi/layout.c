/// layout.c: where instruments of several kinds, or drums that are no set, stand around one player.
///
/// Each kind alone has places of its own; those of `setup multi` count where it has the instrument.
/// Keyboards come first, in front, then timpani, then drums: each as near to its usual place as the
/// others leave room, and where its strokes are in reach. Seen from above an instrument is a
/// circle, a keyboard a line from left to right with a margin. What is small hangs over the far
/// half of timpani, where no stick comes. Kicks stand below the others.
#include "midi/part.h"

#include "base/setups.h"

#include <math.h>
#include <string.h>

#define GAP 0.02          // between instruments (m); chosen
#define REACH 0.88        // to a stroke (m); measured: some hands come so far, all 0.1 less
#define REACH_SEATED 0.78 // the same among drums alone, and straight ahead; measured: .79 .. .83
#define SHOULDER 0.2      // of the other hand, which reaches a drum, too, from the middle (m)
#define BODY 0.25         // no instrument is nearer to the player (m); chosen
#define STEP 0.03         // of the places that are tried (m)
#define FARTHEST 40       // of them (steps)
#define LARGE 0.25        // radius of timpani, at least (m)
#define SMALL 0.1         // at most (m)
#define HIGHER 0.1        // a keyboard behind another one (m)
#define HANGS 1.05        // what is small, over others (m)
#define OVER_BARS 0.97    // what stands behind a keyboard (m); chosen
#define LOW 0.5           // what a foot plays is lower (m)

static double radius_of(const midi_head *h)
{
    return h->depth > 0 ? h->depth : h->radius;
}

// how deep two instruments would be in each other (m)
static double overlap(const midi_head *a, const midi_head *b)
{
    bool over = a->z >= HANGS && b->radius > LARGE;
    double away = hypot(b->x, b->y), share = over ? 0.55 : 1, // of its radius, where it is struck
        near = over && away > 0 ? 1 - 0.45 * b->radius / away : 1, x = near * b->x, y = near * b->y;
    double along = fmax(0, fabs(a->y - y) - a->side - b->side);
    return fmax(0, radius_of(a) + share * radius_of(b) + GAP - hypot(a->x - x, along));
}

// where `setup multi` has it; false if it has none. Of timpani it has one
static bool find_usual(const midi_head *h, double at[4])
{
    const char *made, *name = h->choice == MIDI_TIMPANI               ? "timpano"
                              : strcmp(h->name, "temple-blocks") == 0 ? "blocks"
                                                                      : h->name;
    const himc_setup *s = himc_setups;
    int length;
    while (strcmp(s->name, "multi") != 0)
        s++;
    return himc_setup_find(s->text, name, &made, &length, at);
}

// there it has room with the others that are
static bool is_usual(const midi_head *h)
{
    double at[4];
    return find_usual(h, at) && h->x == at[0] && h->y == at[1];
}

// of a place: the way to the usual one (m), and more for what makes it worse
static double cost_of(const midi_part *part, const bool *placed, const midi_head *h,
                      const midi_head *usual)
{
    double near = hypot(h->x, fmax(0, fabs(h->y) - h->side)),
           beside = h->depth > 0 ? h->side : SHOULDER,
           far = hypot(h->x + 0.5 * h->depth, fabs(h->y) + beside) - 0.6 * h->radius, reach = REACH;
    if (part->kinds == 1u << MIDI_DRUMS) {
        far = fmax(far, h->x);
        reach = REACH_SEATED;
    }
    double way = hypot(h->x - usual->x, h->y - usual->y),
           cost = way + 20 * fmax(0, far - reach) + 10 * fmax(0, BODY + radius_of(h) - near) +
                  2 * fmax(0, -h->x);
    for (int i = 0; i < part->heads; i++)
        if (placed[i] && (way > 0 || !is_usual(h) || !is_usual(&part->head[i])))
            cost += 20 * overlap(h, &part->head[i]);
    return cost;
}

static void place(const midi_part *part, const bool *placed, midi_head *head)
{
    midi_head best = *head;
    double least = cost_of(part, placed, &best, head);
    for (int x = -FARTHEST / 4; x <= FARTHEST; x++)
        for (int y = -FARTHEST; y <= FARTHEST; y++) {
            midi_head h = *head;
            h.x = STEP * x;
            h.y = STEP * y;
            double cost = cost_of(part, placed, &h, head);
            if (cost < least - 1e-9) {
                least = cost;
                best = h;
            }
        }
    *head = best;
}

// sticks come to it over the bars of a keyboard
static bool is_behind(const midi_part *part, const bool *placed, const midi_head *h)
{
    for (int i = 0; i < part->heads; i++) {
        const midi_head *bars = &part->head[i];
        if (placed[i] && bars->depth > 0 && h->x > bars->x &&
            fabs(h->y - bars->y) < bars->side + h->radius)
            return true;
    }
    return false;
}

void himc_midi_lay_out(midi_part *part)
{
    bool placed[MIDI_HEADS] = {false};
    int timpani = 0, keyboards = 0;
    for (int i = 0; i < part->heads; i++)
        timpani += part->head[i].choice == MIDI_TIMPANI;
    for (int turn = 0; turn < 3; turn++)
        for (int i = 0; i < part->heads; i++) {
            midi_head *h = &part->head[i];
            int own = h->choice == MIDI_TIMPANI ? 1 : h->choice == MIDI_DRUMS ? 2 : 0;
            if (own != turn || h->z < LOW)
                continue;
            double at[4];
            if ((own > 1 || (own == 1 && timpani == 1)) && find_usual(h, at)) {
                h->x = at[0];
                h->y = at[1];
                h->z = at[2];
                h->tilt = at[3];
            }
            if (own == 2 && h->radius <= SMALL)
                h->z = fmax(h->z, HANGS);
            if (own == 0)
                h->z += HIGHER * keyboards++;
            place(part, placed, h);
            if (own > 0 && is_behind(part, placed, h))
                h->z = fmax(h->z, OVER_BARS);
            placed[i] = true;
        }
}
