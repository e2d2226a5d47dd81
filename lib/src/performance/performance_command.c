/// performance_command.c: the performer's commands, those of command_rows.h.
///
/// They act between physics steps. A command of kind AT_SAMPLE with a delay waits in a queue until
/// the step at its sample; the others may allocate or read files, and act at once. A command that
/// cannot be carried out changes nothing and gives the reason in one line.
#include "base/argument.h"
#include "base/format.h"
#include "performance/performance_state.h"

#define LONGEST_DELAY 8192 // chosen: the largest block of Pure Data and more (samples)

// a setting, and what follows from its change
static bool set(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings, old = p->settings;
    setting_effect effect = himc_settings_effect(c->id);
    himc_planner *planner = p->motion->planner;
    enum { DRUMS = 3 }; // form of `gain`
    if (!himc_performance_allows(p->recording.file, c, error) ||
        !himc_settings_read(&s, &p->host.usual, c, error))
        return false;
    if (effect == AFTER_BODY) {
        if (!p->motion->track || p->written.take_command.count == 0)
            return himc_performance_rebuild(p, &s, error);
        p->settings = s; // a take is loaded again for a body of other size: its lengths stay
        if (himc_job_carry_out(himc_performance_take_again_job(p, error), error))
            return true;
        p->settings = old;
        return false;
    }
    himc_performance_adopt(p, &s);
    bool replans = effect == AFTER_REPLAN || effect == AFTER_GRIP || effect == AFTER_HUMAN;
    switch (effect) {
    case AFTER_MODE:
        if (old.control.mode == HIMC_PIPELINE_IK && s.control.mode != HIMC_PIPELINE_IK)
            himc_body_take_up(p->body);
        replans = p->motion->has_regression;
        break;
    case AFTER_LIMITS:
        himc_performance_renew_limits(p);
        himc_body_clear_limit_counts(p->body); // the counts belong to other limits
        break;
    case AFTER_FADER:
        if (c->form == DRUMS)
            himc_drums_fade(&p->drums, pow(10, c->atom[0].number / 20), p->drums.mute);
        break;
    case AFTER_STEPS: himc_performance_restart_steps(p); break;
    case AFTER_GRIP:
        himc_planner_set_grip(planner, s.grip);
        himc_planner_set_servo(planner, s.servo);
        break;
    case AFTER_HUMAN: himc_planner_set_human(planner, s.human); break;
    default: break;
    }
    if (replans)
        himc_motion_replan(p->motion);
    return true;
}

// the commands

static himc_listener listener_of(const himc_command *c)
{
    enum { OFF, USUAL };
    if (c->form == OFF)
        return (himc_listener){.on = false};
    if (c->form == USUAL)
        return himc_listener_usual();
    himc_listener listener =
        himc_listener_at(himc_vec3_make(c->atom[0].number, c->atom[1].number, c->atom[2].number));
    if (c->count > 3)
        listener.yaw = himc_argument_usual(c->atom[3].number, listener.yaw);
    return listener;
}

static bool takes_long(const himc_performance *p, const himc_command *c)
{
    int file;
    switch (c->id) {
    case HIMC_COMMAND_AT:
    case HIMC_COMMAND_SCORE:
    case HIMC_COMMAND_PRESET:
    case HIMC_COMMAND_SETUP:
    case HIMC_COMMAND_TAKE:
    case HIMC_COMMAND_RECORD: return true;
    case HIMC_COMMAND_UNITS:
    case HIMC_COMMAND_DUMP: return himc_command_file(c, &file) != HIMC_FILE_NONE;
    case HIMC_COMMAND_LISTENER: return himc_drums_listening_takes_long(&p->drums);
    case HIMC_COMMAND_INSTRUMENT:
    case HIMC_COMMAND_MAKE_DRUM: return himc_drums_find(&p->drums, c->atom[0].symbol) < 0;
    default: return false;
    }
}

/// The job of a command that reads or writes a file, makes a drum or computes heads: it takes long.
/// A loader (himc/loader.h) carries it out; the performance must outlive it.
static himc_job *job_of(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_listener listener;
    switch (c->id) {
    case HIMC_COMMAND_AT: return himc_performance_change_job(p, c, error);
    case HIMC_COMMAND_SCORE:
    case HIMC_COMMAND_PRESET:
    case HIMC_COMMAND_SETUP:
        return himc_performance_score_job(p, NULL, NULL, c, error); // as the parser has it
    case HIMC_COMMAND_TAKE: return himc_performance_take_job(p, c, error);
    case HIMC_COMMAND_RECORD: return himc_performance_record_job(p, c, error);
    case HIMC_COMMAND_UNITS: return himc_performance_units_job(p, c, error);
    case HIMC_COMMAND_DUMP: return himc_performance_dump_job(p, c, error);
    case HIMC_COMMAND_INSTRUMENT:
    case HIMC_COMMAND_MAKE_DRUM: return himc_performance_drum_job(p, c, error);
    case HIMC_COMMAND_LISTENER:
        listener = listener_of(c);
        return himc_drums_listen_job(&p->drums, &listener, error);
    default: return NULL; // takes no time
    }
}

