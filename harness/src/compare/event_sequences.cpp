#include "event_sequences.h"

#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "compare_parts.h"

namespace rehearse {
namespace {

using EdgesOf = std::vector<EventEdge> EventSequence::*;

class SequenceMaker {
 public:
  SequenceMaker(const Trace& golden, const Trace& actual, std::uint64_t end)
      : golden_(golden), actual_(actual), end_(end) {}

  EventSequences make() {
    const auto same = [](const msg::ContactChange& a, const msg::ContactChange& b) {
      return a.tick == b.tick && a.begins == b.begins && a.link == b.link && a.other == b.other;
    };
    const auto &contacts = golden_.contact_changes(), &others = actual_.contact_changes();
    const bool both_tell =
        golden_.find_channel(run_topics::contact_changes) && actual_.find_channel(run_topics::contact_changes);
    if (both_tell && !std::equal(contacts.begin(), contacts.end(), others.begin(), others.end(), same)) {
      add_contacts(golden_, &EventSequence::golden);
      add_contacts(actual_, &EventSequence::actual);
    }
    for (const TraceChannel& channel : golden_.channels()) {
      const TraceChannel* other = actual_.find_channel(channel.topic);
      if (!other || (channel.cells == other->cells && channel.times == other->times)) continue;
      if (channel.type == msg::JointState::type_name) add_limits(channel, *other);
      if (channel.type == msg::Tick::type_name) add_refusals(channel, *other);
    }
    return std::move(sequences_);
  }

 private:
  void add_contacts(const Trace& trace, EdgesOf edges) {
    for (const msg::ContactChange& change : trace.contact_changes()) {
      const std::uint64_t time = change.stamp.to_ns();
      if (time > end_) break;
      const std::string reversed = "contacts/" + change.other + "/" + change.link;  // the scenario's order is another
      const bool is_known = sequences_.count(reversed) > 0;
      EventSequence& sequence = sequences_[is_known ? reversed : "contacts/" + change.link + "/" + change.other];
      if (is_known) {
        (sequence.*edges).push_back({change.tick, time, change.begins});
        continue;
      }
      sequence.source = {EventKind::contact,
                         run_topics::contact_changes,
                         change.link + " " + change.other,
                         "the contact",
                         {std::string(body_of_name(change.link)), std::string(body_of_name(change.other))}};
      (sequence.*edges).push_back({change.tick, time, change.begins});
    }
  }

  /// An older golden states no limits: then those of the run are meant.
  void add_limits(const TraceChannel& golden, const TraceChannel& actual) {
    const mcap::StringMap& stated = limits_in(golden).empty() ? actual.metadata : golden.metadata;
    for (const std::string& element : limits_in(stated)) {
      double lower = 0.0, upper = 0.0;
      const auto now = actual.metadata.find("limits:" + element);
      if (!read_limits(stated.at("limits:" + element), lower, upper)) continue;
      EventSequence sequence;
      const std::string body = ChannelName::parse(golden.topic).body;
      sequence.source = {EventKind::limit, golden.topic, element, "being at its limit", {body}};
      sequence.golden = edges_at(golden, element, lower, upper);
      if (now != actual.metadata.end()) read_limits(now->second, lower, upper);
      sequence.actual = edges_at(actual, element, lower, upper);
      if (!sequence.golden.empty() || !sequence.actual.empty())
        sequences_.emplace("limits/" + body + "/" + element, std::move(sequence));
    }
  }

  static std::vector<std::string> limits_in(const TraceChannel& channel) { return limits_in(channel.metadata); }
  static std::vector<std::string> limits_in(const mcap::StringMap& metadata) {
    constexpr std::string_view key = "limits:";
    std::vector<std::string> elements;
    for (auto at = metadata.lower_bound(std::string(key)); at != metadata.end() && at->first.starts_with(key); ++at)
      elements.push_back(at->first.substr(key.size()));
    return elements;
  }

  static bool read_limits(const std::string& text, double& lower, double& upper) {
    const char* const end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, lower);
    if (first.ec != std::errc() || first.ptr == end) return false;
    const auto second = std::from_chars(first.ptr + 1, end, upper);
    return second.ec == std::errc() && second.ptr == end;
  }

  /// A joint that rests on its stop goes a little to and fro: it has left a limit when it is this far from it, of the
  /// span between the two.
  static constexpr double leaving = 1e-3;

  std::vector<EventEdge> edges_at(const TraceChannel& channel, const std::string& element, double lower,
                                  double upper) const {
    const std::size_t column = column_of(channel, element);
    if (column == channel.columns.size()) return {};
    const double span = upper - lower;
    const double away = std::isfinite(span) ? leaving * span : leaving;
    bool there = false;
    return edges_of(channel, [&, column](std::size_t row) {
      const double value = channel.number(row, column);
      const double from = there ? away : 0.0;
      there = value >= upper - from || value <= lower + from;
      return there;
    });
  }

  void add_refusals(const TraceChannel& golden, const TraceChannel& actual) {
    for (std::size_t column = 0; column < golden.columns.size(); ++column) {
      const std::string& element = golden.columns[column].element;
      const std::size_t other = column_of(actual, element);
      if (!is_result_of_control(golden, element) || other == actual.columns.size()) continue;
      EventSequence sequence;
      sequence.source = {EventKind::refusal, golden.topic, element, "false from control()", {}};
      sequence.golden = refusals(golden_, golden, column);
      sequence.actual = refusals(actual_, actual, other);
      if (!sequence.golden.empty() || !sequence.actual.empty()) sequences_.emplace(element, std::move(sequence));
    }
  }

