/// loader.c: one helper thread, one job at a time, and a queue of commands in their order.
///
/// The job goes from hand to hand: the host makes it, the helper prepares it, the host installs it,
/// the helper frees it with all that it has replaced. `stage` says whose it is; only its owner
/// touches it and sets the next stage (release), the other reads it (acquire).
///
/// The lock is for sleeping and waking alone. The helper may lose the processor while it holds it,
/// so the host only tries it: if the helper could not be woken, the next himc_loader_run tries
/// again. Only himc_loader_finish and himc_loader_free wait.
///
/// Commands of another thread come by a ring, the reasons of those refused go back by another.
#define _POSIX_C_SOURCE 200809L
#include "himc/loader.h"
#include "base/array.h"
#include "drum/drum_performer.h"
#include "system/ring.h"
#include "system/thread.h"

#include <stdatomic.h>
#include <string.h>

#define WAITING_LOADS 256 // chosen: a page of a patch, sent at once
#define REFUSALS 64       // chosen: a page of a terminal
#define SHORT_AT_ONCE 8   // short commands in one run; chosen: 10 us each at most

typedef enum loader_stage { IDLE, PREPARING, PREPARED, FREEING } loader_stage;

typedef struct waiting_load {
    himc_load_target target; ///< its drum is retained
    himc_command command;
} waiting_load;

typedef struct waiting_post {
    himc_performance *performance;
    himc_command command;
} waiting_post;

struct himc_loader {
    waiting_load queue[WAITING_LOADS]; ///< a ring; the first is under way
    int first, count;
    long dropped;

    pthread_t thread;
    bool running;
    pthread_mutex_t lock;
    pthread_cond_t work, done; ///< for the helper, for the host
    bool stop;                 ///< under the lock
    bool asleep;               ///< the helper has work and could not be woken; the host's
    _Atomic loader_stage stage;
    system_ring posts, refusals; ///< of waiting_post, from another thread; of himc_error, to it
    himc_job *job;               ///< the helper's while PREPARING or FREEING, else the host's
    bool good;                   ///< it was prepared ...
    himc_error error;            ///< ... or why not
};

static loader_stage stage_of(himc_loader *loader)
{
    return atomic_load_explicit(&loader->stage, memory_order_acquire);
}

static bool is_helpers(loader_stage stage)
{
    return stage == PREPARING || stage == FREEING;
}

// the helper

static void *help(void *object)
{
    himc_loader *loader = object;
    pthread_mutex_lock(&loader->lock);
    while (!loader->stop) {
        loader_stage stage = stage_of(loader);
        if (!is_helpers(stage)) {
            pthread_cond_wait(&loader->work, &loader->lock);
            continue;
        }
        pthread_mutex_unlock(&loader->lock);
        if (stage == PREPARING)
            loader->good = loader->job->prepare(loader->job, &loader->error);
        else
            loader->job->free(loader->job);
        stage = stage == PREPARING ? PREPARED : IDLE;
        atomic_store_explicit(&loader->stage, stage, memory_order_release);
        pthread_mutex_lock(&loader->lock);
        pthread_cond_signal(&loader->done);
    }
    pthread_mutex_unlock(&loader->lock);
    return NULL;
}

// the host

// Each stage wakes the helper once: a condition that is signalled again before its waiter has left
// may wait for it.
static void wake(himc_loader *loader)
{
    if (!loader->asleep || pthread_mutex_trylock(&loader->lock) != 0)
        return;
    pthread_cond_signal(&loader->work);
    pthread_mutex_unlock(&loader->lock);
    loader->asleep = false;
}

static void hand_over(himc_loader *loader, loader_stage stage)
{
    atomic_store_explicit(&loader->stage, stage, memory_order_release);
    loader->asleep = true;
    wake(loader);
}

static void free_memory(himc_loader *loader)
{
    himc_ring_free(&loader->posts);
    himc_ring_free(&loader->refusals);
    free(loader);
}

