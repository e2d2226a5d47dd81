/// performance_body.c: the body, its controller and the forces on it.
///
/// The controller assumes the skeleton; the engine simulates the plant, which may be heavier. A
/// push is a constant force on a point of a segment. It is not given to the controller, so it
/// disturbs the motion. `ik` has no forces, so pushes have no effect there.
#include "performance/performance_body.h"
#include "base/array.h"
#include "base/format.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

// chosen: the engine keeps joints together to a micrometre
#define JOINT_GAP 0.01 // a joint further apart has come apart (m)
// a player has fallen: his pelvis is so far from its seat (m), or leans by 60 degrees; chosen
#define FALLEN 0.3
#define LEANING 0.5 // cosine
// the beat has jumped if it is farther from that foreseen at the last tick (beats); chosen: more
// than a change of tempo between two ticks makes
#define SAME_COURSE 0.25
#define UNIT 1e-6 // a unit quaternion's squared length is so near 1; chosen: rounding of floats

void himc_body_free(performance_body *b)
{
    if (!b)
        return;
    himc_character_free(b->character);
    free(b);
}

bool himc_body_make_parts(body_parts *parts, const performance_settings *s, himc_error *error)
{
    if (!himc_skeleton_init(&parts->skeleton, &s->skeleton, error))
        return false;
    parts->skeleton.segment[HIMC_PELVIS].joint =
        s->stance == HIMC_STANCE_FIXED ? HIMC_JOINT_FIXED : HIMC_JOINT_FREE;
    parts->plant = parts->skeleton;
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        himc_segment *heavy = &parts->plant.segment[i];
        heavy->mass *= s->weight[i];
        heavy->inertia = himc_vec3_scale(heavy->inertia, s->weight[i]);
    }
    parts->character = himc_character_new(&parts->plant, error);
    return parts->character;
}

static double energy(const himc_character *c)
{
    return himc_character_kinetic(c) + himc_character_potential(c);
}

void himc_body_adopt(performance_body *b, const body_parts *parts)
{
    if (b->accounting) {
        b->work.placed += energy(parts->character) - energy(b->character);
        himc_character_account(parts->character, &b->work);
    }
    himc_character_free(b->character);
    b->character = parts->character;
    b->skeleton = parts->skeleton;
    b->plant = parts->plant;
    b->shares = true;
    for (int i = 0; i < HIMC_SEGMENTS; i++) { // all but the bytes between the fields
        const himc_segment *s = &b->skeleton.segment[i], *t = &b->plant.segment[i];
        b->shares = b->shares && s->parent == t->parent &&
                    memcmp(&s->mass, &t->mass, sizeof *s - offsetof(himc_segment, mass)) == 0;
    }
}

performance_body *himc_body_new(const performance_settings *s, himc_error *error)
{
    performance_body *b = himc_new(sizeof *b, "performance", error);
    body_parts parts;
    if (b && himc_body_make_parts(&parts, s, error)) {
        himc_body_adopt(b, &parts);
        return b;
    }
    free(b);
    return NULL;
}

// seat and floor hold nothing of where the body was
static void settle(performance_body *b)
{
    himc_support_lift(&b->support);
    b->balance = (himc_balance){.carried = {{0, 0, 0}, {0, 0, 0}}};
}

void himc_body_place(performance_body *b, const himc_setpoint *at)
{
    himc_pose pose;
    memcpy(pose.joint, at->posture.joint, sizeof pose.joint);
    himc_pose_to_state(&b->skeleton, &pose, at->posture.rate, &b->state);
    settle(b);
    if (himc_character_place(b->character, &b->state))
        return;
    pose = himc_pose_zero();
    himc_pose_to_state(&b->skeleton, &pose, NULL, &b->state);
    himc_character_place(b->character, &b->state);
}

void himc_body_seat(performance_body *b, double height)
{
    if (b->skeleton.segment[HIMC_PELVIS].origin.z != height &&
        himc_character_seat(b->character, height))
        b->skeleton.segment[HIMC_PELVIS].origin.z = b->plant.segment[HIMC_PELVIS].origin.z = height;
}

void himc_body_take_up(performance_body *b)
{
    settle(b);
    himc_character_place(b->character, &b->state);
}

