/// player_points.c: the points of a take that are joint centres, and their check against a body.
///
/// Each row of the table gives a centre as one marker or the mean of several; the first row with
/// all markers in the take is used. Names are tried with the side before and behind ("LeftElbow",
/// "LELB", "Elbow_L"); names without a side belong to the hand of a lone tip, else to the right
/// one. Upper arms are called "Arm" where forearms are called "ForeArm" ("LeftShoulder" is a
/// clavicle then), knees "Leg" where thighs are "UpLeg". A marker on the acromion is above the
/// shoulder's centre by 10.4 % of the upper arm (de Leva, J. Biomech. 29(9), 1996, joint centre
/// positions): 3 cm. Markers on the pelvis are above the hip joints by 8 cm.
///
/// The check: bones keep their length. Two centres with a distance that varies by more than 25 %
/// of a usual bone's length between its 10 % and 90 % quantiles are not the ends of a bone, for
/// example because names are permuted; the farther one is dropped. Bones are of human size: if most
/// are not, the file's unit is wrong. A player's left shoulder is on the side of the left hip.
#include "capture/player.h"

#include "base/line.h"
#include "base/order.h"

#include "capture/take.h"

#include <stdlib.h>
#include <string.h>

#define MARKERS 4           // most of a centre
#define ABOVE_HIPS 0.08     // chosen: of the pelvis' front and back markers, roughly (m)
#define ABOVE_SHOULDER 0.03 // 10.4 % of the upper arm, de Leva 1996 (m)

// how far a segment's length may be from the usual one; chosen: adults differ by less
#define LEAST_LENGTH 0.5 // of the usual length
#define MOST_LENGTH 1.6

typedef struct row {
    int point; // a player_point
    bool sided;
    const char *names;  // each a point, or several joined by '+' whose mean is the centre
    const char *beside; // name that must also be in the take for the others to mean this centre
    double below;       // of the centre, below the markers (m)
} row;

static const row rows[] = {
    {POINT_HIPS, false, "Hips Pelvis MidHip LeftHip+RightHip LHip+RHip", NULL, 0},
    {POINT_HIPS, false, "ASISl+ASISr+PSISl+PSISr LASI+RASI+LPSI+RPSI", NULL, ABOVE_HIPS},
    {POINT_WAIST, false, "Waist Spine LowerBack Abdomen", NULL, 0},
    {POINT_NECK, false, "Neck STER+C7 STER+T1 CLAV+C7", NULL, 0},
    {POINT_HEAD, false, "Head Neck_end", NULL, 0},
    {POINT_SHOULDER, true, "UpperArm", NULL, 0},
    {POINT_SHOULDER, true, "Arm", "ForeArm", 0},
    {POINT_SHOULDER, true, "ShoulderJoint Shoulder SJC", NULL, 0},
    {POINT_SHOULDER, true, "SHO Acromion ACRO_tip", NULL, ABOVE_SHOULDER},
    {POINT_ELBOW, true, "Elbow ForeArm LowerArm EJC ELBL+ELBM EPICl+EPICm ELB", NULL, 0},
    {POINT_WRIST, true, "Wrist Hand WJC WRA+WRB STYLr+STYLu", NULL, 0},
    {POINT_GRIP, true, "Grip Stick Mallet Finger FIN Knuckle MEDH+LATH", NULL, 0},
    {POINT_HIP, true, "UpLeg UpperLeg Thigh Hip HJC", NULL, 0},
    {POINT_KNEE, true, "Knee", NULL, 0},
    {POINT_KNEE, true, "Leg", "UpLeg", 0},
    {POINT_KNEE, true, "LowerLeg Shin KJC KNE", NULL, 0},
    {POINT_ANKLE, true, "Ankle Foot AJC ANK", NULL, 0},
    {POINT_TOE, true, "ToeBase Toe Toes Foot_end", NULL, 0},
    {POINT_TOE_END, true, "ToeBase_end", NULL, 0},
    {POINT_HEAD_END, false, "Head_end HeadTop", NULL, 0},
    {POINT_BESIDE + HIMC_NECK, false, "Neck_side", NULL, 0},
    {POINT_BESIDE + HIMC_HEAD, false, "Head_side", NULL, 0},
    {POINT_BESIDE + HIMC_LEFT_UPPER_ARM, true, "Arm_side", NULL, 0},
    {POINT_BESIDE + HIMC_LEFT_FOREARM, true, "ForeArm_side", NULL, 0},
    {POINT_BESIDE + HIMC_LEFT_HAND, true, "Hand_side", NULL, 0},
    {POINT_BESIDE + HIMC_LEFT_STICK, true, "Stick_side", NULL, 0},
    {POINT_BESIDE + HIMC_LEFT_UPPER_LEG, true, "UpLeg_side", NULL, 0},
    {POINT_BESIDE + HIMC_LEFT_LOWER_LEG, true, "Leg_side", NULL, 0},
    {POINT_BESIDE + HIMC_LEFT_FOOT, true, "Foot_side", NULL, 0},
    {POINT_BESIDE + HIMC_LEFT_TOES, true, "ToeBase_side", NULL, 0},
};
#define ROWS (sizeof rows / sizeof rows[0])

