/// stand.h: balance of one who stands.
#ifndef HIMC_STAND_H
#define HIMC_STAND_H

#include "body/support.h"

/// Where he is over his feet; computed again in each step by himc_stand_feel, except goal and hips.
typedef struct himc_stand {
    bool standing;
    himc_vec3 over;    ///< centre of mass, from the middle of the soles (m)
    himc_vec3 moving;  ///< its velocity (m/s)
    himc_vec3 pressed; ///< centre of pressure, from there (m)
    double weight;     ///< that the soles carry (N)
    double aside;      ///< of the soles, from their middle (m)
    himc_vec3 stays;   ///< where the centre of mass would be with the pelvis at its place (m) ...
    himc_vec3 goal;    ///< ... and where it is wanted, which follows (m); 0 at first
    himc_vec3 hips;    ///< relative acceleration asked of both in the last step (rad/s^2)
} himc_stand;

/// Measures centre of mass and pressure over the soles; of one who does not stand nothing.
HIMC_RT void himc_stand_feel(himc_stand *stand, const himc_support *support,
                             const himc_skeleton *skeleton, const himc_body_state *state);

/// Changes the relative accelerations of hips and ankles (rad/s^2) so that he keeps his balance;
/// `pelvis` is the pelvis' angular acceleration in the last step (rad/s^2), `step` the time to the
/// next (s).
HIMC_RT void himc_stand_legs(himc_stand *stand, const himc_body_state *state, himc_vec3 pelvis,
                             double step, himc_vec3 wanted[HIMC_JOINTS]);

#endif
