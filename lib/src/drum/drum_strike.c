/// drum_strike.c: strikes without a performer, and the onsets of all contacts.
///
/// A free mallet is launched where the head is at that moment, so its first sample has its first
/// force and a strike is exact to the sample. It has no weight: in the few milliseconds of a
/// contact gravity changes nothing, and so even the gentlest mallet leaves the head again. Then its
/// report is queued.
///
/// The 2009 papers let a blow sound by any of three techniques: this modal one, signals, or clips
/// of recorded sound. The other two need a contact's onset, not its report, which comes when the
/// contact is over and its force known. So an onset has the position, the velocity, and the pitch
/// to which the head is tuned. Contact, head and body are the same with every technique; the head's
/// own sound goes off in 10 ms, and comes back, as far as the head still vibrates, with `modal`.
#include "base/head_frame.h"
#include "drum/contact.h"
#include "drum/drum_state.h"
#include "head/idiophone.h"

#include <math.h>

#define GONE 0.005 // (m) above the head at rest and rising: the contact is over; chosen
#define LEVER 0.5  // of the tip's speed the shaft has on the hoop; chosen: halfway to the fulcrum
#define LONGEST_LIFE 1.0 // (s) of a mallet, whatever it does; chosen

// The pedal of a hi-hat throws one plate against the other, at .5 to 1 m/s. That one, a part of it
// at each place, meets the edge and is pressed on it for a while, which chokes both. Chosen.
static const himc_mallet_head plate = {
    .stiffness = 1e8, .exponent = 1.5, .loss = 3, .mass = 0.1, .radius = 0.01, .relaxation = 5e-6};
#define PLATE_PLACES 4
#define PLATE_ASLANT 3e-4 // (m) from one place to the next
#define PLATE_SPEED 0.2   // of a hand's
#define PLATE_EDGE 0.95   // per radius
#define PRESS 25.0        // of the foot on each place, of its speed (N s/m) ...
#define PRESS_EASES 0.03  // ... falling in this time (s) ...
#define LAID_TIME 0.15    // a hand lies on a head that rings (s); chosen: 90 dB at HIMC_DAMP
#define PRESS_TIME 0.15   // ... until it lets go (s) ...
#define PRESS_LIFT 20.0   // ... and lifts the plate (m/s^2)
#define PRESS_HOLD 0.75   // of `damp`: 50 1/s

bool himc_drum_may_strike(const himc_head_frame *surface, double x, double y, double velocity,
                          himc_error *error)
{
    double radius = surface->radius, side = 0.5 * surface->length, aside = 0.5 * surface->width;
    if (side == 0)
        side = aside = radius;
    return himc_check_range("strike: X", x, -side, side, "m", error) &&
           himc_check_range("strike: Y", y, -aside, aside, "m", error) &&
           himc_check_range("strike: X Y, from the centre", hypot(x, y), 0, radius, "m", error) &&
           himc_check_range("strike: VELOCITY", velocity, HIMC_STRIKE_VELOCITY_MIN,
                            HIMC_STRIKE_VELOCITY_MAX, "m/s", error);
}

bool himc_drum_strike_at(himc_drum *drum, int delay, double x, double y, double velocity,
                         himc_error *error)
{
    return himc_drum_kick(drum, delay, x, y, velocity, 0, error);
}

bool himc_drum_kick(himc_drum *drum, int delay, double x, double y, double velocity, int kick,
                    himc_error *error)
{
    if (!himc_drum_may_strike(&drum->set.place, x, y, velocity, error))
        return false;
    if (delay == HIMC_STRIKE_NEVER)
        return true;
    if (!himc_check_range("strike: delay", delay, 0, DRUM_MAX_DELAY, "samples", error))
        return false;
    if (drum->waiting_count == DRUM_QUEUE)
        return himc_error_set(error, "strike: %d wait already, expected up to %d", DRUM_QUEUE,
                              DRUM_QUEUE);
    drum->waiting[drum->waiting_count++] =
        (drum_waiting){drum->time + (uint64_t)delay, x, y, velocity, kick};
    return true;
}

// index of the oldest entry, which is taken out; the ring must not be empty
static int queue_pop(drum_queue *q)
{
    int oldest = q->first;
    q->first = (oldest + 1) % DRUM_QUEUE;
    q->count--;
    return oldest;
}

