#include <rehearse/body.h>
#include <rehearse/scenario.h>

#include "campaign_claims.h"
#include "mesh/heightmap_file.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"
#include "scenario_variations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rehearse {
namespace {

bool is_golden_name(std::string_view text) {
  const std::size_t dot = text.find('.');
  const auto is_word = [](std::string_view part) {
    return !part.empty() && std::ranges::all_of(part, [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    });
  };
  return dot != std::string_view::npos && is_word(text.substr(0, dot)) && is_word(text.substr(dot + 1));
}

void read_names(Findings& findings, const Keys& keys, Scenario& scenario) {
  scenario.name = std::filesystem::path(scenario.file).stem().string();
  if (const YamlNode* node = keys.find("name")) {
    const auto name = read_text(findings, *node, "name");
    if (name && (name->empty() || name->find_first_of("/\n") != std::string::npos)) {
      expected(findings, *node, "name", "one line without '/', because files are named after it");
    } else if (name) {
      scenario.name = *name;
    }
  }
}

void read_golden_name(Findings& findings, const YamlNode& node, std::string_view label, Scenario& scenario) {
  const auto golden = read_text(findings, node, label, "Suite.Test");
  if (golden && !is_golden_name(*golden)) {
    expected(findings, node, label, "Suite.Test, each of letters, digits, '_' and '-'");
  } else if (golden) {
    scenario.golden = *golden;
  }
}

/// A name, or a map with the name and the rate of the state. Must be called after the time step is read.
void read_golden(Findings& findings, const YamlNode& node, Scenario& scenario) {
  if (node.kind != YamlNode::Kind::map) return read_golden_name(findings, node, "golden", scenario);
  const Keys keys(findings, node, golden_form());
  if (const YamlNode* name = keys.find("name")) read_golden_name(findings, *name, "name", scenario);
  const YamlNode* state = keys.find("state");
  if (state == nullptr) return;
  const auto rate = read_rate(findings, *state, "state");
  if (!rate) return;
  const double ticks = 1.0 / (*rate * scenario.time_step);  // from one sample to the next
  if (std::round(ticks) < 1.0 || std::abs(ticks - std::round(ticks)) > 1e-6 * ticks)
    findings.error(*state, fmt::format("state is {} Hz, which is not the rate of every nth tick", *rate),
                   fmt::format("expected {} Hz divided by a whole number", 1.0 / scenario.time_step));
  else
    scenario.golden_state_rate = *rate;
}

void read_clock(Findings& findings, const Keys& keys, Scenario& scenario) {
  keys.number("time_step", scenario.time_step);
  const Range durations{0.0, Scenario::max_duration, "[s]", true};
  const YamlNode* node = keys.require("duration", "the length of the run [s]");
  if (node == nullptr) return;
  const auto duration = read_number(findings, *node, "duration", durations);
  if (!duration) return;
  scenario.duration = *duration;
  if (scenario.ticks() < 1)
    findings.error(*node, fmt::format("duration is {}, which is no tick", *duration),
                   fmt::format("expected at least one time step, {} s", scenario.time_step));
}

/// Must be called after the duration is read.
void read_horizon(Findings& findings, const YamlNode& node, Scenario& scenario) {
  const auto horizon = read_number(findings, node, "horizon", {0.0, Scenario::max_duration, "[s]"});
  if (!horizon) return;
  if (scenario.duration > 0.0 && *horizon > scenario.duration)
    findings.error(node, fmt::format("horizon is {}, after the end of the run", *horizon),
                   fmt::format("expected a time up to the duration, {} s", scenario.duration));
  scenario.horizon = *horizon;
}

void read_seed(Findings& findings, const Keys& keys, Scenario& scenario) {
  if (const YamlNode* node = keys.find("seed")) {
    const auto seed = read_integer(findings, *node, "seed", 0, std::numeric_limits<std::uint32_t>::max());
    if (seed) scenario.seed = static_cast<std::uint32_t>(*seed);
  } else {
    keys.set_default("seed", {fmt::format("{}", scenario.seed)});
  }
}

void read_solver(Findings& findings, const YamlNode& node, SolverSettings& solver) {
  using enum SolverSettings::Method;
  const Keys keys(findings, node, solver_form());
  keys.word("method", "direct (by the tree of joints), quick (iterative, by ODE) or exact (by ODE)",
            {{"direct", direct}, {"quick", quick}, {"exact", exact}}, solver.method);
  keys.integer("iterations", solver.iterations);
  keys.number("over_relaxation", solver.over_relaxation);
  keys.number("erp", solver.erp);
  keys.number("cfm", solver.cfm);
  keys.number("max_correcting_velocity", solver.max_correcting_velocity);
  keys.number("surface_layer", solver.surface_layer);
  keys.number("friction", solver.friction);
  keys.integer("max_contacts", solver.max_contacts);
  keys.number("belt_depth", solver.belt_depth);
  keys.number("sleep_after", solver.sleep_after);
  keys.number("sleep_speed", solver.sleep_speed);
}

void read_record(Findings& findings, const YamlNode& node, Scenario& scenario) {
  const Keys keys(findings, node, record_form());
  keys.flag("frames", scenario.record_frames);
}

void read_light(Findings& findings, const YamlNode& node, Look& look) {
  const Keys keys(findings, node, light_form());
  if (!keys.is_map()) return;
  SceneLight lamp;
  if (keys.require("position", "[x, y, z] [m]") != nullptr) keys.vector3("position", lamp.position);
  if (const YamlNode* color = keys.find("color")) {
    if (const auto values = read_numbers(findings, *color, "color", 3, 3, {0.0, 1.0}))
      lamp.light.color = Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]).cast<float>();
  }
  double intensity = 1.0;
  keys.number("intensity", intensity);
  lamp.light.intensity = static_cast<float>(intensity);
  keys.number("range", lamp.light.range);
  if (keys.find("direction") != nullptr) {
    LightCone cone;
    keys.vector3("direction", cone.direction);
    const auto angle = [&](const char* key, float& out) {
      const YamlNode* value = keys.find(key);
      const auto read = value ? read_angle(findings, *value, key) : std::nullopt;
      if (read && (*read < 0.0 || *read > std::numbers::pi))
        expected(findings, *value, key, "an angle from 0 to 180 deg");
      if (read) out = static_cast<float>(*read);
    };
    cone.beam_width = 0.5f;
    cone.cut_off_angle = 0.7f;
    angle("beam_width", cone.beam_width);
    angle("cut_off_angle", cone.cut_off_angle);
    if (cone.direction.isZero(0.0))
      expected(findings, *keys.find("direction"), "direction", "a direction as in [0, 0, -1]");
    lamp.light.cone = cone;
  }
  for (const char* key : {"beam_width", "cut_off_angle"})
    if (const YamlNode* found = keys.find(key); found != nullptr && !lamp.light.cone)
      findings.error(*found, fmt::format("{} is given without direction", key),
                     "a light without direction shines in all directions");
  look.lights.push_back(lamp);
}