  /// The message that closes a run has no results.
  std::vector<EventEdge> refusals(const Trace& trace, const TraceChannel& channel, std::size_t column) const {
    const std::size_t rows = channel.rows() - (channel.rows() > 0 && is_closing(trace, channel) ? 1 : 0);
    return edges_of(channel, [&](std::size_t row) { return row < rows && channel.bits(row, column) == 0; });
  }

  static bool is_closing(const Trace& trace, const TraceChannel& channel) {
    const auto outcome = RunFacts::of(trace).outcome;
    const std::size_t column = column_of(channel, "tick");
    if (!outcome || column == channel.columns.size()) return false;
    return outcome->ticks == static_cast<std::int64_t>(channel.bits(channel.rows() - 1, column));
  }

  template <class State>
  std::vector<EventEdge> edges_of(const TraceChannel& channel, State&& state) const {
    const TickClock& clock = &channel == golden_.find_channel(channel.topic) ? golden_clock_ : actual_clock_;
    std::vector<EventEdge> edges;
    bool before = false;
    for (std::size_t row = 0; row < channel.rows() && channel.times[row] <= end_; ++row) {
      const bool now = state(row);
      if (now != before) edges.push_back({clock.tick_at(channel.times[row]), channel.times[row], now});
      before = now;
    }
    return edges;
  }

  const Trace& golden_;
  const Trace& actual_;
  const std::uint64_t end_;
  const TickClock golden_clock_{golden_}, actual_clock_{actual_};
  EventSequences sequences_;
};

}  // namespace

EventSequences event_sequences(const Trace& golden, const Trace& actual, std::uint64_t end) {
  return SequenceMaker(golden, actual, end).make();
}

namespace {

/// Which of the longer sequence's events remain alone: the table of the cheapest way to pair the first s of the shorter
/// one after having left out d of the longer.
class Aligner {
 public:
  Aligner(const std::vector<EventEdge>& shorter, const std::vector<EventEdge>& longer)
      : shorter_(shorter), longer_(longer), left_out_(longer.size() - shorter.size()) {}

  bool fits() const {
    constexpr std::size_t most_cells = 4'000'000;
    return (shorter_.size() + 1) * (left_out_ + 1) <= most_cells;
  }

  /// By event of the longer one, its partner in the shorter one; none: it remains alone.
  std::vector<std::optional<std::size_t>> partners() const {
    const std::size_t width = left_out_ + 1;
    constexpr double unreachable = std::numeric_limits<double>::infinity();
    std::vector<double> cost((shorter_.size() + 1) * width, unreachable);
    const auto at = [&](std::size_t s, std::size_t d) -> double& { return cost[s * width + d]; };
    for (std::size_t s = 0; s <= shorter_.size(); ++s) {
      for (std::size_t d = 0; d < width; ++d) {
        if (s == 0 && d == 0) at(s, d) = 0.0;
        if (d > 0) at(s, d) = std::min(at(s, d), at(s, d - 1));
        if (s > 0) at(s, d) = std::min(at(s, d), at(s - 1, d) + price(s - 1, s - 1 + d));
      }
    }
    std::vector<std::optional<std::size_t>> partners(longer_.size());
    for (std::size_t s = shorter_.size(), d = left_out_; s > 0;) {
      if (at(s, d) == at(s - 1, d) + price(s - 1, s - 1 + d)) {
        --s;
        partners[s + d] = s;
      } else {
        --d;
      }
    }
    return partners;
  }

 private:
  double price(std::size_t s, std::size_t l) const {
    constexpr double unlike = 1e15;  // more than any number of ticks
    return shorter_[s].begins == longer_[l].begins ? static_cast<double>(std::abs(shorter_[s].tick - longer_[l].tick))
                                                   : unlike;
  }

  const std::vector<EventEdge>& shorter_;
  const std::vector<EventEdge>& longer_;
  const std::size_t left_out_;
};

}  // namespace

std::vector<EventPair> align(const std::vector<EventEdge>& golden, const std::vector<EventEdge>& actual) {
  const bool golden_longer = golden.size() > actual.size();
  const auto &longer = golden_longer ? golden : actual, &shorter = golden_longer ? actual : golden;
  std::vector<std::optional<std::size_t>> partners;
  if (const Aligner aligner(shorter, longer); aligner.fits()) {
    partners = aligner.partners();
  } else {  // thousands more in the one than in the other: where they come apart is what counts
    partners.resize(longer.size());
    for (std::size_t i = 0; i < shorter.size(); ++i) partners[i] = i;
  }
  std::vector<EventPair> pairs;
  const auto pair = [&](std::optional<std::size_t> of_longer, std::optional<std::size_t> of_shorter) {
    pairs.push_back(golden_longer ? EventPair{of_longer, of_shorter} : EventPair{of_shorter, of_longer});
  };
  for (std::size_t l = 0; l < longer.size(); ++l) {
    const auto s = partners[l];
    if (s && shorter[*s].begins != longer[l].begins) {  // nothing fits: both are alone
      pair(l, std::nullopt);
      pair(std::nullopt, s);
    } else {
      pair(l, s);
    }
  }
  return pairs;
}

}  // namespace rehearse
