/// encode.c: the performer's state as OSC 1.0. Several messages go into a bundle with the time of
/// the state. A packet that would grow beyond its limit is closed and another is
/// begun, with the same time tag, so that no packet is fragmented on the way.
///
/// The second half writes the body as a humanoid avatar (Virtual Motion Capture protocol,
/// protocol.vmc.info), for programs that know bones by Unity's names.
///
/// World: x right, y up, z forward, left-handed: a vector (x, y, z) becomes (-y, z, x). That is a
/// reflection, so the axis of a rotation is reversed: (x, y, z, w) becomes (y, -z, -x, w).
/// Rest: a humanoid rests in the T, arms straight out, palms down; in our zero pose they hang. A
/// quarter turn A about x takes the arm of a T to a hanging arm, so the rotation of a bone in the
/// world is R A, and in the frame of its parent (R_p A_p)^-1 R A. Invariant: adding up the
/// positions and rotations sent, from the root along the bones, gives our joints, mirrored.
#include "osc/encode.h"
#include "himc/body.h"
#include "osc/message.h"
#include "osc/counters.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define BUNDLE_HEAD 16 // "#bundle" and the time tag (OSC 1.0) (bytes)

// --- packets

uint64_t himc_osc_time_tag(double wall)
{
    double whole = floor(wall);
    // 70 years of 365 days and 17 leap days lie between 1900 and 1970 (RFC 868)
    return ((uint64_t)whole + 2208988800u) << 32 | (uint64_t)((wall - whole) * 4294967296.0);
}

void himc_osc_encode_begin(osc_packets *p, size_t limit, bool bundle, double wall)
{
    p->limit = limit;
    p->bundle = bundle;
    p->count = 0;
    p->time_tag = himc_osc_time_tag(wall);
}

static void add_message(osc_packets *p, const osc_message *message)
{
    size_t size = himc_osc_message_size(message), length = p->bundle ? 4 : 0;
    if (size == 0 || size + BUNDLE_HEAD + 4 > p->limit)
        return;
    if (p->count == 0 || !p->bundle || p->size[p->count - 1] + length + size > p->limit) {
        if (p->count == PACKETS)
            return;
        unsigned char *head = p->data[p->count];
        p->size[p->count++] = p->bundle ? BUNDLE_HEAD : 0;
        if (p->bundle) {
            memcpy(head, "#bundle", 8);
            himc_osc_put32(head + 8, (uint32_t)(p->time_tag >> 32));
            himc_osc_put32(head + 12, (uint32_t)p->time_tag);
        }
    }
    unsigned char *at = p->data[p->count - 1] + p->size[p->count - 1];
    if (p->bundle)
        himc_osc_put32(at, (uint32_t)size);
    himc_osc_message_write(message, at + length);
    p->size[p->count - 1] += length + size;
}

// one message; types: s text, i int, f double
static void add(osc_packets *p, const char *path, const char *types, ...)
{
    osc_message message;
    va_list args;
    himc_osc_message_begin(&message, path);
    va_start(args, types);
    for (; *types; types++) {
        if (*types == 's')
            himc_osc_message_text(&message, va_arg(args, const char *));
        else if (*types == 'i')
            himc_osc_message_int(&message, va_arg(args, int));
        else
            himc_osc_message_float(&message, (float)va_arg(args, double));
    }
    va_end(args);
    add_message(p, &message);
}

// --- states

void himc_osc_encode_pose(osc_packets *p, const osc_pose *pose)
{
    // before the bodies, which complete a pose
    const float(*s)[3] = pose->support;
    if (pose->sits)
        add(p, "/himc/support", "ffffffffffff", s[0][0], s[0][1], s[0][2], s[1][0], s[1][1],
            s[1][2], s[2][0], s[2][1], s[2][2], s[3][0], s[3][1], s[3][2]);
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        const float *x = pose->origin[i], *q = pose->orientation[i];
        add(p, "/himc/body", "sfffffff", himc_segment_name(i), x[0], x[1], x[2], q[3], q[0], q[1],
            q[2]);
    }
}

void himc_osc_encode_targets(osc_packets *p, const osc_pose *pose)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const float *x = pose->target[hand];
        add(p, "/himc/targets", "sfff", himc_hand_name((himc_hand)hand), x[0], x[1], x[2]);
    }
}

void himc_osc_encode_strike(osc_packets *p, const osc_strike *strike)
{
    const himc_strike *s = &strike->strike;
    // a float's time is exact to 1 ms for two hours only; whole seconds begin again after 68 years
    double whole = floor(s->time);
    add(p, "/himc/strike", "fssfffffsiif", s->time, himc_hand_name(s->hand), s->drum, s->x, s->y,
        s->velocity, s->force, s->duration, s->nuance, (int)strike->number,
        (int)fmod(whole, 2147483648.0), s->time - whole);
}

