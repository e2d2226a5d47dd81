/// performance_command.c: what each command of the vocabulary does to a performance.
///
/// One table, one small function a command. They act between physics steps: one that comes with a
/// delay waits in a short queue until the step at its sample. A command that cannot be carried
/// out changes nothing and says why in one line.
#include "performance_state.h"

#include <stdio.h>
#include <string.h>

#define APPROACH 1.0       // from wherever the sticks are to the beginning of a take (s)
#define LONGEST_DELAY 8192 // samples

typedef bool (*action)(himc_performance *p, const himc_command *command, himc_error *error);

static int find_drum(const himc_performance *p, const char *name)
{
    for (int i = 0; i < p->drums; i++)
        if (strcmp(himc_drum_name(p->drum[i].drum), name) == 0)
            return i;
    return -1;
}

static bool put_drum(himc_performance *p, himc_drum *drum, bool silent, int *index,
                     himc_error *error)
{
    int i = find_drum(p, himc_drum_name(drum));
    if (i < 0 && p->drums == HIMC_DRUMS)
        return himc_error_set(error, "drum %s: a performer plays on %d drums at most",
                              himc_drum_name(drum), HIMC_DRUMS);
    if (i < 0)
        i = p->drums++;
    else
        himc_drum_release(p->drum[i].drum);
    p->drum[i] = (slot){.drum = drum, .silent = silent, .revision = himc_drum_revision(drum) - 1};
    performance_notice_drums(p);
    *index = i;
    return true;
}

static bool make_drum(himc_performance *p, const char *name, double inches, bool silent, int *index,
                      himc_error *error)
{
    himc_drum *drum = himc_drum_new(name, inches, p->config.sample_rate, error);
    if (!drum)
        return false;
    if (put_drum(p, drum, silent, index, error))
        return true;
    himc_drum_release(drum);
    return false;
}

bool performance_ensure_drum(himc_performance *p, const char *name, int *index, himc_error *error)
{
    *index = name[0] ? find_drum(p, name) : 0;
    if (*index >= 0 && *index < p->drums)
        return true;
    if (!make_drum(p, name[0] ? name : "drum", 23, true, index, error))
        return false;
    performance_note(p, "no drum %s: playing on a silent one",
                     himc_drum_name(p->drum[*index].drum));
    return true;
}

bool himc_performance_add_drum(himc_performance *p, himc_drum *drum, himc_error *error)
{
    int index;
    if (put_drum(p, himc_drum_retain(drum), false, &index, error))
        return true;
    himc_drum_release(drum);
    return false;
}

// strokes name their drum by its slot, so a drum that leaves is replaced by a silent one of its
// name
void himc_performance_remove_drum(himc_performance *p, const char *name)
{
    int i = find_drum(p, name), index;
    char kept[HIMC_NAME_SIZE];
    if (i < 0)
        return;
    snprintf(kept, sizeof kept, "%s", name);
    if (!make_drum(p, kept, 23, true, &index, NULL))
        performance_note(p, "drum %s: out of memory for a silent one", kept);
}

himc_drum *himc_performance_drum(himc_performance *p, int index)
{
    return index >= 0 && index < p->drums ? p->drum[index].drum : NULL;
}

static bool add_stroke(himc_performance *p, const himc_stroke *stroke, himc_error *error)
{
    int drum;
    return performance_ensure_drum(p, stroke->drum, &drum, error) &&
           himc_planner_add(p->planner, stroke, drum, error);
}

static bool do_stroke(himc_performance *p, const himc_command *c, himc_error *error)
{
    p->replan = true;
    return add_stroke(p, &c->stroke, error);
}

static bool do_hit(himc_performance *p, const himc_command *c, himc_error *error)
{
    int drum;
    if (!performance_ensure_drum(p, c->stroke.drum, &drum, error))
        return false;
    himc_planner_hit(p->planner, step_time(p), &c->stroke, drum);
    p->replan = true;
    return true;
}

static bool do_tempo(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    if (c->count > 1)
        return himc_error_set(error,
                              "tempo: BEAT: only in a score file; here a tempo holds from now on");
    himc_planner_tempo(p->planner, step_time(p), c->atom[0].number);
    p->replan = true;
    return true;
}

static void drop_track(himc_performance *p)
{
    himc_track_free(p->track);
    p->track = NULL;
    p->track_start = INFINITY;
}

static bool do_clear(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c, (void)error;
    himc_planner_clear(p->planner);
    p->replan = true;
    return true;
}

static void start_track(himc_performance *p, double t)
{
    double start = t + APPROACH;
    himc_track_rewind(p->track);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (himc_track_present(p->track, (himc_hand)hand)) {
            himc_target now = p->reference.tip[hand];
            himc_track_approach(p->track, (himc_hand)hand, &now, APPROACH);
        }
    p->track_start = start;
}

