#include <rehearse/body.h>
#include <rehearse/scenario.h>

#include "bound_form.h"
#include "campaign_claims.h"
#include "mesh/heightmap_file.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"
#include "scenario_variations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rehearse {
namespace {

/// Whether a check simulates runs that it could prove; always_simulates() reads it, too.
const Words<bool> simulate_words{"always, or unproved (only runs that a check can't prove)",
                                 {{"always", true}, {"unproved", false}}};

const BoundForm<Scenario>& bound_record_form() {
  static const BoundForm<Scenario> form{
      "record", "record", {{"frames", &Scenario::record_frames, "whether pictures are recorded"}}};
  return form;
}

const BoundForm<Scenario>& bound_scenario_form() {
  constexpr double most_seed = 4294967295.0;
  static const BoundForm<Scenario> form{
      "scenario",
      "the scenario",
      {FormKey{"rehearse", types::whole(1, 1), "version of the form", required},
       FormKey{"name", types::text_like("^[^/\n]+$"), "names files of the run; default: the file's name without .yaml"},
       FormKey{"golden", types::either({types::matching("[A-Za-z0-9_-]+\\.[A-Za-z0-9_-]+"), types::of(golden_form)}),
               "the recording to compare with, Suite.Test"},
       FormKey{"duration", types::number({0.0, Scenario::max_duration, "[s]", true}),
               "duration of the run, of at least one tick; the number of ticks is duration / time_step, rounded [s]",
               required},
       {"ends_when_done", &Scenario::ends_when_done,
        "the run ends after the step in which control() of all controllers returned false; duration is then the "
        "longest"},
       {"planar", &Scenario::planar,
        "root links that aren't fixed stay in the plane of x and z in which they begin: they neither move along y nor "
        "turn about x and z"},
       {"time_step",
        &Scenario::time_step,
        {Scenario::min_time_step, Scenario::max_time_step, "[s]"},
        "of physics and controllers [s]"},
       {"seed", &Scenario::seed, {0, most_seed}, "seed of the physics engine's generator"},
       {"gravity", &Scenario::gravity, any_acceleration, "[x, y, z] [m/s²]"},
       {"options", &Scenario::options, "option string for every controller, before its own"},
       {"initial_commands", &Scenario::initial_commands,
        "what controllers write in initialize() acts in the first step, as with Choreonoid's AIST item; false, as with "
        "its ODE item: that step has no commands"},
       FormKey{"solver", types::of(solver_form), "settings of the physics engine"},
       {"lever_arms", &Scenario::lever_arms,
        "accelerometers and IMUs measure at their own place; false: at their link's origin, as in Choreonoid"},
       FormKey{"bodies", types::list(types::of(body_form), 1), "the bodies of the world, in this order", required},
       FormKey{"materials", types::map(types::name()),
               "BODY: NAME or BODY/LINK: NAME, the material of a body's links or of one link"},
       FormKey{"pairs", types::list(types::of(pair_form)),
               "what applies between two materials, in place of the values of bodies, models and solver"},
       FormKey{"joints", types::list(types::of(joint_form)), "joints between links in addition to those of the models"},
       FormKey{"welds", types::list(types::of(weld_form)), "links that are fixed to each other for a time"},
       FormKey{"pushes", types::list(types::of(push_form)), "forces from outside"},
       FormKey{"joystick", types::list(types::of(joystick_entry_form)),
               "moves of axes and presses of buttons; default: there is no joystick"},
       FormKey{"noise", types::list(types::of(noise_form)), "errors of readings: noise, latency, rate, gaps"},
       FormKey{"look", types::of(look_form), "the background's colour, and settings of all cameras"},
       {"magnetic_field",
        &Scenario::magnetic_field,
        {-1e3, 1e3, "[T]"},
        "[x, y, z], the same everywhere, in world axes [T]"},
       FormKey{"cameras", types::either({types::word({"all", "none"}), types::list(types::text())}),
               "cameras that take pictures: all, none, or a list of Body/Camera", "all"},
       FormKey{"record", types::of(record_form), "parts of the recording"},
       FormKey{"tolerances", types::list(types::of(tolerance_form)), "allowed differences from the golden"},
       FormKey{"horizon", types::number({0.0, Scenario::max_duration, "[s]"}),
               "time up to which channels are compared with the golden, at most the duration; later only expect is "
               "judged; default: 0.8 of the measured one if the noise was measured, else the whole run [s]"},
       FormKey{"expect", types::list(types::of(expectation_form)), "properties that the run must have"},
       FormKey{"simulate", types::word(simulate_words.names()),
               "what a check simulates: only runs that it can't prove, or all", simulate_words.name_of(false)},
       FormKey{"vary", types::map(types::of(parameter_form)), "parameters that a campaign varies"},
       {"realtime",
        &Scenario::counts_costs,
        {"counts (the costs of control() are recorded)", {{"counts", true}}},
        "the costs of control() are recorded and compared, and nothing is proved"},
       FormKey{"pass_rate", types::of(pass_rate_form), "the share of a campaign's cases that must pass"},
       FormKey{"sometimes", types::map(types::text()), "NAME: CONDITION, which some case of a campaign must reach"},
       FormKey{"plan", types::word({"random", "sobol", "latin_hypercube"}), "how a campaign draws its cases",
               "random"}}};
  return form;
}

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
  bound_scenario_form().read(keys, scenario);
  read_names(findings, keys, scenario);
  read_clock(findings, keys, scenario);
  if (const YamlNode* node = keys.find("golden")) read_golden(findings, *node, scenario);
  const YamlNode* solver = keys.find("solver");
  read_solver(findings, solver ? *solver : findings.absent_map(root, "solver"), scenario.solver);
  if (const YamlNode* node = keys.find("record"))
    bound_record_form().read(Keys(findings, *node, record_form()), scenario);
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
  bool always = false;  // only a check uses it: always_simulates()
  keys.read("simulate", simulate_words, always);
  (void)read_claims(findings, root, scenario);  // campaigns use them
  if (const YamlNode* node = keys.find("vary")) read_variations(findings, *node, root, scenario);
  if (!findings.any_error()) check_rates(findings, *keys.find("bodies"), scenario);
}

}  // namespace

const Form& scenario_form() { return bound_scenario_form(); }
const Form& record_form() { return bound_record_form(); }

const Form& golden_form() {
  static const Form form{
      "golden",
      "the golden",
      {{"name", types::matching("[A-Za-z0-9_-]+\\.[A-Za-z0-9_-]+"), "Suite.Test, the recording to compare with"},
       {"state", types::quantity(std::span(rate_units).first(1), {0.0, 1e9, "[Hz]", true}),
        "rate of the state and of sensors in the golden; the others are kept at every tick"}}};
  return form;
}

const Form& tolerances_file_form() {
  static const Form form{
      "tolerances_file",
      "the file",
      {{"tolerances", types::list(types::of(tolerance_form)), "allowed differences from the golden", required}}};
  return form;
}

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
