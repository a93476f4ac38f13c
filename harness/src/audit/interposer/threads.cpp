// Threads and processes that a controller starts.
#include <pthread.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "next.h"
#include "system_calls.h"
#include "watching.h"

namespace rehearse::interposer {
namespace {

constexpr timespec schedule_delay{0, 3'000'000};

struct Start {
  void* (*routine)(void*);
  void* argument;
  bool late;
};

void wait_a_little() {
  sleep_really(schedule_delay);  // not in simulated time, which a thread that takes turns sees
}

void* run_own_thread(void* argument) {
  const Start start = *static_cast<Start*>(argument);
  free(argument);
  if (start.late) wait_a_little();
  thread_state.own_thread = true;
  return start.routine(start.argument);
}

}  // namespace

REHEARSE_INTERPOSED(int, pthread_create,
                    (pthread_t * thread, const pthread_attr_t* attributes, void* (*routine)(void*), void* argument)) {
  if (!watching()) return next_pthread_create.get()(thread, attributes, routine, argument);
  const Caller caller =
      note(source_of::pthread_create, "pthread_create",
           will_take_turns(reinterpret_cast<const void*>(routine)) ? "in turns" : "", __builtin_return_address(0));
  if (!caller.is_controller) return next_pthread_create.get()(thread, attributes, routine, argument);
  const Threads schedule = substitution_for(caller).threads;
  auto* start = static_cast<Start*>(malloc(sizeof(Start)));
  *start = {routine, argument, schedule == Threads::late};
  const int failed = next_pthread_create.get()(thread, attributes, run_own_thread, start);
  if (failed) free(start);
  if (!failed && schedule == Threads::early) wait_a_little();
  return failed;
}

REHEARSE_NOTED(pid_t, fork, (), (), "")

// The real vfork() can't be called here: its caller must not return before the child has ended. fork() has the same
// effect, only slower.
REHEARSE_INTERPOSED(pid_t, vfork, ()) {
  if (watching()) note(source_of::vfork, "vfork", "", __builtin_return_address(0));
  return next_fork.get()();
}

REHEARSE_NOTED(int, clone,
               (int (*function)(void*), void* stack, int flags, void* argument, void* parent, void* storage,
                void* child),
               (function, stack, flags, argument, parent, storage, child), "")
REHEARSE_NOTED(int, posix_spawn,
               (pid_t * child, const char* path, const void* actions, const void* attributes, char* const* arguments,
                char* const* environment),
               (child, path, actions, attributes, arguments, environment), path)
REHEARSE_NOTED(int, posix_spawnp,
               (pid_t * child, const char* name, const void* actions, const void* attributes, char* const* arguments,
                char* const* environment),
               (child, name, actions, attributes, arguments, environment), name)
REHEARSE_NOTED(int, system, (const char* command), (command), command)
REHEARSE_NOTED(FILE*, popen, (const char* command, const char* mode), (command, mode), command)
REHEARSE_NOTED(int, execve, (const char* path, char* const* arguments, char* const* environment),
               (path, arguments, environment), path)
REHEARSE_NOTED(int, execv, (const char* path, char* const* arguments), (path, arguments), path)
REHEARSE_NOTED(int, execvp, (const char* path, char* const* arguments), (path, arguments), path)

}  // namespace rehearse::interposer