static bool do_play(himc_performance *p, const himc_command *c, himc_error *error)
{
    int index;
    (void)c;
    if (!performance_ensure_drum(p, "", &index, error))
        return false;
    p->piece_start = step_time(p);
    if (p->track)
        start_track(p, p->piece_start);
    else
        himc_planner_play(p->planner, p->piece_start);
    p->playing = true;
    p->replan = true;
    return true;
}

static bool do_stop(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c, (void)error;
    if (p->track)
        himc_track_stop(p->track, step_time(p) - p->track_start, p->reference.tip);
    himc_planner_stop(p->planner, step_time(p));
    p->playing = false;
    p->replan = true;
    return true;
}

static bool do_seek(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    himc_planner_seek(p->planner, step_time(p), c->atom[0].number);
    p->replan = true;
    return true;
}

// a line of a score that is not a stroke: for the performer or one of its drums
static bool run_line(himc_performance *p, const himc_score_line *line, himc_error *error)
{
    int index;
    if (!line->drum[0])
        return himc_performance_command(p, &line->command, 0, error);
    return performance_ensure_drum(p, line->drum, &index, error) &&
           himc_drum_command(p->drum[index].drum, &line->command, error);
}

static bool fill_from_score(himc_performance *p, const himc_score *score, const char *path,
                            himc_error *error)
{
    for (int i = 0; i < score->line_count; i++)
        if (!run_line(p, &score->lines[i], error))
            return himc_error_prefix(error, "%s:%d", path, score->lines[i].line);
    performance_notice_drums(p);
    himc_planner_clear(p->planner);
    if (!himc_planner_set_tempi(p->planner, score->tempi, score->tempo_count, error))
        return himc_error_prefix(error, "%s", path);
    for (int i = 0; i < score->stroke_count; i++)
        if (!add_stroke(p, &score->strokes[i], error))
            return himc_error_prefix(error, "%s", path);
    return true;
}

static bool do_score(himc_performance *p, const himc_command *c, himc_error *error)
{
    const char *path = c->atom[0].symbol;
    himc_score *score = himc_score_load(path, error);
    if (!score)
        return false;
    bool ok = fill_from_score(p, score, path, error);
    himc_score_free(score);
    if (ok)
        drop_track(p);
    p->replan = true;
    return ok;
}

// says how much of a take the player cannot follow; the arm then stretches towards it
static void note_reach(himc_performance *p, const himc_track *track, const char *path)
{
    double length = himc_track_length(track), farthest = 0;
    int far = 0, count = 0;
    for (double t = 0; t < length; t += 0.01)
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            if (!himc_track_present(track, (himc_hand)hand))
                continue;
            himc_vec3 x = himc_track_target(track, (himc_hand)hand, t).x;
            himc_vec3 near = himc_posture_reachable(&p->posture, (himc_hand)hand, x);
            double missing = himc_vec3_length(himc_vec3_sub(x, near));
            count++;
            far += missing > 1e-3;
            farthest = fmax(farthest, missing);
        }
    if (far > 0)
        performance_note(p, "%s: tips out of reach in %.0f %% of the take, by up to %.2f m", path,
                         100.0 * far / count, farthest);
}

static bool do_take(himc_performance *p, const himc_command *c, himc_error *error)
{
    int drum;
    const char *path = c->atom[0].symbol;
    himc_take *take = himc_take_load(path, &p->take_options, error);
    if (!take)
        return false;
    himc_track *track = NULL;
    if (performance_ensure_drum(p, "", &drum, error)) {
        const himc_place *place = himc_drum_place(p->drum[drum].drum);
        track = himc_track_new(take, &p->take_options, place, p->skeleton.mallet_radius, error);
        if (!track && error && strncmp(error->text, path, strlen(path)) != 0)
            himc_error_prefix(error, "%s", path);
    }
    himc_skeleton_config old = p->body;
    int measured = track ? himc_body_measure(take, &p->body) : 0;
    himc_take_free(take);
    if (!track)
        return false;
    if (measured > 0 && !performance_build_body(p, error)) {
        p->body = old;
        himc_track_free(track);
        return himc_error_prefix(error, "%s", path);
    }
    if (measured > 0)
        performance_note(p, "%s: the player's body has %d lengths from it", path, measured);
    note_reach(p, track, path);
    drop_track(p);
    p->track = track;
    p->replan = true;
    return true;
}

