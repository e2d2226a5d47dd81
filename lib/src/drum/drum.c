/// drum.c: a head advances with whatever touches it, sample by sample, into a ring that others
/// read.
///
/// Every sample is the same computation whichever way it is asked for. While nothing can touch
/// (himc_contact_clear) the head runs free in long vectorised passes, whose bits equal single steps
/// (bank.c); otherwise each sample is a himc_contact_step of all sticks. So the output does not
/// depend on how the caller cuts time into blocks.
#include "drum/drum_state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_AHEAD 512 // (samples)
#define MOST_FORCE \
    1e5 // (N) a larger one from outside counts as this, so that the sound stays finite

static bool check_rate(double rate, himc_error *error)
{
    return himc_check_range("sample rate", rate, 8000, 192000, "Hz", error);
}

himc_drum *himc_drum_new(const char *name, double inches, double sample_rate, himc_error *error)
{
    if (strlen(name) >= HIMC_NAME_SIZE) {
        himc_error_set(error, "drum: name %s, allowed up to %d characters", name,
                       HIMC_NAME_SIZE - 1);
        return NULL;
    }
    if (!himc_check_range("inches", inches, 12, 60, "in", error) || !check_rate(sample_rate, error))
        return NULL;
    himc_head head = himc_head_default();
    head.radius = inches * 0.0254 / 2;
    himc_membrane *membrane = himc_membrane_new(&head, sample_rate, error);
    himc_drum *drum = calloc(1, sizeof *drum);
    if (!membrane || !drum) {
        himc_membrane_free(membrane);
        free(drum);
        if (membrane)
            himc_error_set(error, "drum: no memory");
        return NULL;
    }
    snprintf(drum->name, sizeof drum->name, "%s", name);
    drum->references = 1;
    drum->level = 1;
    drum->membrane = membrane;
    himc_drum_mallet_preset("medium", &drum->mallet);
    snprintf(drum->mallet_name, sizeof drum->mallet_name, "medium");
    drum->place = (himc_head_frame){.center = {0.70, 0, 0.85}, .radius = head.radius};
    drum->rate = sample_rate;
    drum->spot_x = -0.75 * head.radius;
    himc_membrane_watch(membrane, drum->spot_x, drum->spot_y);
    return drum;
}

himc_drum *himc_drum_retain(himc_drum *drum)
{
    drum->references++;
    return drum;
}

void himc_drum_release(himc_drum *drum)
{
    if (!drum || --drum->references > 0)
        return;
    himc_membrane_free(drum->membrane);
    free(drum);
}

const char *himc_drum_name(const himc_drum *drum)
{
    return drum->name;
}

void himc_drum_rest(himc_drum *drum)
{
    himc_membrane_rest(drum->membrane);
    drum->waiting_count = 0;
    for (int i = 0; i < HIMC_STICKS; i++)
        drum->mallets[i] = (drum_mallet){.used = false};
}

bool himc_drum_is_placed(const himc_drum *drum)
{
    return drum->placed;
}

void himc_drum_stand(himc_drum *drum, himc_vec3 center)
{
    drum->place.center = center;
    drum->revision++;
}

const himc_head_frame *himc_drum_head_frame(const himc_drum *drum)
{
    return &drum->place;
}

himc_membrane *himc_drum_membrane(himc_drum *drum)
{
    return drum->membrane;
}

const himc_mallet_head *himc_drum_mallet(const himc_drum *drum)
{
    return &drum->mallet;
}

unsigned himc_drum_revision(const himc_drum *drum)
{
    return drum->revision;
}

double himc_drum_rate(const himc_drum *drum)
{
    return drum->rate;
}

bool himc_drum_set_rate(himc_drum *drum, double sample_rate, himc_error *error)
{
    if (!check_rate(sample_rate, error) ||
        !himc_membrane_set_rate(drum->membrane, sample_rate, error))
        return false;
    double ratio = sample_rate / drum->rate;
    for (int i = 0; i < drum->waiting_count; i++) {
        uint64_t left = drum->waiting[i].at > drum->time ? drum->waiting[i].at - drum->time : 0;
        drum->waiting[i].at = drum->time + (uint64_t)llround((double)left * ratio);
    }
    // touches under way keep the seconds that have passed since
    for (int i = 0; i < HIMC_STICKS; i++) {
        drum_mallet *m = &drum->mallets[i];
        m->touch = drum->time - (uint64_t)llround((double)(drum->time - m->touch) * ratio);
        m->release = drum->time - (uint64_t)llround((double)(drum->time - m->release) * ratio);
    }
    drum->rate = sample_rate;
    return true;
}

// what happens from outside in one call, and how far it has been played
typedef struct outside {
    const double *force, *x, *y;
    int at, n;
} outside;

static void move_spot(himc_drum *drum, const outside *o)
{
    if (!o->force || !o->x || !o->y || !isfinite(o->x[o->at]) || !isfinite(o->y[o->at]))
        return;
    drum->spot_x = o->x[o->at];
    drum->spot_y = o->y[o->at];
    himc_membrane_watch(drum->membrane, drum->spot_x, drum->spot_y);
}

// the force of sample `at`, made fit
static double outside_force(const outside *o, int at)
{
    if (!o->force || !isfinite(o->force[at]))
        return 0;
    return fmin(fmax(o->force[at], -MOST_FORCE), MOST_FORCE);
}

