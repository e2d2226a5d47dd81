/// loader.h: commands that take long, without holding up the sound.
///
/// A loader has a helper thread. A command that reads a file or computes a head of many modes is
/// prepared there, while the performance or the drum plays on; himc_loader_run then installs it
/// between two blocks. Commands that come behind it wait, so all act in the order in which they
/// came. The host calls, from one thread:
///
///     himc_loader_command(loader, &target, &command, &error);          for each command
///     himc_loader_run(loader);                                         before each block
///
/// A host that can wait calls himc_loader_finish instead: then each command acts when it comes, and
/// the result depends on no clock.
#ifndef HIMC_LOADER_H
#define HIMC_LOADER_H

#include "himc/drum.h"

HIMC_BEGIN

typedef struct himc_performance himc_performance; ///< performance.h

/// A helper thread and the commands that wait for it. Opaque.
typedef struct himc_loader himc_loader;

/// A loader; its thread starts with the first command that takes long. NULL without memory.
himc_loader *himc_loader_new(himc_error *error);
/// Waits for the helper thread and ends it; commands that wait are dropped. NULL is allowed.
void himc_loader_free(himc_loader *loader);

/// The receiver of a command, and who is told the result of one that has waited. All of it is
/// borrowed until the loader is idle.
typedef struct himc_load_target {
    himc_performance *performance; ///< of a performer's command, else NULL
    himc_drum *drum;               ///< of a drum's command, else NULL
    int delay; ///< of a performer's command that need not wait, himc_performance_command (samples)
    /// Called by himc_loader_run and himc_loader_finish when a command that has waited was carried
    /// out (`error` is NULL) or refused, with the reason. NULL: nobody is told.
    void (*done)(void *user, const char *error);
    void *user; ///< given to `done`
} himc_load_target;

/// Carries a command out at once, if it is short and none waits; else it is accepted and waits.
/// False with the reason if it was refused, or if 256 commands wait: the first one dropped is an
/// error, the others are counted, and `done` of the last one tells their number.
bool himc_loader_command(himc_loader *loader, const himc_load_target *target,
                         const himc_command *command, himc_error *error);

// From another thread than the host's, without a lock: a program whose audio callback is the host
// posts its commands, and the callback calls himc_loader_run before each block:
//
//     himc_loader_post(loader, performance, "hit right legato f", &error);     control thread
//     while (himc_loader_refused(loader, &error)) ...                          control thread
//     himc_loader_run(loader); himc_performance_read(performance, frames, 2, n);     callback

#define HIMC_LOADER_POSTS 256 ///< commands that may wait for himc_loader_run

/// Checks a performer's command, also DRUM COMMAND ..., and leaves it to himc_loader_run, whose
/// next calls carry out the posted ones in their order, a few in each, after all that waits;
/// `performance` is borrowed until then. `info` and `dump` tell nothing: himc_performance_describe
/// does. False with the reason: the text is no command, or HIMC_LOADER_POSTS wait. One thread at a
/// time may post.
bool himc_loader_post(himc_loader *loader, himc_performance *performance, const char *text,
                      himc_error *error);
/// For the thread that posts: takes the oldest reason why a posted command was not carried out.
/// False if there is none. At most 64 reasons wait; further ones are counted, and a last line tells
/// how many they are.
HIMC_RT bool himc_loader_refused(himc_loader *loader, himc_error *error);
/// Carries out the lines that `dump` has told (HIMC_DESCRIBE_STATE), each with a `;`, at once and
/// after all that waits: all of them, or none and false with the reason. A performer's are a score.
bool himc_loader_restore(himc_loader *loader, const himc_load_target *target, const char *state,
                         himc_error *error);
/// Installs what is ready, about 0.2 ms of it, and never waits for the helper thread. It may
/// allocate: it carries short commands out, and makes what the helper works on. True while commands
/// wait.
bool himc_loader_run(himc_loader *loader);
/// True while commands wait. For the thread of himc_loader_run.
HIMC_RT bool himc_loader_busy(const himc_loader *loader);
/// Carries out all that waits, at once.
void himc_loader_finish(himc_loader *loader);

/// What a checked command `drum` or `instrument` makes; one reference belongs to the caller. NULL
/// with the reason.
himc_drum *himc_drum_made(const himc_command *command, double sample_rate, himc_error *error);

HIMC_END

#endif
