/// grip.c: the hand as a bounded spring along the head's normal.
///
/// A press leads the tip to its target as computed torque does, y'' = a_t + 2 w (v_t - v) +
/// w^2 (y_t - y), but never pushes down with more than F, so a target far below the head presses no
/// harder than one a centimetre below. With the target at rest this is a spring and a damper, which
/// only take energy; the bound makes the spring softer, and it takes energy still.
#include "control/grip.h"

#define PRESS_FORCE 8.0                 // chosen: a firm press of a mallet (N)
#define PRESS_RATE (2 * HIMC_PI * 20.0) // as the controller's default bandwidth (rad/s)

void himc_grip_limit_depth(double depth, double *height, double *velocity, double *acceleration)
{
    double f = tanh(*height / depth), slope = 1 - f * f, bend = -2 * f * slope / depth;
    if (*height >= 0)
        return;
    *height = depth * f;
    *acceleration = slope * *acceleration + bend * *velocity * *velocity;
    *velocity *= slope;
}

double himc_grip_press(const himc_target *target, const himc_target *tip, himc_vec3 normal,
                       double mass)
{
    double off = himc_vec3_dot(normal, himc_vec3_sub(target->x, tip->x));
    double slow = himc_vec3_dot(normal, himc_vec3_sub(target->v, tip->v));
    double a = himc_vec3_dot(normal, target->a) + PRESS_RATE * (2 * slow + PRESS_RATE * off);
    return fmax(a, -PRESS_FORCE / mass);
}
