/// take_names.c: what points are called. Laboratories name the same thing "RTIP", "Daphnee:R_Tip",
/// "StickTipRight" or "RightStick_end"; names are compared as plain letters and digits without
/// prefixes, and read as a few known words with at most one word for the side among them.
#include "capture/take_data.h"

#include <string.h>

void himc_take_plain_name(const char *name, char plain[TAKE_NAME])
{
    const char *colon = strrchr(name, ':');
    size_t n = 0;
    for (const char *c = colon ? colon + 1 : name; *c && n < TAKE_NAME - 1; c++) {
        if (*c >= 'A' && *c <= 'Z')
            plain[n++] = (char)(*c - 'A' + 'a');
        else if ((*c >= 'a' && *c <= 'z') || (*c >= '0' && *c <= '9'))
            plain[n++] = *c;
    }
    plain[n] = 0;
}

int himc_take_find(const himc_take *take, const char *name)
{
    for (int i = 0; i < take->points; i++)
        if (strcmp(take->names[i], name) == 0)
            return i;
    char wanted[TAKE_NAME], plain[TAKE_NAME];
    himc_take_plain_name(name, wanted);
    for (int i = 0; i < take->points && wanted[0]; i++) {
        himc_take_plain_name(take->names[i], plain);
        if (strcmp(plain, wanted) == 0)
            return i;
    }
    return -1;
}

static const char *skip_words(const char *at, const char *const *words, char *rest)
{
    for (int i = 0; words[i];) {
        size_t n = strlen(words[i]);
        bool fits = strncmp(at, words[i], n) == 0;
        if (fits) {
            strncat(rest, at, n);
            at += n;
        }
        i = fits ? 0 : i + 1;
    }
    return at;
}

int himc_take_side(const char *plain, const char *const *words, char rest[TAKE_NAME])
{
    static const struct {
        const char *word;
        int hand;
    } sides[] = {{"left", HIMC_LEFT},
                 {"right", HIMC_RIGHT},
                 {"l", HIMC_LEFT},
                 {"r", HIMC_RIGHT},
                 {"", HIMC_HANDS}};
    rest[0] = 0;
    const char *at = skip_words(plain, words, rest);
    size_t before = strlen(rest);
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        size_t n = strlen(sides[i].word);
        rest[before] = 0;
        if (strncmp(at, sides[i].word, n) == 0 && !*skip_words(at + n, words, rest) && rest[0])
            return sides[i].hand;
    }
    return -1;
}

// 0 for what is no stick; else the more it is the very end of one, the higher
static int tip_rank(const char *rest)
{
    if (strstr(rest, "tip"))
        return 4;
    if (strstr(rest, "bead") || strstr(rest, "end"))
        return strcmp(rest, "end") && strcmp(rest, "headend") ? 3 : 0;
    if (strstr(rest, "mallet") || strstr(rest, "beater"))
        return 2;
    return strstr(rest, "stick") ? 1 : 0;
}

static int best_tip(const himc_take *take, int side)
{
    // longer words first: "drumstick" must not be read as "drum" and a rest
    static const char *const words[] = {"stick",   "mallet", "beater", "bead", "drum",
                                        "timpani", "tip",    "head",   "end",  NULL};
    int best = -1, best_rank = 0;
    for (int i = 0; i < take->points; i++) {
        char plain[TAKE_NAME], rest[TAKE_NAME];
        himc_take_plain_name(take->names[i], plain);
        int hand = himc_take_side(plain, words, rest), rank = hand == side ? tip_rank(rest) : 0;
        if (rank > best_rank) {
            best = i;
            best_rank = rank;
        }
    }
    return best;
}

int himc_take_find_tip(const himc_take *take, himc_hand hand, const himc_take_options *options)
{
    const char *name = hand == HIMC_LEFT ? options->left_tip : options->right_tip;
    if (name)
        return himc_take_find(take, name);
    int found = best_tip(take, hand);
    if (found < 0 && hand == HIMC_RIGHT) // a lone bead without a side
        found = best_tip(take, HIMC_HANDS);
    const char *other = hand == HIMC_LEFT ? options->right_tip : options->left_tip;
    return found >= 0 && other && himc_take_find(take, other) == found ? -1 : found;
}
