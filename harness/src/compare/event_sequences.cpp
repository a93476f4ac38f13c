#include "event_sequences.h"

#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "compare_parts.h"
#include "run_survey.h"
#include "trace/hashing.h"

namespace rehearse {
namespace {

constexpr std::string_view limits_key = "limits:";

std::vector<std::string> limits_in(const mcap::StringMap& metadata) {
  std::vector<std::string> elements;
  for (auto at = metadata.lower_bound(std::string(limits_key));
       at != metadata.end() && at->first.starts_with(limits_key); ++at)
    elements.push_back(at->first.substr(limits_key.size()));
  return elements;
}

bool read_limits(const std::string& text, double& lower, double& upper) {
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, lower);
  if (first.ec != std::errc() || first.ptr == end) return false;
  const auto second = std::from_chars(first.ptr + 1, end, upper);
  return second.ec == std::errc() && second.ptr == end;
}

}  // namespace

WatchedLimits::WatchedLimits(const Trace& golden_run, const Trace& actual_run) {
  for (const TraceChannel& channel : golden_run.channels()) {
    const TraceChannel* other = actual_run.find_channel(channel.topic);
    if (channel.type != msg::JointState::type_name || !other) continue;
    const mcap::StringMap& stated = limits_in(channel.metadata).empty() ? other->metadata : channel.metadata;
    for (const std::string& element : limits_in(stated)) {
      WatchedLimit limit{channel.topic, element};
      const std::string key = std::string(limits_key) + element;
      if (!read_limits(stated.at(key), limit.lower, limit.upper)) continue;
      golden.push_back(limit);
      const auto now = other->metadata.find(key);
      if (now != other->metadata.end()) read_limits(now->second, limit.lower, limit.upper);
      actual.push_back(std::move(limit));
    }
  }
}

void EdgeFinder::take(const Trace& piece) {
  if (!closing_tick_) {
    const auto outcome = RunFacts::of(piece).outcome;
    closing_tick_.emplace(outcome ? outcome->ticks : std::nullopt);
  }
  for (const TraceChannel& channel : piece.channels()) {
    const bool is_tick = channel.type == msg::Tick::type_name;
    if ((!is_tick && channel.type != msg::JointState::type_name) || piece.find_channel(channel.topic) != &channel)
      continue;
    std::uint64_t& hash = hashes_[channel.topic];
    for (std::size_t row = 0; row < channel.rows(); ++row)
      hash = hash_bytes(channel.row(row), channel.columns.size() * sizeof(std::uint64_t), hash ^ channel.times[row]);
    if (is_tick)
      take_refusals(channel);
    else
      take_limits(channel);
  }
}

void EdgeFinder::take_limits(const TraceChannel& channel) {
  // A joint at its stop oscillates a little. It has left a limit at this distance from it, relative to the span between
  // both limits.
  constexpr double leaving = 1e-3;
  for (const WatchedLimit& limit : limits_) {
    if (limit.topic != channel.topic) continue;
    const std::size_t column = column_of(channel, limit.element);
    if (column == channel.columns.size()) continue;
    const double span = limit.upper - limit.lower;
    const double away = std::isfinite(span) ? leaving * span : leaving;
    Watched& watched = watched_[{limit.topic, limit.element}];
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      const double value = channel.number(row, column);
      const double from = watched.there ? away : 0.0;
      const bool now = value >= limit.upper - from || value <= limit.lower + from;
      if (now != watched.there) watched.edges.push_back({0, channel.times[row], now});
      watched.there = now;
    }
  }
}

/// The message that closes a run contains no results of control().
void EdgeFinder::take_refusals(const TraceChannel& channel) {
  const std::size_t tick = column_of(channel, "tick");
  const auto closes = [&](std::size_t row) {
    return *closing_tick_ && tick < channel.columns.size() &&
           **closing_tick_ == static_cast<std::int64_t>(channel.bits(row, tick));
  };
  for (std::size_t column = 0; column < channel.columns.size(); ++column) {
    const std::string& element = channel.columns[column].element;
    if (!is_result_of_control(channel, element)) continue;
    Watched& watched = watched_[{channel.topic, element}];
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      const bool now = channel.bits(row, column) == 0 && !closes(row);
      if (now != watched.there) watched.edges.push_back({0, channel.times[row], now});
      watched.there = now;
    }
  }
}

const std::vector<EventEdge>* EdgeFinder::find(const std::string& topic, const std::string& element) const {
  const auto found = watched_.find({topic, element});
  return found == watched_.end() ? nullptr : &found->second.edges;
}

std::uint64_t EdgeFinder::hash_of(const std::string& topic) const {
  const auto found = hashes_.find(topic);
  return found == hashes_.end() ? 0 : found->second;
}

namespace {

using EdgesOf = std::vector<EventEdge> EventSequence::*;

class SequenceMaker {
 public:
  SequenceMaker(const RunSurvey& golden, const RunSurvey& actual, std::uint64_t end)
      : golden_(golden), actual_(actual), end_(end) {}