// index of a new last entry; a full ring loses its oldest
static int queue_push(drum_queue *q)
{
    if (q->count == DRUM_QUEUE)
        queue_pop(q);
    return (q->first + q->count++) % DRUM_QUEUE;
}

// index of the strike that begins first, of several the first asked for; -1 if none waits
static int earliest(const himc_drum *drum)
{
    int best = -1;
    for (int i = 0; i < drum->waiting_count; i++)
        if (best < 0 || drum->waiting[i].at < drum->waiting[best].at)
            best = i;
    return best;
}

// a mallet on its way down, over the head where that is now; NULL: all are in use
static drum_mallet *add_mallet(himc_drum *drum, const himc_mallet_head *head, double x, double y,
                               double velocity, int kick)
{
    for (int i = 0; i < HIMC_STICKS; i++) {
        drum_mallet *m = &drum->mallets[i];
        if (m->used)
            continue;
        *m = (drum_mallet){
            .used = true,
            .stick = {.head = *head, .mass = head->mass, .x = x, .y = y, .velocity = -velocity},
            .kick = kick,
            .report = {.x = x, .y = y, .velocity = velocity}};
        himc_stick_put(drum->membrane, &m->stick);
        return m;
    }
    return NULL;
}

// plates are never quite parallel: they meet at one place after the other
static bool close_hats(himc_drum *drum, double velocity, int kick)
{
    double speed = PLATE_SPEED * velocity;
    double out = PLATE_EDGE * himc_membrane_head(drum->membrane)->radius;
    drum_mallet *first = NULL, *m;
    for (int i = 0; i < PLATE_PLACES; i++) {
        double angle = 2 * HIMC_PI * i / PLATE_PLACES;
        m = add_mallet(drum, &plate, -out * cos(angle), out * sin(angle), speed,
                       first ? DRUM_NOT_TOLD : kick);
        if (!m)
            break;
        m->stick.height += i * PLATE_ASLANT;
        m->stick.acceleration = -PRESS * speed / plate.mass;
        m->stick.hold = PRESS_HOLD;
        first = first ? first : m;
    }
    return first;
}

void himc_drum_launch(himc_drum *drum)
{
    for (;;) {
        int next = earliest(drum);
        if (next < 0 || drum->waiting[next].at > drum->time)
            return;
        drum_waiting w = drum->waiting[next];
        bool free = w.kick > 0 && himc_drum_hats(drum)
                        ? close_hats(drum, w.velocity, w.kick)
                        : add_mallet(drum, &drum->set.mallet[HIMC_RIGHT], w.x, w.y, w.velocity,
                                     w.kick) != NULL;
        if (!free)
            return;
        drum->waiting_count--;
        for (int i = next; i < drum->waiting_count; i++)
            drum->waiting[i] = drum->waiting[i + 1];
    }
}

int himc_drum_until_launch(const himc_drum *drum, int most)
{
    int next = earliest(drum);
    if (next < 0 || drum->waiting[next].at >= drum->time + (uint64_t)most)
        return most;
    return drum->waiting[next].at > drum->time ? (int)(drum->waiting[next].at - drum->time) : 0;
}

int himc_drum_add_mallets(himc_drum *drum, himc_stick **sticks)
{
    int count = 0;
    for (int i = 0; i < HIMC_STICKS; i++)
        if (drum->mallets[i].used)
            sticks[count++] = &drum->mallets[i].stick;
    return count;
}

static void follow(himc_drum *drum, drum_mallet *m)
{
    const himc_stick *s = &m->stick;
    if (s->force > 0) {
        if (m->report.force == 0)
            m->first = drum->time - 1;
        m->end = drum->time;
        m->report.force = fmax(m->report.force, fmax(s->force, s->peak));
        m->report.impulse += s->force / drum->rate;
    }
    // a foot presses less and less, and lets go
    m->stick.acceleration *= 1 - 1 / (PRESS_EASES * drum->rate);
    if (++m->age == (int)(PRESS_TIME * drum->rate) && s->hold > 0)
        m->stick.acceleration = PRESS_LIFT;
    bool gone = !s->touching && s->height > GONE && s->velocity > 0;
    m->used = !gone && m->age <= LONGEST_LIFE * drum->rate;
    if (m->used || m->report.force == 0 || m->kick == DRUM_NOT_TOLD)
        return;
    m->report.time = ((double)m->first - (double)drum->zero) / drum->rate;
    m->report.duration = (double)(m->end - m->first) / drum->rate;
    drum->reports[queue_push(&drum->report_queue)] = m->report;
    if (m->kick)
        drum->kicks[queue_push(&drum->kick_queue)] = (drum_kick){m->report, m->first, m->kick};
}