static const char *const point_names[POINT_BESIDE] = {
    "hips",           "waist",          "neck",           "head",
    "left shoulder",  "right shoulder", "left elbow",     "right elbow",
    "left wrist",     "right wrist",    "left grip",      "right grip",
    "left tip",       "right tip",      "left hip",       "right hip",
    "left knee",      "right knee",     "left ankle",     "right ankle",
    "left toes",      "right toes",     "left toes' end", "right toes' end",
    "top of the head"};

void himc_player_note(himc_player *player, const char *format, ...)
{
    int most = sizeof player->notes / sizeof player->notes[0];
    if (player->note_count >= most)
        return;
    va_list args;
    va_start(args, format);
    himc_line_print(player->notes[player->note_count++], sizeof player->notes[0], format, args);
    va_end(args);
}

// the point of that name of `length` on the side of the hand; HIMC_HANDS: without a side
static int find_named(const himc_take *take, const char *name, size_t length, int hand)
{
    static const char *const forms[HIMC_HANDS + 1][4] = {
        {"Left%s", "L%s", "%sLeft", "%sL"}, {"Right%s", "R%s", "%sRight", "%sR"}, {"%s"}};
    char text[TAKE_NAME];
    int found = -1;
    for (int i = 0; i < 4 && forms[hand][i] && found < 0; i++) {
        const char *form = forms[hand][i], *at = strchr(form, '%');
        snprintf(text, sizeof text, "%.*s%.*s%s", (int)(at - form), form, (int)length, name,
                 at + 2);
        found = himc_take_find(take, text);
    }
    return found;
}

// a centre by the first name with all points in the take: the mean of the markers, gaps filled;
// hand HIMC_HANDS: names without side. False without memory
static bool find_centre(player_points *p, int which, int hand, const himc_take_options *options,
                        himc_player *player)
{
    int point[MARKERS], count = 0, first = himc_take_first_frame(p->take);
    const row *r = NULL;
    for (const row *k = rows; k < rows + ROWS && !r; k++) {
        if (which != k->point && !(k->sided && which == k->point + 1))
            continue;
        bool all = !k->beside || find_named(p->take, k->beside, strlen(k->beside), hand) >= 0;
        for (const char *name = k->names; all && !r && *name; name += strspn(name, " ")) {
            bool found = true;
            for (count = 0; *name && *name != ' '; name += *name == '+') {
                size_t length = strcspn(name, "+ ");
                point[count] = found ? find_named(p->take, name, length, hand) : -1;
                found = point[count++] >= 0;
                name += length;
            }
            r = found ? k : NULL;
        }
    }
    if (!r)
        return true;
    size_t frames = (size_t)p->frames;
    himc_vec3 *sum = calloc(frames, sizeof *sum), *one = malloc(frames * sizeof *one);
    bool memory = sum && one, shown = memory;
    for (int i = 0; shown && i < count; i++) {
        himc_take_gap gap;
        shown = himc_take_fill(p->take, point[i], options->longest_gap, one, &gap) >= 0;
        if (!shown)
            himc_player_note(
                player, "%s: %s is missing in frames %d .. %d, expected gaps up to %g s",
                which < POINT_BESIDE ? point_names[which] : himc_segment_name(which - POINT_BESIDE),
                himc_take_point_name(p->take, point[i]), first + gap.begin, first + gap.end - 1,
                options->longest_gap);
        for (size_t k = 0; shown && k < frames; k++)
            sum[k] = himc_vec3_madd(sum[k], 1.0 / count, one[k]);
    }
    free(one);
    if (!shown) {
        free(sum);
        return memory;
    }
    for (size_t k = 0; k < frames; k++)
        sum[k].z -= r->below;
    p->x[which] = sum;
    p->node[which] = count == 1 ? point[0] : -1;
    return true;
}