static bool do_target(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_hand hand = strcmp(c->atom[0].symbol, "left") == 0 ? HIMC_LEFT : HIMC_RIGHT;
    himc_vec3 asked = {c->atom[1].number, c->atom[2].number, c->atom[3].number};
    himc_vec3 x = himc_posture_reachable(&p->posture, hand, asked);
    (void)error;
    if (himc_vec3_length(himc_vec3_sub(x, asked)) > 1e-3)
        performance_note(p, "target %s %g %g %g: out of reach, going to %.3f %.3f %.3f",
                         himc_hand_name(hand), asked.x, asked.y, asked.z, x.x, x.y, x.z);
    himc_planner_reach(p->planner, step_time(p), hand, x);
    p->replan = true;
    return true;
}

// which of the words, which the parser has checked
static int word_index(const char *word, const char *const *words, int count)
{
    for (int i = 0; i < count; i++)
        if (strcmp(word, words[i]) == 0)
            return i;
    return 0;
}

static bool do_mode(himc_performance *p, const himc_command *c, himc_error *error)
{
    static const char *const words[] = {"himc", "id", "ik"};
    himc_pipeline mode = (himc_pipeline)word_index(c->atom[0].symbol, words, 3);
    (void)error;
    // leaving `ik` the body takes up where the picture was
    if (p->controller.mode == HIMC_PIPELINE_IK && mode != HIMC_PIPELINE_IK)
        himc_character_place(p->character, &p->state);
    p->controller.mode = mode;
    return true;
}

static bool do_solver(himc_performance *p, const himc_command *c, himc_error *error)
{
    static const char *const words[] = {"dls", "pinv", "transpose"};
    (void)error;
    p->controller.solver = (himc_solver)word_index(c->atom[0].symbol, words, 3);
    return true;
}

static bool do_damping(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->controller.damping = c->atom[0].number;
    return true;
}

static bool do_law(himc_performance *p, const himc_command *c, himc_error *error)
{
    static const char *const words[] = {"printed", "feedforward", "computed-torque"};
    (void)error;
    p->controller.law = (himc_law)word_index(c->atom[0].symbol, words, 3);
    return true;
}

static bool reset_gains(himc_performance *p)
{
    himc_controller fresh;
    himc_body_state state;
    himc_pose pose;
    himc_vec3 level[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        level[hand] = p->from.tip[hand].x;
    himc_posture_at(&p->posture, level, &pose);
    himc_pose_to_state(&p->skeleton, &pose, NULL, &state);
    himc_controller_init(&fresh, &p->skeleton, &state);
    memcpy(p->controller.gain, fresh.gain, sizeof fresh.gain);
    memcpy(p->controller.gain_set, fresh.gain_set, sizeof fresh.gain_set);
    return true;
}

static bool do_gain(himc_performance *p, const himc_command *c, himc_error *error)
{
    if (c->count == 1)
        return reset_gains(p);
    int joint = himc_joint_find(c->atom[0].symbol);
    if (joint < 0) {
        himc_error_set(error, "gain: JOINT: %s, allowed", c->atom[0].symbol);
        size_t used = error ? strlen(error->text) : 0;
        for (int j = 0; error && j < HIMC_JOINTS; j++)
            used += (size_t)snprintf(error->text + used, sizeof error->text - used, " %s",
                                     himc_joint_name(j));
        return false;
    }
    himc_controller_set_gain(&p->controller, joint, c->atom[1].number, c->atom[2].number);
    return true;
}

static bool do_rate(himc_performance *p, const himc_command *c, himc_error *error)
{
    bool physics = strcmp(c->atom[0].symbol, "physics") == 0;
    double hz = c->atom[1].number;
    if (physics) {
        if (!himc_check_range("rate physics", hz, 500, 48000, "Hz", error))
            return false;
        p->config.physics_rate = hz;
    } else {
        if (!himc_check_range("rate task", hz, 50, 2000, "Hz", error))
            return false;
        p->config.task_rate = hz;
    }
    performance_reset_clock(p);
    return true;
}

static bool do_coupling(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->one_way = strcmp(c->atom[0].symbol, "one-way") == 0;
    return true;
}

static bool do_player(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_skeleton_config old = p->body;
    p->body.height = c->atom[0].number;
    p->body.mass = c->atom[1].number;
    if (performance_build_body(p, error))
        return true;
    p->body = old;
    return false;
}

static bool do_reset(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_skeleton_config old = p->body;
    (void)c;
    p->body = himc_skeleton_default();
    if (!performance_build_body(p, error)) {
        p->body = old;
        return false;
    }
    drop_track(p);
    himc_planner_stop(p->planner, step_time(p));
    himc_planner_clear(p->planner);
    p->controller.mode = HIMC_PIPELINE_HIMC;
    p->controller.law = HIMC_LAW_COMPUTED_TORQUE;
    p->controller.solver = HIMC_SOLVER_DLS;
    p->config.physics_rate = himc_performance_default().physics_rate;
    p->config.task_rate = himc_performance_default().task_rate;
    p->one_way = p->playing = false;
    p->square_sum = p->height_sum = p->peak_force = 0;
    p->square_count = p->height_count = p->recoveries = 0;
    p->strokes = p->played = 0;
    performance_reset_clock(p);
    return true;
}

static bool do_drum(himc_performance *p, const himc_command *c, himc_error *error)
{
    int index;
    if (!p->make_drums || find_drum(p, c->atom[0].symbol) >= 0)
        return true; // in Pd each [membrane~ NAME] is one
    return make_drum(p, c->atom[0].symbol, c->count > 1 ? c->atom[1].number : 23, false, &index,
                     error);
}

static bool do_info(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)p, (void)c, (void)error; // answered by whoever asked, with himc_performance_describe
    return true;
}

