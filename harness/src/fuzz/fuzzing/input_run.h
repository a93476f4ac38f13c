// InputRun: gives a controller a sequence of inputs, and judges what it does. Internal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "claims.h"
#include "core/guard/answer.h"
#include "fuzz_setup.h"
#include "inputs.h"

namespace rehearse {

enum class InputEnd {
  passed,
  not_finite,
  beyond_limit,
  violated,
  threw,
  crashed,
  hung,
  ended_process,
  took_memory,
  not_repeated,
  not_realtime,
  unable,  // the controller can't be loaded, or fails before the first tick
};
/// As FuzzFinding::kind.
const char* to_string(InputEnd end);
/// True if the process in which a run ended so isn't sound.
inline bool ends_process(InputEnd end) {
  return end == InputEnd::crashed || end == InputEnd::hung || end == InputEnd::threw ||
         end == InputEnd::ended_process || end == InputEnd::took_memory || end == InputEnd::unable;
}

/// A comparison in the code of a controller, in one run.
struct SeenComparison {
  std::uint32_t place = 0, seen = 0;        // seen: bits 1 a < b, 2 a == b, 4 a > b
  double a = 0.0, b = 0.0, distance = 0.0;  // the nearest operands that aren't equal
};

struct InputOutcome {
  InputEnd end = InputEnd::passed;
  std::string sentence;
  std::string reason;                 // the sentence without its numbers: equal for findings of one kind
  std::int64_t tick = -1;             // at which it ended so
  std::uint64_t hash = 0;             // of all commands
  std::vector<std::uint32_t> states;  // code and values that were reached; ascending
  std::uint32_t points = 0;           // edges of the code among them
  std::vector<SeenComparison> comparisons;
  std::vector<double> margins;  // by expectation; infinity: it has none
  std::vector<double> peaks;    // by output: the greatest magnitude

  bool passed() const { return end == InputEnd::passed; }
  /// True if it fails in the same way.
  bool is_like(const InputOutcome& other) const { return end == other.end && reason == other.reason; }
};

void each_member(Passed<SeenComparison> auto& value, auto& each) {
  auto& [place, seen, a, b, distance] = value;
  each(place), each(seen), each(a), each(b), each(distance);
}
void each_member(Passed<InputOutcome> auto& value, auto& each) {
  auto& [end, sentence, reason, tick, hash, states, points, comparisons, margins, peaks] = value;
  each(end), each(sentence), each(reason), each(tick), each(hash), each(states), each(points), each(comparisons);
  each(margins), each(peaks);
}

std::string without_numbers_in(const std::string& sentence);

/// What a process with fresh memory contains there.
enum class MemoryFill { large_numbers, zeros };

/// What a run needs besides its inputs: made once, before the workers.
struct RunParts {
  const FuzzSetup& setup;
  RunTable table;
  std::optional<Claims> claims;  // none: before the names of variables are known
};

/// Makes a run in this process. `recording`: the file that it is recorded in; empty: it isn't.
InputOutcome run_inputs(RunParts& parts, const Inputs& inputs, MemoryFill fill,
                        const std::filesystem::path& recording = {});

/// The series of the runs: inputs of joints, commands, and variables that the run of the inputs sets. Fails if the
/// controller can't be loaded or fails.
Result<std::vector<NamedSeries>> series_of_run(const FuzzSetup& setup, const Inputs& inputs);

}  // namespace rehearse
