// The `noise` of a scenario: deviations of the readings of sensors and joints from the truth.
#include <rehearse/scenario.h>

#include "base/glob.h"
#include "base/names.h"
#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"
#include "sensor_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {
namespace {

const BoundForm<ReadingErrors>& bound_noise_form() {
  static const BoundForm<ReadingErrors> form = [] {
    const ValueType latency = types::quantity(time_units, any_latency),
                    exposure = types::quantity(time_units, any_exposure);
    BoundForm<ReadingErrors> noise{
        "noise",
        "noise",
        {FormKey{"sensor", types::text(), "a pattern of Body/Sensor, such as SR1/*; * matches any text"},
         FormKey{"joint", types::text(),
                 "a pattern of Body/Joint; controllers get readings with errors, /Body/joints has the truth"},
         FormKey{
             "imu", types::of(data_sheet_form),
             "the five numbers of an IMU's data sheet, see below; in place of angular_velocity, acceleration and rate"},
         {"dropout",
          &ReadingErrors::dropout,
          {0.0, 1.0},
          "share of missing readings: without burst beams of a RangeSensor and depths of a RangeCamera have no "
          "measurement"},
         {"burst", &ReadingErrors::burst, types::quantity(time_units, {0.0, 1e3, "[s]", true}),
          "mean duration of a gap: whole readings are missing in bursts; needs dropout [s]"},
         {"rate", &ReadingErrors::rate, types::quantity(rate_units, any_reading_rate),
          "of samples; in between, controllers read the last one; not of cameras and range sensors; default: each tick "
          "[Hz]"},
         {"phase", &ReadingErrors::phase, types::quantity(time_units, any_time),
          "time of the first sample; needs rate [s]"},
         {"latency", &ReadingErrors::latency, latency,
          "from a sample to its arrival, at the first tick that isn't earlier [s]"},
         {"jitter", &ReadingErrors::jitter, latency,
          "the latency of each sample lies evenly between latency - jitter and latency + jitter; at most latency [s]"},
         {"exposure", [](ReadingErrors& errors) -> double& { return errors.exposure.time; }, exposure,
          "of cameras: a picture is the mean light of subframes moments from its capture on, for at most a period [s]"},
         {"subframes",
          [](ReadingErrors& errors) -> int& { return errors.exposure.frames; },
          {1, Exposure::most_frames},
          "of exposure: they lie evenly in it, each as the tick in which it lies"},
         {"readout", [](ReadingErrors& errors) -> double& { return errors.exposure.readout; }, exposure,
          "of cameras: the top row begins at the capture, the others evenly within this time; with exposure at most a "
          "period [s]"},
         FormKey{"stuck", types::of(spell_form), "the last sample before is repeated; a camera delivers no picture"}},
        {},
        {{"sensor", "joint"}}};
    for (const MeasuredQuantity& each : measured_quantities())
      noise.keys.push_back(
          {each.name, types::of([each]() -> const Form& { return errors_form(each); }), "its errors, see below"});
    return noise;
  }();
  return form;
}

/// Whether a key of noise names a quantity.
bool is_quantity(std::string_view key) {
  const std::vector<MeasuredQuantity>& all = measured_quantities();
  return std::ranges::any_of(all, [&](const MeasuredQuantity& each) { return each.name == key; });
}

/// The numbers of an IMU's data sheet beside its rate, by the names of Kalibr's imu.yaml.
struct SheetNumber {
  std::string_view key, quantity;
  const ErrorForm& form;
};
constexpr SheetNumber sheet_numbers[] = {{"gyroscope_random_walk", "angular_velocity", bias_walk_error},
                                         {"gyroscope_noise_density", "angular_velocity", density_error},
                                         {"accelerometer_random_walk", "acceleration", bias_walk_error},
                                         {"accelerometer_noise_density", "acceleration", density_error}};

/// A device or a joint with errors.
struct Target {
  std::string name;  // Body/Device or Body/Joint
  std::vector<MeasuredQuantity> quantities;
  ReadingErrors* errors = nullptr;  // destination
  bool is_joint = false;
  bool slides = false;        // of a joint
  bool has_own_rate = false;  // a camera or range sensor
  const Camera* camera = nullptr;
};

class NoiseReader {
 public:
  NoiseReader(Findings& findings, Scenario& scenario);
  void read_rule(const YamlNode& node);

 private:
  struct Given {
    MeasuredQuantity quantity;
    bool slides = false;
    QuantityErrors errors;
  };

  std::optional<std::vector<const Target*>> find_targets(const Keys& keys, const YamlNode& node) const;
  std::vector<Given> read_quantities(const Keys& keys, const std::vector<const Target*>& targets) const;
  ReadingErrors read_timing(const Keys& keys, const std::vector<const Target*>& targets) const;
  void check_dropout(const Keys& keys) const;
  void check_exposure(const Keys& keys, const std::vector<const Target*>& targets, const Exposure& exposure) const;
  void read_data_sheet(const Keys& keys, const std::vector<const Target*>& targets, std::vector<Given>& given,
                       ReadingErrors& timing) const;