static const action actions[HIMC_COMMANDS] = {
    [HIMC_COMMAND_STROKE] = do_stroke,     [HIMC_COMMAND_HIT] = do_hit,
    [HIMC_COMMAND_TEMPO] = do_tempo,       [HIMC_COMMAND_CLEAR] = do_clear,
    [HIMC_COMMAND_PLAY] = do_play,         [HIMC_COMMAND_STOP] = do_stop,
    [HIMC_COMMAND_SEEK] = do_seek,         [HIMC_COMMAND_SCORE] = do_score,
    [HIMC_COMMAND_TAKE] = do_take,         [HIMC_COMMAND_TARGET] = do_target,
    [HIMC_COMMAND_MODE] = do_mode,         [HIMC_COMMAND_SOLVER] = do_solver,
    [HIMC_COMMAND_DAMPING] = do_damping,   [HIMC_COMMAND_LAW] = do_law,
    [HIMC_COMMAND_GAIN] = do_gain,         [HIMC_COMMAND_RATE] = do_rate,
    [HIMC_COMMAND_COUPLING] = do_coupling, [HIMC_COMMAND_PLAYER] = do_player,
    [HIMC_COMMAND_INFO] = do_info,         [HIMC_COMMAND_RESET] = do_reset,
    [HIMC_COMMAND_MAKE_DRUM] = do_drum,
};

// commands that act at their sample; the others, which may allocate or read files, act at once
static bool waits(himc_command_id id)
{
    return id == HIMC_COMMAND_HIT || id == HIMC_COMMAND_TARGET || id == HIMC_COMMAND_TEMPO ||
           id == HIMC_COMMAND_PLAY || id == HIMC_COMMAND_STOP || id == HIMC_COMMAND_SEEK ||
           id == HIMC_COMMAND_MODE || id == HIMC_COMMAND_LAW || id == HIMC_COMMAND_SOLVER ||
           id == HIMC_COMMAND_DAMPING || id == HIMC_COMMAND_COUPLING;
}

// drums that a waiting command will want are made now, not in the audio callback
static bool prepare(himc_performance *p, const himc_command *command, himc_error *error)
{
    int index;
    if (command->id == HIMC_COMMAND_HIT)
        return performance_ensure_drum(p, command->stroke.drum, &index, error);
    return command->id != HIMC_COMMAND_PLAY || performance_ensure_drum(p, "", &index, error);
}

bool himc_performance_command(himc_performance *p, const himc_command *command, int delay,
                              himc_error *error)
{
    action act = actions[command->id];
    if (!act)
        return himc_error_set(error, "a drum's command, not the performer's");
    if (delay <= 0 || !waits(command->id))
        return act(p, command, error);
    if (delay > LONGEST_DELAY)
        return himc_error_set(error, "delay: %d samples, allowed 0 .. %d", delay, LONGEST_DELAY);
    if (p->waiting_count == WAITING_COMMANDS)
        return himc_error_set(error, "more than %d commands at once: this one is dropped",
                              WAITING_COMMANDS);
    if (!prepare(p, command, error))
        return false;
    waiting_command *w = &p->waiting[p->waiting_count++];
    w->due = p->sample + (uint64_t)delay;
    himc_command_copy(&w->command, command);
    return true;
}

void performance_run_due_commands(himc_performance *p)
{
    int kept = 0;
    for (int i = 0; i < p->waiting_count; i++) {
        himc_error error;
        if (p->waiting[i].due > p->made) {
            if (kept != i) {
                p->waiting[kept].due = p->waiting[i].due;
                himc_command_copy(&p->waiting[kept].command, &p->waiting[i].command);
            }
            kept++;
        } else if (!actions[p->waiting[i].command.id](p, &p->waiting[i].command, &error)) {
            performance_note(p, "%s", error.text);
        }
    }
    p->waiting_count = kept;
}

void himc_performance_make_drums(himc_performance *p, bool make_drums)
{
    p->make_drums = make_drums;
}

void himc_performance_take_options(himc_performance *p, const himc_take_options *options)
{
    p->take_options = *options;
}