himc_loader *himc_loader_new(himc_error *error)
{
    himc_loader *loader = himc_new(sizeof *loader, "loader", error);
    if (!loader)
        return NULL;
    if (!himc_ring_init(&loader->posts, sizeof(waiting_post), HIMC_LOADER_POSTS) ||
        !himc_ring_init(&loader->refusals, sizeof(himc_error), REFUSALS)) {
        free_memory(loader);
        himc_error_set(error, "loader: out of memory");
        return NULL;
    }
    pthread_mutex_init(&loader->lock, NULL);
    pthread_cond_init(&loader->work, NULL);
    pthread_cond_init(&loader->done, NULL);
    return loader;
}

static waiting_load *take_first(himc_loader *loader)
{
    waiting_load *first = &loader->queue[loader->first];
    loader->first = (loader->first + 1) % WAITING_LOADS;
    loader->count--;
    return first;
}

void himc_loader_free(himc_loader *loader)
{
    if (!loader)
        return;
    pthread_mutex_lock(&loader->lock);
    loader->stop = true;
    pthread_cond_signal(&loader->work);
    pthread_mutex_unlock(&loader->lock);
    if (loader->running)
        pthread_join(loader->thread, NULL);
    if (stage_of(loader) != IDLE)
        loader->job->free(loader->job);
    while (loader->count > 0)
        himc_drum_release(take_first(loader)->target.drum);
    pthread_cond_destroy(&loader->work);
    pthread_cond_destroy(&loader->done);
    pthread_mutex_destroy(&loader->lock);
    free_memory(loader);
}

// the first command is carried out, or refused; tells it, and what was dropped, after the last
static void end_first(himc_loader *loader, const char *error)
{
    const waiting_load *first = take_first(loader);
    himc_load_target target = first->target;
    himc_error lost = {""}, named = {""};
    if (error && first->command.drum[0]) {
        himc_error_set(&named, "%s: %s", first->command.drum, error);
        error = named.text;
    }
    if (loader->count == 0 && loader->dropped > 1)
        himc_error_set(&lost, "%ld commands dropped: more than %d waited", loader->dropped,
                       WAITING_LOADS);
    loader->dropped = loader->count == 0 ? 0 : loader->dropped;
    if (target.done)
        target.done(target.user, error);
    if (target.done && lost.text[0])
        target.done(target.user, lost.text);
    himc_drum_release(target.drum);
}

// a performance's first member: the drum's room does not know the others
static const himc_runner *runner_of(const himc_load_target *target)
{
    return (const himc_runner *)(const void *)target->performance;
}

static bool takes_long(const himc_load_target *target, const himc_command *command)
{
    return target->drum ? himc_drum_takes_long(target->drum, command)
                        : runner_of(target)->takes_long(target->performance, command);
}

static bool carry_out(const himc_load_target *target, const himc_command *command, int delay,
                      himc_error *error)
{
    return target->drum ? himc_drum_command(target->drum, command, error)
                        : runner_of(target)->run(target->performance, command, delay, error);
}

// begins with the first that waits; true if it was short
static bool begin_first(himc_loader *loader)
{
    const himc_load_target *target = &loader->queue[loader->first].target;
    const himc_command *command = &loader->queue[loader->first].command;
    himc_error error = {""};
    if (takes_long(target, command)) {
        if (!loader->running)
            loader->running = himc_system_start_thread(&loader->thread, help, loader);
        if (!loader->running)
            himc_error_set(&error, "no thread to load in");
        loader->job = !loader->running ? NULL
                      : target->drum   ? himc_drum_job(target->drum, command, &error)
                                     : runner_of(target)->job(target->performance, command, &error);
        if (loader->job)
            hand_over(loader, PREPARING);
        else
            end_first(loader, error.text);
        return false;
    }
    bool head = himc_command_table((int)command->id)->marks & HIMC_CHANGES_HEAD;
    bool good = carry_out(target, command, 0, &error);
    end_first(loader, good ? NULL : error.text);
    return !head;
}

static void install(himc_loader *loader)
{
    himc_job_state state =
        loader->good ? loader->job->install(loader->job, &loader->error) : HIMC_JOB_FAILED;
    if (state == HIMC_JOB_MORE)
        return;
    hand_over(loader, state == HIMC_JOB_AGAIN ? PREPARING : FREEING);
    if (state != HIMC_JOB_AGAIN) {
        himc_error why = loader->error;
        end_first(loader, state == HIMC_JOB_DONE ? NULL : why.text);
    }
}

