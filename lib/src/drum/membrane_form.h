/// membrane_form.h: what a membrane is, without how it moves; for one made aside, in another
/// thread, and then put in the place of the one that sounds.
#ifndef HIMC_MEMBRANE_FORM_H
#define HIMC_MEMBRANE_FORM_H

#include "himc/membrane.h"

/// A membrane's outline, head and pickups.
typedef struct himc_membrane_form {
    himc_shape shape; ///< its grid is retained
    himc_head head;
    himc_pickup pickups[HIMC_PICKUPS];
    int pickup_count;
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
/// Gives `membrane` the form of `made`, which has the same rate and is then only to be freed. Modes
/// of the same outline go on, as with himc_membrane_set_head; another outline begins at rest, as
/// with himc_membrane_set_shape. No memory is allocated.
void himc_membrane_exchange(himc_membrane *membrane, himc_membrane *made);

#endif