static bool carry_out(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_job_carry_out(job_of(p, c, error), error);
}

// a command for the score and the transport
static bool act_on_score(himc_performance *p, const himc_command *c, himc_error *error)
{
    const himc_atom *atom = c->atom;
    himc_planner *planner = p->motion->planner;
    switch (c->id) {
    case HIMC_COMMAND_STROKE:
    case HIMC_COMMAND_ROLL:
    case HIMC_COMMAND_FLAM:
    case HIMC_COMMAND_DRAG:
    case HIMC_COMMAND_RUFF: return himc_performance_add_stroke(p, &c->stroke, error);
    case HIMC_COMMAND_CLOCK: return himc_performance_clock(p, c, error);
    case HIMC_COMMAND_CRESC:
        if (p->written.dynamics.from >= 1 + atom[0].number)
            himc_events_note(&p->events,
                             "cresc: strokes up to beat %g have their dynamics, expected cresc "
                             "before them",
                             p->written.dynamics.from - 1);
        return himc_dynamics_add(&p->written.dynamics, c, error);
    case HIMC_COMMAND_HIT: return himc_performance_hit(p, &c->stroke, error);
    case HIMC_COMMAND_PLAY: return himc_performance_play(p, error);
    case HIMC_COMMAND_STOP: himc_performance_stop(p); return true;
    case HIMC_COMMAND_TARGET:
        himc_performance_target(p, (himc_hand)c->choice[0],
                                himc_vec3_make(atom[1].number, atom[2].number, atom[3].number));
        return true;
    case HIMC_COMMAND_NUDGE: return himc_performance_nudge(p->motion->track, c, error);
    case HIMC_COMMAND_TEMPO: return himc_performance_tempo(p, c, error);
    case HIMC_COMMAND_LOOP:
        if (c->count == 1) {
            himc_planner_loop(planner, step_time(p), atom[0].number != 0);
            break;
        }
        himc_planner_loop_beats(planner, step_time(p), atom[0].number, atom[1].number);
        if (p->motion->playing)
            himc_performance_tell_loop(p);
        break;
    case HIMC_COMMAND_SEEK: himc_planner_seek(planner, step_time(p), atom[0].number); break;
    case HIMC_COMMAND_CLEAR:
        himc_planner_clear(planner);
        if (p->motion->playing && himc_motion_plays_score(p->motion) &&
            !himc_planner_is_looped(planner)) {
            p->motion->playing = false;
            himc_events_add(&p->events, &(himc_event){.kind = HIMC_EVENT_DONE});
        }
        himc_feet_clear(&p->motion->feet);
        himc_text_clear(&p->written.score);
        himc_dynamics_clear(&p->written.dynamics);
        himc_drums_drop_heads(&p->drums);
        himc_body_plan_pushes(p->body, NULL, 0, PUSHES_ANEW, NULL);
        break;
    case HIMC_COMMAND_UNITS: // clear
        himc_planner_clear_units(planner);
        himc_text_clear(&p->written.units);
        break;
    default: return set(p, c, error);
    }
    himc_motion_replan(p->motion);
    return true;
}

/// Carries out any command now.
static bool act(himc_performance *p, const himc_command *c, himc_error *error)
{
    const himc_walls usual = HIMC_WALLS_USUAL;
    himc_walls walls = p->drums.walls;
    himc_listener listener;
    planned_push push;
    switch (c->id) {
    case HIMC_COMMAND_LISTENER:
        listener = listener_of(c);
        return himc_drums_listen(&p->drums, &listener, error);
    case HIMC_COMMAND_INSTRUMENT:
    case HIMC_COMMAND_MAKE_DRUM:
        return himc_performance_find_drum(p, c->atom[0].symbol) || carry_out(p, c, error);
    case HIMC_COMMAND_INFO: // the host answers, with himc_performance_describe; also without a file
    case HIMC_COMMAND_DUMP: return c->count == 0 || carry_out(p, c, error);
    case HIMC_COMMAND_GET:
    case HIMC_COMMAND_SUBSCRIBE:
    case HIMC_COMMAND_UNSUBSCRIBE:
    case HIMC_COMMAND_LISTEN:
        return himc_error_set(error, "%s: only as a message to [himc~] or over OSC",
                              himc_command_table((int)c->id)->name);
    case HIMC_COMMAND_RESET: return himc_performance_reset(p, error);
    case HIMC_COMMAND_MUTE:
        himc_drums_fade(&p->drums, p->drums.gain, c->atom[0].number == 1);
        return true;
    case HIMC_COMMAND_ROOM:
        walls.seconds = himc_argument_usual(c->atom[0].number, usual.seconds);
        if (c->count > 1)
            walls.volume = himc_argument_usual(c->atom[1].number, usual.volume);
        himc_drums_enclose(&p->drums, &walls);
        return true;
    case HIMC_COMMAND_PUSH:
        if (!himc_body_read_push(c, p->settings.stance, &push, error))
            return false;
        himc_body_push(p->body, &push, step_time(p));
        return true;
    default: return takes_long(p, c) ? carry_out(p, c, error) : act_on_score(p, c, error);
    }
}

