/// idiophone.h: an instrument without a skin: bars, blocks, bells, cymbals. Each of its parts is
/// struck in a place of its own and has modes of its own, which are numbers: frequency, loss, mass,
/// shape. They are read from a list (list.c) or computed (bar.c, plate.c).
#ifndef HIMC_IDIOPHONE_H
#define HIMC_IDIOPHONE_H

#include "head/kind.h"

#define HIMC_PARTS 64 ///< most of an instrument; chosen: a keyboard of five octaves has 61
/// (N/m, kg/m^2) chosen: what stands for stiffness and mass of the material as it is made; only
/// their changes count, so `tune` has a decade of frequency up and down
#define HIMC_IDIOPHONE_TENSION 1000.0
#define HIMC_IDIOPHONE_DENSITY 1.0

/// A part: a bar or a disc.
typedef struct himc_part {
    char name[HIMC_PART_SIZE]; ///< a pitch, or another word
    double x, y;               ///< of its centre (m)
    double length;             ///< along x (m); 0 of a disc
    double width;              ///< along y, or the disc's diameter (m)
} himc_part;

/// A mode of a part.
typedef struct himc_partial {
    int part;
    double frequency;  ///< (Hz)
    double loss;       ///< beside what the head's fields say (1/s)
    double mass;       ///< where its shape is 1 (kg)
    double pressure;   ///< at 1 m, any way, per acceleration where it is 1 (Pa s^2/m); 0: a strip's
    double share;      ///< of what it loses, sent by its resonator
    int first, points; ///< of its shape: even steps from end to end of a bar, from centre to edge
    bool twists;       ///< it turns about the bar's axis, and the shape is that of its left edge
} himc_partial;

/// Constant once made; counts its references, which may be in several threads.
struct himc_idiophone {
    _Atomic int references;
    char *name;           ///< what its kind made it of (owned) ...
    double pitches[2];    ///< ... and the numbers after that; 0: none (Hz, or inches and mm)
    int parts, modes;     ///< modes in order of frequency
    himc_part *part;      ///< (parts) (owned)
    himc_partial *mode;   ///< (modes) (owned)
    double *shape;        ///< of all modes (owned)
    int points;           ///< in that
    double principal;     ///< (Hz)
    double length, width; ///< of the rectangle around all parts (m); length 0: a disc
    double radius;        ///< of the circle around (m)
    double constant, hysteresis, square; ///< of the decay, per omega, per omega^2 (1/s, 1, s)
    himc_mallet_head mallet;
    double dampers;   ///< all that its pedal lays on its modes (1/s); 0: it has no pedal
    bool pedal_lifts; ///< a pressed pedal lifts them
    bool discs;       ///< that a motor turns in its tubes
    bool cased;       ///< no air goes around its bars
    int row;          ///< in the table of its kind, if that asks
};

/// One without parts; NULL with the reason. One reference belongs to the caller.
himc_idiophone *himc_idiophone_new(const char *name, himc_error *error);
/// Adds a part, or a mode of `points` shape values to the last part. False without room.
bool himc_idiophone_add_part(himc_idiophone *body, const himc_part *part, himc_error *error);
bool himc_idiophone_add_mode(himc_idiophone *body, himc_partial mode, const double *shape,
                             int points, himc_error *error);
/// After the last part: sorts the modes, and moves the parts around their common centre.
void himc_idiophone_finish(himc_idiophone *body);

/// Puts a stroke for a part of a shape, if it says one, at its place on a surface of that radius
/// (m): from now on with HIMC_SPOT_XY, each hand on its side of that unless the stroke has said X
/// and Y on the part. False with the reason if the shape has no such part.
bool himc_idiophone_place(const himc_shape *shape, double radius, himc_stroke *stroke,
                          himc_error *error);

/// Of the list of modes `name`, in the library or a file (list.c). NULL with "file:line: ...".
himc_idiophone *himc_list_load(const char *name, himc_error *error);

/// What all kinds of them have in common (kind.h).
#define HIMC_IDIOPHONE_KIND                                                                  \
    .usual = HIMC_MODES_MAX, .fit = himc_idiophone_fit, .surface = himc_idiophone_surface,   \
    .principal = himc_idiophone_principal, .film = himc_idiophone_film,                      \
    .list = himc_idiophone_list, .shapes = himc_idiophone_shapes, .far = himc_idiophone_far, \
    .loss = himc_idiophone_loss, .mallet = himc_idiophone_mallet, .tube = himc_idiophone_tube
void himc_idiophone_fit(const himc_shape *shape, himc_head *head);
HIMC_RT void himc_idiophone_surface(const himc_shape *shape, himc_head_frame *surface);
HIMC_RT double himc_idiophone_principal(const himc_shape *shape);
HIMC_RT double himc_idiophone_film(const himc_shape *shape);
bool himc_idiophone_list(himc_modes *modes, bool automatic);
HIMC_RT void himc_idiophone_shapes(const himc_modes *modes, double radius, double x, double y,
                                   double *shapes);
HIMC_RT pickup_weights himc_idiophone_far(const himc_pickup *pickup, const himc_head *head,
                                          const himc_modes *modes, int index,
                                          const himc_mode *mode);
HIMC_RT double himc_idiophone_tube(const himc_modes *modes, int index, const himc_mode *mode);
HIMC_RT double himc_idiophone_loss(const himc_modes *modes, int index, double omega);
const himc_mallet_head *himc_idiophone_mallet(const himc_shape *shape);

#endif
