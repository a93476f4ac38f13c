// The findings about one channel, and the judges of its parts. Internal.
#pragma once

#include <rehearse/compare.h>

#include <cstdint>
#include <memory>

#include "compared_traces.h"

namespace rehearse {

/// Collects the divergences of one channel: counts them, keeps the first and the worst.
class ChannelFindings {
 public:
  explicit ChannelFindings(ChannelComparison& result) : result_(result) {}
  /// Counts a value whose bits differ. True if it has to be described: it is the first, the first beyond, or the worst.
  bool count(double difference, double tolerance, bool beyond);
  /// Stores the description of the value that was counted last.
  void describe(const Divergence& divergence, bool beyond);
  /// Stores a difference other than of two values: missing, extra, of a different kind. Fails the channel.
  void structure(const Divergence& divergence);
  /// Like structure(), for a difference that precedes all others of the same tick and stage.
  void structure_before(const Divergence& divergence);
  /// Stores a difference of bits that fails nothing: of a hash, or of a value that isn't judged.
  void mark(const Divergence& divergence);
  ChannelComparison& result() { return result_; }

 private:
  ChannelComparison& result_;
  double worst_times_ = -1.0;
  double worst_difference_ = -1.0;
};

/// Judges some values of a channel's messages, window after window.
class PartJudge {
 public:
  virtual ~PartJudge() = default;
  virtual void take(const MatchedChannel& window) = 0;
  /// Counts pairs of messages that are equal.
  virtual void take_equal(std::int64_t /*pairs*/) {}
  virtual void finish() {}
};

std::unique_ptr<PartJudge> judge_numbers(const ComparedTraces& traces, const PairedChannel& channel,
                                         ChannelFindings& findings);
/// Judges the values without a column in the tables of numbers.
std::unique_ptr<PartJudge> judge_rests(const ComparedTraces& traces, const PairedChannel& channel,
                                       ChannelFindings& findings);
std::unique_ptr<PartJudge> judge_payloads(const ComparedTraces& traces, const PairedChannel& channel,
                                          ChannelFindings& findings);

}  // namespace rehearse
