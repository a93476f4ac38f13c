// Defines functions that replace those of the C library with the same name, and call them.
#pragma once

#include <dlfcn.h>
#include <stdlib.h>

#include "core/guard/c_functions.h"
#include "watching.h"

namespace rehearse::interposer {

/// The source as which a call of each function is logged.
namespace source_of {
#define REHEARSE_SOURCE(name, source, guard, cost) inline constexpr Source name = Source::source;
REHEARSE_C_FUNCTIONS(REHEARSE_SOURCE)
#undef REHEARSE_SOURCE
}  // namespace source_of

/// True for functions by which threads wait in turns (turn_functions.h). A thread that takes turns gets their
/// answers, and its calls of them are not logged: nothing outside of the process determines them.
namespace is_of_turns {
#define REHEARSE_OF_guarded false
#define REHEARSE_OF_turns true
#define REHEARSE_OF_counted false
#define REHEARSE_OF_derived false
#define REHEARSE_OF_allocator false
#define REHEARSE_OF_free false
#define REHEARSE_IS_OF_TURNS(name, source, guard, cost) inline constexpr bool name = REHEARSE_OF_##guard;
REHEARSE_C_FUNCTIONS(REHEARSE_IS_OF_TURNS)
#undef REHEARSE_IS_OF_TURNS
}  // namespace is_of_turns

/// The function of this name that would be called without the interposer.
template <class Function>
class Next {
 public:
  constexpr explicit Next(const char* name) : name_(name) {}
  Function* get() {
    Function* found = __atomic_load_n(&found_, __ATOMIC_RELAXED);
    if (!found) {
      found = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name_));
      if (!found) abort();  // it exists, because the caller is linked to it
      __atomic_store_n(&found_, found, __ATOMIC_RELAXED);
    }
    return found;
  }

 private:
  const char* name_;
  Function* found_ = nullptr;
};

}  // namespace rehearse::interposer

/// Begins the definition of a function that is exported under `name`. In C++ it has a different name, because the C
/// library's headers declare theirs with attributes, and redirect some to others. next_name is the replaced function.
#define REHEARSE_INTERPOSED(result, name, parameters)                                                   \
  static_assert(::rehearse::interposer::source_of::name != ::rehearse::interposer::Source::none);       \
  [[maybe_unused]] static ::rehearse::interposer::Next<result parameters> next_##name{#name};           \
  extern "C" __attribute__((visibility("default"))) result interposed_##name parameters __asm__(#name); \
  extern "C" result interposed_##name parameters

// NOLINTBEGIN(bugprone-macro-parentheses): a list of arguments has its own

/// A function that is only logged. The call is its last statement, so it is compiled to a jump: the real function sees
/// its caller's return address.
#define REHEARSE_NOTED(result, name, parameters, arguments, text)      \
  REHEARSE_INTERPOSED(result, name, parameters) {                      \
    if (watching() && !(is_of_turns::name && takes_turns()))           \
      note(source_of::name, #name, text, __builtin_return_address(0)); \
    return next_##name.get() arguments;                                \
  }

/// A function that is logged, and answered if the caller's substitution has `aspect` (one of its members). The last
/// arguments are the statements of the answer, which can use `caller` and `substitution`.
#define REHEARSE_ANSWERED(aspect, result, name, parameters, arguments, text, ...)                \
  REHEARSE_INTERPOSED(result, name, parameters) {                                                \
    if (!watching() || (is_of_turns::name && takes_turns())) return next_##name.get() arguments; \
    const Caller caller = note(source_of::name, #name, text, __builtin_return_address(0));       \
    const Substitution& substitution = substitution_for(caller);                                 \
    if (!substitution.aspect) return next_##name.get() arguments;                                \
    __VA_ARGS__                                                                                  \
  }
// NOLINTEND(bugprone-macro-parentheses)