void himc_osc_encode_missed(osc_packets *p, const himc_strike *missed)
{
    add(p, "/himc/missed", "fssf", isfinite(missed->beat) ? missed->beat : -1.0,
        himc_hand_name(missed->hand), missed->drum, missed->time);
}

void himc_osc_encode_beat(osc_packets *p, double beat)
{
    add(p, "/himc/beat", "f", beat);
}

void himc_osc_encode_head(osc_packets *p, const osc_head *head)
{
    char path[64];
    osc_message message;
    snprintf(path, sizeof path, "/membrane/%s/head", head->name);
    himc_osc_message_begin(&message, path);
    for (int i = 0; i < head->count; i++)
        himc_osc_message_float(&message, head->amplitude[i]);
    add_message(p, &message);
}

void himc_osc_encode_sound(osc_packets *p, const osc_sound *sound)
{
    unsigned char bytes[2 * 2 * SOUND_FRAMES], *at = bytes;
    osc_message message;
    for (int i = 0; i < SOUND_FRAMES; i++)
        for (int channel = 0; channel < sound->channels; channel++) {
            double value = fmax(-1, fmin(1, (double)sound->sample[i][channel]));
            int16_t whole = (int16_t)lrint(32767 * value);
            *at++ = (unsigned char)((uint16_t)whole >> 8);
            *at++ = (unsigned char)whole;
        }
    himc_osc_message_begin(&message, "/himc/sound");
    himc_osc_message_int(&message, (int32_t)sound->first);
    himc_osc_message_int(&message, sound->rate);
    himc_osc_message_int(&message, sound->channels);
    himc_osc_message_bytes(&message, bytes, (size_t)(at - bytes));
    add_message(p, &message);
}

void himc_osc_encode_drum(osc_packets *p, const osc_drum *drum)
{
    char path[64];
    snprintf(path, sizeof path, "/membrane/%s/place", drum->name);
    add(p, path, "fffffff", drum->place[0], drum->place[1], drum->place[2], drum->place[3],
        drum->place[4], drum->place[5], drum->place[6]);
}

void himc_osc_encode_status(osc_packets *p, const osc_status *status, const himc_osc_counts *c)
{
    const himc_performance_stats *s = &status->stats;
    const struct {
        const char *name;
        double value;
    } pair[] = {{"sound", s->sample_rate},
                {"physics", s->physics_rate},
                {"task", s->task_rate},
                {"load", status->load},
                {"seconds", s->seconds},
                {"strokes", s->strokes},
                {"played", s->played},
                {"strikes", (double)status->strikes},
                {"recoveries", (double)s->recoveries},
                {"limit_hits", (double)s->limit_hits},
#define COUNTED(ID, field) {#field, (double)c->field},
                OSC_COUNTERS(COUNTED){"lost", (double)c->lost}};
    osc_message message;
    himc_osc_message_begin(&message, "/himc/status");
    for (size_t i = 0; i < sizeof pair / sizeof *pair; i++) {
        himc_osc_message_text(&message, pair[i].name);
        himc_osc_message_float(&message, (float)pair[i].value);
    }
    add_message(p, &message);
}

void himc_osc_encode_line(osc_packets *p, bool error, const char *text)
{
    add(p, error ? "/himc/error" : "/himc/info", "s", text);
}

// --- the avatar

typedef struct bone {
    const char *name;
    int segment, parent; // parent: a bone, -1 for the root
    int arm;             // +1 left, -1 right, 0 none
    double along;        // share of the way from the joint of `segment` to that of `towards`
    int towards;
} bone;