void read_look(Findings& findings, const YamlNode& node, Look& look) {
  const Keys keys(findings, node, look_form());
  keys.flag("shadows", look.shadows);
  keys.flag("antialiasing", look.antialiasing);
  if (const YamlNode* sky = keys.find("sky")) {
    if (const auto color = read_numbers(findings, *sky, "sky", 3, 3, {0.0, 1.0}))
      look.sky = Eigen::Vector4d((*color)[0], (*color)[1], (*color)[2], 1.0).cast<float>();
  }
  if (const YamlNode* lights = keys.find("lights"))
    for (const YamlNodePtr& light : read_list(findings, *lights, "lights", "a list of lights, each with a position"))
      read_light(findings, *light, look);
}

// False if the rest of the file can't be checked: it isn't a scenario, or has a different version.
bool check_version(Findings& findings, const YamlNode& root) {
  if (root.kind != YamlNode::Kind::map) {
    expected(findings, root, "the scenario", "a map that begins with rehearse: 1");
    return false;
  }
  const YamlNode* version = find_key(root, "rehearse");
  if (version == nullptr) {
    findings.error(root, "the scenario has no 'rehearse'", "expected rehearse: 1, the version of the form");
    return true;
  }
  if (version->kind == YamlNode::Kind::scalar && version->text == "1") return true;
  expected(findings, *version, "rehearse", "1, the version of the form that this program reads");
  return false;
}

