// Divergences: their values, their order, and their words. Internal.
#pragma once

#include <rehearse/compare.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rehearse {

/// A divergence in words: the text of its place ("tick 3 (0.003 s)"), then channel, element, expected and actual.
/// `with_stage`: false for files without ticks, where the stage has no meaning.
std::string describe(const Divergence& divergence, const std::string& place, bool with_stage);

/// The divergence with everything that is known of it: also relative error and ULPs, however many.
std::string describe_in_full(const Divergence& divergence, const std::string& place);

/// The news of a verdict. For two numbers with a tolerance: "Arm/SHOULDER/q is beyond ±0.001 rad from tick 512 (0.512
/// s) on, worst 0.0136 rad (14 times) at tick 739"; `worst`: of the same channel; none: it isn't known. For any
/// other difference "differs at", then its description.
struct HeadlineWords {
  std::string when;                 // the place in time: "tick 3 (0.003 s)"
  std::string before_beyond = {};   // words before the first form
  std::string before_differs = {};  // words before the second form
  std::string name = {};            // of the first form's series; empty: as in tolerance rules
  bool has_ticks = true;            // false for files without ticks, where the stage has no meaning
};
std::string headline_of(const Divergence& first, const std::optional<Divergence>& worst, const HeadlineWords& words);

/// "only rounding differs: Rig/Mag/magnetic_field/x by 3e-15 T (1 ULP) at tick 12, and no tolerance covers it"; empty
/// if another difference is beyond its tolerance, or is no few ULPs.
std::string rounding_text(const Comparison& comparison);

/// The worst difference of the channel of a divergence.
std::optional<Divergence> worst_of_channel(const Comparison& comparison, const Divergence& of);

/// The name of a time by the names of its seconds and nanoseconds: "header/stamp"; nullopt: they are no time.
std::optional<std::string> name_of_time(std::string_view seconds, std::string_view nanoseconds);
/// [ns]
std::int64_t time_of_parts(std::int64_t seconds, std::uint64_t nanoseconds);
/// Sets the members that two times [ns] determine, in seconds.
void put_times(Divergence& divergence, std::int64_t expected, std::int64_t actual);

/// Up to so many steps between two numbers, exclusive, a difference is one of rounding.
inline constexpr std::uint64_t few_ulps = 1000;

/// "17 ULPs"; empty for a thousand or more, which say nothing to a person.
std::string few_ulps_text(std::uint64_t ulps);

/// "tick 512 (0.512 s)"
std::string when_text(const Divergence& divergence);

/// Order of causes: by tick, then by stage. Equal places keep the order in which they were found.
bool comes_before(const Divergence& a, const Divergence& b);

/// Order of sizes: by multiples of the tolerance; a difference without tolerance is as one at its tolerance.
bool is_worse(const Divergence& a, const Divergence& b);

/// Sets the values of two different cells, and their difference. Integers beyond 2^53, where doubles have gaps, are
/// also stated in the note.
void put_cells(Divergence& divergence, CellKind kind, std::uint64_t expected, std::uint64_t actual);
std::uint64_t distance_of_integers(CellKind kind, std::uint64_t a, std::uint64_t b);
/// The difference that put_numbers() writes: 0 for two NaN.
double difference_between(double expected, double actual);

}  // namespace rehearse