bool himc_player_points_find(player_points *p, himc_take *take, const himc_take_options *options,
                             himc_player *player)
{
    himc_take_tip tips[HIMC_HANDS] = {{.present = false}, {.present = false}};
    bool found = himc_take_tips(take, options, tips, NULL), present[HIMC_HANDS];
    *p = (player_points){.take = take, .frames = himc_take_frames(take)};
    size_t size = (size_t)p->frames * sizeof(himc_vec3);
    for (int i = 0; i < POINT_COUNT; i++)
        p->node[i] = -1;
    p->distance = malloc((size_t)p->frames * sizeof *p->distance);
    if (!p->distance)
        return false;
    // the tips, filled in the same way as for playing
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        present[hand] = found && tips[hand].present;
        if (!present[hand])
            continue;
        himc_vec3 *x = p->x[POINT_TIP + hand] = malloc(size);
        if (!x)
            return false;
        memcpy(x, tips[hand].x, size);
        p->node[POINT_TIP + hand] = himc_take_find(take, tips[hand].name);
    }
    int lone = present[HIMC_LEFT] && !present[HIMC_RIGHT] ? HIMC_LEFT : HIMC_RIGHT;
    for (int i = 0; i < POINT_COUNT; i++) {
        bool paired =
            i >= POINT_BESIDE + HIMC_LEFT_UPPER_ARM || (i >= POINT_SHOULDER && i < POINT_HEAD_END);
        int hand = paired ? (i - POINT_SHOULDER) % 2 : HIMC_HANDS;
        if (i / 2 == POINT_TIP / 2)
            continue;
        if (!find_centre(p, i, hand, options, player))
            return false;
        if (paired && hand == lone && !p->x[i] && !find_centre(p, i, HIMC_HANDS, options, player))
            return false;
    }
    // a point called hips may not be between the hip joints
    const himc_vec3 *left = p->x[POINT_HIP], *right = p->x[POINT_HIP + 1];
    if (!left || !right)
        return true;
    if (!p->x[POINT_HIPS])
        p->x[POINT_HIPS] = malloc(size);
    for (int i = 0; p->x[POINT_HIPS] && i < p->frames; i++)
        p->x[POINT_HIPS][i] = himc_vec3_scale(himc_vec3_add(left[i], right[i]), 0.5);
    return p->x[POINT_HIPS] != NULL;
}

void himc_player_points_free(player_points *p)
{
    for (int i = 0; i < POINT_COUNT; i++)
        free(p->x[i]);
    free(p->distance);
}

double himc_player_distance(const player_points *p, int from, int to, double quantile)
{
    const himc_vec3 *a = p->x[from], *b = p->x[to];
    if (!a || !b)
        return 0;
    for (int i = 0; i < p->frames; i++)
        p->distance[i] = himc_vec3_length(himc_vec3_sub(b[i], a[i]));
    qsort(p->distance, (size_t)p->frames, sizeof *p->distance, himc_order_doubles);
    return p->distance[(int)(quantile * p->frames)];
}

