/// drum_strike.c: hits without a performer: free mallets, launched as they touch, forgotten when
/// they have left.
///
/// A mallet starts where the head is at that moment, so that its first sample is its first force
/// and a strike is exact to the sample. It is weightless: in the few milliseconds of a contact
/// gravity changes nothing, and so even the gentlest one leaves.
#include "drum/drum_state.h"

#include <math.h>

#define GONE 0.005  // (m) above the head at rest and rising: it will not come back
#define LONGEST 1.0 // (s) a mallet is taken away after this whatever it does

bool himc_drum_strike_at(himc_drum *drum, int delay, double x, double y, double velocity,
                         himc_error *error)
{
    if (!himc_check_range("strike x", x, -drum->place.radius, drum->place.radius, "m", error) ||
        !himc_check_range("strike y", y, -drum->place.radius, drum->place.radius, "m", error) ||
        !himc_check_range("strike place, from the centre", hypot(x, y), 0, drum->place.radius, "m",
                          error) ||
        !himc_check_range("strike velocity", velocity, 0.001, HIMC_STRIKE_VELOCITY_MAX, "m/s",
                          error) ||
        !himc_check_range("strike delay", delay, 0, DRUM_MAX_DELAY, "samples", error))
        return false;
    if (drum->waiting_count == DRUM_WAITING)
        return himc_error_set(error, "strike: %d wait already, allowed up to %d", DRUM_WAITING,
                              DRUM_WAITING);
    drum->waiting[drum->waiting_count++] =
        (drum_waiting){drum->time + (uint64_t)delay, x, y, velocity};
    return true;
}

static drum_mallet *free_mallet(himc_drum *drum)
{
    for (int i = 0; i < HIMC_STICKS; i++)
        if (!drum->mallets[i].used)
            return &drum->mallets[i];
    return NULL;
}

// the one that has waited longest, the first asked for if several have; -1 if none is due
static int earliest(const himc_drum *drum)
{
    int best = -1;
    for (int i = 0; i < drum->waiting_count; i++)
        if (best < 0 || drum->waiting[i].at < drum->waiting[best].at)
            best = i;
    return best;
}

static void forget(himc_drum *drum, int index)
{
    drum->waiting_count--;
    for (int i = index; i < drum->waiting_count; i++)
        drum->waiting[i] = drum->waiting[i + 1];
}

static void launch(himc_drum *drum, drum_mallet *m, const drum_waiting *w)
{
    *m = (drum_mallet){.used = true};
    m->stick = (himc_stick){.head = drum->mallet,
                            .mass = drum->mallet.mass,
                            .x = w->x,
                            .y = w->y,
                            .height = himc_membrane_displacement(drum->membrane, w->x, w->y),
                            .velocity = -w->velocity};
    m->report = (himc_contact_report){.x = w->x, .y = w->y, .velocity = w->velocity};
}

void himc_drum_launch(himc_drum *drum)
{
    for (;;) {
        int next = earliest(drum);
        drum_mallet *m = free_mallet(drum);
        if (next < 0 || !m || drum->waiting[next].at > drum->time)
            return;
        launch(drum, m, &drum->waiting[next]);
        forget(drum, next);
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

// its story ends: the report waits for himc_drum_strike_next; the oldest is dropped when nobody
// asks
static void finish(himc_drum *drum, drum_mallet *m)
{
    m->used = false;
    if (!m->touched)
        return;
    m->report.time = ((double)m->touch - (double)drum->zero) / drum->rate;
    m->report.duration = (double)(m->release - m->touch) / drum->rate;
    if (drum->report_count == DRUM_REPORTS) {
        drum->report_first = (drum->report_first + 1) % DRUM_REPORTS;
        drum->report_count--;
    }
    drum->reports[(drum->report_first + drum->report_count++) % DRUM_REPORTS] = m->report;
}

static void follow(himc_drum *drum, drum_mallet *m)
{
    const himc_stick *s = &m->stick;
    if (s->force > 0) {
        if (!m->touched)
            m->touch = drum->time - 1;
        m->touched = true;
        m->release = drum->time;
        m->report.force = fmax(m->report.force, fmax(s->force, s->peak));
        m->report.impulse += s->force / drum->rate;
    }
    m->age++;
    if ((!s->touching && s->height > GONE && s->velocity > 0) || m->age > LONGEST * drum->rate)
        finish(drum, m);
}

void himc_drum_follow_mallets(himc_drum *drum)
{
    for (int i = 0; i < HIMC_STICKS; i++)
        if (drum->mallets[i].used)
            follow(drum, &drum->mallets[i]);
}

bool himc_drum_strike_next(himc_drum *drum, himc_contact_report *report)
{
    if (drum->report_count == 0)
        return false;
    *report = drum->reports[drum->report_first];
    drum->report_first = (drum->report_first + 1) % DRUM_REPORTS;
    drum->report_count--;
    return true;
}
