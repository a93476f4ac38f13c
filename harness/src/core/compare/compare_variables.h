// Variables of controllers, which affect a verdict only if a rule names them. Internal.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compared_traces.h"

namespace rehearse {

/// True if a rule names this variable of a controller, "SR1/Walker/variable/phase", by a pattern with "/variable/" in
/// it. Variables are internals of a controller: only then they affect a verdict.
bool asks_for_variable(std::string_view series, const std::vector<ToleranceRule>& rules);
/// True for a variable of a controller that no rule names, and for commands that moved the world before a branch began.
bool isnt_compared(const TraceChannel& channel, const std::vector<ToleranceRule>& rules);
/// Finds differences of the variables that no rule names.
class VariablesRemark {
 public:
  explicit VariablesRemark(const ComparedTraces& traces);
  /// The channels that the windows have to contain.
  const std::vector<PairedChannel>& channels() const { return channels_; }
  void take(const Window& window);
  /// The remark; empty if all are equal.
  std::string text() const;

 private:
  struct Found {
    std::uint64_t time;
    std::size_t order;  // of the channels
    std::string text;
  };
  void find_lone(const Trace& of, const RunSurvey& run, const Trace& other, const char* which);

  const ComparedTraces& traces_;
  std::vector<PairedChannel> channels_;             // channels that may differ
  std::vector<std::optional<std::size_t>> orders_;  // by index in channels_; none: it differs
  std::vector<Found> found_;
};

}  // namespace rehearse