void read_scenario(Findings& findings, const YamlNode& root, const Scenario::ModelSource& models,
                   const Scenario::FileSource& files, Scenario& scenario) {
  if (!check_version(findings, root)) return;
  const Keys keys(findings, root, scenario_form());
  read_names(findings, keys, scenario);
  read_clock(findings, keys, scenario);
  if (const YamlNode* node = keys.find("golden")) read_golden(findings, *node, scenario);
  keys.flag("ends_when_done", scenario.ends_when_done);
  keys.flag("planar", scenario.planar);
  read_seed(findings, keys, scenario);
  keys.vector3("gravity", scenario.gravity);
  keys.vector3("magnetic_field", scenario.magnetic_field);
  keys.text("options", scenario.options);
  keys.flag("lever_arms", scenario.lever_arms);
  const YamlNode* solver = keys.find("solver");
  read_solver(findings, solver ? *solver : findings.absent_map(root, "solver"), scenario.solver);
  if (const YamlNode* node = keys.find("record")) read_record(findings, *node, scenario);
  if (const YamlNode* node = keys.require("bodies", "a list of the bodies in the world"))
    read_bodies(findings, *node, models, files, scenario);
  read_materials(findings, keys.find("materials"), keys.find("pairs"), scenario);
  if (const YamlNode* node = keys.find("joints")) read_connections(findings, *node, scenario);
  if (const YamlNode* node = keys.find("welds")) read_welds(findings, *node, scenario);
  if (const YamlNode* node = keys.find("pushes")) read_pushes(findings, *node, scenario);
  if (const YamlNode* node = keys.find("joystick")) read_joystick(findings, *node, scenario);
  if (const YamlNode* node = keys.find("noise")) read_noise(findings, *node, scenario);
  if (const YamlNode* node = keys.find("bodies")) read_faults(findings, *node, scenario);
  if (const YamlNode* node = keys.find("look")) read_look(findings, *node, scenario.look);
  if (const YamlNode* node = keys.find("cameras")) read_cameras(findings, *node, scenario);
  if (const YamlNode* node = keys.find("tolerances")) read_tolerances(findings, *node, scenario);
  if (const YamlNode* node = keys.find("horizon")) read_horizon(findings, *node, scenario);
  if (const YamlNode* node = keys.find("expect")) read_expectations(findings, *node, scenario);
  keys.word("realtime", "counts (the costs of control() are recorded)", {{"counts", true}}, scenario.counts_costs);
  bool always = false;  // only a check uses it: always_simulates()
  keys.word("simulate", "always, or unproved (only runs that a check can't prove)",
            {{"always", true}, {"unproved", false}}, always);
  (void)read_claims(findings, root, scenario);  // campaigns use them
  if (const YamlNode* node = keys.find("vary")) read_variations(findings, *node, root, scenario);
  if (!findings.any_error()) check_rates(findings, *keys.find("bodies"), scenario);
}

}  // namespace

Diagnostic at(const Place& place, Diagnostic diagnostic) {
  diagnostic.file = place.file;
  diagnostic.line = place.line;
  diagnostic.column = place.column;
  return diagnostic;
}

std::int64_t Scenario::ticks() const { return std::lround(duration / time_step); }

bool Scenario::runs_camera(const std::string& body, const std::string& camera) const {
  return !cameras || std::ranges::find(*cameras, body + "/" + camera) != cameras->end();
}

bool Scenario::runs_a_camera() const {
  return std::ranges::any_of(bodies, [this](const ScenarioBody& body) {
    return std::ranges::any_of(body.model->devices, [&](const Device& device) {
      return std::holds_alternative<Camera>(device.kind) && runs_camera(body.name, device.name);
    });
  });
}

Result<Scenario> Scenario::load(const std::filesystem::path& file) {
  std::string text = REHEARSE_TRY(read_yaml_file(file, "a scenario"));
  return load_text(std::move(text), file);
}

namespace {

/// The sources of models and of other files, by paths relative to the folder of a scenario.
struct FilesBeside {
  Scenario::ModelSource models;
  Scenario::FileSource bytes;
};

FilesBeside files_beside(const std::filesystem::path& file) {
  const auto beside = [folder = file.parent_path()](const std::string& model_file,
                                                    const UrdfOptions& options) -> Result<Model> {
    const std::filesystem::path path = folder / model_file;
    UrdfOptions here = options;
    for (auto& [name, directory] : here.packages) directory = folder / directory;
    std::error_code ignored;
    if (!model_file.empty() && std::filesystem::is_regular_file(path, ignored)) return load_model(path, here);
    return error(fmt::format("there is no model file '{}'", shortened(model_file)),
                 fmt::format("looked for {}, relative to the scenario", shortened(path.string(), 500)));
  };
  const auto bytes = [folder = file.parent_path()](const std::string& name) -> Result<std::string> {
    const std::filesystem::path path = folder / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) return read_heightmap_file(path);
    return error(fmt::format("there is no file '{}'", shortened(name)),
                 fmt::format("looked for {}, relative to the scenario", shortened(path.string(), 500)));
  };
  return {beside, bytes};
}

