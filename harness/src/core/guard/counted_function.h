// The rows of c_functions.h for cost_counter.cpp, and for replacements that do more than counting.
#pragma once

#include <cstdint>

namespace rehearse {

struct CountedFunction {
  enum class Count : std::uint8_t {
    none,
    allocate_0,
    allocate_1,
    allocate_2,
    allocate_product,
    reallocate,
    release,
    lock,
    system,
    exception
  };
  void* next;  // the first member: the replacements in assembly read it; null: it isn't known yet
  const char* name;
  Count count;
};

/// Counts the present call of a function that process_tripwires.cpp replaces.
void count_guarded(const CountedFunction& function);

}  // namespace rehearse
