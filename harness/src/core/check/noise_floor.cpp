// Remarks on tolerances, estimated horizons and noise of series, from a noise floor.
#include "noise_floor.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "base/hashing.h"
#include "core/compare/compare_provenance.h"
#include "core/compare/series_rules.h"
#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

constexpr double estimated_share = 0.8;  // of a measured horizon

struct Doubt {
  std::string where;
  double tolerance = 0.0;
  double noise = 0.0;
  double badness = 0.0;
  int count = 0;
};

/// Keeps the channel with the largest `badness`.
void keep_worst(Doubt& doubt, const ChannelNoise& of, double tolerance, double noise, double badness) {
  if (++doubt.count > 1 && badness <= doubt.badness) return;
  doubt.badness = badness;
  doubt.where = fmt::format("{} [{}]", of.channel, of.unit);
  doubt.tolerance = tolerance;
  doubt.noise = noise;
}

/// The tightest tolerance of each unit of each channel, as the comparisons applied them.
std::map<std::pair<std::string, std::string>, double> tolerances_in(const std::vector<const Comparison*>& comparisons) {
  std::map<std::pair<std::string, std::string>, double> tightest;
  const auto take = [&](const std::vector<ChannelComparison>& channels) {
    for (const ChannelComparison& channel : channels)
      for (const SeriesComparison& series : channel.series) {
        const auto [place, is_new] = tightest.emplace(std::pair(channel.channel, series.unit), series.tolerance);
        if (!is_new) place->second = std::min(place->second, series.tolerance);
      }
  };
  for (const Comparison* comparison : comparisons) {
    take(comparison->channels);
    take(comparison->same);
  }
  return tightest;
}

void compare_provenance(const NoiseFloor& noise, const Trace& golden, std::vector<std::string>& remarks) {
  constexpr const char* again = "measure it again: rehearse golden noise";
  const auto provenance = RunFacts::of(golden).provenance;
  for (const char* fact : {facts::rehearse, facts::physics, facts::libc, facts::renderer}) {
    const auto measured = noise.made_with.find(fact);
    if (!provenance || measured == noise.made_with.end()) continue;
    const auto recorded = provenance->find(fact);
    if (recorded != provenance->end() && recorded->second != measured->second)
      remarks.push_back(fmt::format("the noise was measured with {} \"{}\", the golden recorded with \"{}\"; {}", fact,
                                    measured->second, recorded->second, again));
  }
  if (noise.recording != hash_of_recording(golden))
    remarks.push_back(fmt::format("the noise was measured for a different recording than this golden; {}", again));
}

}  // namespace

std::optional<double> NoiseFloor::horizon() const {
  std::optional<double> earliest;
  for (const Perturbation& perturbation : perturbations)
    if (perturbation.horizon && (!earliest || *perturbation.horizon < *earliest)) earliest = perturbation.horizon;
  return earliest;
}

double NoiseFloor::of_unit(const std::string& unit) const {
  double largest = std::numeric_limits<double>::epsilon();
  for (const ChannelNoise& noise : channels)
    if (noise.unit == unit) largest = std::max({largest, noise.controller.value_or(0.0), noise.plant.value_or(0.0)});
  return largest;
}

std::string hash_of_recording(const Trace& trace) {
  std::uint64_t hash = 0;
  for (const TraceChannel& channel : trace.channels()) {
    hash = hash_bytes(channel.topic.data(), channel.topic.size(), hash);
    hash = hash_bytes(channel.times.data(), channel.times.size() * sizeof(std::uint64_t), hash);
    hash = hash_bytes(channel.cells.data(), channel.cells.size() * sizeof(std::uint64_t), hash);
  }
  return hash_text(hash);
}

std::map<std::string, double, std::less<>> noise_of_series(const NoiseFloor& noise, const Trace& golden) {
  std::map<std::string, double, std::less<>> floors;
  if (noise.recording != hash_of_recording(golden)) return floors;
  std::map<std::pair<std::string, std::string>, double> by_unit;
  for (const ChannelNoise& channel : noise.channels)
    by_unit[{channel.channel, channel.unit}] = std::max(channel.controller.value_or(0.0), channel.plant.value_or(0.0));
  for (const TraceChannel& channel : golden.channels()) {
    for (const TraceColumn& column : channel.columns) {
      const std::string unit = unit_of(channel.metadata, column.element);
      const auto known = by_unit.find({channel.topic, unit == "quaternion" ? "rad" : unit});
      if (known != by_unit.end()) floors.emplace(series_of(channel, column), known->second);
    }
  }
  return floors;
}

std::optional<double> estimated_horizon(const Trace& golden) {
  const auto noise = load_noise_floor(noise_file_of(golden.file()));
  if (!noise || noise->recording != hash_of_recording(golden)) return std::nullopt;
  const std::optional<double> left = noise->horizon();
  return left ? std::optional(estimated_share * *left) : std::nullopt;
}

std::vector<std::string> noise_remarks(const NoiseFloor& noise, const Trace& golden,
                                       const std::vector<const Comparison*>& comparisons, double doubtful) {
  std::vector<std::string> remarks;
  compare_provenance(noise, golden, remarks);
  const auto tolerances = tolerances_in(comparisons);
  Doubt below, above;
  for (const ChannelNoise& channel : noise.channels) {
    const auto found = tolerances.find({channel.channel, channel.unit});
    if (found == tolerances.end() || channel.unit == "of 255") continue;  // the share of pixels is judged
    const double tolerance = found->second;
    const double measured = std::max(channel.controller.value_or(0.0), channel.plant.value_or(0.0));
    const double floor = noise.of_unit(channel.unit);
    if (measured > tolerance) keep_worst(below, channel, tolerance, measured, measured / tolerance);
    const bool loosened = tolerance > default_tolerance(channel.unit).atol;  // a default isn't doubted
    if (channel.unit != "of pixels" && loosened && tolerance > doubtful * floor)
      keep_worst(above, channel, tolerance, floor, tolerance / floor);
  }
  if (below.count > 0)
    remarks.push_back(fmt::format("{} {} below the measured noise, the most in {}: {:g} is allowed, {:.3g} is noise",
                                  below.count, below.count == 1 ? "tolerance lies" : "tolerances lie", below.where,
                                  below.tolerance, below.noise));
  if (above.count > 0)
    remarks.push_back(
        fmt::format("{} {} more than {:g} times above the measured noise, the most in {}: {:g} is allowed, "
                    "{:.3g} is the noise of its unit",
                    above.count, above.count == 1 ? "tolerance lies" : "tolerances lie", doubtful, above.where,
                    above.tolerance, above.noise));
  return remarks;
}

}  // namespace rehearse