using StatedValues = std::vector<std::pair<std::string, std::string>>;  // by path

/// The errors of a scenario that has these values, each with the values.
Diagnostics with_values(const StatedValues& values, Diagnostics errors) {
  std::string stated;
  for (const auto& [path, value] : values)
    stated += fmt::format("{}'{}' at {}", stated.empty() ? "with " : ", ", path, value);
  if (stated.empty()) return errors;
  for (Diagnostic& found : errors) found.message = fmt::format("{}: {}", stated, found.message);
  return errors;
}

/// Puts a value at a path of the text, in which `put` are.
Result<void> state_value(const std::filesystem::path& file, const std::pair<std::string, std::string>& value,
                         const StatedValues& put, std::string& text) {
  const Result<YamlNodePtr> root = parse_yaml(text, file.string());
  if (!root) return with_values(put, root.errors());
  Scenario scenario;
  scenario.file = file.string();
  scenario.text = text;
  Findings findings(scenario.file);
  const FilesBeside files = files_beside(file);
  read_scenario(findings, **root, files.models, files.bytes, scenario);
  if (findings.any_error()) return with_values(put, findings.errors());
  auto place = place_of(findings, **root, scenario, value.first);
  if (!place) return with_values({value}, findings.errors());
  scenario.variations = {*std::move(place)};
  auto varied = scenario.varied_text({value.second});
  if (!varied) return with_values({value}, varied.errors());
  text = *std::move(varied);
  return {};
}

}  // namespace

Result<Scenario> Scenario::load_text(std::string text, const std::filesystem::path& file) {
  const FilesBeside files = files_beside(file);
  return parse(std::move(text), file.string(), files.models, files.bytes);
}

Result<Scenario> load_with(const std::filesystem::path& file,
                           const std::vector<std::pair<std::string, std::string>>& values) {
  std::string text = REHEARSE_TRY(read_yaml_file(file, "a scenario"));
  StatedValues put;
  for (const auto& value : values) {
    REHEARSE_TRY(state_value(file, value, put, text));
    put.push_back(value);
  }
  auto scenario = Scenario::load_text(std::move(text), file);
  if (!scenario) return with_values(values, scenario.errors());
  return scenario;
}

Result<Scenario> Scenario::parse(std::string text, const std::string& file, const ModelSource& models,
                                 const FileSource& files) {
  const YamlNodePtr root = REHEARSE_TRY(parse_yaml(text, file));
  Scenario scenario;
  scenario.file = file;
  scenario.text = std::move(text);
  Findings findings(file);
  read_scenario(findings, *root, models, files, scenario);
  if (findings.any_error()) return findings.errors();
  scenario.warnings = findings.warnings();
  return scenario;
}

Result<std::vector<ToleranceRule>> load_tolerances(const std::filesystem::path& file) {
  std::string text = REHEARSE_TRY(read_yaml_file(file, "a scenario"));
  const YamlNodePtr root = REHEARSE_TRY(parse_yaml(std::move(text), file.string()));
  Findings findings(file.string());
  Scenario scenario;  // read_tolerances() writes the list into it
  scenario.file = file.string();
  if (root->kind != YamlNode::Kind::map) {
    expected(findings, *root, "the file", "a map with a list of tolerances");
  } else if (find_key(*root, "rehearse") != nullptr) {
    if (const YamlNode* node = find_key(*root, "tolerances")) read_tolerances(findings, *node, scenario);
  } else {
    const Keys keys(findings, *root, tolerances_file_form());
    if (const YamlNode* node = keys.require("tolerances", "a list of tolerances, each with its channel"))
      read_tolerances(findings, *node, scenario);
  }
  if (findings.any_error()) return findings.errors();
  return std::move(scenario.tolerances);
}

}  // namespace rehearse
