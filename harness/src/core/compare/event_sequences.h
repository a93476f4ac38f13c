// Sequences of events, which begin and end in a run, by tick, and the alignment of two sequences. Internal.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse {

/// The beginning or the end of an event.
struct EventEdge {
  std::int64_t tick = 0;
  std::uint64_t time = 0;  // [ns]
  bool begins = false;
};

enum class EventKind {
  contact,  // two links touch
  limit,    // a joint is at a limit that the simulation enforces
  refusal,  // control() returns false
};

/// The place of a sequence's events in a trace, and the bodies that they affect.
struct EventSource {
  EventKind kind = EventKind::contact;
  std::string channel;              // topic
  std::string element;              // within the channel
  std::string what;                 // for a person: "the contact"
  std::vector<std::string> bodies;  // bodies whose numbers an event changes
};

/// The results of control(), by their element in /tick.
EventSource source_of_refusals(const std::string& element);
/// How early or late an event may be without a rule [ticks].
int default_ticks(EventKind kind);

struct EventSequence {
  EventSource source;
  std::vector<EventEdge> golden, actual;  // in the order of time
};

/// By the name of the sequence in tolerance rules: contacts/LINK/OTHER, limits/Body/JOINT/u, controller_results/0.
using EventSequences = std::map<std::string, EventSequence>;

/// A joint's element that the simulation keeps between two limits, in its unit.
struct WatchedLimit {
  std::string topic;
  std::string element;
  double lower = 0.0;
  double upper = 0.0;
};

/// The limits that two traces state for the joints of both. An older golden states none; then the limits of the run
/// apply to both.
struct WatchedLimits {
  WatchedLimits(const Trace& golden, const Trace& actual);
  std::vector<WatchedLimit> golden, actual;
};

/// Finds the times at which joints are at their limits or controllers refuse, in the pieces of a run.
class EdgeFinder {
 public:
  explicit EdgeFinder(std::vector<WatchedLimit> limits) : limits_(std::move(limits)) {}
  void take(const Trace& piece);

  const std::vector<WatchedLimit>& limits() const { return limits_; }
  /// Beginnings and ends, without their ticks. Null: the element isn't watched.
  const std::vector<EventEdge>* find(const std::string& topic, const std::string& element) const;
  /// The hash of the times and numbers of a topic that can have these events.
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
  std::optional<std::optional<std::int64_t>> closing_tick_;  // tick of the message that closes the run, if stated
};

struct RunSurvey;

/// Contacts, limits and refusals of both runs, up to a time [ns]. Events on channels with equal numbers are left out.
EventSequences event_sequences(const RunSurvey& golden, const RunSurvey& actual, std::uint64_t end);

/// Indices into two sequences; none: that sequence has no partner for the event.
struct EventPair {
  std::optional<std::size_t> golden, actual;
};

/// Pairs the events of two sequences: as few as possible remain alone, and the pairs are as near in time as possible. A
/// beginning is never paired with an end.
std::vector<EventPair> align(const std::vector<EventEdge>& golden, const std::vector<EventEdge>& actual);

/// "begins" or "ends".
std::string_view verb_of(const EventEdge& edge);

/// An event that is early, late, missing or extra.
struct JudgedEvent {
  EventEdge edge;                        // the earlier one of two
  std::optional<std::int64_t> expected;  // tick in the golden; none: it is extra
  std::optional<std::int64_t> actual;    // tick in the run; none: it is missing
  bool beyond = false;                   // the difference is larger than allowed
  Divergence place;                      // its difference and its tolerance are in ticks
};

struct JudgedSequence {
  std::int64_t events = 0;  // number of pairs, and of events without a partner
  std::vector<JudgedEvent> differing;
  /// The spans between the two times of events that are off by no more than is allowed [ns].
  std::vector<std::pair<std::uint64_t, std::uint64_t>> apart;
};

/// Compares the events of two runs. `allowed`: how early or late an event may be [ticks]; an event that lasts no longer
/// may also be missing or extra. `last_tick`: of both runs; the partner of an event just before it may come later.
JudgedSequence judge_sequence(const EventSequence& sequence, int allowed, std::int64_t last_tick);

}  // namespace rehearse
