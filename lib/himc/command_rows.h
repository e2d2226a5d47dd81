/// command_rows.h: the table of all commands, one row per command.
///
/// Everything else follows from these rows: the ids (command.h), the parser and its error lines
/// (lib/src/base/command.c), the actions of performer and drum, the manual, Pure Data and OSC.
///
/// This file has no include guard. Define HIMC_COMMAND_ROW, then include it; it undefines the macro
/// at its end. Without a definition the rows are empty. The columns of HIMC_COMMAND_ROW(ID, word,
/// receiver, when, marks, atoms, does):
///
///   ID        the command is HIMC_COMMAND_ID
///   word      the command's name; a drum's action is the function do_word
///   receiver  PERFORMER or DRUM
///   when      NOW        acts when it arrives: it may allocate, read files, or be refused for a
///                        reason that the parser cannot know
///             AT_SAMPLE  acts on its sample, in the audio callback
///             HOST       the program around the library answers it
///             NETWORK    the OSC server carries it out
///   marks     0, or several of himc_command_marks joined by |
///   atoms     the grammar. Capitals name an argument (lib/src/base/argument.c has its range),
///             small letters stand for themselves, `a|b` is one word of several, brackets are
///             optional, ` | ` separates the forms. SPOT is a word or two numbers, `...` any atoms.
///             Where words are the names of an enum's values, they stand in the order of that enum.
///   does      one sentence for the manual
///
/// A command that only sets something of the performer is a HIMC_SETTING_ROW(ID, word, when, atoms,
/// kind, field, usual, after, does). The command's action, the default, `dump`, `reset` and the
/// check of scores follow from it. The library alone reads its further columns:
///
///   kind      how its atoms are stored: switch, word, numbers, or its own way
///             (lib/src/performance/performance_settings.c)
///   field     where: of performance_settings (lib/src/performance/performance_settings.h)
///   usual     its default, as atoms; "": that of the struct around the field
///   after     the consequence of a change (setting_effect), NOTHING for most

#ifndef HIMC_COMMAND_ROW
#define HIMC_COMMAND_ROW(ID, word, receiver, when, marks, atoms, does)
#endif
#ifndef HIMC_SETTING_ROW
#define HIMC_SETTING_ROW(ID, word, when, atoms, kind, field, usual, after, does) \
    HIMC_COMMAND_ROW(ID, word, PERFORMER, when, 0, atoms, does)
#endif

#define HIMC_ROW_STROKE "HAND NUANCE DYNAMIC [SPOT] [dead] [PART] [DRUM]"
#define HIMC_ROW_ROLL "single|double|press"
#define HIMC_ROW_STREAM "pose|targets|strikes|head|vmc|sound|errors"

// The laws of control (lib/src/control/law.h) with their words: printed, tau = ks (qt - q) - kd q'
// (2012 paper, equation 2); feedforward, gravity added, and kd (qt' - q') in place of -kd q';
// computed-torque, desired accelerations, torques by inverse dynamics; the default. Last: the law
// gives accelerations
#define HIMC_LAWS(LAW)                                  \
    LAW(PRINTED, printed, "printed", false)             \
    LAW(FEEDFORWARD, feedforward, "feedforward", false) \
    LAW(COMPUTED_TORQUE, computed_torque, "computed-torque", true)
// the kinds of a head (lib/src/head/kind.h) with their forms of `shape`, before that of a file
#define HIMC_KINDS(KIND)                      \
    KIND(round, "circle")                     \
    KIND(rectangle, "rectangle LENGTH WIDTH") \
    KIND(list, "modes FILE")                  \
    KIND(listed, "listed LISTED")             \
    KIND(bar, "bar BAR HZ [HZ]")              \
    KIND(two_heads, "shell SHELL [INCHES]")   \
    KIND(plate, "plate PLATE [INCHES] [MM]")
// the instruments that the library has as lists of modes (lib/src/head/lists.c)
#define HIMC_LISTS(LIST)  \
    LIST("claves")        \
    LIST("wood-block")    \
    LIST("temple-blocks") \
    LIST("triangle")      \
    LIST("agogo")         \
    LIST("cowbell")       \
    LIST("tambourine")
