// The information that a call asks for, as text, and the factor of an audit that changes its answer.
#pragma once

#include <rehearse/audit.h>

#include <optional>
#include <string_view>
#include <vector>

#include "call_log.h"

namespace rehearse {

/// The argument of a call that starts a thread which takes turns (core/turns/scheduler.h).
inline constexpr std::string_view in_turns = "in turns";

struct Aspect {
  std::string_view words;        // "the clock", "the number of processors"
  std::optional<Factor> factor;  // the factor that varies it; none: no factor does
  bool has_answer = true;        // false: it only has an effect
  bool in_part = false;          // true: the factor varies the order of the answer, and not its content
};

Aspect aspect_of(const ObservedCall& call);

/// True if `words` contains the word; each of them is between spaces.
bool is_one_of(std::string_view word, std::string_view words);

/// True for a call on a file that the same controller wrote before this call, so that it determined the content.
/// `calls` in order of their first occurrence.
bool is_of_own_file(const std::vector<ObservedCall>& calls, const ObservedCall& call);

}  // namespace rehearse
