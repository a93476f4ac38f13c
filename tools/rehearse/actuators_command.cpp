// rehearse actuators: prints the drives of a MuJoCo model as a scenario's `actuators:`.
#include <fmt/format.h>
#include <rehearse/mjcf.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "command.h"
#include "output.h"

namespace rehearse::tool {
namespace {

/// The name as a scalar of YAML.
std::string scalar(const std::string& name) {
  const bool is_word = std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
  return is_word ? name : Json(name).dump();
}

Exit run_actuators(const std::string& file) {
  const Result<std::vector<MjcfDrive>> drives = load_mjcf_drives(file);
  if (!drives) return refuse(drives.errors());
  std::string rules;
  for (const MjcfDrive& drive : *drives) {
    if (!drive.states_anything()) continue;
    rules += fmt::format("  - {{joint: {}", scalar(drive.joint));
    const std::pair<const char*, const std::optional<double>&> values[] = {
        {"effort", drive.effort},   {"armature", drive.armature},           {"damping", drive.damping},
        {"coulomb", drive.coulomb}, {"position_gain", drive.position_gain}, {"velocity_gain", drive.velocity_gain}};
    for (const auto& [key, value] : values)
      if (value) rules += fmt::format(", {}: {}", key, *value);
    rules += "}\n";
  }
  if (rules.empty())
    return refuse(error_in(file,
                           fmt::format("its {} state nothing of their drives", count_text(drives->size(), "joint")),
                           "expected damping, frictionloss, armature, forces or gains"));
  fmt::print("actuators:\n{}", rules);
  return Exit::done;
}

std::function<Exit()> declare_actuators(CLI::App& options) {
  const auto file = std::make_shared<std::string>();
  options.add_option("MODEL", *file, "a model of MuJoCo, .xml")->required()->type_name("");
  return [file] { return run_actuators(*file); };
}

}  // namespace

extern const Verb actuators_verb{"actuators", "  rehearse actuators go2.xml >> scenario.yaml\n", declare_actuators};

}  // namespace rehearse::tool
