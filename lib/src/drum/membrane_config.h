/// membrane_config.h: what a head is, without how it moves: plain data, from which a model
/// (model.h) is made in any thread and then put in the place of the one that sounds.
#ifndef HIMC_MEMBRANE_CONFIG_H
#define HIMC_MEMBRANE_CONFIG_H

#include "head/shared.h"

/// Rays: what ears (ears.h) need of a head beside its pickups, the sound it sends out in the
/// direction of the left ear, of the right ear, and of the floor's mirror image, as loud as at 1 m;
/// their distance tells their near field.
enum { HIMC_EAR_LEFT, HIMC_EAR_RIGHT, HIMC_EARS };
enum { HIMC_RAY_LEFT, HIMC_RAY_RIGHT, HIMC_RAY_FLOOR, HIMC_RAYS };
#define HIMC_OUTPUTS (HIMC_PICKUPS + HIMC_RAYS) ///< pickups, then rays

/// A membrane's outline, head, pickups and rays. Copies share the outline's grid.
typedef struct himc_membrane_config {
    himc_shape shape;
    himc_head head;
    himc_pickup pickups[HIMC_OUTPUTS]; ///< rays from HIMC_PICKUPS on
    int pickup_count;
    bool rays;   ///< it has them
    bool muted;  ///< the sound of the first HIMC_EARS pickups is not wanted, and their outputs are
                 ///< of no use; a membrane's own, and no difference between two configs
    bool shares; ///< the air between this head and others takes what its shared modes radiate; they
                 ///< decay by so much less
    double rate; ///< (Hz)
} himc_membrane_config;

/// Whether output k, a pickup or a ray, sounds.
static inline bool himc_membrane_config_has(const himc_membrane_config *c, int k)
{
    return k < HIMC_PICKUPS ? k < c->pickup_count && !(c->muted && k < HIMC_EARS) : c->rays;
}

HIMC_RT bool himc_head_equal(const himc_head *a, const himc_head *b);
/// Sets in `head` what differs between `was` and `now`.
HIMC_RT void himc_head_keep_edits(himc_head *head, const himc_head *was, const himc_head *now);
/// True if modes of one outline are modes of the other, in another size.
HIMC_RT bool himc_shape_equal(const himc_shape *a, const himc_shape *b);
HIMC_RT bool himc_membrane_config_equal(const himc_membrane_config *a,
                                        const himc_membrane_config *b);
/// True if outline, head and pickups are the same: all that a second head beside it follows.
HIMC_RT bool himc_membrane_config_alike(const himc_membrane_config *a,
                                        const himc_membrane_config *b);

/// False with the reason if there is no such head.
bool himc_membrane_config_check(const himc_membrane_config *config, himc_error *error);
/// Sets these rays (HIMC_RAYS, of kind AIR), or NULL for none; false if it has them already.
HIMC_RT bool himc_membrane_config_set_rays(himc_membrane_config *config, const himc_pickup *rays);
/// Moves points of pickups that a smaller head no longer has to its rim.
HIMC_RT void himc_membrane_config_keep_pickups(himc_membrane_config *config);

/// Frequency of the principal mode (Hz) of a head of that outline: (1,1) if round, else the lowest.
HIMC_RT double himc_head_principal(const himc_head *head, const himc_shape *shape);
/// The tension (N/m) that brings it nearest to `frequency` (Hz).
HIMC_RT double himc_head_tension(const himc_head *head, const himc_shape *shape, double frequency);
/// The air around a head, over its own volume or the usual one for its radius.
HIMC_RT himc_air himc_air_over(const himc_head *head);

#endif