// the drum that a command is for, or NULL with the reason
static himc_drum *drum_of(himc_performance *p, const himc_command *c, himc_error *error)
{
    int index = himc_drums_find(&p->drums, c->drum);
    if (index >= 0)
        return p->drums.slot[index].drum;
    himc_drums_refuse(&p->drums, c->drum, HIMC_SPOT_XY, error);
    return NULL;
}

static himc_job *state_job(himc_performance *p, const char *state, himc_error *error)
{
    return himc_performance_score_job(p, state, "state", NULL, error);
}

const himc_runner himc_performance_runner = {takes_long, himc_performance_command, job_of,
                                             state_job, drum_of};

// True if a command stands for another one: a note for a hit, if anything, or a gliss in beats for
// the drum's in seconds; `good` tells if it could.
static bool becomes(himc_performance *p, const himc_command *c, int delay, himc_command *other,
                    bool *good, himc_error *error)
{
    himc_atom atoms[] = {c->atom[1], {HIMC_ATOM_NUMBER, 0, NULL}};
    if (c->id == HIMC_COMMAND_NOTE) {
        other->id = HIMC_COMMAND_HIT;
        *good = himc_performance_note(p, c, delay, &other->stroke, error);
    } else if (c->id == HIMC_COMMAND_DRUM_GLISS) {
        atoms[1].number = c->atom[2].number * 60 / himc_performance_measure(p).bpm;
        *good = himc_command_parse(other, HIMC_DRUM, "gliss", atoms, 2, error);
        himc_format(other->drum, sizeof other->drum, "%s", c->atom[0].symbol);
    }
    return c->id == HIMC_COMMAND_NOTE || c->id == HIMC_COMMAND_DRUM_GLISS;
}

bool himc_performance_command(himc_performance *p, const himc_command *command, int delay,
                              himc_error *error)
{
    himc_command other = {.count = 0};
    bool can = false;
    const himc_command_row *row = himc_command_table((int)command->id);
    if (!row)
        return himc_error_set(error, "command %d: not from the parser", (int)command->id);
    if (command->drum[0]) { // DRUM COMMAND ...
        himc_drum *drum = drum_of(p, command, error);
        const himc_atom *atom = command->atom;
        if (!drum)
            return false;
        himc_motion_stir(p->motion);
        int ahead = himc_clock_ahead(&p->clock);
        bool good = command->id == HIMC_COMMAND_STRIKE
                        ? himc_drum_strike_at(drum, delay > ahead ? delay - ahead : 0,
                                              atom[0].number, atom[1].number, atom[2].number, error)
                        : himc_drum_command(drum, command, error);
        return good || himc_error_prefix(error, "%s", command->drum);
    }
    if (becomes(p, command, delay, &other, &can, error))
        return can && ((!other.drum[0] && !other.stroke.drum[0]) ||
                       himc_performance_command(p, &other, delay, error));
    if (row->receiver != HIMC_PERFORMER)
        return himc_error_set(error, "a drum's command, not the performer's");
    bool on_beat = command->id == HIMC_COMMAND_TEMPO && command->count > 1; // and it allocates
    if (delay <= 0 || row->when != HIMC_WHEN_AT_SAMPLE || on_beat)
        return act(p, command, error);
    if (delay > LONGEST_DELAY)
        return himc_error_set(error, "delay: %d samples, expected 0 .. %d", delay, LONGEST_DELAY);
    if (!himc_queue_has_room(&p->queue))
        return himc_queue_drop(&p->queue, error);
    // drums for waiting commands are made now, not in the audio callback
    int index;
    bool hits = command->id == HIMC_COMMAND_HIT;
    bool starts = command->id == HIMC_COMMAND_CLOCK && command->form != 0;
    if ((hits || starts || command->id == HIMC_COMMAND_PLAY) &&
        !himc_performance_ensure_drum(p, hits ? command->stroke.drum : "",
                                      hits ? command->stroke.spot : HIMC_SPOT_NORMAL, &index,
                                      error))
        return false;
    himc_queue_add(&p->queue, command, p->clock.played + delay);
    return true;
}

bool himc_performance_send(himc_performance *p, const char *text, himc_error *error)
{
    himc_command command;
    return himc_command_parse_text(&command, HIMC_PERFORMER, text, error) &&
           himc_performance_command(p, &command, 0, error);
}

static bool run_waiting(himc_performance *p, const himc_command *command, himc_error *error)
{
    himc_drums_catch_up(&p->drums);
    himc_motion_stir(p->motion);
    return act(p, command, error);
}

void himc_performance_run_due_commands(himc_performance *p)
{
    himc_queue_run(&p->queue, p->clock.made, run_waiting, p, &p->events);
}
