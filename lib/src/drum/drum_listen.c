/// drum_listen.c: who hears a drum, and the ways of its sound to there.
#include "drum/drum_state.h"

#include "base/head_frame.h"

// the ways to the ears; the rays may come from elsewhere
static void find_ways(himc_drum *drum, bool rays)
{
    if (!drum->listener.on) {
        himc_membrane_mute_pickups(drum->membrane, false);
        himc_ears_close(&drum->ears);
        if (rays && !himc_ears_heard(&drum->ears))
            himc_membrane_set_rays(drum->membrane, NULL);
        return;
    }
    himc_ear_paths paths = himc_ears_trace(&drum->listener, &drum->place);
    if (rays)
        himc_membrane_set_rays(drum->membrane, paths.ray);
    himc_ears_set(&drum->ears, &paths, &drum->walls, drum->rate);
}

void himc_drum_find_ways(himc_drum *drum)
{
    find_ways(drum, true);
}

void himc_drum_listen(himc_drum *drum, const himc_listener *listener)
{
    if (himc_listener_equal(&drum->listener, listener))
        return;
    drum->listener = *listener;
    find_ways(drum, true);
}

void himc_drum_enclose(himc_drum *drum, const himc_walls *walls)
{
    if (drum->walls.seconds == walls->seconds && drum->walls.volume == walls->volume)
        return;
    drum->walls = *walls;
    find_ways(drum, false);
}

void himc_drum_hear_as(himc_drum *drum, const himc_drum *other)
{
    if (himc_listener_equal(&drum->listener, &other->listener) &&
        himc_head_frame_equal(&drum->place, &other->place))
        return;
    drum->listener = other->listener;
    drum->place = other->place;
    find_ways(drum, false);
}
