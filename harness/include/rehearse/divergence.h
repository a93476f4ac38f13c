// Divergence: one place where two runs differ, and by how much.
#pragma once

#include <rehearse/trace.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rehearse {

struct Divergence {
  std::int64_t tick = 0;
  double time = 0.0;      // of the tick [s]
  std::string channel;    // topic
  std::string element;    // within the channel's messages: RLEG_KNEE/u; empty: the message as a whole
  double expected = 0.0;  // in the recording or golden
  double actual = 0.0;
  double difference = 0.0;  // |actual - expected|, by angle where it is one; 0 if both are NaN, NaN if one is
  std::uint64_t ulps = 0;   // representable numbers between them; the largest value if either is NaN
  double tolerance = 0.0;   // that it should have kept; 0: bit for bit
  std::string unit;         // may be empty
  std::string note;         // if it isn't a matter of two numbers: "missing", "120 pixels differ, ..."
  Stage stage = Stage::controller;
};

/// Differences of a run from another one, counted in the order in which they are found.
struct Differences {
  std::int64_t values = 0;  // numbers compared
  std::int64_t values_different = 0;
  std::optional<Divergence> first;
  std::optional<Divergence> worst;   // by absolute difference
  std::optional<Divergence> beyond;  // the first beyond its tolerance, or with a note

  void add(Divergence found);
};

/// Sets expected, actual, difference, ulps and unit: those that two numbers determine.
void put_numbers(Divergence& divergence, double expected, double actual, std::string_view unit = {});

/// The difference relative to what was expected; NaN where that means nothing: angles between orientations, angles
/// modulo a turn, what isn't a matter of two numbers.
double relative_difference(const Divergence& divergence);

/// How many times its tolerance a difference is; infinity where none is allowed.
double times_tolerance(double difference, double tolerance);

/// One sentence: tick, time, channel, element, expected, actual, absolute and relative difference, ULPs, times the
/// tolerance, and stage.
std::string to_string(const Divergence& divergence);

/// An object with all members, and relative and times_tolerance. expected, actual, difference, relative, ulps,
/// tolerance and times_tolerance are null where it isn't a matter of two numbers; NaN and infinities are strings.
std::string to_json(const Divergence& divergence);

/// How many steps from one double to the next lead from a to b; 0 for equal bits and for 0 and -0. NaN with anything
/// but the same bits: the largest value.
std::uint64_t ulps_between(double a, double b);

/// Same bits.
bool identical(double a, double b);

}  // namespace rehearse