  Findings& findings_;
  std::vector<Target> sensors_;
  std::vector<Target> joints_;
};

NoiseReader::NoiseReader(Findings& findings, Scenario& scenario) : findings_(findings) {
  for (ScenarioBody& body : scenario.bodies) {
    if (body.model == nullptr) continue;
    give_room(body);
    for (std::size_t i = 0; i < body.model->devices.size(); ++i) {
      const Device& device = body.model->devices[i];
      if (std::vector<MeasuredQuantity> quantities = quantities_of(device); !quantities.empty())
        sensors_.push_back({body.name + "/" + device.name, std::move(quantities), &body.errors.devices[i], false, false,
                            value_count(device) == 0, std::get_if<Camera>(&device.kind)});
    }
    for (std::size_t id = 0; id < body.model->joints.size(); ++id) {
      const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
      joints_.push_back({body.name + "/" + joint.name,
                         {joint_quantities.begin(), joint_quantities.end()},
                         &body.errors.joints[id],
                         true,
                         is_linear(joint.type),
                         false});
    }
  }
}

/// The targets that match the rule's pattern; if there are none, an error is reported and the result is none.
std::optional<std::vector<const Target*>> NoiseReader::find_targets(const Keys& keys, const YamlNode& node) const {
  const YamlNode* sensor = keys.find("sensor");
  const YamlNode* joint = keys.find("joint");
  if ((sensor == nullptr) == (joint == nullptr)) {
    findings_.error(node,
                    sensor == nullptr ? "noise names neither a sensor nor a joint" : "noise names a sensor and a joint",
                    "expected one of sensor: Body/Sensor and joint: Body/Joint");
    return std::nullopt;
  }
  const YamlNode& at = sensor == nullptr ? *joint : *sensor;
  const std::string_view key = sensor == nullptr ? "joint" : "sensor";
  const auto pattern = read_text(findings_, at, key, fmt::format("a pattern such as SR1/*"));
  if (!pattern) return std::nullopt;
  std::vector<const Target*> targets;
  std::vector<std::string> names;
  for (const Target& target : sensor == nullptr ? joints_ : sensors_) {
    if (matches(*pattern, target.name)) targets.push_back(&target);
    names.push_back(target.name);
  }
  if (!targets.empty()) return targets;
  findings_.error(at, fmt::format("there is no {} '{}'", key, shortened(*pattern)),
                  name_hint(*pattern, names, fmt::format("{}s", key)));
  return std::nullopt;
}

/// Checks that each quantity is one that a target measures. Joints of both types are read once for each.
std::vector<NoiseReader::Given> NoiseReader::read_quantities(const Keys& keys,
                                                             const std::vector<const Target*>& targets) const {
  std::vector<Given> given;
  for (const NamedEntry& entry : keys.entries()) {
    if (!is_quantity(entry.name)) continue;
    std::vector<std::string> known;
    std::array<std::optional<MeasuredQuantity>, 2> found;  // by Target::slides
    for (const Target* target : targets) {
      for (const MeasuredQuantity& quantity : target->quantities) {
        if (quantity.name == entry.name) found[target->slides ? 1 : 0] = quantity;
        if (std::ranges::find(known, quantity.name) == known.end()) known.emplace_back(quantity.name);
      }
    }
    if (!found[0] && !found[1])
      findings_.error(*entry.key,
                      targets.size() == 1 ? fmt::format("{} doesn't measure '{}'", targets[0]->name, entry.name)
                                          : fmt::format("none of them measures '{}'", entry.name),
                      name_hint(entry.name, known, "quantities"));
    for (const bool slides : {false, true}) {
      const auto& quantity = found[slides ? 1 : 0];
      if (!quantity) continue;
      const auto errors = read_quantity_errors(findings_, *entry.value, *quantity, slides);
      if (!errors) break;
      given.push_back({*quantity, slides, *errors});
    }
  }
  return given;
}

void NoiseReader::check_dropout(const Keys& keys) const {
  const YamlNode* burst = keys.find("burst");
  if (burst && !keys.find("dropout"))
    findings_.error(*burst, "there is a burst without a dropout", "dropout is the share of readings in bursts");
}

/// Of the targets that are cameras.
void NoiseReader::check_exposure(const Keys& keys, const std::vector<const Target*>& targets,
                                 const Exposure& exposure) const {
  const YamlNode *time = keys.find("exposure"), *readout = keys.find("readout"), *frames = keys.find("subframes");
  if (frames && !time)
    findings_.error(*frames, "there are subframes without an exposure", "they are the moments of which it is the mean");
  const YamlNode* place = readout ? readout : time ? time : frames;
  if (!place) return;
  if (std::ranges::none_of(targets, [](const Target* target) { return target->camera != nullptr; }))
    findings_.error(*place, fmt::format("{} is no camera", targets[0]->name), "only cameras have an exposure");
  constexpr double rounding = 1e-9;  // [s]: a rate of 30 Hz and an exposure of 33.333333 ms
  for (const Target* target : targets) {
    if (!target->camera) continue;
    const double longest = std::min(1.0 / target->camera->frame_rate, 1.0), given = exposure.time + exposure.readout;
    if (given <= longest + rounding) continue;
    findings_.error(
        *place,
        fmt::format("{} exposes for {:.4g} s, and its picture arrives after {:.4g} s", target->name, given, longest),
        "expected exposure and readout of at most a period together");
    break;
  }
}

/// The errors of whole readings.
ReadingErrors NoiseReader::read_timing(const Keys& keys, const std::vector<const Target*>& targets) const {
  ReadingErrors errors;
  bound_noise_form().read(keys, errors);
  if (const YamlNode* jitter = keys.find("jitter"); jitter && errors.jitter > errors.latency)
    findings_.error(*jitter,
                    fmt::format("the jitter is {} s, above the latency of {} s", errors.jitter, errors.latency),
                    "each latency lies between latency - jitter and latency + jitter");
  const YamlNode* rate = keys.find("rate");
  const auto own = std::ranges::find_if(targets, [](const Target* target) { return target->has_own_rate; });
  if (rate && own != targets.end())
    findings_.error(*rate, fmt::format("{} has a rate of its own", (*own)->name),
                    "the model's file or `sensors` states it");
  if (const YamlNode* phase = keys.find("phase"); phase && !rate)
    findings_.error(*phase, "there is a phase without a rate", "phase is the time of the first sample");
  if (const YamlNode* stuck = keys.find("stuck"))
    if (const auto spell = read_stuck(findings_, *stuck)) errors.stuck.push_back(*spell);
  check_dropout(keys);
  check_exposure(keys, targets, errors.exposure);
  return errors;
}

/// `imu`: the five numbers of a data sheet in the place of the quantities' errors and the rate.
void NoiseReader::read_data_sheet(const Keys& keys, const std::vector<const Target*>& targets,
                                  std::vector<Given>& given, ReadingErrors& timing) const {
  const YamlNode* node = keys.find("imu");
  if (!node) return;
  for (const std::string_view key : {"angular_velocity", "acceleration", "rate"})
    if (const YamlNode* other = keys.find(key))
      return findings_.error(*other, fmt::format("imu and {} state the same errors", key),
                             "expected the five numbers of imu, or the errors of the quantities");
  const Keys sheet(findings_, *node, data_sheet_form());
  if (!sheet.is_map()) return;
  const auto measured = [](const Target& target, std::string_view name) {
    return std::ranges::find_if(target.quantities, [&](const MeasuredQuantity& each) { return each.name == name; });
  };
  const auto imu = std::ranges::find_if(targets, [&](const Target* target) {
    return measured(*target, "angular_velocity") != target->quantities.end() &&
           measured(*target, "acceleration") != target->quantities.end();
  });
  if (imu == targets.end())
    return findings_.error(*node, fmt::format("{} is no IMU", targets[0]->name),
                           "imu states errors of an angular velocity and an acceleration");
  for (const SheetNumber& number : sheet_numbers) {
    const YamlNode* value = sheet.require(number.key, "a number of the data sheet");
    const MeasuredQuantity& quantity = *measured(**imu, number.quantity);
    const auto read = value ? read_error_numbers(findings_, *value, number.form, quantity, false) : std::nullopt;
    if (given.empty() || given.back().quantity.name != quantity.name) given.push_back({quantity, false, {}});
    if (read && (*read)[0] != number.form.neutral) given.back().errors.given.push_back({&number.form, *read, {}});
  }
  if (const YamlNode* rate = sheet.require("update_rate", "a rate as 400 Hz"))
    timing.rate = read_quantity(findings_, *rate, "update_rate", rate_units, any_reading_rate).value_or(0.0);
}

/// A later rule replaces an earlier one completely.
void NoiseReader::read_rule(const YamlNode& node) {
  const Keys keys(findings_, node, noise_form());
  if (!keys.is_map()) return;
  const auto targets = find_targets(keys, node);
  if (!targets) return;
  std::vector<Given> given = read_quantities(keys, *targets);
  ReadingErrors timing = read_timing(keys, *targets);
  read_data_sheet(keys, *targets, given, timing);
  if (keys.entries().size() == 1)
    findings_.error(node, "noise has neither a quantity nor an error of whole readings",
                    "expected a quantity, as in range: {stddev: 0.01}, or one as dropout: 0.1 or latency: 5 ms");
  for (const Target* target : *targets) {
    ReadingErrors errors = timing;
    errors.quantities.resize(target->quantities.size());
    for (std::size_t i = 0; i < errors.quantities.size(); ++i)
      for (const Given& each : given)
        if (each.quantity.name == target->quantities[i].name && each.slides == target->slides)
          errors.quantities[i] = each.errors;
    *target->errors = std::move(errors);
  }
}

}  // namespace

const Form& noise_form() { return bound_noise_form(); }

void give_room(ScenarioBody& body) {
  body.errors.devices.resize(body.model->devices.size());
  body.errors.joints.resize(body.model->joints.size());
}

void read_noise(Findings& findings, const YamlNode& node, Scenario& scenario) {
  NoiseReader reader(findings, scenario);
  for (const YamlNodePtr& rule : read_list(findings, node, "noise", "a list of noise of sensors and joints"))
    reader.read_rule(*rule);
}

}  // namespace rehearse
