// Sequences of events: what begins and ends in a run, by tick, and two of them put beside each other. Internal.
#pragma once

#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// Something begins, or what had begun ends.
struct EventEdge {
  std::int64_t tick = 0;
  std::uint64_t time = 0;  // [ns]
  bool begins = false;
};

enum class EventKind {
  contact,  // two links touch
  limit,    // a joint is at a limit that the simulation keeps it to
  refusal,  // control() returns false
};

/// Where the events of a sequence stand in a trace, and what they are about.
struct EventSource {
  EventKind kind = EventKind::contact;
  std::string channel;              // topic
  std::string element;              // within the channel
  std::string what;                 // for a person: "the contact"
  std::vector<std::string> bodies;  // whose numbers an event changes
};

struct EventSequence {
  EventSource source;
  std::vector<EventEdge> golden, actual;  // in the order of time
};

/// By the name that rules know it by: contacts/LINK/OTHER, limits/Body/JOINT/u, controller_results/0.
using EventSequences = std::map<std::string, EventSequence>;

/// A joint's element that is kept between two numbers, in its unit.
struct WatchedLimit {
  std::string topic;
  std::string element;
  double lower = 0.0;
  double upper = 0.0;
};

/// The limits that two traces state of the joints of both. An older golden states none: then those of the run are
/// meant.
struct WatchedLimits {
  WatchedLimits(const Trace& golden, const Trace& actual);
  std::vector<WatchedLimit> golden, actual;
};

/// Finds where joints are at their limits and where controllers refuse, in the pieces of a run.
class EdgeFinder {
 public:
  explicit EdgeFinder(std::vector<WatchedLimit> limits) : limits_(std::move(limits)) {}
  void take(const Trace& piece);

  const std::vector<WatchedLimit>& limits() const { return limits_; }
  /// Beginnings and ends, without their ticks. Null: there is nothing to watch.
  const std::vector<EventEdge>* find(const std::string& topic, const std::string& element) const;
  /// Of the times and numbers of a topic that can have such events.
  std::uint64_t hash_of(const std::string& topic) const;

 private:
  struct Watched {
    std::vector<EventEdge> edges;
    bool there = false;
  };
  void take_limits(const TraceChannel& channel);
  void take_refusals(const TraceChannel& channel);

  const std::vector<WatchedLimit> limits_;
  std::map<std::pair<std::string, std::string>, Watched> watched_;  // by topic and element
  std::map<std::string, std::uint64_t> hashes_;                     // by topic
  std::optional<std::optional<std::int64_t>> closing_tick_;  // of the message that closes the run, as it states it
};

struct RunSurvey;

/// Contacts, limits and refusals of both runs, up to a time [ns]. Those that follow from channels of the same numbers
/// are left out.
EventSequences event_sequences(const RunSurvey& golden, const RunSurvey& actual, std::uint64_t end);

/// Indices into two sequences; none: the other has nothing for it.
struct EventPair {
  std::optional<std::size_t> golden, actual;
};

/// The two sequences beside each other: as few as possible remain alone, and then the pairs are as near in time as
/// possible. A beginning is never paired with an end.
std::vector<EventPair> align(const std::vector<EventEdge>& golden, const std::vector<EventEdge>& actual);

}  // namespace rehearse