// bars that are computed (lib/src/head/bar.c)
#define HIMC_BARS(BAR) \
    BAR("marimba") BAR("xylophone") BAR("vibraphone") BAR("glockenspiel") BAR("tubular-bell")
// drums with a shell (lib/src/head/two_heads.c)
#define HIMC_SHELLS(SHELL) \
    SHELL("snare")         \
    SHELL("tom")           \
    SHELL("concert-tom")   \
    SHELL("bass-drum")     \
    SHELL("kick")          \
    SHELL("conga")         \
    SHELL("bongo")         \
    SHELL("timbale")
// cymbals and gongs (lib/src/head/plate.c)
#define HIMC_PLATES(PLATE) \
    PLATE("crash") PLATE("ride") PLATE("china") PLATE("splash") PLATE("hi-hat") PLATE("tam-tam")
// the set-ups that the library has (lib/src/base/setups.c)
#define HIMC_SETUPS(SETUP) \
    SETUP("kit") SETUP("timpani") SETUP("multi") SETUP("xylophone") SETUP("marimba") SETUP("bells")
// the words of `instrument`
#define HIMC_INSTRUMENTS(WORD) \
    WORD("timpano") HIMC_BARS(WORD) HIMC_LISTS(WORD) HIMC_SHELLS(WORD) HIMC_PLATES(WORD)
#define HIMC_ROW_KIND(name, form) form " | "
#define HIMC_ROW_LAW(ID, name, word, accelerates) "|" word

// to the performer
HIMC_COMMAND_ROW(
    STROKE, stroke, PERFORMER, NOW, 0, "BEAT " HIMC_ROW_STROKE,
    "adds one stroke to the score; dead: the mallet stays on the head; PART: a pitch or a name, of "
    "an instrument that has several")
HIMC_COMMAND_ROW(
    HIT, hit, PERFORMER, AT_SAMPLE, HIMC_AFTER_STROKES, HIMC_ROW_STROKE,
    "plays a stroke `latency` after the message; any: with the better hand, on one drum in turns")
HIMC_COMMAND_ROW(
    NOTE, note, PERFORMER, NOW, HIMC_AFTER_STROKES, "PITCH VELOCITY [NUANCE]",
    "plays a MIDI note as `hit any` does, on the drum or bar that sounds it, on the "
    "instrument of that General MIDI key, or on the nearest pitch; VELOCITY 0 ends it, "
    "as `noteoff` says")
HIMC_COMMAND_ROW(
    ROLL, roll, PERFORMER, NOW, 0,
    "BEAT LENGTH " HIMC_ROW_ROLL " DYNAMIC DYNAMIC [SPOT] [PART] [DRUM] | "
    "BEAT LENGTH " HIMC_ROW_ROLL " DYNAMIC [SPOT] [PART] [DRUM]",
    "adds a roll, from one dynamic to another: single strokes, or strokes that bounce once "
    "(double) or until the next (press)")
HIMC_COMMAND_ROW(CRESC, cresc, PERFORMER, NOW, 0, "BEAT LENGTH DYNAMIC DYNAMIC",
                 "moves the dynamic of strokes and rolls that have `-` for theirs evenly from one "
                 "to another, which then holds; as a message before them")
HIMC_COMMAND_ROW(FLAM, flam, PERFORMER, NOW, 0, "BEAT " HIMC_ROW_STROKE,
                 "adds a stroke with a grace note by the other hand")
HIMC_COMMAND_ROW(DRAG, drag, PERFORMER, NOW, 0, "BEAT " HIMC_ROW_STROKE,
                 "adds a stroke with two grace notes by the other hand, which bounces")
HIMC_COMMAND_ROW(RUFF, ruff, PERFORMER, NOW, 0, "BEAT " HIMC_ROW_STROKE,
                 "adds a stroke with two grace notes as `drag`, a little slower")