void himc_body_init_controller(performance_body *b, const performance_settings *s,
                               const himc_pose *rest)
{
    himc_body_state state;
    himc_pose_to_state(&b->skeleton, rest, NULL, &state);
    himc_controller_init(&b->controller, &s->control, &b->skeleton, &state);
    himc_muscles_rest(&b->muscles);
    if (b->skeleton.segment[HIMC_PELVIS].joint == HIMC_JOINT_FREE) {
        himc_support_init(&b->support, &b->plant, &state, s->stance == HIMC_STANCE_STANDING);
        b->balance = (himc_balance){.carried = {{0, 0, 0}, {0, 0, 0}}};
        b->controller.balance = &b->balance;
    }
    b->legs = (himc_sleeping_legs){.asked = NULL};
    b->controller.legs = &b->legs;
    b->controller.muscles = &b->muscles;
    b->controller.saturation = &b->saturation;
    himc_character_use(b->character, s->engine);
}

void himc_body_configure(performance_body *b, const performance_settings *s)
{
    himc_controller_configure(&b->controller, &s->control);
    himc_character_use(b->character, s->engine);
}

void himc_body_set_limits(performance_body *b, const himc_limits *limits)
{
    if (limits)
        b->limits = *limits;
    b->controller.limits = limits ? &b->limits : NULL;
    b->legs = (himc_sleeping_legs){.asked = NULL};
    memset(b->saturation.measure, 0, sizeof b->saturation.measure);
}

void himc_body_clear_limit_counts(performance_body *b)
{
    himc_saturation_counts *s = &b->saturation;
    memset(s->held, 0, sizeof s->held);
    memset(s->hits, 0, sizeof s->hits);
    memset(s->farthest, 0, sizeof s->farthest);
}

void himc_body_push(performance_body *b, const planned_push *push, double t)
{
    himc_vec3 at = b->plant.segment[push->segment].center;
    if (push->along >= 0)
        at = himc_vec3_scale(at, push->along / himc_vec3_length(at));
    b->push[push->segment] = (body_push){push->force, at, t + push->seconds};
    b->push_end = fmax(b->push_end, t + push->seconds);
}

bool himc_body_make_push_room(performance_body *b, int count, himc_error *error)
{
    int begun = 0;
    while (begun < b->planned_count && b->planned[begun].beat < b->pushed_to)
        begun++;
    if (b->planned_count + count <= HIMC_PUSHES)
        return true;
    if (b->planned_count - begun + count > HIMC_PUSHES)
        return himc_error_set(error, "push: one too many, expected %d", HIMC_PUSHES);
    b->planned_count -= begun;
    memmove(b->planned, b->planned + begun, (size_t)b->planned_count * sizeof *b->planned);
    return true;
}

bool himc_body_plan_pushes(performance_body *b, const planned_push *list, int count,
                           push_order order, himc_error *error)
{
    if (order != PUSHES_AFTER)
        b->planned_count = 0;
    if (order == PUSHES_ANEW)
        b->pushed_to = -1;
    if (!himc_body_make_push_room(b, count, error))
        return false;
    for (int i = 0; i < count; i++)
        b->planned[b->planned_count++] = list[i];
    return true;
}

bool himc_body_insert_push(performance_body *b, const planned_push *push, himc_error *error)
{
    int at = b->planned_count;
    if (at == HIMC_PUSHES)
        return himc_error_set(error, "push: one too many, expected %d", HIMC_PUSHES);
    for (; at > 0 && b->planned[at - 1].beat > push->beat; at--)
        b->planned[at] = b->planned[at - 1];
    b->planned[at] = *push;
    b->planned_count++;
    return true;
}

bool himc_body_may_exchange_pushes(const performance_body *b, const planned_push *list, int count)
{
    int same = 0;
    for (; same < count && same < b->planned_count; same++) {
        const planned_push *a = &list[same], *c = &b->planned[same];
        if (a->beat != c->beat || a->segment != c->segment || a->seconds != c->seconds ||
            a->along != c->along || himc_vec3_length(himc_vec3_sub(a->force, c->force)) != 0)
            break;
    }
    return (same == count || list[same].beat >= b->pushed_to) &&
           (same == b->planned_count || b->planned[same].beat >= b->pushed_to);
}