// samples from now on without force at the present spot
static int outside_quiet(const himc_drum *drum, const outside *o)
{
    int i = o->at;
    while (i < o->n && outside_force(o, i) == 0) {
        if (o->force && o->x && o->y && (o->x[i] != drum->spot_x || o->y[i] != drum->spot_y))
            break;
        i++;
    }
    return i - o->at;
}

static int channels(const himc_drum *drum)
{
    int count;
    himc_membrane_pickups(drum->membrane, &count);
    return count;
}

// the membrane's last sample; a channel that nobody hears is silent
static void keep(himc_drum *drum)
{
    size_t at = drum->time++ % HIMC_DRUM_RING;
    double level = himc_drum_loudness(drum);
    for (int k = 0, count = channels(drum); k < HIMC_PICKUPS; k++)
        drum->sound[k][at] = k < count ? level * himc_membrane_heard_by(drum->membrane, k) : 0;
    drum->seen[at] = himc_membrane_seen(drum->membrane);
}

#define CHUNK 64

// the head alone; the sticks fly
static void run_clear(himc_drum *drum, int n, himc_stick *const *sticks, int count,
                      double *const *forces, int at)
{
    double heard[HIMC_PICKUPS][CHUNK] = {{0}}, seen[CHUNK], h = 1 / drum->rate;
    double *into[HIMC_PICKUPS];
    for (int k = 0; k < HIMC_PICKUPS; k++)
        into[k] = heard[k];
    himc_membrane_run_all(drum->membrane, n, into, seen);
    for (int i = 0; i < n; i++, drum->time++) {
        double level = himc_drum_loudness(drum);
        for (int k = 0; k < HIMC_PICKUPS; k++)
            drum->sound[k][drum->time % HIMC_DRUM_RING] = level * heard[k][i];
        drum->seen[drum->time % HIMC_DRUM_RING] = seen[i];
    }
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < n; i++)
            himc_stick_fly(sticks[k], h);
        for (int i = 0; forces && forces[k] && i < n; i++)
            forces[k][at + i] = 0;
    }
}

static void step_once(himc_drum *drum, himc_stick **all, int given, double *const *forces,
                      const outside *o)
{
    double force = outside_force(o, o->at);
    if (force != 0)
        himc_membrane_push(drum->membrane, drum->spot_x, drum->spot_y, force);
    int count = given + himc_drum_add_mallets(drum, all + given);
    unsigned known[2 * HIMC_STICKS];
    for (int k = 0; k < count; k++)
        known[k] = all[k]->touches;
    himc_contact_step(drum->membrane, all, count);
    for (int k = 0; k < count; k++)
        if (all[k]->touches != known[k])
            himc_drum_keep_touch(drum, all[k]);
    for (int k = 0; forces && k < given; k++)
        if (forces[k])
            forces[k][o->at] = all[k]->force;
    keep(drum);
    himc_drum_follow_mallets(drum);
}

void himc_drum_advance(himc_drum *drum, int n, himc_stick *const *sticks, int stick_count,
                       double *const *forces, const double *force, const double *x, const double *y)
{
    himc_stick *all[2 * HIMC_STICKS];
    outside o = {force, x, y, 0, n};
    for (int i = 0; i < stick_count; i++)
        all[i] = sticks[i];
    while (o.at < n) {
        himc_drum_launch(drum);
        move_spot(drum, &o);
        bool alone = himc_drum_add_mallets(drum, all + stick_count) == 0;
        int run = alone ? outside_quiet(drum, &o) : 0;
        run = himc_drum_until_launch(drum, run < CHUNK ? run : CHUNK);
        run = himc_contact_clear(drum->membrane, all, stick_count, run);
        if (run > 0)
            run_clear(drum, run, all, stick_count, forces, o.at);
        else
            step_once(drum, all, stick_count, forces, &o);
        o.at += run > 0 ? run : 1;
    }
}

// samples [start, start + n) of a ring
static void copy(const himc_drum *drum, const double *ring, uint64_t start, int n, double *out)
{
    uint64_t oldest = drum->time > HIMC_DRUM_RING ? drum->time - HIMC_DRUM_RING : 0;
    for (int i = 0; i < n; i++) {
        uint64_t at = drum->zero + start + (uint64_t)i;
        out[i] = at >= oldest && at < drum->time ? ring[at % HIMC_DRUM_RING] : 0;
    }
}

void himc_drum_read(const himc_drum *drum, uint64_t start, int n, double *sound,
                    double *displacement)
{
    if (sound)
        copy(drum, drum->sound[0], start, n, sound);
    if (displacement)
        copy(drum, drum->seen, start, n, displacement);
}

void himc_drum_read_channel(const himc_drum *drum, int channel, uint64_t start, int n,
                            double *sound)
{
    copy(drum, drum->sound[channel], start, n, sound);
}

uint64_t himc_drum_time(const himc_drum *drum)
{
    return drum->time - drum->zero;
}

void himc_drum_realign(himc_drum *drum, int ahead)
{
    uint64_t kept = ahead > 0 ? (uint64_t)ahead : 0, before = drum->zero;
    drum->zero = drum->time - (kept < drum->time ? kept : drum->time);
    for (int i = 0; i < drum->report_count; i++)
        drum->reports[(drum->report_first + i) % DRUM_REPORTS].time -=
            ((double)drum->zero - (double)before) / drum->rate;
}

bool himc_drum_set_driver(himc_drum *drum, himc_drum_driver driver)
{
    if (driver.performer && drum->driver.performer && drum->driver.performer != driver.performer)
        return false;
    drum->driver = driver;
    return true;
}

himc_drum_driver himc_drum_get_driver(const himc_drum *drum)
{
    return drum->driver;
}