HIMC_COMMAND_ROW(
    AT, at, PERFORMER, NOW, 0, "BEAT DRUM COMMAND [...] | BEAT push SEGMENT [...]",
    "changes a drum at a beat by tune, gliss, tension, pedal, damp, muffle, decay or glide; or "
    "pushes the performer")
HIMC_COMMAND_ROW(DRUM_GLISS, gliss, PERFORMER, NOW, HIMC_NOT_IN_SCORE,
                 "DRUM HZ LENGTH | DRUM NOTE LENGTH",
                 "moves a drum's pedal evenly to that pitch in LENGTH beats of the tempo now")
HIMC_COMMAND_ROW(
    TEMPO, tempo, PERFORMER, AT_SAMPLE, 0, "BPM [BEAT] | BPM BPM LENGTH [BEAT]",
    "sets the tempo, 100 by default, from that beat or from now on; or moves it evenly "
    "to another in LENGTH beats")
HIMC_COMMAND_ROW(LOOP, loop, PERFORMER, NOW, 0, "SWITCH | FROM TO",
                 "1: the score begins again after its last whole beat; FROM TO: its beats from one "
                 "up to the other are repeated; 0: the round under way is the last")
HIMC_COMMAND_ROW(CLEAR, clear, PERFORMER, NOW, HIMC_AFTER_STROKES, "",
                 "forgets the score and all queued strokes")
HIMC_COMMAND_ROW(PLAY, play, PERFORMER, AT_SAMPLE, HIMC_AFTER_STROKES, "",
                 "starts the score from the current beat")
HIMC_COMMAND_ROW(STOP, stop, PERFORMER, AT_SAMPLE, HIMC_AFTER_STROKES, "",
                 "stops the score; the sticks come to rest")
HIMC_COMMAND_ROW(SEEK, seek, PERFORMER, AT_SAMPLE, HIMC_AFTER_STROKES, "BEAT", "goes to a beat")
HIMC_COMMAND_ROW(SCORE, score, PERFORMER, NOW, HIMC_NOT_IN_SCORE | HIMC_IN_FOLDER, "FILE",
                 "loads a score; while one plays, the new one follows it")
HIMC_COMMAND_ROW(TAKE, take, PERFORMER, NOW, HIMC_IN_FOLDER, "FILE",
                 "loads a motion capture and tracks it")
HIMC_COMMAND_ROW(
    NUDGE, nudge, PERFORMER, NOW, 0, "HAND TIME SPAN X Y Z",
    "moves a tip of the take by that way at that time, smoothly within SPAN before and after")
HIMC_COMMAND_ROW(UNITS, units, PERFORMER, NOW, 0, "clear | FILE NUANCE [SPOT]",
                 "plays strokes cut out of a take instead of the built-in ones")
HIMC_COMMAND_ROW(CLOCK, clock, PERFORMER, AT_SAMPLE, HIMC_NOT_IN_SCORE,
                 "[PHASE] | start|continue|stop",
                 "a tick of MIDI's clock, 24 a beat, its start, going on and stop; or where in its "
                 "beat a phasor is: tempo and beat follow, as `sync` says")
HIMC_COMMAND_ROW(TARGET, target, PERFORMER, AT_SAMPLE, HIMC_AFTER_STROKES, "HAND X Y Z",
                 "moves a drumstick's tip to a point, or along a stream of points")

// settings, in the order of `dump`
HIMC_SETTING_ROW(RATE, rate, NOW, "physics HZ | task HZ", rate, physics_rate, "", STEPS,
                 "sets the rate of simulation or control")
HIMC_SETTING_ROW(
    ENGINE, engine, AT_SAMPLE, "tree|ode", word, engine, "tree", NOTHING,
    "solves the equations of the body's motion along the tree of joints, or by the Open Dynamics "
    "Engine, to the same result")
HIMC_SETTING_ROW(COUPLING, coupling, AT_SAMPLE, "two-way|one-way", word, coupling, "two-way",
                 NOTHING, "two-way: the head's vibration pushes back on the stick")
HIMC_SETTING_ROW(PLAYER, player, NOW, "HEIGHT MASS", player, skeleton, "", BODY,
                 "changes the performer's body")
