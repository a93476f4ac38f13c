// Threads that take turns, for the replacements of the C library's functions. Internal.
#pragma once

#include <pthread.h>

#include "core/turns/scheduler.h"

namespace rehearse {

/// True if this thread takes turns and has the turn, which it hasn't in a signal handler while it waits. A thread whose
/// call has failed stays here for ever.
inline bool takes_turns() {
  if (!this_turn) return false;
  if (this_turn->is_lost) TurnScheduler::instance().stop_if_lost();
  return this_turn->state == TurnThread::State::running;
}

/// True if it takes turns, and there are other threads: else a wait without a deadline is the C library's.
inline bool waits_in_turns() { return takes_turns() && !this_turn->is_alone; }

/// Answers a system call of a thread that takes turns, with errno. False: it has to be made.
bool answer_turn_call(long number, const long (&given)[6], long& result);

/// A guest closes a descriptor.
void note_turn_close(int descriptor);

/// A guest names a thread.
void name_turn_thread(pthread_t handle, const char* name);

/// Starts a thread in code of a guest, as pthread_create() does. `function`: with which it begins.
int start_thread(pthread_t* thread, const pthread_attr_t* attributes, void* (*routine)(void*), void* argument,
                 const void* function);

/// True if this is the thread of a controller's call, or a thread that a controller started.
bool in_controllers_code();

/// Prepares the scheduler for the calls of this process.
void prepare_turns();

/// What the threads wait for in a deadlock, with their lines: the end of a message.
std::string describe_deadlock();
/// Between two calls: "threads.cpp:88: 'planner' waits for a condition", for each thread that takes turns.
std::vector<std::string> describe_threads_at_rest();

}  // namespace rehearse
