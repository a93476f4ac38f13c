// What a call asks for, in words, and which change of an audit gives it another answer.
#pragma once

#include <rehearse/audit.h>

#include <optional>
#include <string_view>
#include <vector>

#include "call_log.h"

namespace rehearse {

struct Aspect {
  std::string_view words;        // "the clock", "the number of processors"
  std::optional<Factor> factor;  // that varies it; none: nothing does
  bool has_answer = true;        // false: it only does something
};

Aspect aspect_of(const ObservedCall& call);

/// A file that the same controller made itself before this call: what is in it, it knows. `calls` in order of their
/// first occurrence.
bool is_of_own_file(const std::vector<ObservedCall>& calls, const ObservedCall& call);

}  // namespace rehearse
