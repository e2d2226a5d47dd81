/// command_table.c: the vocabulary: one table.
///
/// The `atoms` text of a row is the grammar the parser (command.c) follows, so the manual cannot
/// differ from it. Capitals name an argument (argument.c says what it may be), small letters stand
/// for themselves, `a|b` is one word of several, brackets are optional, ` | ` separates whole
/// alternatives; SPOT is a word or two numbers. Invariant: row i is the command whose id is i.
#include "himc/command.h"

#define WHAT "pose|targets|strikes|head|vmc"
#define STROKE_ATOMS "HAND NUANCE DYNAMIC [SPOT] [DRUM]"

static const himc_command_row table[] = {
    {HIMC_COMMAND_STROKE, HIMC_PERFORMER, "stroke", "BEAT " STROKE_ATOMS,
     "adds one stroke to the score"},
    {HIMC_COMMAND_HIT, HIMC_PERFORMER, "hit", STROKE_ATOMS,
     "plays a stroke as soon as it can be prepared"},
    {HIMC_COMMAND_TEMPO, HIMC_PERFORMER, "tempo", "BPM [BEAT]",
     "sets the tempo, from that beat or from now on"},
    {HIMC_COMMAND_GRIP, HIMC_PERFORMER, "grip", "french|german",
     "how the sticks are held: thumbs up, or palms down (german)"},
    {HIMC_COMMAND_LOOP, HIMC_PERFORMER, "loop", "SWITCH",
     "whether the score begins again after its last whole beat"},
    {HIMC_COMMAND_CLEAR, HIMC_PERFORMER, "clear", "", "forgets the score and all that is queued"},
    {HIMC_COMMAND_PLAY, HIMC_PERFORMER, "play", "", "starts the score from the current beat"},
    {HIMC_COMMAND_STOP, HIMC_PERFORMER, "stop", "", "stops the score; the sticks come to rest"},
    {HIMC_COMMAND_SEEK, HIMC_PERFORMER, "seek", "BEAT", "goes to a beat"},
    {HIMC_COMMAND_SCORE, HIMC_PERFORMER, "score", "FILE",
     "loads a score; while one plays, the new one follows it"},
    {HIMC_COMMAND_TAKE, HIMC_PERFORMER, "take", "FILE", "loads a motion capture and tracks it"},
    {HIMC_COMMAND_UNITS, HIMC_PERFORMER, "units", "clear | FILE NUANCE [SPOT]",
     "cuts strokes out of a take and plays them instead of the built-in ones"},
    {HIMC_COMMAND_TARGET, HIMC_PERFORMER, "target", "HAND X Y Z",
     "moves a drumstick's tip to a place; many of them, it follows"},
    {HIMC_COMMAND_MODE, HIMC_PERFORMER, "mode", "himc|id|ik", "chooses the control pipeline"},
    {HIMC_COMMAND_SOLVER, HIMC_PERFORMER, "solver", "dls|pinv|transpose|nakamura|sdls",
     "chooses the inverse kinematics"},
    {HIMC_COMMAND_DAMPING, HIMC_PERFORMER, "damping", "LAMBDA",
     "sets the damping of the least squares"},
    {HIMC_COMMAND_POSTURE, HIMC_PERFORMER, "posture", "SWITCH",
     "whether the tips' null space is for a natural posture (1), or for nothing, as published"},
    {HIMC_COMMAND_BEND, HIMC_PERFORMER, "bend", "SWITCH",
     "whether `id` bends a take's arms to its tips, so that strokes land (1), or follows the "
     "joints as captured, as published (0)"},
    {HIMC_COMMAND_ELBOW, HIMC_PERFORMER, "elbow", "SWITCH",
     "whether the elbow's place comes before the rest of the posture"},
    {HIMC_COMMAND_WEIGHTS, HIMC_PERFORMER, "weights", "SHOULDER ELBOW WRIST GRIP",
     "how willingly each joint turns to bring the tip nearer"},
    {HIMC_COMMAND_LAW, HIMC_PERFORMER, "law", "printed|feedforward|computed-torque",
     "chooses the inverse dynamics"},
    {HIMC_COMMAND_GAIN, HIMC_PERFORMER, "gain", "reset | frequency FACTOR | JOINT KS KD",
     "sets stiffness and damping of a joint's servo, the natural frequency of all over the usual, "
     "or all as they were"},
    {HIMC_COMMAND_LIMITS, HIMC_PERFORMER, "limits", "ellipsoid|euler|off",
     "keeps the joints as far as the take's player turned them, or table 1's"},
    {HIMC_COMMAND_STRENGTH, HIMC_PERFORMER, "strength", "human|off | JOINT TORQUE",
     "sets the most that a joint's torque may be, or a man's for all, or any"},
    {HIMC_COMMAND_RATE, HIMC_PERFORMER, "rate", "physics HZ | task HZ",
     "sets the rate of simulation or control"},
    {HIMC_COMMAND_COUPLING, HIMC_PERFORMER, "coupling", "two-way|one-way",
     "whether the head's vibration pushes back on the stick"},
    {HIMC_COMMAND_PLAYER, HIMC_PERFORMER, "player", "HEIGHT MASS", "changes the performer's body"},
    {HIMC_COMMAND_PUSH, HIMC_PERFORMER, "push", "SEGMENT FX FY FZ SECONDS",
     "pushes a part of the body with a force for so long"},
    {HIMC_COMMAND_RECORD, HIMC_PERFORMER, "record", "stop | FILE",
     "writes what is played as a take, .bvh .c3d or .trc, when stopped"},
    {HIMC_COMMAND_INFO, HIMC_PERFORMER, "info", "", "tells the state in a few lines"},
    {HIMC_COMMAND_RESET, HIMC_PERFORMER, "reset", "", "makes everything as when just made"},
    {HIMC_COMMAND_MAKE_DRUM, HIMC_PERFORMER, "drum", "NAME [INCHES]",
     "makes a drum, 23 inches by default"},
    {HIMC_COMMAND_SUBSCRIBE, HIMC_PERFORMER, "subscribe", "HOST PORT " WHAT " [HZ] | HOST vmc [HZ]",
     "sends that to an address over OSC, 33 times a second by default; vmc to port 39539"},
    {HIMC_COMMAND_UNSUBSCRIBE, HIMC_PERFORMER, "unsubscribe",
     "HOST PORT [" WHAT "] [HZ] | HOST vmc", "stops sending that, or anything, to an address"},
    {HIMC_COMMAND_LISTEN, HIMC_PERFORMER, "listen", "PORT",
     "takes commands over OSC at that port of this machine; 0 ends it"},
    {HIMC_COMMAND_RADIUS, HIMC_DRUM, "radius", "RADIUS", "sets the head's radius"},
    {HIMC_COMMAND_TENSION, HIMC_DRUM, "tension", "TENSION", "sets the head's tension"},
    {HIMC_COMMAND_DENSITY, HIMC_DRUM, "density", "DENSITY", "sets the head's mass per area"},
    {HIMC_COMMAND_TUNE, HIMC_DRUM, "tune", "HZ | NOTE",
     "sets the tension so that the principal mode sounds there"},
    {HIMC_COMMAND_MODES, HIMC_DRUM, "modes", "COUNT", "sets the number of modes"},
    {HIMC_COMMAND_DECAY, HIMC_DRUM, "decay", "T60 | SIGMA0 SIGMA1",
     "sets the losses by the decay time, or by both of their parameters"},
    {HIMC_COMMAND_AIR, HIMC_DRUM, "air", "SWITCH", "whether air and kettle load the head"},
    {HIMC_COMMAND_KETTLE, HIMC_DRUM, "kettle", "usual | VOLUME",
     "sets the volume under the head, or the usual one for its radius"},
    {HIMC_COMMAND_GLIDE, HIMC_DRUM, "glide", "AMOUNT",
     "sets how much the tension rises as the head bows out"},
    {HIMC_COMMAND_DAMP, HIMC_DRUM, "damp", "AMOUNT", "lays a hand on the head"},
    {HIMC_COMMAND_SHAPE, HIMC_DRUM, "shape", "circle | rectangle LENGTH WIDTH | FILE",
     "makes a head of another outline, or one of masses and springs from a file"},
    {HIMC_COMMAND_MALLET, HIMC_DRUM, "mallet", "soft|medium|hard|wood | K ALPHA MASS",
     "chooses the mallet, or its stiffness, exponent and mass"},
    {HIMC_COMMAND_PLACE, HIMC_DRUM, "place", "X Y Z [TILT]",
     "says where the head stands and how it leans"},
    {HIMC_COMMAND_PICKUP, HIMC_DRUM, "pickup", "air AZIMUTH ELEVATION DISTANCE | X Y",
     "says where the sound is taken: in the air or on the head"},
    {HIMC_COMMAND_PICKUPS, HIMC_DRUM, "pickups", "CHANNELS", "sets by how many it is heard"},
    {HIMC_COMMAND_CHANNEL, HIMC_DRUM, "channel",
     "CHANNEL air AZIMUTH ELEVATION DISTANCE | CHANNEL X Y",
     "says where the sound of one of them is taken"},
    {HIMC_COMMAND_TECHNIQUE, HIMC_DRUM, "technique", "modal|signal|clip",
     "how blows become sound: by the head, or in Pure Data by the patch around it"},
    {HIMC_COMMAND_STRIKE, HIMC_DRUM, "strike", "X Y VELOCITY", "strikes without a performer"},
};

#define ROWS ((int)(sizeof table / sizeof *table))

const himc_command_row *himc_command_table(int index)
{
    return index >= 0 && index < ROWS ? &table[index] : NULL;
}
