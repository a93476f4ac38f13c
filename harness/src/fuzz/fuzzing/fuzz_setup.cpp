#include "fuzz_setup.h"

#include <fmt/format.h>
#include <rehearse/body.h>
#include <rehearse/model.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/names.h"

namespace rehearse {
namespace {

constexpr int most_ticks = 100'000;
constexpr std::size_t most_numbers = 10'000'000;  // of a run's inputs

/// In quotes, for YAML.
std::string in_yaml_quotes(const std::string& text) { return nlohmann::json(text).dump(-1, ' ', false); }

Diagnostic mistake(const FuzzPlan& plan, std::string message, std::string hint = {}) {
  return error(fmt::format("the fuzz test {}: {}", plan.name, message), std::move(hint));
}

const char* name_of(FuzzRange::Quantity quantity) {
  switch (quantity) {
    case FuzzRange::Quantity::q: return "q";
    case FuzzRange::Quantity::dq: return "dq";
    case FuzzRange::Quantity::ddq: return "ddq";
    case FuzzRange::Quantity::u: break;
  }
  return "u";
}

Diagnostic unknown(const FuzzPlan& plan, const char* what, const std::string& name, std::vector<std::string> names) {
  std::string all;
  for (const std::string& known : names) all += (all.empty() ? "" : ", ") + known;
  return mistake(plan, fmt::format("the model has no {} \"{}\"", what, name),
                 fmt::format("it has {}", all.empty() ? "none" : all));
}

/// q and dq within the limits of the model.
std::vector<FuzzRange> ranges_of(const Joint& joint) {
  constexpr double displacement = 3.0, velocity = 10.0;
  const bool is_limited = joint.lower > -unlimited && joint.upper < unlimited;
  const double fastest = joint.velocity < unlimited ? joint.velocity : velocity;
  return {{FuzzRange::Quantity::q, is_limited ? joint.lower : -displacement, is_limited ? joint.upper : displacement},
          {FuzzRange::Quantity::dq, -fastest, fastest}};
}

Result<void> check_range(const FuzzPlan& plan, const std::string& name, double low, double high) {
  if (std::isfinite(low) && std::isfinite(high) && low <= high) return {};
  return mistake(plan, fmt::format("the range of {} goes from {} to {}", name, low, high),
                 "expected two finite numbers, the lower one first");
}

Result<void> add_joint(FuzzSetup& setup, const FuzzPlan::Joint& wanted) {
  const Model& model = setup.model();
  const int link = model.find_joint(wanted.name);
  if (link < 0 || model.links[static_cast<std::size_t>(link)].joint.id < 0) {
    std::vector<std::string> names;
    for (const int moved : model.joints) names.push_back(model.links[static_cast<std::size_t>(moved)].joint.name);
    return unknown(setup.plan, "joint", wanted.name, names);
  }
  const Joint& joint = model.links[static_cast<std::size_t>(link)].joint;
  for (const FuzzRange& range : wanted.ranges.empty() ? ranges_of(joint) : wanted.ranges) {
    InputColumn column;
    column.name = fmt::format("{}/{}", wanted.name, name_of(range.quantity));
    column.statement = fmt::format("joint(\"{}\").{}", wanted.name, name_of(range.quantity));
    column.joint = joint.id;
    column.quantity = range.quantity;
    column.low = range.low;
    column.high = range.high;
    REHEARSE_TRY(check_range(setup.plan, column.name, column.low, column.high));
    if (std::ranges::find(setup.columns, column.name, &InputColumn::name) != setup.columns.end())
      return mistake(setup.plan, fmt::format("{} has two ranges", column.name));
    const auto start = setup.plan.start.find(wanted.name);
    if (range.quantity == FuzzRange::Quantity::q) column.start = start == setup.plan.start.end() ? 0.0 : start->second;
    column.start = column.clamped(column.start);
    setup.columns.push_back(std::move(column));
  }
  return {};
}

/// The ranges of a device's values by the units of its quantities.
std::vector<std::pair<double, double>> limits_of(const Device& device, std::size_t count) {
  if (const auto* laser = std::get_if<RangeSensor>(&device.kind))
    return std::vector(count, std::pair(laser->min_distance, laser->max_distance));
  static const std::map<std::string_view, double> greatest{
      {"rad/s", 10.0}, {"m/s²", 50.0}, {"N", 1000.0}, {"N·m", 100.0}, {"T", 1e-4}};
  std::vector<std::pair<double, double>> limits;
  if (std::holds_alternative<ContactSensor>(device.kind)) limits.emplace_back(0.0, 8.0);  // points
  for (const MeasuredQuantity& quantity : quantities_of(device)) {
    const auto known = greatest.find(quantity.unit);
    const double most = known == greatest.end() ? 1.0 : known->second;
    for (int i = 0; i < quantity.axes; ++i) limits.emplace_back(-most, most);
  }
  limits.resize(count, {-1.0, 1.0});
  return limits;
}

Result<void> add_device(FuzzSetup& setup, const FuzzPlan::Device& wanted) {
  const Model& model = setup.model();
  const int index = model.find_device(wanted.name);
  if (index < 0) {
    std::vector<std::string> names;
    for (const Device& device : model.devices) names.push_back(device.name);
    return unknown(setup.plan, "device", wanted.name, names);
  }
  const Device& device = model.devices[static_cast<std::size_t>(index)];
  const auto* laser = std::get_if<RangeSensor>(&device.kind);
  const auto count = static_cast<std::size_t>(laser ? laser->beams() : value_count(device));
  if (count == 0)
    return mistake(setup.plan,
                   fmt::format("the device \"{}\" is a {}, which measures no numbers", wanted.name, type_name(device)));
  if (setup.values_of_devices[static_cast<std::size_t>(index)] > 0)
    return mistake(setup.plan, fmt::format("the device \"{}\" is stated twice", wanted.name));
  setup.values_of_devices[static_cast<std::size_t>(index)] = count;
  setup.first_of_devices[static_cast<std::size_t>(index)] = setup.columns.size();
  const auto limits = limits_of(device, count);
  for (std::size_t i = 0; i < count; ++i) {
    InputColumn column;
    column.name = fmt::format("{}/{}", wanted.name, i);
    column.statement = fmt::format("device(\"{}\").values[{}]", wanted.name, i);
    column.device = index;
    column.element = static_cast<int>(i);
    std::tie(column.low, column.high) = wanted.range ? *wanted.range : limits[i];
    REHEARSE_TRY(check_range(setup.plan, column.name, column.low, column.high));
    column.start = column.clamped(0.0);
    setup.columns.push_back(std::move(column));
  }
  return {};
}

/// "always: CONDITION" as a line of a scenario.
std::optional<std::string> line_of(const std::string& expectation) {
  for (const std::string_view quantifier : {"always:", "never:", "eventually:"}) {
    if (!expectation.starts_with(quantifier)) continue;
    std::string condition = expectation.substr(quantifier.size());
    condition.erase(0, condition.find_first_not_of(' '));
    if (!condition.empty()) return fmt::format("  - {} {}\n", quantifier, in_yaml_quotes(condition));
  }
  return std::nullopt;
}

}  // namespace

std::string scenario_text(const FuzzPlan& plan, const std::string& body, int ticks) {
  std::string text = fmt::format(
      "# The inputs of a fuzz test: no physics moves the robot.\nrehearse: 1\nname: {}\nduration: {}\ntime_step: {}\n"
      "bodies:\n  - name: {}\n    model: {}\n",
      in_yaml_quotes(plan.name), static_cast<double>(ticks) * plan.time_step, plan.time_step, in_yaml_quotes(body),
      in_yaml_quotes(plan.model));
  std::string joints;
  for (const auto& [joint, start] : plan.start)
    joints += fmt::format("{}{}: {}", joints.empty() ? "" : ", ", in_yaml_quotes(joint), start);
  if (!joints.empty()) text += fmt::format("    joints: {{{}}}\n", joints);
  text += fmt::format("    controllers:\n      - library: {}\n", in_yaml_quotes(plan.library));
  if (!plan.options.empty()) text += fmt::format("        options: {}\n", in_yaml_quotes(plan.options));
  if (!plan.expectations.empty()) text += "expect:\n";
  for (const std::string& expectation : plan.expectations) text += line_of(expectation).value_or("");
  return text;
}

Result<Scenario> scenario_of(const FuzzPlan& plan, const std::string& body, int ticks) {
  auto scenario = Scenario::load_text(scenario_text(plan, body, ticks), fixture_path(plan.name + ".yaml"));
  if (!scenario) {
    // Its file exists nowhere: a line of it would lead astray. Those of a model lead to its file.
    Diagnostics found = scenario.errors();
    for (Diagnostic& one : found)
      if (one.file.ends_with(plan.name + ".yaml")) one = mistake(plan, one.message, one.hint);
    return found;
  }
  return scenario;
}

Result<FuzzSetup> set_up(const FuzzPlan& plan) {
  if (plan.ticks < 1 || plan.ticks > most_ticks)
    return mistake(plan, fmt::format("a run has {} ticks", plan.ticks), fmt::format("expected 1 to {}", most_ticks));
  for (const std::string& expectation : plan.expectations)
    if (!line_of(expectation))
      return mistake(plan, fmt::format("\"{}\" is no expectation", expectation),
                     "expected \"always: CONDITION\", \"never: CONDITION\" or \"eventually: CONDITION\"");
  FuzzSetup setup;
  setup.plan = plan;
  const auto model = load_model(fixture_path(plan.model));
  if (!model) return model.errors();
  setup.scenario = REHEARSE_TRY(scenario_of(plan, model->name, plan.ticks));
  setup.values_of_devices.resize(setup.model().devices.size());
  setup.first_of_devices.resize(setup.model().devices.size());
  for (const FuzzPlan::Joint& joint : plan.joints) REHEARSE_TRY(add_joint(setup, joint));
  for (const FuzzPlan::Device& device : plan.devices) REHEARSE_TRY(add_device(setup, device));
  if (setup.columns.empty()) return mistake(plan, "it states no input", "add .joint(NAME) or .device(NAME)");
  if (setup.columns.size() * static_cast<std::size_t>(plan.ticks) > most_numbers)
    return mistake(plan,
                   fmt::format("a run has {} numbers", setup.columns.size() * static_cast<std::size_t>(plan.ticks)),
                   fmt::format("expected at most {}: fewer ticks or devices", most_numbers));
  return setup;
}

}  // namespace rehearse
