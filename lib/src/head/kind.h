/// kind.h: a kind of instrument is one file with a table of functions, himc_kind_NAME, and a row of
/// HIMC_KINDS in himc/command_rows.h. Modes, pickups and models ask the kind of their shape.
///
/// Whatever bends is tuned like a membrane: a mode has z, a pure number, and sounds at z/(2 pi
/// radius) sqrt(T/sigma), with the mass sigma pi radius^2 norm and the decay S0 + S1 omega^2 + its
/// own loss. Force and displacement use the same shapes, so energy never grows.
#ifndef HIMC_KIND_H
#define HIMC_KIND_H

#include "bank/bank.h"
#include "head/grid.h"
#include "himc/command.h"
#include "himc/membrane.h"

typedef struct himc_kind himc_kind;
typedef struct himc_modes himc_modes;
typedef struct himc_idiophone himc_idiophone;
typedef struct himc_shell himc_shell;
typedef struct himc_cascade himc_cascade;

/// An outline. Its size is the head's radius, that of the circle around it.
typedef struct himc_shape {
    const himc_kind *kind;
    double length;        ///< along x (m); only the ratio to `width` counts; 0 if it has no sides
    double width;         ///< along y (m)
    himc_grid *grid;      ///< of a head from a file, borrowed; else NULL
    himc_idiophone *body; ///< of an instrument without a skin (idiophone.h), borrowed; else NULL
    const himc_shell *shell; ///< of a drum with one (two_heads.h), and its width; else NULL
} himc_shape;

/// Adds a reference to what a shape has borrowed, or gives it back.
void himc_shape_retain(const himc_shape *shape);
void himc_shape_release(const himc_shape *shape);

/// Sound per unit of a mode's state, in the units of himc/membrane.h (HIMC_PICKUP_PRESSURE,
/// HIMC_PICKUP_VELOCITY).
typedef struct pickup_weights {
    double displacement; ///< per metre of q
    double velocity;     ///< per m/s of q'
    double force;        ///< per newton of modal force phi f
    double gain;         ///< of `form`; 0 of those that have none
} pickup_weights;

/// All functions are HIMC_RT but for `list`; positions (x, y) are from the centre
/// (m). A function is NULL only where its comment says what that means.
struct himc_kind {
    const char *name; ///< word of the command `shape`; NULL: its grid's path
    bool air;         ///< it has pairs of modes, which air, kettle and uneven lugs act on
    int usual;        ///< listed modes of HIMC_MODES_AUTO, or as many as there are

    /// Sets the sides from the atoms of `shape`, or makes the body of which one reference is the
    /// caller's; false with the reason. NULL: it has none.
    bool (*read)(const himc_command *command, himc_shape *shape, himc_error *error);
    /// Sets what the shape itself says of a head: size, material. NULL: nothing.
    void (*fit)(const himc_shape *shape, himc_head *head);
    /// Sets sides and spots of the surface that is struck, of the radius that it has. NULL: a disc
    /// with the spots of a drumhead.
    void (*surface)(const himc_shape *shape, himc_head_frame *surface);
    /// What a mode that sounds at omega (rad/s) loses beside the head's decay (1/s). NULL: nothing.
    double (*loss)(const himc_modes *modes, int index, double omega);
    /// The mallet that suits, borrowed. NULL: a timpanist's.
    const himc_mallet_head *(*mallet)(const himc_shape *shape);
    /// Of the principal mode: radius times wavenumber.
    double (*principal)(const himc_shape *shape);
    /// Frequency of it (Hz). NULL: as bare, or in the air of a timpano.
    double (*pitch)(const himc_shape *shape, const himc_head *head);
    /// Area of the film that the outline holds, per radius^2; 0 without a film.
    double (*film)(const himc_shape *shape);

    /// How its modes, which are then of one mass, exchange energy at a head's `glide` 1, borrowed
    /// (bank.h). NULL: they do not.
    const himc_cascade *(*cascade)(const himc_shape *shape);

    /// Lists `modes->exact` modes (modes.h), if `automatic` also what stands for those above.
    /// False without memory.
    bool (*list)(himc_modes *modes, bool automatic);
    /// What the list's modes sound like in that head, and what mixes their shapes. NULL: as listed.
    void (*sounds)(himc_modes *modes, const himc_head *head, himc_oscillator *oscillators);
    /// himc_modes_shapes
    void (*shapes)(const himc_modes *modes, double radius, double x, double y, double *shapes);
    /// No value of that mode's shape is larger. NULL: not known.
    double (*largest)(const himc_mode *mode);

    /// Radius (m) of the patch that a mallet's patch of radius b (m) covers there. NULL: a point.
    double (*patch)(const himc_head *head, double x, double y, double b);
    /// Static compliance (m/N) under a patch of radius b > 0 (m) that lies inside, of all modes,
    /// listed or not: mean displacement per newton spread evenly. NULL: not known.
    double (*compliance)(const himc_head *head, double x, double y, double b);

    /// Weights of mode `index` at a pickup of kind AIR; `mode` has its frequency, decay, mass.
    pickup_weights (*far)(const himc_pickup *pickup, const himc_head *head, const himc_modes *modes,
                          int index, const himc_mode *mode);
    /// Weight on a mode's velocity, at a pickup 1 m away, of the tube that a motor opens and shuts.
    /// NULL: it has none.
    double (*tube)(const himc_modes *modes, int index, const himc_mode *mode);
    /// Those at any such pickup, but for its gain. NULL: they differ in more.
    pickup_weights (*form)(const himc_mode *mode);
    /// Integrals over the outline, per radius^2, of a shape times cos and sin of kx x + ky y, k and
    /// places per radius: what himc_pickup_of_outline needs. NULL: `far` is another.
    void (*transform)(const himc_modes *modes, int index, double kx, double ky, double *even,
                      double *odd);
};

#define HIMC_KIND_TABLE(name, form) extern const himc_kind himc_kind_##name;
HIMC_KINDS(HIMC_KIND_TABLE)
extern const himc_kind himc_kind_grid; ///< any outline: masses and springs from a file

#endif