HIMC_SETTING_ROW(
    STANCE, stance, NOW, "fixed|seated|standing", word, stance, "fixed", BODY,
    "fixed: the pelvis is held, as published; seated: it rests on the stool, the feet on the "
    "floor, and a foot works the pedals; standing: he balances on his feet, without pedals, with "
    "`law computed-torque`")
HIMC_SETTING_ROW(MODE, mode, AT_SAMPLE, "himc|id|ik", word, control.mode, "", MODE,
                 "chooses the control pipeline")
HIMC_SETTING_ROW(SOLVER, solver, AT_SAMPLE, "dls|pinv|transpose|nakamura|sdls", word,
                 control.solver, "", NOTHING, "chooses the inverse kinematics")
HIMC_SETTING_ROW(DAMPING, damping, AT_SAMPLE, "LAMBDA", numbers, control.damping, "", NOTHING,
                 "sets the damping of the least squares")
HIMC_SETTING_ROW(POSTURE, posture, AT_SAMPLE, "SWITCH", switch, control.posture, "", NOTHING,
                 "null space of the tips: 1 keeps a natural posture, 0 is unused, as published")
HIMC_SETTING_ROW(
    BEND, bend, AT_SAMPLE, "SWITCH", switch, bend, "1", REPLAN,
    "in `id`: 1 bends a take's arms so that strokes land, 0 follows the joints as captured, as "
    "published")
HIMC_SETTING_ROW(ELBOW, elbow, AT_SAMPLE, "SWITCH", switch, control.elbow, "", NOTHING,
                 "1: the elbow's place has priority over the rest of the posture")
HIMC_SETTING_ROW(WEIGHTS, weights, AT_SAMPLE, "SHOULDER ELBOW WRIST GRIP", numbers, control.weight,
                 "", NOTHING, "sets how readily each joint turns to bring the tip nearer")
HIMC_SETTING_ROW(LAW, law, AT_SAMPLE, &HIMC_LAWS(HIMC_ROW_LAW)[1], word, control.law, "", NOTHING,
                 "chooses the inverse dynamics")
HIMC_SETTING_ROW(LIMITS, limits, NOW, "off|ellipsoid|euler", word, limits, "off", LIMITS,
                 "limits the joints to the range of the take's player, else of table 1")
HIMC_SETTING_ROW(
    GAIN, gain, NOW, "reset | frequency FACTOR | JOINT KS KD | DB", gain, gain, "", FADER,
    "sets stiffness and damping of a joint's servo, or the natural frequency of all over the "
    "default; reset: the defaults; with one number: how loud all drums are heard")
HIMC_SETTING_ROW(
    STRENGTH, strength, NOW, "human|off | JOINT TORQUE", strength, control.strength, "", NOTHING,
    "human: joints have a man's largest torques, 80 N m at the shoulder of 75 kg, up to 6 times "
    "that (standing 2) while a tip is astray; off: no limit, as published; or sets the largest "
    "torque of a joint")
HIMC_SETTING_ROW(
    GRIP, grip, NOW, "german|french [servo] | servo", grip, grip, "german", GRIP,
    "palms down (german) or thumbs up (french); doubles, buzzes and grace notes bounce; servo: a "
    "stroke has one short contact, as published")
HIMC_SETTING_ROW(HUMAN, human, AT_SAMPLE, "AMOUNT [SEED]", human, human, "0", HUMAN,
                 "lets strokes vary as a player's do, 0: not at all; each seed is another player")
HIMC_SETTING_ROW(ALIVE, alive, AT_SAMPLE, "SWITCH", switch, alive, "0", NOTHING,
                 "1: head and trunk follow the music, the player breathes; 0: they rest")
HIMC_SETTING_ROW(
    LATENCY, latency, AT_SAMPLE, "MS | auto", latency, latency, "150", NOTHING,
    "each hit lands so long after its message, 150 by default, as strong as that allows; auto: "
    "330; 0: as soon as it can")

