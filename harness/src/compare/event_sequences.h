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

/// Contacts, limits and refusals of both traces, up to a time [ns]. Those that follow from channels of the same bits
/// are left out.
EventSequences event_sequences(const Trace& golden, const Trace& actual, std::uint64_t end);

/// Indices into two sequences; none: the other has nothing for it.
struct EventPair {
  std::optional<std::size_t> golden, actual;
};

/// The two sequences beside each other: as few as possible remain alone, and then the pairs are as near in time as
/// possible. A beginning is never paired with an end.
std::vector<EventPair> align(const std::vector<EventEdge>& golden, const std::vector<EventEdge>& actual);

}  // namespace rehearse
