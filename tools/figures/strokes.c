/// strokes.c: captured strokes and what the controllers make of them, for figures 5 and 6(a) of
/// Bouënard, Gibet & Wanderley 2012: `strokes follow LAW GAIN` and `strokes phases LAW GAIN`.
///
/// `follow` plays the first trial of the evaluation, legato, under `ik`, `id` and `himc`, one block
/// each: time (s); captured flexion of wrist, elbow and shoulder (degrees), heights of tip, wrist
/// and elbow (m), all of the right side; the same six as simulated. `phases` has a block for each
/// nuance: time; depth and height of the right tip, captured, then simulated by `himc` (m).
///
/// Flexions are read off the segments' directions alike in both: of the elbow the angle between
/// upper arm and forearm, of the shoulder the upper arm's from hanging, in the sagittal plane, of
/// the wrist the hand's elevation over the forearm's.
#include "../trial.h"
#include "control/controller.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HAND HIMC_RIGHT

static himc_vec3 origin(const himc_body_state *body, int k)
{
    return body->origin[himc_arm_joint(HAND, k) + 1];
}

static himc_vec3 along(const himc_body_state *body, int k)
{
    return himc_vec3_unit(himc_vec3_sub(origin(body, k + 1), origin(body, k)));
}

static void print_arm(const himc_body_state *body)
{
    himc_vec3 upper = along(body, 0), fore = along(body, 1), hand = along(body, 2);
    double shoulder = atan2(upper.x, -upper.z), elbow = acos(himc_vec3_dot(upper, fore));
    double wrist = asin(hand.z) - asin(fore.z), degree = HIMC_PI / 180;
    printf(" %.3f %.3f %.3f %.5f %.5f %.5f", wrist / degree, elbow / degree, shoulder / degree,
           body->tip[HAND].z, origin(body, 2).z, origin(body, 1).z);
}

static void print_follow(void *user, const trial_frame *frame)
{
    (void)user;
    printf("%.4f", frame->time);
    print_arm(frame->captured);
    print_arm(frame->simulated_body);
    puts("");
}

static void print_phase(void *user, const trial_frame *frame)
{
    (void)user;
    himc_vec3 a = frame->captured->tip[HAND], b = frame->simulated->tip[HAND];
    printf("%.4f %.5f %.5f %.5f %.5f\n", frame->time, a.x, a.z, b.x, b.z);
}

static bool play(trial_kind kind, double gain, void (*frame)(void *, const trial_frame *),
                 himc_error *error)
{
    trial_result result;
    trial_config config = trial_default(&kind, 1);
    config.gain = gain;
    config.frame = frame;
    bool good = trial_run(&config, &result, error);
    puts("\n");
    return good;
}

static bool follow(himc_law law, double gain, himc_error *error)
{
    static const himc_pipeline order[] = {HIMC_PIPELINE_IK, HIMC_PIPELINE_ID, HIMC_PIPELINE_HIMC};
    for (int i = 0; i < 3; i++)
        if (!play((trial_kind){HIMC_LEGATO, order[i], law}, gain, print_follow, error))
            return false;
    return true;
}

static bool phases(himc_law law, double gain, himc_error *error)
{
    for (int n = 0; n < HIMC_NUANCES; n++)
        if (!play((trial_kind){(himc_nuance)n, HIMC_PIPELINE_HIMC, law}, gain, print_phase, error))
            return false;
    return true;
}

static int find_law(const char *name)
{
    trial_kind kind = {HIMC_LEGATO, HIMC_PIPELINE_ID, HIMC_LAW_PRINTED};
    for (int law = 0; law < TRIAL_LAWS; law++) {
        kind.law = (himc_law)law;
        if (!strcmp(name, trial_law_name(&kind).text))
            return law;
    }
    return -1;
}

int main(int count, char **word)
{
    himc_error error;
    int law = count == 4 ? find_law(word[2]) : -1;
    double gain = count == 4 ? atof(word[3]) : 0;
    if (law < 0 || !(gain > 0) || (strcmp(word[1], "follow") && strcmp(word[1], "phases"))) {
        fprintf(stderr, "strokes: wanted is follow|phases LAW GAIN\n");
        return 1;
    }
    bool good = strcmp(word[1], "follow") ? phases((himc_law)law, gain, &error)
                                          : follow((himc_law)law, gain, &error);
    if (!good)
        fprintf(stderr, "strokes: %s\n", error.text);
    return !good;
}