HIMC_SETTING_ROW(SYNC, sync, AT_SAMPLE, "midi|phase|off", word, sync, "midi", NOTHING,
                 "midi: tempo and beat follow the ticks of `clock`; phase: its PHASE, in Pure Data "
                 "the signal of the last inlet; off: none")
HIMC_SETTING_ROW(SUBDIVIDE, subdivide, AT_SAMPLE, "PARTS", numbers, subdivide, "1", NOTHING,
                 "tells so many parts of each beat: `beat 2.5`")
HIMC_SETTING_ROW(NOTEOFF, noteoff, AT_SAMPLE, "ring|damp", word, noteoff, "ring", NOTHING,
                 "the end of a `note`: damp lays a hand on what rings, ring lets it ring")

HIMC_COMMAND_ROW(PUSH, push, PERFORMER, AT_SAMPLE, HIMC_AT_BEAT, "SEGMENT FX FY FZ SECONDS [ALONG]",
                 "pushes a segment for a time, at its centre of mass or ALONG m from its joint")
HIMC_COMMAND_ROW(
    LISTENER, listener, PERFORMER, NOW, 0, "off | usual | X Y Z [YAW]",
    "places the two ears that hear all drums, facing the performer or that way; usual: in front, "
    "except for drums with a pickup of their own; off: by the drums' pickups")
HIMC_COMMAND_ROW(
    ROOM, room, PERFORMER, AT_SAMPLE, 0, "SECONDS [VOLUME]",
    "sets reverberation time and size of the listener's room, 2 s and 1500 m^3 by default; 0: no "
    "walls")
HIMC_COMMAND_ROW(MUTE, mute, PERFORMER, AT_SAMPLE, 0, "SWITCH", "1: silences all drums")
HIMC_COMMAND_ROW(RECORD, record, PERFORMER, NOW, HIMC_WRITES_FILE, "stop | FILE",
                 "records the motion; `stop` writes it as a take, .bvh .c3d or .trc")
HIMC_COMMAND_ROW(GET, get, PERFORMER, HOST, HIMC_NOT_IN_SCORE, "WHAT",
                 "answers with a setting, as the command that sets it, or with tempo, beat, state, "
                 "drums, loop, room, listener, mute")
HIMC_COMMAND_ROW(INFO, info, PERFORMER, HOST, 0, "", "describes the state in a few lines")
HIMC_COMMAND_ROW(DUMP, dump, PERFORMER, NOW, HIMC_NOT_IN_SCORE | HIMC_WRITES_FILE, "[FILE]",
                 "answers with the state as commands, or writes it to a file, which is a score")
HIMC_COMMAND_ROW(PRESET, preset, PERFORMER, NOW, HIMC_NOT_IN_SCORE | HIMC_IN_FOLDER, "NAME",
                 "loads NAME.txt, a score, or written by `dump`")
HIMC_COMMAND_ROW(RESET, reset, PERFORMER, NOW, 0, "",
                 "sets everything as when just made; a [membrane~] keeps its settings")
HIMC_COMMAND_ROW(MAKE_DRUM, drum, PERFORMER, NOW, HIMC_MAKES_DRUM, "NAME [INCHES]",
                 "makes a drum, 26 inches by default")
HIMC_COMMAND_ROW(
    INSTRUMENT, instrument, PERFORMER, NOW, HIMC_MAKES_DRUM,
    "NAME INSTRUMENT [SIZE] [SIZE] | NAME INSTRUMENT NOTE [NOTE] | NAME modes FILE",
    "makes an instrument with its own mallets: of so many inches (a cymbal also mm thick), of that "
    "pitch, or with bars between two pitches")
HIMC_COMMAND_ROW(SETUP, setup, PERFORMER, NOW, HIMC_IN_FOLDER, "SETUP | FILE",
                 "makes several instruments and puts them at their places")
HIMC_COMMAND_ROW(SUBSCRIBE, subscribe, PERFORMER, NETWORK, 0,
                 "HOST PORT " HIMC_ROW_STREAM " [HZ] | HOST vmc [HZ]",
                 "sends a stream to an address over OSC, 33 times a second by default; vmc to port "
                 "39539")
