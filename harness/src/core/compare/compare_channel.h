// ChannelComparer: compares a channel of two runs, window after window. Internal.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "channel_findings.h"

namespace rehearse {

/// Compares a channel that both runs have, window after window.
class ChannelComparer {
 public:
  /// `differing_events`: the comparison of events found a difference on this channel.
  ChannelComparer(const ComparedTraces& traces, const PairedChannel& channel, bool differing_events);
  ChannelComparer(const ChannelComparer&) = delete;
  ChannelComparer& operator=(const ChannelComparer&) = delete;

  const PairedChannel& channel() const { return channel_; }
  /// True if the messages have to be read.
  bool needs_windows() const { return needs_windows_; }
  /// Counts the first messages, which are equal and which no window will contain.
  void take_equal(std::uint64_t messages);
  void take(const Window& window);
  ChannelComparison finish();

 private:
  /// Messages that only one run has.
  struct Lone {
    std::int64_t count = 0;
    std::optional<Divergence> first;
    void take(const ComparedTraces& traces, const TraceChannel& of, const std::vector<std::size_t>& messages);
  };

  bool has_another_form();
  void make_judges();
  void compare_bytes(const MatchedChannel& matched);
  void report(Lone& lone, const char* what);

  const ComparedTraces& traces_;
  const PairedChannel channel_;
  const bool differing_events_;
  ChannelComparison result_;
  ChannelFindings findings_{result_};
  std::vector<std::unique_ptr<PartJudge>> judges_;
  bool has_judges_ = false;
  bool needs_windows_ = false;
  Lone missing_, extra_;
};

}  // namespace rehearse