void himc_body_begin_pushes(performance_body *b, double now, double next, double t)
{
    // after a jump from the tick before on, in which it was
    double from = fabs(b->pushed_to - now) < SAME_COURSE ? b->pushed_to : now - fmax(next - now, 0);
    bool round = next < now; // a loop ends on a whole beat
    double end = floor(now) + 1, to = round ? end : next;
    for (int i = 0; i < b->planned_count; i++) {
        const planned_push *push = &b->planned[i];
        if ((push->beat >= from && push->beat < to) ||
            (round && (push->beat == end || push->beat < next)))
            himc_body_push(b, push, t);
    }
    b->pushed_to = next;
}

bool himc_body_observe(performance_body *b, bool check)
{
    himc_character_observe(b->character, &b->state);
    // the numbers may be finite although the body has come apart
    for (int i = 1; check && i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &b->skeleton.segment[i];
        himc_vec3 r = himc_mat3_apply(&b->state.rotation[segment->parent], segment->origin);
        himc_vec3 gap =
            himc_vec3_sub(himc_vec3_add(b->state.origin[segment->parent], r), b->state.origin[i]);
        if (!(himc_vec3_dot(gap, gap) < JOINT_GAP * JOINT_GAP))
            return false;
    }
    return true;
}

bool himc_body_has_fallen(const performance_body *b)
{
    return b->controller.balance &&
           (himc_vec3_length(himc_vec3_sub(b->state.origin[0],
                                           b->skeleton.segment[HIMC_PELVIS].origin)) > FALLEN ||
            b->state.rotation[0].m[2][2] < LEANING);
}

bool himc_body_drive(performance_body *b, const himc_drive *drive, himc_error *error)
{
    static const himc_drive none;
    for (int j = 0; drive && j < HIMC_JOINTS; j++) {
        const himc_quat *q = &drive->rotation[j];
        double length = q->w * q->w + q->x * q->x + q->y * q->y + q->z * q->z;
        if (drive->aimed[j] && !(fabs(length - 1) < UNIT))
            return himc_error_set(error, "drive: %s: a rotation of length %g, expected 1",
                                  himc_joint_name(j), sqrt(length));
        if (drive->aimed[j] && !himc_vec3_finite(drive->rate[j]))
            return himc_error_set(error, "drive: %s: expected a finite rate", himc_joint_name(j));
        if (drive->turned[j] && !himc_vec3_finite(drive->torque[j]))
            return himc_error_set(error, "drive: %s: expected a finite torque", himc_joint_name(j));
    }
    b->drive = drive ? *drive : none;
    b->aimed = false;
    for (int j = 0; j < HIMC_JOINTS; j++)
        b->aimed = b->aimed || b->drive.aimed[j];
    return true;
}

// the reference with the joints that are aimed from outside
static const himc_reference *aim(const performance_body *b, const himc_reference *reference,
                                 himc_reference *aimed)
{
    if (!b->aimed)
        return reference;
    *aimed = *reference;
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (b->drive.aimed[j]) {
            aimed->posture.joint[j] = b->drive.rotation[j];
            aimed->posture.rate[j] = b->drive.rate[j];
            aimed->posture.acceleration[j] = himc_vec3_make(0, 0, 0);
        }
    return aimed;
}

void himc_body_control(performance_body *b, const himc_reference *reference, double h)
{
    himc_reference aimed;
    b->controller.step = h;
    b->controller.articulation = b->shares ? himc_character_articulation(b->character) : NULL;
    if (b->controller.balance) {
        himc_support_press(&b->support, &b->plant, &b->state);
        himc_balance_feel(&b->balance, &b->support, &b->plant, &b->state);
    }
    himc_controller_torques(&b->controller, &b->skeleton, &b->state, aim(b, reference, &aimed),
                            b->torque);
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (b->drive.turned[j])
            b->torque[j] = himc_mat3_apply(&b->state.rotation[j + 1], b->drive.torque[j]);
}

body_push himc_body_pushed(const performance_body *b, int segment, double t)
{
    return t < b->push[segment].until ? b->push[segment]
                                      : (body_push){.at = b->plant.segment[segment].center};
}

