/// drum_listen.c: who hears a drum, and the ways of its sound to there.
#include "drum/drum_state.h"

#include "base/array.h"
#include "base/head_frame.h"

bool himc_drum_open_ears(himc_drum *drum, himc_error *error)
{
    if (!drum->ears)
        drum->ears = himc_new(sizeof *drum->ears, "listener", error);
    return drum->ears;
}

bool himc_drum_is_heard(const himc_drum *drum)
{
    return himc_listener_hears(&drum->listener, drum->set.picked);
}

bool himc_drum_set_usual_listener(himc_drum *drum, himc_error *error)
{
    if (!himc_drum_open_ears(drum, error))
        return false;
    drum->alone = himc_listener_usual();
    himc_drum_listen(drum, &drum->alone);
    return true;
}

void himc_drum_find_ways(himc_drum *drum)
{
    if (!himc_drum_is_heard(drum)) {
        himc_membrane_mute_pickups(drum->membrane, false);
        if (drum->ears)
            himc_ears_close(drum->ears);
        if (!himc_ears_heard(drum->ears))
            himc_membrane_set_rays(drum->membrane, NULL);
        return;
    }
    himc_ear_paths paths = himc_ears_trace(&drum->listener, &drum->set.place);
    himc_membrane_set_rays(drum->membrane, paths.ray);
    himc_ears_set(drum->ears, &paths, &drum->walls, drum->rate);
}

void himc_drum_listen(himc_drum *drum, const himc_listener *listener)
{
    listener = listener ? listener : &drum->alone;
    if (himc_listener_equal(&drum->listener, listener))
        return;
    drum->listener = *listener;
    himc_drum_find_ways(drum);
}

void himc_drum_enclose(himc_drum *drum, const himc_walls *walls)
{
    if (drum->walls.seconds == walls->seconds && drum->walls.volume == walls->volume)
        return;
    drum->walls = *walls;
    himc_drum_find_ways(drum);
}

// a drum that no performer has is heard by those who hear the other
static bool hears_with(const himc_drum *drum, const himc_drum *other)
{
    return drum->driver.performer ||
           (himc_listener_equal(&drum->listener, &other->listener) &&
            drum->set.picked == other->set.picked && drum->walls.seconds == other->walls.seconds &&
            drum->walls.volume == other->walls.volume &&
            himc_head_frame_equal(&drum->set.place, &other->set.place));
}

bool himc_drum_follows(const himc_drum *drum, const himc_drum *other)
{
    himc_membrane_config own = himc_drum_head_config(drum), its = himc_drum_head_config(other);
    return hears_with(drum, other) && himc_membrane_config_alike(&own, &its);
}

bool himc_drum_follow(himc_drum *drum, const himc_drum *other, himc_error *error)
{
    const himc_membrane_config *now = himc_membrane_config_of(drum->membrane);
    himc_membrane_config to = himc_drum_head_config(other), own = himc_drum_head_config(drum);
    bool hears = hears_with(drum, other);
    if (!hears && other->listener.on && !himc_drum_open_ears(drum, error))
        return false;
    to.rate = now->rate;
    to.shares = false; // no other head is near
    to.muted = now->muted;
    if (drum->driver.performer)
        to.rays = false,
        himc_membrane_config_set_rays(&to, now->rays ? now->pickups + HIMC_PICKUPS : NULL);
    if (himc_drum_glides(other)) {
        if (!himc_membrane_config_equal(&own, &to) &&
            !himc_drum_take_head(drum, &to, himc_drum_gliss_rest(other), NULL, error))
            return false;
    } else if (!himc_membrane_config_equal(&own, &to)) {
        drum->gliss.left = 0;
        himc_model *made = himc_model_new(&to, other->membrane->model, error);
        if (!made)
            return false;
        himc_model_free(himc_membrane_exchange(drum->membrane, made));
    }
    himc_drum_find_noise(drum, &drum->set.mallet[HIMC_RIGHT]);
    drum->set.place = himc_head_frame_at(&drum->set.place, &other->set.place);
    if (hears)
        return true;
    drum->listener = other->listener;
    drum->walls = other->walls;
    drum->set.picked = other->set.picked;
    drum->set.place = other->set.place;
    himc_drum_find_ways(drum);
    return true;
}
