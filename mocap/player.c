/// player.c: the numbers: three players, five nuances, three spots.
///
/// The players differ as percussionists do: in height, mass, proportions of the arm, sticks, grip
/// (1 is french, thumbs up; 0 german, palms down), in how they sit, in the hand's share of a stroke
/// and in how much earlier the arm's upper joints reverse. The nuances are fitted so that the
/// strokes, measured as a laboratory measures them, have the heights and speeds of measured
/// timpani strokes, and the order of heights and depths of the 2012 paper's figure 6(a).
/// README.md has the comparison. All numbers without another source are chosen.
#include "parts.h"

const mocap_player himc_mocap_player[HIMC_MOCAP_PLAYERS] = {
    {.name = "ida",
     .height = 1.64,
     .mass = 58,
     .upper_arm = 1.02,
     .forearm = 0.98,
     .stick = 0.36,
     .edge = 0.19,
     .seat = 0.73,
     .lean = 0.10,
     .sway = 0.010,
     .french = 0.10,
     .out = 0.34,
     .palm = -0.22,
     .shoulder = 0.72,
     .fingers = 0.00,
     .lead = {0.030, 0.024, 0.010, 0},
     .apart = 0.055,
     .pace = 1.03,
     .size = 0.95,
     .looseness = 0.95},
    {.name = "jon",
     .height = 1.78,
     .mass = 75,
     .upper_arm = 0.99,
     .forearm = 1.02,
     .stick = 0.37,
     .edge = 0.21,
     .seat = 0.72,
     .lean = 0.08,
     .sway = 0.014,
     .french = 0.90,
     .out = 0.20,
     .palm = -0.20,
     .shoulder = 0.68,
     .fingers = 0.12,
     .lead = {0.024, 0.020, 0.008, 0},
     .apart = 0.045,
     .pace = 1.00,
     .size = 1.00,
     .looseness = 0.8},
    {.name = "max",
     .height = 1.90,
     .mass = 92,
     .upper_arm = 1.00,
     .forearm = 0.99,
     .stick = 0.38,
     .edge = 0.24,
     .seat = 0.71,
     .lean = 0.12,
     .sway = 0.012,
     .french = 0.45,
     .out = 0.27,
     .palm = -0.24,
     .shoulder = 0.70,
     .fingers = 0.06,
     .lead = {0.034, 0.026, 0.012, 0},
     .apart = 0.060,
     .pace = 0.97,
     .size = 1.05,
     .looseness = 0.95},
};

const mocap_gesture himc_mocap_gesture[HIMC_NUANCES] = {
    [HIMC_LEGATO] = {.height = 0.298,
                     .shoulder = 1.15,
                     .wrist = 0.2,
                     .grip = 0.73,
                     .loop = 0.02,
                     .down = 2,
                     .impact = 3.75,
                     .up = 2.1,
                     .rebound = 3.1,
                     .fall = 0.28,
                     .lift = 0.27,
                     .interval = 0.56,
                     .spread = {0.12, 0.15, 0.19}},
    [HIMC_TENUTO] = {.height = 0.344,
                     .shoulder = 1.2,
                     .wrist = 0.18,
                     .grip = 0.69,
                     .loop = 0.01,
                     .down = 2.3,
                     .impact = 3.75,
                     .up = 1.3,
                     .rebound = 2.1,
                     .fall = 0.30,
                     .lift = 0.36,
                     .interval = 0.70,
                     .spread = {0.08, 0.2, 0.28}},
    [HIMC_ACCENT] = {.height = 0.365,
                     .shoulder = 8,
                     .wrist = 0.2,
                     .grip = 0.70,
                     .loop = 0.01,
                     .down = 2.35,
                     .impact = 4,
                     .up = 2.45,
                     .rebound = 3.4,
                     .fall = 0.28,
                     .lift = 0.28,
                     .interval = 0.60,
                     .spread = {0.12, 0.14, 0.13}},
    [HIMC_VERTICAL_ACCENT] = {.height = 0.328,
                              .shoulder = 0.7,
                              .wrist = 0.22,
                              .grip = 0.86,
                              .loop = 0.01,
                              .down = 3.9,
                              .impact = 6.6,
                              .up = 2.15,
                              .rebound = 3.3,
                              .fall = 0.22,
                              .lift = 0.33,
                              .interval = 0.68,
                              .spread = {0.11, 0.14, 0.22}},
    [HIMC_STACCATO] = {.height = 0.325,
                       .shoulder = 0.1,
                       .wrist = 0.2,
                       .grip = 0.77,
                       .loop = 0.01,
                       .down = 1.35,
                       .impact = 2.4,
                       .up = 2.5,
                       .rebound = 3.5,
                       .fall = 0.38,
                       .lift = 0.28,
                       .interval = 0.74,
                       .spread = {0.15, 0.16, 0.16}},
};

double himc_mocap_spot(himc_spot spot)
{
    return spot == HIMC_SPOT_CENTER ? 0.53 : spot == HIMC_SPOT_NORMAL ? 0.40 : 0.30;
}

himc_skeleton_config himc_mocap_body(int player)
{
    const mocap_player *p = &himc_mocap_player[player];
    himc_skeleton_config c = himc_skeleton_default();
    himc_skeleton usual;
    c.height = p->height;
    c.mass = p->mass;
    c.stick_length = p->stick;
    c.seat = p->seat;
    himc_skeleton_init(&usual, &c, NULL);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int upper = HIMC_LEFT_UPPER_ARM + hand, lower = HIMC_LEFT_FOREARM + hand;
        c.length[upper] = p->upper_arm * usual.segment[upper].length;
        c.length[lower] = p->forearm * usual.segment[lower].length;
    }
    return c;
}