// X(ID, bone); a parent stands before its children; shares chosen: chest and shoulders where a rig
// has them
#define BONE_ROWS(X)                                                               \
    X(HIPS, Hips, HIMC_PELVIS, -1, 0, 0, 0)                                        \
    X(SPINE, Spine, HIMC_TRUNK, HIPS, 0, 0, 0)                                     \
    X(CHEST, Chest, HIMC_TRUNK, SPINE, 0, 0.4, HIMC_NECK)                          \
    X(NECK, Neck, HIMC_NECK, CHEST, 0, 0, 0)                                       \
    X(HEAD, Head, HIMC_HEAD, NECK, 0, 0, 0)                                        \
    X(SHOULDER_L, LeftShoulder, HIMC_TRUNK, CHEST, 0, 0.85, HIMC_LEFT_UPPER_ARM)   \
    X(SHOULDER_R, RightShoulder, HIMC_TRUNK, CHEST, 0, 0.85, HIMC_RIGHT_UPPER_ARM) \
    X(UPPER_ARM_L, LeftUpperArm, HIMC_LEFT_UPPER_ARM, SHOULDER_L, 1, 0, 0)         \
    X(UPPER_ARM_R, RightUpperArm, HIMC_RIGHT_UPPER_ARM, SHOULDER_R, -1, 0, 0)      \
    X(LOWER_ARM_L, LeftLowerArm, HIMC_LEFT_FOREARM, UPPER_ARM_L, 1, 0, 0)          \
    X(LOWER_ARM_R, RightLowerArm, HIMC_RIGHT_FOREARM, UPPER_ARM_R, -1, 0, 0)       \
    X(HAND_L, LeftHand, HIMC_LEFT_HAND, LOWER_ARM_L, 1, 0, 0)                      \
    X(HAND_R, RightHand, HIMC_RIGHT_HAND, LOWER_ARM_R, -1, 0, 0)                   \
    X(UPPER_LEG_L, LeftUpperLeg, HIMC_LEFT_UPPER_LEG, HIPS, 0, 0, 0)               \
    X(UPPER_LEG_R, RightUpperLeg, HIMC_RIGHT_UPPER_LEG, HIPS, 0, 0, 0)             \
    X(LOWER_LEG_L, LeftLowerLeg, HIMC_LEFT_LOWER_LEG, UPPER_LEG_L, 0, 0, 0)        \
    X(LOWER_LEG_R, RightLowerLeg, HIMC_RIGHT_LOWER_LEG, UPPER_LEG_R, 0, 0, 0)      \
    X(FOOT_L, LeftFoot, HIMC_LEFT_FOOT, LOWER_LEG_L, 0, 0, 0)                      \
    X(FOOT_R, RightFoot, HIMC_RIGHT_FOOT, LOWER_LEG_R, 0, 0, 0)                    \
    X(TOES_L, LeftToes, HIMC_LEFT_TOES, FOOT_L, 0, 0, 0)                           \
    X(TOES_R, RightToes, HIMC_RIGHT_TOES, FOOT_R, 0, 0, 0)
#define BONE_ID(id, ...) id,
#define BONE(id, name, ...) {#name, __VA_ARGS__},
enum { BONE_ROWS(BONE_ID) BONES };
static const bone bones[BONES] = {BONE_ROWS(BONE)};

static himc_vec3 vector(const float x[3])
{
    return himc_vec3_make(x[0], x[1], x[2]);
}

static himc_quat rotation(const osc_pose *pose, int segment)
{
    const float *q = pose->orientation[segment];
    return (himc_quat){q[3], q[0], q[1], q[2]};
}

// a position and a rotation in Unity's world
static void add_transform(osc_packets *p, const char *path, const char *name, himc_vec3 x,
                          himc_quat q)
{
    add(p, path, "sfffffff", name, -x.y, x.z, x.x, q.y, -q.z, -q.x, q.w);
}

void himc_osc_encode_vmc_pose(osc_packets *p, const osc_pose *pose, double time)
{
    static const char *const mallet[] = {"left-mallet", "right-mallet"};
    himc_vec3 x[BONES];
    himc_quat q[BONES];
    add(p, "/VMC/Ext/OK", "iiii", 1, 3, 0, 1); // loaded, calibrated, mode, tracking
    add(p, "/VMC/Ext/T", "f", time);
    add_transform(p, "/VMC/Ext/Root/Pos", "root", (himc_vec3){0, 0, 0}, himc_quat_identity());
    for (int i = 0; i < BONES; i++) {
        const bone *b = &bones[i];
        // its beginning, and its rotation away from the T, in our world
        himc_vec3 joint = vector(pose->origin[b->segment]);
        himc_vec3 way = himc_vec3_sub(vector(pose->origin[b->towards]), joint);
        himc_quat from_t = himc_quat_exp(himc_vec3_make(-b->arm * HIMC_PI / 2, 0, 0));
        x[i] = himc_vec3_madd(joint, b->along, way);
        q[i] = himc_quat_mul(rotation(pose, b->segment), from_t);
        himc_vec3 offset = x[i];
        himc_quat relative = q[i];
        if (b->parent >= 0) {
            himc_quat back = himc_quat_conj(q[b->parent]);
            offset = himc_quat_rotate(back, himc_vec3_sub(x[i], x[b->parent]));
            relative = himc_quat_mul(back, q[i]);
        }
        add_transform(p, "/VMC/Ext/Bone/Pos", b->name, offset, relative);
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        add_transform(p, "/VMC/Ext/Tra/Pos", mallet[hand], vector(pose->tip[hand]),
                      rotation(pose, himc_stick_segment((himc_hand)hand)));
}

void himc_osc_encode_vmc_strike(osc_packets *p, const himc_strike *strike, double hz)
{
    // MIDI: key 69 is A4, 440 Hz; a force of 200 N is full velocity, chosen
    double key = round(69 + 12 * log2(hz / 440)), velocity = strike->force / 200;
    int note = key < 0 ? 0 : key > 127 ? 127 : (int)key;
    velocity = velocity > 1 ? 1 : velocity;
    add(p, "/VMC/Ext/Midi/Note", "iiif", 1, (int)strike->hand, note, velocity);
    add(p, "/VMC/Ext/Midi/Note", "iiif", 0, (int)strike->hand, note, 0.0);
}
