/// tracks.h: for tests of tracks: a take and its track at a drum.
#ifndef HIMC_TESTS_TRACKS_H
#define HIMC_TESTS_TRACKS_H

#include "take_players.h"

#include "track/track.h"

#include "unity.h"

#define LEVEL 0.85 // height of the head (m)

static const himc_head_frame place = {.center = {0.5, 0, LEVEL}, .radius = 0.3};
static himc_error error;
static himc_take *take;
static himc_track *track;

void setUp(void)
{
    error.text[0] = 0;
    take = NULL;
    track = NULL;
}

void tearDown(void)
{
    himc_track_free(track);
    himc_take_free(take);
}

#endif
