#include "event_sequences.h"

#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "base/hashing.h"
#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"
#include "run_survey.h"
#include "series_rules.h"

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

EventSource source_of_refusals(const std::string& element) {
  return {EventKind::refusal, run_topics::tick, element, "the result false of control()", {}};
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
    if (both_tell && !std::ranges::equal(contacts, others, same)) {
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
      if (actual_.edges.find(channel.topic, column.element)) add(column.element, source_of_refusals(column.element));
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

int default_ticks(EventKind kind) { return kind == EventKind::refusal ? 0 : 1; }

std::string_view verb_of(const EventEdge& edge) { return edge.begins ? "begins" : "ends"; }

namespace {

constexpr double never = std::numeric_limits<double>::infinity();  // distance of an event that only one run has

class SequenceJudge {
 public:
  SequenceJudge(const EventSequence& sequence, int allowed, std::int64_t last_tick)
      : sequence_(sequence), allowed_(allowed), last_tick_(last_tick) {}

  JudgedSequence judge() {
    const std::vector<EventPair> pairs = align(sequence_.golden, sequence_.actual);
    judged_.events = std::ssize(pairs);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const EventPair& pair = pairs[i];
      if (pair.golden && pair.actual) {
        judge_pair(sequence_.golden[*pair.golden], sequence_.actual[*pair.actual]);
      } else if (is_short(pairs, i)) {
        judge_short(edge_of(pair), edge_of(pairs[i + 1]), pair.golden.has_value());
        ++i;
      } else {
        judge_lone(edge_of(pair), pair.golden.has_value());
      }
    }
    return std::move(judged_);
  }

 private:
  const EventEdge& edge_of(const EventPair& pair) const {
    return pair.golden ? sequence_.golden[*pair.golden] : sequence_.actual[*pair.actual];
  }

  /// True for two events that only one trace has, a beginning and an end or the reverse, within the allowed distance.
  bool is_short(const std::vector<EventPair>& pairs, std::size_t i) const {
    if (i + 1 == pairs.size() || (pairs[i + 1].golden && pairs[i + 1].actual)) return false;
    if (pairs[i].golden.has_value() != pairs[i + 1].golden.has_value()) return false;
    return edge_of(pairs[i + 1]).tick - edge_of(pairs[i]).tick <= allowed_;
  }

  void judge_pair(const EventEdge& golden, const EventEdge& actual) {
    if (golden.tick == actual.tick) return;
    const auto off = std::abs(golden.tick - actual.tick);
    tell(golden.tick < actual.tick ? golden : actual, golden.tick, actual.tick, off > allowed_,
         static_cast<double>(off),
         fmt::format("{} {} at tick {}, expected tick {}", sequence_.source.what, verb_of(golden), actual.tick,
                     golden.tick));
    if (off <= allowed_) judged_.apart.push_back(std::minmax({golden.time, actual.time}));
  }

  void judge_short(const EventEdge& begin, const EventEdge& end, bool missing) {
    const auto lasts = end.tick - begin.tick;
    const std::string text = fmt::format("{} {} at tick {} for {} tick{}, which {}", sequence_.source.what,
                                         verb_of(begin), begin.tick, lasts, lasts == 1 ? "" : "s", lacks(missing));
    for (const EventEdge* edge : {&begin, &end}) tell_lone(*edge, missing, false, static_cast<double>(lasts), text);
    judged_.apart.emplace_back(begin.time, end.time);
  }

  void judge_lone(const EventEdge& edge, bool missing) {
    // its partner may come after the end of the compared time
    const bool at_end = last_tick_ - edge.tick < allowed_;
    tell_lone(
        edge, missing, !at_end, never,
        fmt::format("{} {} at tick {}, which {}", sequence_.source.what, verb_of(edge), edge.tick, lacks(missing)));
  }

  static const char* lacks(bool missing) { return missing ? "is missing in this run" : "is not in the golden"; }

  void tell_lone(const EventEdge& edge, bool missing, bool beyond, double off, std::string note) {
    const auto here = std::optional(edge.tick);
    tell(edge, missing ? here : std::nullopt, missing ? std::nullopt : here, beyond, off, std::move(note));
  }

  void tell(const EventEdge& edge, std::optional<std::int64_t> expected, std::optional<std::int64_t> actual,
            bool beyond, double off, std::string note) {
    const EventSource& source = sequence_.source;
    JudgedEvent& event = judged_.differing.emplace_back();
    event.edge = edge;
    event.expected = expected;
    event.actual = actual;
    event.beyond = beyond;
    event.place.tick = edge.tick;
    event.place.time = static_cast<double>(edge.time) / 1e9;
    event.place.channel = source.channel;
    event.place.element = source.element;
    event.place.stage = stage_of(source.channel);
    event.place.difference = off;
    event.place.tolerance = off == never ? 0.0 : allowed_;
    event.place.unit = "ticks";
    event.place.note = std::move(note);
  }

  const EventSequence& sequence_;
  const int allowed_;  // [ticks]
  const std::int64_t last_tick_;
  JudgedSequence judged_;
};

}  // namespace

JudgedSequence judge_sequence(const EventSequence& sequence, int allowed, std::int64_t last_tick) {
  return SequenceJudge(sequence, allowed, last_tick).judge();
}

}  // namespace rehearse