  EventSequences make() {
    const auto same = [](const msg::ContactChange& a, const msg::ContactChange& b) {
      return a.tick == b.tick && a.begins == b.begins && a.link == b.link && a.other == b.other;
    };
    const auto &contacts = golden_.whole().contact_changes(), &others = actual_.whole().contact_changes();
    const bool both_tell = golden_.whole().find_channel(run_topics::contact_changes) &&
                           actual_.whole().find_channel(run_topics::contact_changes);
    if (both_tell && !std::equal(contacts.begin(), contacts.end(), others.begin(), others.end(), same)) {
      add_contacts(contacts, &EventSequence::golden);
      add_contacts(others, &EventSequence::actual);
    }
    for (const TraceChannel& channel : golden_.whole().channels()) {
      if (golden_.edges.hash_of(channel.topic) == actual_.edges.hash_of(channel.topic)) continue;
      if (channel.type == msg::JointState::type_name) add_limits(channel);
      if (channel.type == msg::Tick::type_name) add_refusals(channel);
    }
    return std::move(sequences_);
  }

 private:
  void add_contacts(const std::vector<msg::ContactChange>& changes, EdgesOf edges) {
    for (const msg::ContactChange& change : changes) {
      const std::uint64_t time = change.stamp.to_ns();
      if (time > end_) break;
      const std::string reversed = "contacts/" + change.other + "/" + change.link;  // of a different order of bodies
      const bool is_known = sequences_.count(reversed) > 0;
      EventSequence& sequence = sequences_[is_known ? reversed : "contacts/" + change.link + "/" + change.other];
      if (!is_known)
        sequence.source = {EventKind::contact,
                           run_topics::contact_changes,
                           change.link + " " + change.other,
                           "the contact",
                           {std::string(body_of_name(change.link)), std::string(body_of_name(change.other))}};
      (sequence.*edges).push_back({change.tick, time, change.begins});
    }
  }

  void add_limits(const TraceChannel& channel) {
    const std::string body = ChannelName::parse(channel.topic).body;
    for (const WatchedLimit& limit : golden_.edges.limits()) {
      if (limit.topic == channel.topic)
        add("limits/" + body + "/" + limit.element,
            {EventKind::limit, channel.topic, limit.element, "the stop at the limit", {body}});
    }
  }

  void add_refusals(const TraceChannel& channel) {
    for (const TraceColumn& column : channel.columns) {
      if (!is_result_of_control(channel, column.element)) continue;
      if (actual_.edges.find(channel.topic, column.element))
        add(column.element, {EventKind::refusal, channel.topic, column.element, "the result false of control()", {}});
    }
  }

  void add(const std::string& name, EventSource source) {
    EventSequence sequence;
    sequence.golden = edges_in(golden_, source);
    sequence.actual = edges_in(actual_, source);
    sequence.source = std::move(source);
    if (!sequence.golden.empty() || !sequence.actual.empty()) sequences_.emplace(name, std::move(sequence));
  }

  std::vector<EventEdge> edges_in(const RunSurvey& run, const EventSource& source) const {
    std::vector<EventEdge> edges;
    const std::vector<EventEdge>* found = run.edges.find(source.channel, source.element);
    if (!found) return edges;
    for (const EventEdge& edge : *found)
      if (edge.time <= end_) edges.push_back({run.clock.tick_at(edge.time), edge.time, edge.begins});
    return edges;
  }

  const RunSurvey& golden_;
  const RunSurvey& actual_;
  const std::uint64_t end_;
  EventSequences sequences_;
};

}  // namespace

EventSequences event_sequences(const RunSurvey& golden, const RunSurvey& actual, std::uint64_t end) {
  return SequenceMaker(golden, actual, end).make();
}

namespace {

/// Finds the events of the longer sequence that remain alone, with a table of costs: the lowest cost of pairing the
/// first s events of the shorter sequence if d events of the longer one are left out before.
class Aligner {
 public:
  Aligner(const std::vector<EventEdge>& shorter, const std::vector<EventEdge>& longer)
      : shorter_(shorter), longer_(longer), left_out_(longer.size() - shorter.size()) {}

  bool fits() const {
    constexpr std::size_t most_cells = 4'000'000;
    return (shorter_.size() + 1) * (left_out_ + 1) <= most_cells;
  }

  /// By event of the longer sequence: its partner in the shorter one; none: it remains alone.
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
  } else {  // one has thousands more than the other: only their first difference matters
    partners.resize(longer.size());
    for (std::size_t i = 0; i < shorter.size(); ++i) partners[i] = i;
  }
  std::vector<EventPair> pairs;
  const auto pair = [&](std::optional<std::size_t> of_longer, std::optional<std::size_t> of_shorter) {
    pairs.push_back(golden_longer ? EventPair{of_longer, of_shorter} : EventPair{of_shorter, of_longer});
  };
  for (std::size_t l = 0; l < longer.size(); ++l) {
    const auto s = partners[l];
    if (s && shorter[*s].begins != longer[l].begins) {  // no possible pair: both remain alone
      pair(l, std::nullopt);
      pair(std::nullopt, s);
    } else {
      pair(l, s);
    }
  }
  return pairs;
}

}  // namespace rehearse