HIMC_COMMAND_ROW(UNSUBSCRIBE, unsubscribe, PERFORMER, NETWORK, 0,
                 "HOST PORT [" HIMC_ROW_STREAM "] [HZ] | HOST vmc",
                 "stops sending that stream, or all streams, to an address")
HIMC_COMMAND_ROW(LISTEN, listen, PERFORMER, NETWORK, 0, "PORT",
                 "accepts commands over OSC at that port of this machine; 0 ends it")

// to a drum
HIMC_COMMAND_ROW(RADIUS, radius, DRUM, NOW, HIMC_CHANGES_HEAD, "RADIUS", "sets the head's radius")
HIMC_COMMAND_ROW(TENSION, tension, DRUM, NOW, HIMC_CHANGES_HEAD | HIMC_AT_BEAT, "TENSION",
                 "sets the head's tension")
HIMC_COMMAND_ROW(DENSITY, density, DRUM, NOW, HIMC_CHANGES_HEAD, "DENSITY",
                 "sets the head's mass per area")
HIMC_COMMAND_ROW(TUNE, tune, DRUM, NOW, HIMC_CHANGES_HEAD | HIMC_AT_BEAT, "HZ | NOTE",
                 "sets the tension so that the principal mode sounds there")
HIMC_COMMAND_ROW(GLISS, gliss, DRUM, NOW, HIMC_CHANGES_HEAD | HIMC_AT_BEAT,
                 "HZ SECONDS | NOTE SECONDS",
                 "moves the pedal evenly to that pitch in that time while the head sounds")
HIMC_COMMAND_ROW(
    MODES, modes, DRUM, NOW, HIMC_CHANGES_HEAD, "COUNT | auto",
    "sets the number of modes; auto: exact ones where they overlap little, statistical ones above")
HIMC_COMMAND_ROW(DECAY, decay, DRUM, NOW, HIMC_CHANGES_HEAD | HIMC_AT_BEAT, "T60 | SIGMA0 SIGMA1",
                 "sets the losses by the decay time, or by both of their parameters")
HIMC_COMMAND_ROW(AIR, air, DRUM, NOW, HIMC_CHANGES_HEAD, "SWITCH",
                 "1: air and kettle load the head")
HIMC_COMMAND_ROW(KETTLE, kettle, DRUM, NOW, HIMC_CHANGES_HEAD, "usual | VOLUME",
                 "sets the volume under the head, or the usual one for its radius")
HIMC_COMMAND_ROW(
    GLIDE, glide, DRUM, NOW, HIMC_CHANGES_HEAD | HIMC_AT_BEAT, "AMOUNT",
    "sets how much the tension rises as the head bows out, or how much energy a cymbal's high "
    "modes get")
HIMC_COMMAND_ROW(DAMP, damp, DRUM, NOW, HIMC_CHANGES_HEAD | HIMC_AT_BEAT, "AMOUNT",
                 "lays a hand on the head")
HIMC_COMMAND_ROW(PEDAL, pedal, DRUM, NOW, HIMC_CHANGES_HEAD | HIMC_AT_BEAT, "AMOUNT",
                 "closes a hi-hat, or lets the bars of a vibraphone ring")
HIMC_COMMAND_ROW(MOTOR, motor, DRUM, NOW, HIMC_CHANGES_HEAD | HIMC_AT_BEAT, "HZ",
                 "turns the discs in a vibraphone's tubes, so that it swings so often a second")
HIMC_COMMAND_ROW(MUFFLE, muffle, DRUM, NOW, HIMC_CHANGES_HEAD | HIMC_AT_BEAT, "AMOUNT",
                 "lays a cloth on the head, 1: coperto, a dry thud with a pitch")
HIMC_COMMAND_ROW(SKIN, skin, DRUM, NOW, HIMC_CHANGES_HEAD, "plastic|calf",
                 "sets density and losses of a head of that skin, tuned as it was")
