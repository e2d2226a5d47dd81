/// take_describe.c: a take in a few lines for a person: what it is, how it was read, what is in it.
#include "capture/take_data.h"
#include "base/line_sink.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GAP_LINES 40    // points with gaps listed
#define STRIKE_LINES 64 // strikes listed
#define ONE_DRUM 0.45   // no two strikes on one are farther from its usual spot (m)

// names in lines of at most 100 characters
static void tell_points(const himc_take *take, const himc_line_sink *to)
{
    char text[128];
    int used = snprintf(text, sizeof text,
                        "%s %d:", himc_take_has_skeleton(take) ? "joints" : "points", take->points);
    for (int i = 0; i < take->points; i++) {
        if (used + (int)strlen(take->names[i]) > 98) {
            himc_tell(to, "%s", text);
            used = snprintf(text, sizeof text, "   ");
        }
        used += snprintf(text + used, sizeof text - (size_t)used, " %s", take->names[i]);
    }
    himc_tell(to, "%s", text);
}

// "gap NAME: 92 frames: 1-40 77-128", at most six of its gaps
static void tell_gap(const himc_take *take, int point, int missing, const himc_line_sink *to)
{
    char text[200] = "";
    size_t used = 0;
    int shown = 0;
    for (int i = 0, begin = -1; i <= take->frames && shown <= 6; i++) {
        bool seen = i == take->frames || himc_vec3_finite(*himc_take_at(take, i, point));
        if (!seen && begin < 0)
            begin = i;
        if (seen && begin >= 0) {
            int first = take->first_frame + begin, last = take->first_frame + i - 1;
            used += shown == 6 ? (size_t)snprintf(text + used, sizeof text - used, " ...")
                    : first == last
                        ? (size_t)snprintf(text + used, sizeof text - used, " %d", first)
                        : (size_t)snprintf(text + used, sizeof text - used, " %d-%d", first, last);
            begin = -1;
            shown++;
        }
    }
    himc_tell(to, "gap: %s is missing in %d frames:%s", take->names[point], missing, text);
}

static void tell_gaps(const himc_take *take, const himc_line_sink *to)
{
    int points = 0, all = 0;
    for (int i = 0; i < take->points; i++) {
        int missing = himc_take_missing(take, i);
        points += missing > 0;
        all += missing;
        if (missing > 0 && points <= GAP_LINES)
            tell_gap(take, i, missing, to);
    }
    himc_tell(to, "gaps: %d frames in %d points", all, points);
}

static void tell_strikes(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                         const himc_line_sink *to)
{
    int count;
    himc_take_strike *strikes = himc_take_find_strikes(take, tips, &count);
    if (!strikes)
        return;
    himc_tell(to, "strikes: %d", count);
    for (int i = 0; i < count && i < STRIKE_LINES; i++)
        himc_tell(to, "strike: %.4f s %s at %.3f %.3f %.3f m, %.2f m/s down", strikes[i].time,
                  himc_hand_name(strikes[i].hand), strikes[i].x.x, strikes[i].x.y, strikes[i].x.z,
                  strikes[i].velocity);
    himc_vec3 place;
    if (himc_take_strike_place(strikes, count, &place))
        himc_tell(to, "drum: the head belongs under %.3f %.3f m, at the height of %.3f m", place.x,
                  place.y, place.z);
    int far = 0;
    for (int i = 0; i < count; i++)
        far += hypot(strikes[i].x.x - place.x, strikes[i].x.y - place.y) > ONE_DRUM;
    if (far > 0)
        himc_tell(to,
                  "drum: %d strikes are more than %g m from there; a take is played on one drum",
                  far, ONE_DRUM);
    free(strikes);
}

static void tell_tips(himc_take *take, const himc_take_options *options, const himc_line_sink *to)
{
    himc_take_tip tips[HIMC_HANDS];
    himc_error error = {""};
    if (!himc_take_tips(take, options, tips, &error)) {
        himc_tell(to, "tips: %.249s", error.text);
        return;
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (tips[hand].present)
            himc_tell(to, "tip: %s is %s, %d frames filled", himc_hand_name((himc_hand)hand),
                      tips[hand].name, tips[hand].filled);
    tell_strikes(take, tips, to);
}

void himc_take_describe(himc_take *take, const himc_take_options *options,
                        void (*line)(void *, const char *), void *user)
{
    himc_line_sink to = {line, user};
    himc_tell(&to, "format: %s", take->format);
    himc_tell(&to, "length: %d frames at %g Hz, %.3f s, from frame %d", take->frames, take->rate,
              take->frames / take->rate, take->first_frame);
    tell_points(take, &to);
    himc_tell(&to, "units: %s", take->units_text);
    himc_tell(&to, "axes: %s", take->axes_text);
    for (int i = 0; i < take->note_count; i++)
        himc_tell(&to, "note: %s", take->notes[i]);
    tell_gaps(take, &to);
    for (int i = 0; i < take->event_count; i++)
        himc_tell(&to, "event: %.3f s %s", take->events[i].time, take->events[i].label);
    tell_tips(take, options, &to);
}
