/// player_describe.c: a take's player in a few lines for a person.
#include "himc/mocap.h"

#include "base/line_sink.h"

#include <stdio.h>
#include <string.h>

// "upper-arm 0.281 0.283": left and right
static void tell_lengths(const himc_skeleton_config *c, const himc_line_sink *to)
{
    char text[220] = "";
    size_t used = 0;
    for (int i = 0; i < HIMC_SEGMENTS && used < sizeof text; i++) {
        const char *name = himc_segment_name(i);
        bool paired = i >= HIMC_LEFT_UPPER_ARM;
        if (c->length[i] <= 0)
            continue;
        used += (size_t)snprintf(text + used, sizeof text - used, "%s %s %.3f", used ? "," : "",
                                 paired ? name + strlen("left-") : name, c->length[i]);
        if (paired && used < sizeof text)
            used += (size_t)snprintf(text + used, sizeof text - used, " %.3f", c->length[++i]);
    }
    if (used)
        himc_tell(to, "lengths (m):%s", text);
}

static void tell_measures(const himc_player *player, const himc_line_sink *to)
{
    const himc_skeleton_config *c = &player->config;
    const char *from = player->height_from[0] ? player->height_from : "nothing in the take";
    if (player->mass_said)
        himc_tell(to, "player: %.3f m tall (by %s), %.1f kg (the file says so)", c->height, from,
                  c->mass);
    else
        himc_tell(to, "player: %.3f m tall (by %s), %.1f kg (by a body mass index of %.1f)",
                  c->height, from, c->mass, c->mass / (c->height * c->height));
    tell_lengths(c, to);
}

static void tell_posture(const himc_player *player, const himc_line_sink *to)
{
    char text[220] = "";
    size_t used = 0;
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (player->known[j] && used < sizeof text)
            used += (size_t)snprintf(text + used, sizeof text - used, " %s", himc_joint_name(j));
    himc_tell(to, "posture:%s", used ? text : " the natural one, for no joint is shown");
}

// in our world, whose origin is on the floor under the player, and in the take
static void tell_places(const himc_player *player, const himc_head_frame *drum,
                        const himc_line_sink *to)
{
    himc_vec3 floor = himc_vec3_scale(player->offset, -1);
    himc_vec3 head = himc_vec3_add(drum->center, floor), hips = player->hips;
    himc_tell(to, "seat: hip joints %.3f m above the floor, by %s; in the take at %.3f %.3f %.3f m",
              himc_skeleton_seat(&player->config), player->placed ? "the take's own" : "the tips",
              hips.x, hips.y, hips.z);
    himc_tell(
        to,
        "drumhead: centre %.3f m before the player, %.3f m to the left, %.3f m high; in the take "
        "at %.3f %.3f %.3f m",
        drum->center.x, drum->center.y, drum->center.z, head.x, head.y, head.z);
}

void himc_player_describe(const himc_player *player, const himc_head_frame *drum,
                          void (*line)(void *, const char *), void *user)
{
    himc_line_sink to = {line, user};
    tell_measures(player, &to);
    tell_posture(player, &to);
    for (int i = 0; i < player->note_count; i++)
        himc_tell(&to, "note: %.240s", player->notes[i]);
    if (player->seated && drum)
        tell_places(player, drum, &to);
}
