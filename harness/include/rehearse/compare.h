// Comparison: two traces of what should be the same run, value by value; what differs, where first, and by how much.
//
// Three answers at once. `equal`: every number, picture and event has the same bits. `within`: everything passes its
// tolerance (tolerance.h). And the places: the first beyond tolerance, the first where bits differ, the worst.
//
// Messages of a channel are matched by their time, tables by the names of their elements. What one trace has and the
// other lacks (ticks, channels, messages, elements) is a finding with its place. The hashes in /tick are no quantities:
// they say whether bits are equal and from which tick on they aren't, and fail nothing. Integers, booleans and events
// are exact. NaN equals NaN of the same tick; -0 and 0 are other bits and the same number. An orientation is compared
// by the angle between the two, 2 atan2(|v|, |w|) of q_golden^-1 q_actual = (v, w), so q and -q are the same; an angle
// whose channel says `wrap:<element>` in its metadata is compared modulo one turn.
//
// "First" is by tick; within one tick in the order in which things cause each other there: the state of the bodies,
// what sensors measure of it, the pictures that arrive, the inputs that are copied from these, the commands made from
// the inputs.
#pragma once

#include <rehearse/divergence.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// What became of one channel.
struct ChannelComparison {
  std::string channel;  // topic
  Stage stage = Stage::physics;
  std::int64_t values = 0;              // compared: numbers, or pictures
  std::int64_t differing = 0;           // of them, not the same bits
  std::int64_t beyond = 0;              // of them, beyond tolerance
  std::int64_t missing = 0;             // messages of the golden that the other trace hasn't
  std::int64_t extra = 0;               // messages that the golden hasn't
  std::optional<Divergence> first;      // beyond tolerance, or missing
  std::optional<Divergence> first_bit;  // in any bit, or missing
  std::optional<Divergence> worst;      // by times its tolerance, then by difference
};

struct Comparison {
  bool equal = false;                       // bit for bit
  bool within = false;                      // nothing beyond tolerance, nothing missing, nothing extra; true if equal
  std::int64_t ticks = 0;                   // compared
  std::int64_t values = 0;                  // numbers and pictures compared
  std::int64_t pictures = 0;                // of these
  std::int64_t differing = 0;               // of the values, not the same bits
  std::int64_t beyond = 0;                  // of the values, beyond tolerance
  std::optional<Divergence> first;          // beyond tolerance, or missing
  std::optional<Divergence> first_bit;      // in any bit, hashes included
  std::optional<Divergence> worst;          // by times its tolerance, then by difference
  std::vector<ChannelComparison> channels;  // all that differ in any way, by their first_bit
  std::vector<std::string> changed_files;  // attachments that are not what they were in the golden
  bool same_arithmetic = true;  // versions and pins that bits depend on are the golden's
  /// What explains a difference or makes one likely: another scenario, model, controller, library. Sentences.
  std::vector<std::string> remarks;
};

/// What of two traces is compared.
struct CompareOptions {
  /// Values that these parts of the loop make; the channels of the others are left out altogether. Empty: all.
  std::vector<Stage> stages;
  /// Messages up to this time, inclusive [s]; none: as long as both runs go. A run that is shorter is a finding all the
  /// same, unless both reach this time.
  std::optional<double> until;

  bool takes(Stage stage) const;
};

Comparison compare(const Trace& golden, const Trace& actual, const std::vector<ToleranceRule>& rules,
                   const CompareOptions& options = {});

/// Which part of the loop makes the values of a topic, by its name. The hashes and results in /tick have each their own.
Stage stage_of(std::string_view topic, std::string_view element = {});

/// The tolerances of the scenario that the trace carries; none if it carries none.
Result<std::vector<ToleranceRule>> tolerances_of(const Trace& trace);

/// One sentence, without a full stop.
std::string verdict(const Comparison& comparison);

/// The channels that differ, worst and first of each, and the remarks: at most twelve lines, each with its newline;
/// empty if the traces are equal.
std::string table(const Comparison& comparison);

/// An object with verdict, equal, within and first: null, or an object with tick, time, channel, element, expected,
/// actual, ulps and stage, null where it isn't a matter of two numbers. NaN and infinities are strings.
std::string to_json(const Comparison& comparison);

}  // namespace rehearse