static void tell_poster(void *user, const char *why)
{
    himc_loader *loader = user;
    himc_error *slot = why ? himc_ring_slot(&loader->refusals) : NULL;
    if (!slot)
        return;
    himc_error_set(slot, "%s", why);
    himc_ring_push(&loader->refusals);
}

// at most SHORT_AT_ONCE of the posted commands, while none waits: it may make the next one's drum
static void take_posts(himc_loader *loader)
{
    const waiting_post *post;
    bool head = false; // one change of a head takes as long as all others
    for (int i = 0; i < SHORT_AT_ONCE && loader->count == 0 && !head &&
                    (post = himc_ring_peek(&loader->posts));
         i++) {
        himc_error why;
        const himc_load_target target = {
            .performance = post->performance, .done = tell_poster, .user = loader};
        if (!himc_loader_command(loader, &target, &post->command, &why))
            tell_poster(loader, why.text);
        head = himc_command_table((int)post->command.id)->marks & HIMC_CHANGES_HEAD;
        himc_ring_pop(&loader->posts);
    }
}

bool himc_loader_run(himc_loader *loader)
{
    take_posts(loader);
    wake(loader);
    loader_stage stage = stage_of(loader);
    if (stage == PREPARED)
        install(loader);
    for (int i = 0; stage == IDLE && loader->count > 0 && i < SHORT_AT_ONCE; i++)
        if (!begin_first(loader))
            break;
    return himc_loader_busy(loader);
}

bool himc_loader_busy(const himc_loader *loader)
{
    return loader->count > 0 || himc_ring_peek(&loader->posts);
}

void himc_loader_finish(himc_loader *loader)
{
    while (himc_loader_run(loader)) {
        pthread_mutex_lock(&loader->lock);
        pthread_cond_signal(&loader->work);
        while (is_helpers(stage_of(loader)))
            pthread_cond_wait(&loader->done, &loader->lock);
        pthread_mutex_unlock(&loader->lock);
    }
}

bool himc_loader_command(himc_loader *loader, const himc_load_target *asked,
                         const himc_command *command, himc_error *error)
{
    himc_load_target named = *asked, *target = &named;
    if (command->drum[0] && !named.drum) {
        named.drum = runner_of(asked)->drum(asked->performance, command, error);
        if (!named.drum)
            return false;
    }
    if (loader->count == 0 && !takes_long(target, command))
        return carry_out(asked, command, asked->delay, error);
    if (loader->count == WAITING_LOADS) {
        himc_error_set(error, "more than %d commands wait: this one is dropped", WAITING_LOADS);
        return loader->dropped++ > 0;
    }
    waiting_load *load = &loader->queue[(loader->first + loader->count++) % WAITING_LOADS];
    load->target = *target;
    himc_command_copy(&load->command, command);
    if (target->drum)
        himc_drum_retain(target->drum);
    return true;
}

bool himc_loader_post(himc_loader *loader, himc_performance *performance, const char *text,
                      himc_error *error)
{
    himc_command command;
    if (!himc_command_parse_text(&command, HIMC_PERFORMER, text, error))
        return false;
    waiting_post *post = himc_ring_slot(&loader->posts);
    if (!post)
        return himc_error_set(error, "%d commands wait: this one is not taken", HIMC_LOADER_POSTS);
    post->performance = performance;
    himc_command_copy(&post->command, &command);
    himc_ring_push(&loader->posts);
    return true;
}

bool himc_loader_refused(himc_loader *loader, himc_error *error)
{
    const himc_error *oldest = himc_ring_peek(&loader->refusals);
    long lost = oldest ? 0 : himc_ring_lost(&loader->refusals);
    if (oldest) {
        himc_error_set(error, "%s", oldest->text);
        himc_ring_pop(&loader->refusals);
    } else if (lost > 0) {
        himc_error_set(error, "%ld further commands were refused", lost);
    }
    return oldest || lost > 0;
}

bool himc_loader_restore(himc_loader *loader, const himc_load_target *target, const char *state,
                         himc_error *error)
{
    himc_loader_finish(loader);
    himc_job *job = target->drum ? himc_drum_state_job(target->drum, state, error)
                                 : runner_of(target)->state_job(target->performance, state, error);
    return himc_job_carry_out(job, error);
}
