/// player_describe.c: a take's player in a few lines for a person.
#include "himc/player.h"

#include <stdio.h>
#include <string.h>

typedef struct teller {
    void (*line)(void *, const char *);
    void *user;
} teller;

static void tell(const teller *to, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void tell(const teller *to, const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    to->line(to->user, text);
}

static void tell_measures(const himc_player *player, const teller *to)
{
    const himc_skeleton_config *c = &player->config;
    const char *from = player->height_from[0] ? player->height_from : "nothing in the take";
    if (player->mass_said)
        tell(to, "player: %.3f m tall (by %s), %.1f kg (the file says so)", c->height, from,
             c->mass);
    else
        tell(to, "player: %.3f m tall (by %s), %.1f kg (by a body mass index of %.1f)", c->height,
             from, c->mass, c->mass / (c->height * c->height));
    char text[220] = "";
    size_t used = 0;
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        if (c->length[i] > 0 && used < sizeof text)
            used += (size_t)snprintf(text + used, sizeof text - used, "%s %s %.3f", used ? "," : "",
                                     himc_segment_name(i), c->length[i]);
    if (used)
        tell(to, "lengths (m):%s", text);
}

static void tell_posture(const himc_player *player, const teller *to)
{
    char text[220] = "";
    size_t used = 0;
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (player->known[j] && used < sizeof text)
            used += (size_t)snprintf(text + used, sizeof text - used, " %s", himc_joint_name(j));
    tell(to, "posture:%s", used ? text : " the natural one, for no joint is shown");
}

void himc_player_describe(const himc_player *player, void (*line)(void *, const char *), void *user)
{
    teller to = {line, user};
    tell_measures(player, &to);
    tell_posture(player, &to);
    for (int i = 0; i < player->note_count; i++)
        tell(&to, "note: %.240s", player->notes[i]);
    if (player->seated)
        tell(&to, "seat: hip joints at %.3f %.3f m in the take, %.3f m above our floor",
             player->hips.x, player->hips.y, player->config.seat);
}