void himc_drum_follow_mallets(himc_drum *drum)
{
    for (int i = 0; i < HIMC_STICKS; i++)
        if (drum->mallets[i].used)
            follow(drum, &drum->mallets[i]);
}

bool himc_drum_strike_next(himc_drum *drum, himc_contact_report *report)
{
    if (drum->report_queue.count == 0)
        return false;
    *report = drum->reports[queue_pop(&drum->report_queue)];
    return true;
}

void himc_drum_meet(const himc_drum *drum, himc_spot spot, himc_stick *stick)
{
    const himc_shell *shell = himc_membrane_config_of(drum->membrane)->shape.shell;
    double out, own = stick->head.mass, far = hypot(stick->x, stick->y);
    bool beyond = himc_spot_is_beyond(spot) && shell && himc_shell_has_hoop(shell) && far > 0;
    stick->shaft = beyond && spot == HIMC_SPOT_RIMSHOT ? LEVER : 0;
    if (!beyond || spot == HIMC_SPOT_RIMSHOT)
        return;
    stick->head = *himc_fittings_meet(spot, &out);
    stick->head.mass = own;
    double scale = out * himc_membrane_head(drum->membrane)->radius / far;
    stick->x *= scale;
    stick->y *= scale;
}

void himc_drum_launch_shaft(himc_drum *drum, himc_stick *stick)
{
    double out;
    const himc_mallet_head *head = himc_fittings_meet(HIMC_SPOT_RIMSHOT, &out);
    if (stick->shaft > 0)
        add_mallet(drum, head, -out * himc_membrane_head(drum->membrane)->radius, 0,
                   stick->shaft * stick->impact, DRUM_NOT_TOLD);
    stick->shaft = 0;
}

void himc_drum_lay(himc_drum *drum, int delay, bool hand)
{
    uint64_t at = drum->time + (uint64_t)delay;
    if (hand) {
        drum->laid_from = at;
        drum->laid_until = at + (uint64_t)(LAID_TIME * drum->rate);
    } else if (at < drum->laid_until) {
        drum->laid_until = at;
    }
}

bool himc_drum_hats(const himc_drum *drum)
{
    const himc_idiophone *body = himc_membrane_config_of(drum->membrane)->shape.body;
    return body && body->dampers > 0 && !body->pedal_lifts;
}

int himc_drum_kicked(himc_drum *drum, himc_contact_report *report, double *ago)
{
    if (drum->kick_queue.count == 0)
        return 0;
    const drum_kick *kick = &drum->kicks[queue_pop(&drum->kick_queue)];
    *report = kick->report;
    *ago = (double)(drum->time - kick->first) / drum->rate;
    return kick->kick;
}

double himc_drum_pitch(const himc_drum *drum)
{
    return himc_membrane_principal(drum->membrane, himc_membrane_head(drum->membrane));
}

void himc_drum_keep_onset(himc_drum *drum, const himc_stick *stick)
{
    if (!(stick->impact > 0) || stick->hold > 0)
        return; // no blow: a head raised into a resting stick, or under one that is kept there
    drum->onsets[queue_push(&drum->onset_queue)] = (himc_contact_onset){
        .at = (int64_t)drum->time,
        .x = stick->x,
        .y = stick->y,
        .velocity = stick->impact,
        .distance = fmin(hypot(stick->x, stick->y) / himc_membrane_head(drum->membrane)->radius, 1),
        .pitch = himc_drum_pitch(drum)};
}

bool himc_drum_contact_next(himc_drum *drum, himc_contact_onset *onset)
{
    if (drum->onset_queue.count == 0)
        return false;
    *onset = drum->onsets[queue_pop(&drum->onset_queue)];
    onset->at -= (int64_t)drum->zero;
    return true;
}
