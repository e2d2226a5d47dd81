/// take_tips.c: the stick tips: points found by their names, with gaps bridged.
#include "capture/take.h"

#include <string.h>

static int best_tip(const himc_take *take, int side)
{
    // longer words first: "drumstick" must not be read as "drum" and a remainder
    static const char *const words[] = {"stick",   "mallet", "beater", "bead", "drum",
                                        "timpani", "tip",    "head",   "end",  NULL};
    // the closer to the very end of the stick, the later
    static const struct {
        const char *word;
        int rank;
    } ends[] = {{"stick", 1}, {"beater", 2}, {"mallet", 2}, {"end", 3}, {"bead", 3}, {"tip", 4}};
    int best = -1, best_rank = 0;
    for (int i = 0; i < take->points; i++) {
        char plain[TAKE_NAME], rest[TAKE_NAME];
        himc_take_plain_name(take->names[i], plain);
        if (himc_take_side(plain, words, rest) != side || !strcmp(rest, "end") ||
            !strcmp(rest, "headend"))
            continue;
        int rank = 0;
        for (size_t k = 0; k < sizeof ends / sizeof ends[0]; k++)
            rank = strstr(rest, ends[k].word) ? ends[k].rank : rank;
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

bool himc_take_tips(himc_take *take, const himc_take_options *options,
                    himc_take_tip tips[HIMC_HANDS], himc_error *error)
{
    himc_take_options usual = himc_take_default();
    options = options ? options : &usual;
    if (!himc_check_range("longest gap", options->longest_gap, 0, 10, "s", error))
        return false;
    int found = 0;
    char points[96] = ""; // "A, B, C ..." for an error line
    size_t used = 0;
    for (int i = 0; i < take->points; i++) {
        bool fits = used + strlen(take->names[i]) + 6 <= sizeof points;
        used += (size_t)snprintf(points + used, sizeof points - used, "%s%s",
                                 !fits ? " "
                                 : i   ? ", "
                                       : "",
                                 fits ? take->names[i] : "...");
        if (!fits)
            break;
    }
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        const char *name = hand == HIMC_LEFT ? options->left_tip : options->right_tip;
        int point = himc_take_find_tip(take, hand, options);
        tips[hand] = (himc_take_tip){.present = false};
        if (point < 0 && name)
            return himc_error_set(error, "%s: %s tip: no point \"%.40s\", expected %s", take->file,
                                  himc_hand_name(hand), name, points);
        if (point < 0)
            continue;
        if (found && tips[HIMC_LEFT].point == point)
            return himc_error_set(error,
                                  "%s: %s is named as both tips, expected one point for each tip",
                                  take->file, take->names[point]);
        himc_take_gap g;
        himc_take_tip *tip = &tips[hand];
        tip->filled = himc_take_fill(take, point, options->longest_gap, take->tip[hand], &g);
        if (tip->filled < 0)
            return himc_error_set(
                error, "%s: %s tip %s is %s in frames %d .. %d (%.3g s), expected gaps up to %g s",
                take->file, himc_hand_name(hand), take->names[point],
                g.end - g.begin == take->frames ? "never seen" : "missing",
                take->first_frame + g.begin, take->first_frame + g.end - 1,
                (g.end - g.begin) / take->rate, options->longest_gap);
        snprintf(tip->name, sizeof tip->name, "%s", take->names[point]);
        tip->x = take->tip[hand];
        tip->point = point;
        tip->present = true;
        found++;
    }
    return found || himc_error_set(error,
                                   "%s: no point has a stick tip's name (RTIP, STICK_L, "
                                   "RightStick_end, bead, ...), name it with --left-tip or "
                                   "--right-tip, expected %s",
                                   take->file, points);
}
