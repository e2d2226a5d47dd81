/// membrane_form.h: what a membrane is, without how it moves; for one made aside, in another
/// thread, and then put in the place of the one that sounds.
#ifndef HIMC_MEMBRANE_FORM_H
#define HIMC_MEMBRANE_FORM_H

#include "head/shared.h"

/// Rays: what ears (ears.h) need of a head beside its pickups, the sound it sends out in the
/// direction of the left ear, of the right ear, and of the floor's mirror image, as loud as at 1 m;
/// their distance tells their near field.
enum { HIMC_RAY_LEFT, HIMC_RAY_RIGHT, HIMC_RAY_FLOOR, HIMC_RAYS };
#define HIMC_OUTPUTS (HIMC_PICKUPS + HIMC_RAYS) ///< pickups, then rays

/// True if all of both heads is the same.
HIMC_RT bool himc_head_equal(const himc_head *a, const himc_head *b);

/// A membrane's outline, head, pickups and rays.
typedef struct himc_membrane_form {
    himc_shape shape; ///< its grid is retained
    himc_head head;
    himc_pickup pickups[HIMC_OUTPUTS]; ///< rays from HIMC_PICKUPS on
    int pickup_count;
    bool rays;               ///< it has them
    bool shares;             ///< himc_membrane_share
    double rate;             ///< (Hz)
    double watch_x, watch_y; ///< the watched point (m)
} himc_membrane_form;

/// The form of a membrane; free it with himc_membrane_form_free.
HIMC_RT himc_membrane_form himc_membrane_form_of(const himc_membrane *membrane);
void himc_membrane_form_free(himc_membrane_form *form);
/// True if that is the membrane's form, the watched point apart.
HIMC_RT bool himc_membrane_has_form(const himc_membrane *membrane, const himc_membrane_form *form);

/// Number of its modes.
HIMC_RT int himc_membrane_modes(const himc_membrane *membrane);

/// A membrane of that form, at rest; NULL with the reason.
himc_membrane *himc_membrane_new_of(const himc_membrane_form *form, himc_error *error);
/// Sets its rays (HIMC_RAYS, of kind AIR), or NULL for none. Their sound begins, or changes over,
/// in 5 ms; the pickups do not notice.
HIMC_RT void himc_membrane_set_rays(himc_membrane *membrane, const himc_pickup *rays);
/// Its rays, borrowed; NULL if it has none.
HIMC_RT const himc_pickup *himc_membrane_rays(const himc_membrane *membrane);
/// Whether the air between this head and others takes what its shared modes radiate; they decay by
/// so much less.
HIMC_RT void himc_membrane_share(himc_membrane *membrane, bool shares);
/// Whether it does.
HIMC_RT bool himc_membrane_shares(const himc_membrane *membrane);
/// The shared modes (*count), none if it does not share. Borrowed.
HIMC_RT const himc_shared_mode *himc_membrane_shared(const himc_membrane *membrane, int *count);
/// Interval between two exchanges with other heads at a rate (Hz): 8, 16, 32 or 64 samples.
HIMC_RT int himc_membrane_interval(double rate);
/// Grows by one with every change of head or rate.
HIMC_RT unsigned himc_membrane_revision(const himc_membrane *membrane);
/// Between two samples: changes the velocity of mode `index` (m/s).
HIMC_RT void himc_membrane_kick(himc_membrane *membrane, int index, double change);

/// himc_membrane_run with a row for each of the HIMC_OUTPUTS.
HIMC_RT void himc_membrane_run_all(himc_membrane *membrane, int n, double *const *sound,
                                   double *watched);
/// Whether the sound of the pickups is not wanted: it is then 0 in samples with contact, too.
HIMC_RT void himc_membrane_mute_pickups(himc_membrane *membrane, bool mute);

/// Gives `membrane` the form of `made`, which has the same rate, and `made` that of `membrane`.
/// Modes of the same outline go on, as with himc_membrane_set_head; another outline begins at rest,
/// as with himc_membrane_set_shape. What moves in `made` is lost. No memory is allocated.
HIMC_RT void himc_membrane_exchange(himc_membrane *membrane, himc_membrane *made);

#endif