const player_measure himc_player_limbs[PLAYER_LIMBS] = {
    {HIMC_LEFT_UPPER_ARM, POINT_SHOULDER, POINT_ELBOW, 0.2817, true},
    {HIMC_LEFT_FOREARM, POINT_ELBOW, POINT_WRIST, 0.2689, true},
    {HIMC_LEFT_HAND, POINT_WRIST, POINT_GRIP, 0.12, false},
    {HIMC_LEFT_STICK, POINT_GRIP, POINT_TIP, 0.24, false},
    {HIMC_LEFT_UPPER_LEG, POINT_HIP, POINT_KNEE, 0.4222, true},
    {HIMC_LEFT_LOWER_LEG, POINT_KNEE, POINT_ANKLE, 0.434, true},
};
const player_measure himc_player_spine[PLAYER_SPINE] = {
    {HIMC_PELVIS, POINT_HIPS, POINT_WAIST, 0.1457, true},
    {HIMC_TRUNK, POINT_WAIST, POINT_NECK, 0.3862, true},
    {HIMC_NECK, POINT_NECK, POINT_HEAD, 0.0696, false},
};

double himc_player_plausible(double length, double usual)
{
    return length >= LEAST_LENGTH * usual && length <= MOST_LENGTH * usual ? length : 0;
}

// of limb i / 2, on the left for even i
static double limb_length(const player_points *p, int i, double quantile)
{
    const player_measure *m = &himc_player_limbs[i / 2];
    return himc_player_distance(p, (int)m->from + i % 2, (int)m->to + i % 2, quantile);
}

bool himc_player_check(player_points *p, himc_player *player, himc_error *error)
{
    int good = 0, bad = 0, first = 0;
    for (int i = 0; i < HIMC_HANDS * PLAYER_LIMBS; i++) {
        const player_measure *m = &himc_player_limbs[i / 2];
        double l = limb_length(p, i, 0.5);
        bool fits = himc_player_plausible(l, m->usual) > 0, wrong = l > 0 && !fits;
        first = bad == 0 ? i : first;
        good += m->tells_size && fits;
        bad += m->tells_size && wrong;
    }
    // if most of the limbs are not of human size the file's unit is not the stated one
    const player_measure *m = &himc_player_limbs[first / 2];
    if (bad > good)
        return himc_error_set(
            error, "%s: player: %s of %.3g m, expected %.2f .. %.2f m: is the unit right?",
            p->take->file, himc_segment_name(m->segment + first % 2), limb_length(p, first, 0.5),
            LEAST_LENGTH * m->usual, MOST_LENGTH * m->usual);
    const himc_vec3 *left = p->x[POINT_SHOULDER], *right = p->x[POINT_SHOULDER + 1],
                    *left_hip = p->x[POINT_HIP], *right_hip = p->x[POINT_HIP + 1];
    double same = 0;
    for (int i = 0; left && right && left_hip && right_hip && i < p->frames; i++)
        same += himc_vec3_dot(himc_vec3_sub(left[i], right[i]),
                              himc_vec3_sub(left_hip[i], right_hip[i]));
    if (!(same >= 0))
        return himc_error_set(error,
                              "%s: player: the left shoulder is over the right hip, expected "
                              "over the left one: are left and right exchanged?",
                              p->take->file);
    for (int i = 0; i < HIMC_HANDS * PLAYER_LIMBS; i++) {
        double low = limb_length(p, i, 0.1), high = limb_length(p, i, 0.9);
        m = &himc_player_limbs[i / 2];
        if (high - low <= 0.25 * m->usual) // chosen: markers on skin move by far less
            continue;
        himc_player_note(
            player,
            "%s: its length varies from %.3f to %.3f m, a bone's does not: are the points' "
            "names right?",
            himc_segment_name(m->segment + i % 2), low, high);
        free(p->x[(int)m->to + i % 2]);
        p->x[(int)m->to + i % 2] = NULL;
    }
    return true;
}