bool himc_body_simulate(performance_body *b, double t, double h)
{
    world_contact contact[HIMC_SEGMENTS + HIMC_HANDS + HIMC_SUPPORTS];
    int n = 0;
    for (int i = HIMC_SEGMENTS - 1; t < b->push_end && i >= 0; i--)
        if (t < b->push[i].until)
            contact[n++] = (world_contact){.segment = i,
                                           .at = b->push[i].at,
                                           .force = b->push[i].force,
                                           .work = &b->work.push};
    for (int i = 0; b->controller.balance && i < HIMC_SUPPORTS; i++) {
        const himc_support_point *p = &b->support.point[i];
        if (p->touching)
            contact[n++] = (world_contact){.segment = p->segment,
                                           .at = p->at,
                                           .force = p->force,
                                           .work = &b->work.support,
                                           .supports = true};
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        contact[n++] = himc_tip_contact(&b->plant, (himc_hand)hand, b->tip_force[hand],
                                        &b->work.contact[hand]);
    return himc_character_step(b->character, b->torque, contact, n, h);
}

void himc_body_account(performance_body *b, bool on)
{
    if (on != b->accounting)
        memset(&b->work, 0, sizeof b->work);
    b->accounting = on;
    himc_character_account(b->character, on ? &b->work : NULL);
}

bool himc_body_follow(performance_body *b, const himc_reference *reference, double h)
{
    himc_pose pose;
    himc_vec3 rate[HIMC_JOINTS];
    b->controller.step = h;
    himc_controller_kinematic_step(&b->controller, &b->skeleton, reference, &b->state, &pose, rate);
    himc_body_clamp(b, &pose, rate);
    himc_pose_to_state(&b->skeleton, &pose, rate, &b->state);
    return himc_body_state_finite(&b->state);
}

void himc_body_clamp(performance_body *b, himc_pose *pose, himc_vec3 rate[HIMC_JOINTS])
{
    himc_saturation_counts *s = &b->saturation;
    for (int j = 0; b->controller.limits && j < HIMC_JOINTS; j++) {
        s->measure[j] = himc_limit_measure(&b->limits, j, pose->joint[j]);
        if (s->measure[j] <= 1) {
            s->held[j] = false;
            continue;
        }
        himc_quat near = himc_limit_closest(&b->limits, j, pose->joint[j]);
        himc_quat beyond = himc_quat_mul(himc_quat_conj(near), pose->joint[j]);
        s->hits[j] += !s->held[j];
        s->held[j] = true;
        s->farthest[j] = fmax(s->farthest[j], himc_vec3_length(himc_quat_log(beyond)));
        pose->joint[j] = near;
        rate[j] = himc_vec3_make(0, 0, 0);
    }
}

long himc_body_limit_hits(const performance_body *b)
{
    long hits = 0;
    for (int j = 0; j < HIMC_JOINTS; j++)
        hits += b->saturation.hits[j];
    return hits;
}

// false; the error lists the names expected
static bool refuse_name(const char *what, const char *name, const char *(*name_of)(int), int count,
                        himc_error *error)
{
    himc_error_set(error, "%s: %s, expected", what, name);
    size_t used = error ? strlen(error->text) : 0;
    for (int i = 0; error && i < count; i++)
        used += himc_format(error->text + used, sizeof error->text - used, " %s", name_of(i));
    return false;
}

bool himc_body_find_joint(const char *name, const char *what, int *joint, himc_error *error)
{
    *joint = himc_joint_find(name);
    return *joint >= 0 || refuse_name(what, name, himc_joint_name, HIMC_JOINTS, error);
}

bool himc_body_read_push(const himc_command *c, himc_stance stance, planned_push *out,
                         himc_error *error)
{
    const himc_atom *atom = c->atom;
    *out = (planned_push){.force = {atom[1].number, atom[2].number, atom[3].number},
                          .seconds = atom[4].number,
                          .along = c->count > 5 ? atom[5].number : -1};
    for (out->segment = 0; out->segment < HIMC_SEGMENTS; out->segment++)
        if (strcmp(atom[0].symbol, himc_segment_name(out->segment)) == 0)
            return out->segment != HIMC_PELVIS || stance != HIMC_STANCE_FIXED ||
                   himc_error_set(error, "push: pelvis: `stance fixed` holds it, expected `stance "
                                         "seated` or `standing`");
    return refuse_name("push: SEGMENT", atom[0].symbol, himc_segment_name, HIMC_SEGMENTS, error);
}
