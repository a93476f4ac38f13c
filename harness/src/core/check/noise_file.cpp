// The noise floor as a file.
#include <fmt/format.h>
#include <yaml-cpp/emitter.h>

#include "core/golden/golden_files.h"
#include "core/scenario/bound_form.h"
#include "noise_floor.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr int file_version = 1;
constexpr Range any_difference{0.0, 1e300};
constexpr Range any_time{0.0, 1e9, "[s]"};

const BoundForm<Perturbation>& perturbation_form() {
  static const BoundForm<Perturbation> form{
      "perturbation",
      "a perturbation",
      {{"name", &Perturbation::name, types::text(), "of the perturbation", {"the name of the perturbation"}},
       {"not_made", &Perturbation::not_made, "the reason why it wasn't made"},
       FormKey{"levels", types::list(types::word({"controller", "plant", "closed"})), "levels that it changed"},
       {"horizon", &Perturbation::horizon, any_time, "the closed loop left its tolerances then [s]"}}};
  return form;
}

const BoundForm<ChannelNoise>& channel_noise_form() {
  static const BoundForm<ChannelNoise> form{
      "channel_noise",
      "a channel's noise",
      {{"channel", &ChannelNoise::channel, types::text(), "its topic", {"a topic"}},
       {"unit", &ChannelNoise::unit, "of the numbers"},
       {"controller", &ChannelNoise::controller, any_difference, "largest difference of the controller's level"},
       {"plant", &ChannelNoise::plant, any_difference, "largest difference of the plant's level"},
       {"tolerance",
        &ChannelNoise::tolerance,
        any_difference,
        "the tightest tolerance in force",
        {"the tightest tolerance in force"}}}};
  return form;
}

/// Three digits: more have no meaning, and would change the file with every measurement.
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
  if (perturbation.horizon)
    out << YAML::Key << "horizon" << YAML::Value << fmt::format("{:.6g}", *perturbation.horizon);
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
  for (const YamlNodePtr& level : read_list(findings, list, "'levels'", "a list of controller, plant, closed")) {
    if (level->text == "controller")
      perturbation.controller = true;
    else if (level->text == "plant")
      perturbation.plant = true;
    else if (level->text == "closed")
      perturbation.closed = true;
    else
      expected(findings, *level, "a level", "controller, plant or closed");
  }
}

Perturbation read_perturbation(Findings& findings, const YamlNode& node) {
  Perturbation perturbation;
  const Keys keys(findings, node, perturbation_form());
  perturbation_form().read(keys, perturbation);
  if (const YamlNode* levels = keys.find("levels")) read_levels(findings, *levels, perturbation);
  return perturbation;
}

ChannelNoise read_channel(Findings& findings, const YamlNode& node) {
  ChannelNoise noise;
  const Keys keys(findings, node, channel_noise_form());
  channel_noise_form().read(keys, noise);
  return noise;
}

const BoundForm<NoiseFloor>& bound_noise_file_form() {
  static const BoundForm<NoiseFloor> form{
      "noise_file",
      "a noise file",
      {FormKey{"noise", types::whole(1, file_version), "the version of the file's form", required},
       {"scenario", &NoiseFloor::scenario, "the scenario's file"},
       {"recording",
        &NoiseFloor::recording,
        types::text(),
        "the hash of the recording that was perturbed",
        {"the hash of the recording that was perturbed"}},
       {"duration", &NoiseFloor::duration, any_time, "of the recording [s]"},
       FormKey{"made_with", types::map(types::text()), "the program and the machine"},
       FormKey{"perturbations", types::list(types::of(perturbation_form)), "runs that were compared with the recording",
               required},
       {"growth", &NoiseFloor::growth, any_difference, "of differences, per second"},
       FormKey{"channels", types::list(types::of(channel_noise_form)), "the noise of each channel", required}}};
  return form;
}

void read_file(Findings& findings, const YamlNode& root, NoiseFloor& noise) {
  const Keys keys(findings, root, noise_file_form());
  if (!keys.is_map()) return;
  int version = file_version;
  if (keys.require("noise", "the version of the file's form, 1")) keys.read("noise", version);
  bound_noise_file_form().read(keys, noise);
  if (const YamlNode* facts = keys.find("made_with"))
    for (const NamedEntry& fact : read_entries(findings, *facts)) noise.made_with[fact.name] = fact.value->text;
  const auto each = [&](const char* key, const char* what, auto&& read) {
    if (const YamlNode* node = keys.require(key, what))
      for (const YamlNodePtr& item : read_list(findings, *node, fmt::format("'{}'", key), what)) read(*item);
  };
  each("perturbations", "a list of perturbations",
       [&](const YamlNode& node) { noise.perturbations.push_back(read_perturbation(findings, node)); });
  each("channels", "a list of channels with their noise",
       [&](const YamlNode& node) { noise.channels.push_back(read_channel(findings, node)); });
}

}  // namespace

const Form& noise_file_form() { return bound_noise_file_form(); }

std::string to_yaml(const NoiseFloor& noise) {
  YAML::Emitter out;
  out << YAML::Comment(
             "Measured by `rehearse golden noise`; not to be edited. Largest differences under the perturbations;")
      << YAML::Newline;
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
  REHEARSE_ASSERT(out.good(), "the emitted text is YAML");
  return std::string(out.c_str(), out.size()) + "\n";
}

Result<void> write_noise_floor(const NoiseFloor& noise, const fs::path& file) {
  return replace_text(file, to_yaml(noise));
}

Result<NoiseFloor> load_noise_floor(const fs::path& file) {
  const auto text = REHEARSE_TRY(read_text(file));
  const auto root = REHEARSE_TRY(parse_yaml(text, file.string()));
  Findings findings(file.string());
  NoiseFloor noise;
  read_file(findings, *root, noise);
  if (findings.any_error()) return findings.errors();
  return noise;
}

}  // namespace rehearse
