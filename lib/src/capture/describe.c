/// describe.c: a take and its player in lines for a person, one per fact: `himc info`.
#include "base/format.h"
#include "base/line.h"
#include "capture/player.h"
#include "capture/take.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define GAP_RANGES 6  // chosen: gaps of one point that are listed
#define ONE_DRUM 0.45 // radius of a large timpano's head (m)

// names in lines of at most 100 characters
static void tell_names(const char *what, char (*names)[TAKE_NAME], int count, const char *between,
                       const himc_line_sink *to)
{
    char text[192];
    int used = snprintf(text, sizeof text, "%s %d:", what, count);
    for (int i = 0; i < count; i++) {
        if (used + (int)strlen(names[i]) > 98) {
            himc_tell(to, "%s", text);
            used = snprintf(text, sizeof text, "   ");
        }
        used += snprintf(text + used, sizeof text - (size_t)used, " %s%s", names[i],
                         i < count - 1 ? between : "");
    }
    himc_tell(to, "%s", text);
}

// "gap: NAME is missing in 92 frames: 1-40 77-128", for 40 points and GAP_RANGES gaps at most
static void tell_gaps(const himc_take *take, const himc_line_sink *to)
{
    int points = 0, all = 0;
    for (int point = 0; point < take->points; point++) {
        int missing = himc_take_missing(take, point), shown = 0;
        points += missing > 0;
        all += missing;
        if (missing == 0 || points > 40)
            continue;
        char text[200] = "";
        size_t used = 0;
        himc_take_gap g = himc_take_next_gap(take, point, 0);
        for (; g.begin < take->frames && shown <= GAP_RANGES; shown++) {
            int first = take->first_frame + g.begin, last = take->first_frame + g.end - 1;
            if (shown == GAP_RANGES)
                used += himc_format(text + used, sizeof text - used, " ...");
            else if (first == last)
                used += himc_format(text + used, sizeof text - used, " %d", first);
            else
                used += himc_format(text + used, sizeof text - used, " %d-%d", first, last);
            g = himc_take_next_gap(take, point, g.end);
        }
        himc_tell(to, "gap: %s is missing in %d frames:%s", take->names[point], missing, text);
    }
    himc_tell(to, "gaps: %d frames in %d points", all, points);
}

static void tell_strikes(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                         const himc_line_sink *to)
{
    himc_strike_survey s;
    if (!himc_take_strikes(take, tips, &s)) {
        himc_tell(to, "strikes: no memory to find them");
        return;
    }
    himc_tell(to, "strikes: %d%s", s.count,
              s.count ? "" : ", no tip falls onto a head; --up says which axis is up");
    for (int i = 0; i < s.count && i < 64; i++) { // listed, chosen
        const himc_take_strike *strike = &s.strikes[i];
        // a capture blunts the fall: the speed at the head is that of the fall before, carried on
        char carried[64] = "";
        double seen = himc_take_fastest_fall(take, &tips[strike->hand], strike);
        if (strike->velocity > HIMC_TAKE_CARRIED_ON * seen)
            snprintf(carried, sizeof carried, ", extrapolated from %.2f in the take", seen);
        himc_tell(to, "strike: %.4f s %s at %.3f %.3f %.3f m, %.2f m/s down%s", strike->time,
                  himc_hand_name(strike->hand), strike->x.x, strike->x.y, strike->x.z,
                  strike->velocity, carried);
    }
    if (s.left_out > 0)
        himc_tell(
            to,
            "left out: %d motions as sharp as strikes, up to %.2f m/s, that end %.3f .. %.3f m "
            "above the head",
            s.left_out, s.fastest, s.lowest, s.highest);
    himc_vec3 place = s.head[0];
    int far = 0, there[HIMC_STRIKE_HEADS] = {0};
    for (int i = 0; i < s.count; i++) {
        far += hypot(s.strikes[i].x.x - place.x, s.strikes[i].x.y - place.y) > ONE_DRUM;
        there[s.strikes[i].head]++;
    }
    free(s.strikes);
    if (s.heads > 0)
        himc_tell(to,
                  "struck: around %.3f %.3f m on the head, which tips touch at a height of %.3f m",
                  place.x, place.y, place.z);
    for (int i = 1; i < s.heads; i++)
        himc_tell(to,
                  "drum: %d strikes are on another head, at a height of %.3f m, but a take is "
                  "played on one drum",
                  there[i], s.head[i].z);
    if (far > 0)
        himc_tell(to,
                  "drum: %d strikes are more than %g m from there, but a take is played "
                  "on one drum",
                  far, ONE_DRUM);
}

