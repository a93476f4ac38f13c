// The noise floor as a file, and what it says of tolerances.
#include <fmt/format.h>
#include <rehearse/noise_floor.h>
#include <yaml-cpp/emitter.h>

#include <algorithm>
#include <limits>
#include <map>

#include "compare_parts.h"
#include "golden_files.h"
#include "hashing.h"
#include "scenario_values.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr int file_version = 1;
constexpr double estimated_share = 0.8;  // of a measured horizon
constexpr Range any_difference{0.0, 1e300};
constexpr Range any_time{0.0, 1e9, "[s]"};

/// Three digits: more of them mean nothing, and would make every measurement another file.
std::string short_text(double number) { return fmt::format("{:.3g}", number); }

void emit_perturbation(YAML::Emitter& out, const Perturbation& perturbation) {
  out << YAML::Flow << YAML::BeginMap << YAML::Key << "name" << YAML::Value << perturbation.name;
  if (!perturbation.not_made.empty()) {
    out << YAML::Key << "not_made" << YAML::Value << perturbation.not_made << YAML::EndMap;
    return;
  }
  out << YAML::Key << "levels" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  if (perturbation.controller) out << "controller";
  if (perturbation.plant) out << "plant";
  if (perturbation.closed) out << "closed";
  out << YAML::EndSeq;
  if (perturbation.horizon) out << YAML::Key << "horizon" << YAML::Value << fmt::format("{:.6g}", *perturbation.horizon);
  out << YAML::EndMap;
}

void emit_channel(YAML::Emitter& out, const ChannelNoise& noise) {
  out << YAML::Flow << YAML::BeginMap << YAML::Key << "channel" << YAML::Value << noise.channel;
  out << YAML::Key << "unit" << YAML::Value << noise.unit;
  if (noise.controller) out << YAML::Key << "controller" << YAML::Value << short_text(*noise.controller);
  if (noise.plant) out << YAML::Key << "plant" << YAML::Value << short_text(*noise.plant);
  out << YAML::Key << "tolerance" << YAML::Value << fmt::format("{:g}", noise.tolerance) << YAML::EndMap;
}

void read_levels(Findings& findings, const YamlNode& list, Perturbation& perturbation) {
  const std::vector<YamlNodePtr>* levels = read_list(findings, list, "'levels'", "a list of controller, plant, closed");
  if (!levels) return;
  for (const YamlNodePtr& level : *levels) {
    if (level->text == "controller") perturbation.controller = true;
    else if (level->text == "plant") perturbation.plant = true;
    else if (level->text == "closed") perturbation.closed = true;
    else expected(findings, *level, "a level", "controller, plant or closed");
  }
}

Perturbation read_perturbation(Findings& findings, const YamlNode& node) {
  Perturbation perturbation;
  const Keys keys(findings, node, "a perturbation", {"name", "not_made", "levels", "horizon"});
  keys.require("name", "what was done");
  keys.text("name", perturbation.name);
  keys.text("not_made", perturbation.not_made);
  keys.number("horizon", any_time, perturbation.horizon);
  if (const YamlNode* levels = keys.find("levels")) read_levels(findings, *levels, perturbation);
  return perturbation;
}

ChannelNoise read_channel(Findings& findings, const YamlNode& node) {
  ChannelNoise noise;
  const Keys keys(findings, node, "a channel's noise", {"channel", "unit", "controller", "plant", "tolerance"});
  keys.require("channel", "a topic");
  keys.require("tolerance", "the tightest that was in force");
  keys.text("channel", noise.channel);
  keys.text("unit", noise.unit);
  keys.number("controller", any_difference, noise.controller);
  keys.number("plant", any_difference, noise.plant);
  keys.number("tolerance", any_difference, noise.tolerance);
  return noise;
}

void read_file(Findings& findings, const YamlNode& root, NoiseFloor& noise) {
  const Keys keys(findings, root, "a noise file",
                  {"noise", "scenario", "recording", "duration", "made_with", "perturbations", "growth", "channels"});
  if (!keys.is_map()) return;
  int version = file_version;
  if (keys.require("noise", "the version of the file's form, 1")) keys.integer("noise", 1, file_version, version);
  keys.require("recording", "the hash of the recording that it was measured around");
  keys.text("scenario", noise.scenario);
  keys.text("recording", noise.recording);
  keys.number("duration", any_time, noise.duration);
  keys.number("growth", any_difference, noise.growth);
  if (const YamlNode* facts = keys.find("made_with"))
    for (const NamedEntry& fact : read_entries(findings, *facts)) noise.made_with[fact.name] = fact.value->text;
  const auto each = [&](const char* key, const char* what, auto&& read) {
    const YamlNode* node = keys.require(key, what);
    const std::vector<YamlNodePtr>* items = node ? read_list(findings, *node, fmt::format("'{}'", key), what) : nullptr;
    if (items)
      for (const YamlNodePtr& item : *items) read(*item);
  };
  each("perturbations", "a list of what was done",
       [&](const YamlNode& node) { noise.perturbations.push_back(read_perturbation(findings, node)); });
  each("channels", "a list of channels with their noise",
       [&](const YamlNode& node) { noise.channels.push_back(read_channel(findings, node)); });
}

