// The functions of the C library that process_tripwires.cpp and those of turn_functions.h replace, as they would be
// called without them. To be included without _FORTIFY_SOURCE, which declares inline functions with the names of those
// that open files.
#pragma once

#include <fcntl.h>
#include <locale.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <threads.h>
#include <time.h>
#include <unistd.h>

#include "c_functions.h"
#include "c_library.h"
#include "counted_function.h"

namespace rehearse {

/// They are looked up when this library is loaded, because a look-up takes the lock of the dynamic linker. A call that
/// was ended while a library was loaded or unloaded holds this lock for ever. A macro instead of a template, because
/// clang gives functions that return and functions that don't the same type name.
struct NextFunctions {
#define REHEARSE_NEXT_guarded(function) decltype(&(::function)) function##_;
#define REHEARSE_NEXT_turns(function) REHEARSE_NEXT_guarded(function)
#define REHEARSE_NEXT_derived(function)
#define REHEARSE_NEXT_counted(function)
#define REHEARSE_NEXT_allocator(function)
#define REHEARSE_NEXT_free(function)
#define REHEARSE_MEMBER(function, source, guard, cost) REHEARSE_NEXT_##guard(function)
  REHEARSE_C_FUNCTIONS(REHEARSE_MEMBER)
#undef REHEARSE_NEXT_guarded
};

const NextFunctions& next_functions();

/// The function of this name that comes next in the search of the dynamic linker; null: there is none.
void* next_function(const char* name);

}  // namespace rehearse

#define REHEARSE_DECLARE_guarded(function) \
  extern "C" __attribute__((visibility("hidden"))) rehearse::CountedFunction rehearse_counted_##function;
#define REHEARSE_DECLARE_turns(function) REHEARSE_DECLARE_guarded(function)
#define REHEARSE_DECLARE_derived(function)
#define REHEARSE_DECLARE_counted(function)
#define REHEARSE_DECLARE_allocator(function)
#define REHEARSE_DECLARE_free(function)
#define REHEARSE_DECLARE(function, source, guard, cost) REHEARSE_DECLARE_##guard(function)
REHEARSE_C_FUNCTIONS(REHEARSE_DECLARE)

/// The next function, for a call: it is counted.
#define REHEARSE_NEXT(function) \
  (::rehearse::count_guarded(rehearse_counted_##function), ::rehearse::next_functions().function##_)
