// RunComparer: compares two runs, window after window. Internal.
#pragma once

#include <rehearse/compare.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "compare_channel.h"
#include "compare_variables.h"
#include "compared_traces.h"

namespace rehearse {

/// Compares two runs, window after window.
class RunComparer {
 public:
  RunComparer(const RunSurvey& golden, const RunSurvey& actual, const std::vector<ToleranceRule>& rules,
              const CompareOptions& options);

  const ComparedTraces& traces() const { return traces_; }
  /// The channels that the windows have to contain.
  std::vector<PairedChannel> channels() const;
  /// No window will contain the messages before that second [ns], which are equal.
  void skip_to(std::uint64_t second);
  void take(const Window& window);
  Comparison finish();

 private:
  void find_undecoded(const std::function<bool(const TraceChannel&)>& taken);
  static ChannelComparison& add_to(std::vector<ChannelComparison>& results, const std::string& topic);

  ComparedTraces traces_;
  Comparison comparison_;
  std::vector<ChannelComparison> results_;
  std::vector<ChannelComparison> of_events_;  // after the values: of two findings in one tick, a value is reported
  std::deque<ChannelComparer> comparers_;     // in the golden's order
  std::optional<VariablesRemark> variables_;
};

}  // namespace rehearse