HIMC_COMMAND_ROW(WIRES, wires, DRUM, NOW, HIMC_CHANGES_HEAD | HIMC_AT_BEAT, "SWITCH | PULL",
                 "puts snare wires to the lower head, drawn to it by PULL, or takes them off")
HIMC_COMMAND_ROW(
    UNIFORMITY, uniformity, DRUM, NOW, HIMC_CHANGES_HEAD, "AMOUNT [SEED]",
    "sets how evenly a round head is tensioned, 1: perfectly; below, pairs of modes beat, each "
    "seed in its own way")
HIMC_COMMAND_ROW(
    SHAPE, shape, DRUM, NOW, HIMC_CHANGES_HEAD, HIMC_KINDS(HIMC_ROW_KIND) "FILE",
    "gives the drum another outline, a shell, bars of one pitch or between two, a cymbal's plate, "
    "a list of modes, or masses on springs (at most 800) from a file")
HIMC_COMMAND_ROW(
    MALLET, mallet, DRUM, NOW, 0,
    "soft|medium|hard|wood|usual | K ALPHA MASS | "
    "HAND soft|medium|hard|wood|usual | "
    "HAND K ALPHA MASS",
    "chooses the mallet, or its stiffness, exponent and mass, of one hand or of both; usual: the "
    "instrument's")
HIMC_COMMAND_ROW(
    NOISE, noise, DRUM, NOW, 0, "AMOUNT [SEED]",
    "sets how loud felt, shaft, shell and stand answer a blow; each seed is another drum")
HIMC_COMMAND_ROW(PLACE, place, DRUM, NOW, 0, "X Y Z [TILT]",
                 "sets where the head stands and how it is tilted")
HIMC_COMMAND_ROW(PICKUP, pickup, DRUM, NOW, HIMC_CHANGES_HEAD,
                 "air AZIMUTH ELEVATION DISTANCE | X Y",
                 "sets where the sound is taken: in the air or on the head")
HIMC_COMMAND_ROW(PICKUPS, pickups, DRUM, NOW, HIMC_CHANGES_HEAD, "CHANNELS",
                 "sets the number of pickups")
HIMC_COMMAND_ROW(CHANNEL, channel, DRUM, NOW, HIMC_CHANGES_HEAD,
                 "CHANNEL air AZIMUTH ELEVATION DISTANCE | CHANNEL X Y",
                 "sets where the sound of one pickup is taken")
HIMC_COMMAND_ROW(
    DRUM_LISTENER, listener, DRUM, NOW, 0, "off | usual",
    "off: the drum is heard by its pickups; usual: by two ears, in place of the first two pickups")
HIMC_COMMAND_ROW(DRUM_GAIN, gain, DRUM, NOW, 0, "DB",
                 "sets how loud the drum is heard, 0 by default")
HIMC_COMMAND_ROW(DRUM_MUTE, mute, DRUM, NOW, 0, "SWITCH", "1: silences the drum")
HIMC_COMMAND_ROW(TECHNIQUE, technique, DRUM, NOW, 0, "modal|signal|clip",
                 "the sound is made by the head, or by the patch around it in Pure Data")
HIMC_COMMAND_ROW(DRUM_INFO, info, DRUM, HOST, 0, "", "describes the drum in a few lines")
HIMC_COMMAND_ROW(DRUM_DUMP, dump, DRUM, NOW, HIMC_NOT_IN_SCORE | HIMC_WRITES_FILE, "[FILE]",
                 "answers with the state as commands, or writes it to a file")
HIMC_COMMAND_ROW(DRUM_PRESET, preset, DRUM, NOW, HIMC_NOT_IN_SCORE, "FILE",
                 "loads FILE.txt, written by `dump`: all of it, or nothing")
HIMC_COMMAND_ROW(STRIKE, strike, DRUM, AT_SAMPLE, 0, "X Y VELOCITY", "strikes without a performer")

#undef HIMC_ROW_STROKE
#undef HIMC_ROW_ROLL
#undef HIMC_ROW_STREAM
#undef HIMC_COMMAND_ROW
#undef HIMC_SETTING_ROW