void himc_take_describe(himc_take *take, const himc_take_options *options,
                        void (*line)(void *, const char *), void *user)
{
    himc_line_sink to = {line, user};
    himc_take_tip tips[HIMC_HANDS];
    himc_error error = {""};
    himc_tell(&to, "format: %s", take->format);
    himc_tell(&to, "length: %d frames at %g Hz, %.3f s, from frame %d", take->frames, take->rate,
              take->frames / take->rate, take->first_frame);
    tell_names(himc_take_has_skeleton(take) ? "joints" : "points", take->names, take->points, "",
               &to);
    himc_tell(&to, "units: %s", take->units_text);
    himc_tell(&to, "axes: %s", take->axes_text);
    for (int i = 0; i < take->note_count; i++)
        himc_tell(&to, "note: %s", take->notes[i]);
    tell_gaps(take, &to);
    if (take->analog) {
        himc_tell(&to, "analog: %d channels of %d samples at %g Hz", take->analog_channels,
                  take->analog_samples, take->analog_rate);
        tell_names("channels", take->analog_names, take->analog_channels, ",", &to);
    }
    for (int i = 0; i < take->event_count; i++)
        himc_tell(&to, "event: %.3f s %s", take->events[i].time, take->events[i].label);
    if (!himc_take_tips(take, options, tips, &error)) {
        himc_tell(&to, "tips: %.249s", error.text);
        return;
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (tips[hand].present)
            himc_tell(&to, "tip: %s is %s, %d frames in gaps are filled",
                      himc_hand_name((himc_hand)hand), tips[hand].name, tips[hand].filled);
    tell_strikes(take, tips, &to);
}

// in the world, with its origin on the floor under the player, and in the take
static void tell_places(const himc_player *player, const himc_head_frame *drum,
                        const himc_line_sink *to)
{
    double seat = himc_skeleton_seat(&player->config), moved = player->offset.z;
    char how[80]; // the seat follows from the take
    if (!player->placed)
        snprintf(how, sizeof how, "by the tips");
    else if (fabs(moved) < 5e-4)
        snprintf(how, sizeof how, "as the take shows");
    else if (seat <= PLAYER_LOWEST_SEAT || seat >= PLAYER_HIGHEST_SEAT)
        snprintf(how, sizeof how, "the %s allowed", seat <= PLAYER_LOWEST_SEAT ? "least" : "most");
    else
        snprintf(how, sizeof how, "%s by %.3f m so that the strikes meet the head",
                 moved > 0 ? "raised" : "lowered", fabs(moved));
    const char *held = player->walks ? ", without the walk," : "";
    himc_vec3 c = drum->center, head = himc_vec3_sub(c, player->offset), hips = player->hips;
    himc_tell(to, "seat: hip joints %.3f m above the floor, %s; in the take%s at %.3f %.3f %.3f m",
              seat, how, held, hips.x, hips.y, hips.z);
    himc_tell(to,
              "drumhead: centre %.3f m %s the player, %.3f m to the %s, %.3f m high; in the take%s "
              "at %.3f %.3f %.3f m",
              fabs(c.x), c.x < 0 ? "behind" : "in front of", fabs(c.y), c.y < 0 ? "right" : "left",
              c.z, held, head.x, head.y, head.z);
}

void himc_player_describe(const himc_player *player, const himc_head_frame *drum,
                          void (*line)(void *, const char *), void *user)
{
    himc_line_sink to = {line, user};
    const himc_skeleton_config *c = &player->config;
    const char *from = player->height_from[0] ? player->height_from : "the default";
    if (player->mass_stated)
        himc_tell(&to, "player: %.3f m tall (by %s), %.1f kg (stated by the file)", c->height, from,
                  c->mass);
    else
        himc_tell(&to,
                  "player: %.3f m tall (by %s), %.1f kg (by a body mass index of %.1f; the "
                  "command player says otherwise)",
                  c->height, from, c->mass, c->mass / (c->height * c->height));
    // "upper-arm 0.281 0.283": left and right
    char text[220] = "";
    size_t used = 0;
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        const char *name = himc_segment_name(i);
        bool paired = i >= HIMC_LEFT_UPPER_ARM;
        if (c->length[i] <= 0)
            continue;
        used += himc_format(text + used, sizeof text - used, "%s %s %.3f", used ? "," : "",
                            paired ? name + strlen("left-") : name, c->length[i]);
        if (paired)
            used += himc_format(text + used, sizeof text - used, " %.3f", c->length[++i]);
    }
    if (used)
        himc_tell(&to, "lengths (m):%s", text);
    used = 0;
    text[0] = 0;
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (player->known[j])
            used += himc_format(text + used, sizeof text - used, " %s", himc_joint_name(j));
    himc_tell(&to, "posture:%s%s",
              used ? " known joints" : " natural, because the take shows no joint", text);
    for (int i = 0; i < player->note_count; i++)
        himc_tell(&to, "note: %.240s", player->notes[i]);
    if (player->seated && drum)
        tell_places(player, drum, &to);
}