struct Doubt {
  std::string where;
  double tolerance = 0.0;
  double noise = 0.0;
  double badness = 0.0;
  int count = 0;
};

/// `badness` is larger where the doubt is.
void keep_worst(Doubt& doubt, const ChannelNoise& of, double tolerance, double noise, double badness) {
  if (++doubt.count > 1 && badness <= doubt.badness) return;
  doubt.badness = badness;
  doubt.where = fmt::format("{} [{}]", of.channel, of.unit);
  doubt.tolerance = tolerance;
  doubt.noise = noise;
}

/// The tightest tolerance of each channel's units, as the comparisons found them.
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
  const mcap::StringMap* facts = golden.find_metadata("rehearse");
  for (const char* fact : {"rehearse", "physics", "libc", "renderer"}) {
    const auto measured = noise.made_with.find(fact);
    if (!facts || measured == noise.made_with.end()) continue;
    const auto recorded = facts->find(fact);
    if (recorded != facts->end() && recorded->second != measured->second)
      remarks.push_back(fmt::format("the noise was measured with {} \"{}\", the golden recorded with \"{}\"; {}", fact,
                                    measured->second, recorded->second, again));
  }
  if (noise.recording != hash_of_recording(golden))
    remarks.push_back(fmt::format("the noise was measured around another recording than this golden; {}", again));
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

fs::path noise_file_of(const fs::path& golden) { return fs::path(golden).replace_extension(".noise"); }

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
      const std::string unit = unit_of(channel, column.element);
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

std::string to_yaml(const NoiseFloor& noise) {
  YAML::Emitter out;
  out << YAML::Comment("Measured by `rehearse golden noise`; not to be edited. Largest differences under the perturbations;") << YAML::Newline;
  out << YAML::Comment("horizons [s], growth per second: in the closed loop.") << YAML::Newline;
  out << YAML::BeginMap << YAML::Key << "noise" << YAML::Value << file_version;
  out << YAML::Key << "scenario" << YAML::Value << noise.scenario;
  out << YAML::Key << "recording" << YAML::Value << YAML::DoubleQuoted << noise.recording;
  out << YAML::Key << "duration" << YAML::Value << fmt::format("{}", noise.duration);
  out << YAML::Key << "made_with" << YAML::Value << YAML::BeginMap;
  for (const auto& [fact, value] : noise.made_with) out << YAML::Key << fact << YAML::Value << value;
  out << YAML::EndMap << YAML::Key << "perturbations" << YAML::Value << YAML::BeginSeq;
  for (const Perturbation& perturbation : noise.perturbations) emit_perturbation(out, perturbation);
  out << YAML::EndSeq;
  if (noise.growth) out << YAML::Key << "growth" << YAML::Value << short_text(*noise.growth);
  out << YAML::Key << "channels" << YAML::Value << YAML::BeginSeq;
  for (const ChannelNoise& channel : noise.channels) emit_channel(out, channel);
  out << YAML::EndSeq << YAML::EndMap;
  REHEARSE_ASSERT(out.good(), "what is emitted is YAML");
  return std::string(out.c_str(), out.size()) + "\n";
}

Result<void> write_noise_floor(const NoiseFloor& noise, const fs::path& file) {
  return replace_text(file, to_yaml(noise));
}

Result<NoiseFloor> load_noise_floor(const fs::path& file) {
  const auto text = read_text(file);
  if (!text) return text.errors();
  const auto root = parse_yaml(*text, file.string());
  if (!root) return root.errors();
  Findings findings(file.string());
  NoiseFloor noise;
  read_file(findings, **root, noise);
  if (findings.any_error()) return findings.errors();
  return noise;
}

std::vector<std::string> noise_remarks(const NoiseFloor& noise, const Trace& golden,
                                       const std::vector<const Comparison*>& comparisons, double doubtful) {
  std::vector<std::string> remarks;
  compare_provenance(noise, golden, remarks);
  const auto tolerances = tolerances_in(comparisons);
  Doubt below, above;
  for (const ChannelNoise& channel : noise.channels) {
    const auto found = tolerances.find({channel.channel, channel.unit});
    if (found == tolerances.end() || channel.unit == "of 255") continue;  // how many pixels differ is what counts
    const double tolerance = found->second;
    const double measured = std::max(channel.controller.value_or(0.0), channel.plant.value_or(0.0));
    const double floor = noise.of_unit(channel.unit);
    if (measured > tolerance) keep_worst(below, channel, tolerance, measured, measured / tolerance);
    if (channel.unit != "of pixels" && tolerance > doubtful * floor) keep_worst(above, channel, tolerance, floor, tolerance / floor);
  }
  if (below.count > 0)
    remarks.push_back(fmt::format("{} {} below the measured noise, the most in {}: {:g} is allowed, {:.3g} is noise",
                                  below.count, below.count == 1 ? "tolerance lies" : "tolerances lie", below.where,
                                  below.tolerance, below.noise));
  if (above.count > 0)
    remarks.push_back(fmt::format("{} {} more than {:g} times above the measured noise, the most in {}: {:g} is allowed, "
                                  "{:.3g} is the noise of its unit",
                                  above.count, above.count == 1 ? "tolerance lies" : "tolerances lie", doubtful,
                                  above.where, above.tolerance, above.noise));
  return remarks;
}

}  // namespace rehearse
