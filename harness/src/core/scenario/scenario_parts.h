// The parts of a scenario file. A separate function reads each of them into the Scenario.
#pragma once

#include <rehearse/scenario.h>

#include <string>

#include "scenario_findings.h"
#include "scenario_values.h"
#include "yaml/yaml_tree.h"

namespace rehearse {

inline constexpr Range any_time{0.0, Scenario::max_duration, "[s]"};  // in a run
inline constexpr Range any_latency{0.0, 1.0, "[s]"};
inline constexpr Range any_reading_rate{0.0, 1e6, "[Hz]", true};
inline constexpr Range any_exposure{0.0, 1.0, "[s]"};

/// The type of a rotation: [roll, pitch, yaw], {axis, angle} or {quaternion}.
ValueType rotation_type();

/// The `solver` map.
void read_solver(Findings& findings, const YamlNode& node, SolverSettings& solver);

/// The `look` map.
void read_look(Findings& findings, const YamlNode& node, Look& look);

/// The `bodies` list with its models, each requested once. A body with a mistake is added nevertheless, so that indices
/// and names of references stay valid. Its model is null if the model is the mistake.
void read_bodies(Findings& findings, const YamlNode& node, const Scenario::ModelSource& models,
                 const Scenario::FileSource& files, Scenario& scenario);

/// The name of a controller that states none: "Hold" for Hold, build/Hold.so and hold.py:Hold.
std::string name_of_library(const std::string& library);

/// The `controllers` list of a body.
void read_controllers(Findings& findings, const YamlNode& node, ScenarioBody& body, const std::string& file);

/// Initial displacements: a map by name or a list by joint id; null: none is given. A displacement that isn't given is
/// 0; if 0 is outside of the limits, it is the nearest limit, with a warning. Sets body.joints, and warns of
/// displacements outside of their limits. `body_node` is the node of the whole body; body.model must not be null.
/// `posture`: the displacements of joints that `node` doesn't state; null: those of the model.
void read_joints(Findings& findings, const YamlNode& body_node, const YamlNode* node, const Posture* posture,
                 ScenarioBody& body);

/// Initial velocities of joints, a map by name. body.model must not be null.
void read_joint_velocities(Findings& findings, const YamlNode& node, ScenarioBody& body);

/// The `actuators` list: rules by joints, of which the last that matches applies, key by key. body.model must not be
/// null.
void read_actuators(Findings& findings, const YamlNode& node, ScenarioBody& body);

/// The `sensors` list: devices in addition to those of the model, which is replaced. body.model must not be null.
void read_sensors(Findings& findings, const YamlNode& node, ScenarioBody& body);

/// The `belts` list: fixed joints of links that become tracks of the model, which is replaced. Controllers know no
/// joint id of them. body.model must not be null.
void read_belts(Findings& findings, const YamlNode& node, ScenarioBody& body);

/// The `links` map: masses and surfaces that replace those of the model. body.model must not be null.
void read_links(Findings& findings, const YamlNode& node, const SolverSettings& solver, ScenarioBody& body);

/// States the defaults of the links that the `links` map doesn't name.
void state_links(Findings& findings, const YamlNode& links, const SolverSettings& solver, const Model& model);
/// States the defaults of a surface: those of the model, else of the solver.
void state_surface(const Keys& keys, const SolverSettings& solver, const Surface& known);

/// `materials`, a map from bodies and links to names, and the `pairs` list; null: the scenario has none. After the
/// bodies.
void read_materials(Findings& findings, const YamlNode* materials, const YamlNode* pairs, Scenario& scenario);

/// The `joints` list: joints between links in addition to those of the models. After the bodies.
void read_connections(Findings& findings, const YamlNode& node, Scenario& scenario);

/// The `welds` list: links that are connected for a time. After the bodies and the duration.
void read_welds(Findings& findings, const YamlNode& node, Scenario& scenario);

/// The `pushes` list. After the bodies.
void read_pushes(Findings& findings, const YamlNode& node, Scenario& scenario);

/// The `joystick` list. After the duration.
void read_joystick(Findings& findings, const YamlNode& node, Scenario& scenario);

/// all, none, or a list of Body/Camera. After the bodies.
void read_cameras(Findings& findings, const YamlNode& node, Scenario& scenario);

/// The `noise` list. After the bodies.
void read_noise(Findings& findings, const YamlNode& node, Scenario& scenario);
/// The `faults` of the bodies, a list for each. After the noise. `bodies`: the list of bodies.
void read_faults(Findings& findings, const YamlNode& bodies, Scenario& scenario);
/// The keys by which a fault names its part.
inline constexpr std::string_view fault_owners[] = {"sensor", "encoder", "actuator", "link", "controller"};
/// Makes room for the errors of each sensor and joint. body.model must not be null.
void give_room(ScenarioBody& body);
/// The map of a quantity's errors; nullopt: a mistake was reported. `slides`: the quantity is that of a joint that
/// slides.
std::optional<QuantityErrors> read_quantity_errors(Findings& findings, const YamlNode& node,
                                                   const MeasuredQuantity& quantity, bool slides);
/// The numbers of an error, as a number with a unit or as a list of the axes.
std::optional<std::array<double, 3>> read_error_numbers(Findings& findings, const YamlNode& node, const ErrorForm& form,
                                                        const MeasuredQuantity& quantity, bool slides);
/// `stuck` as {from: T, until: T}, each with a default: the beginning of the run, and no end.
std::optional<Spell> read_stuck(Findings& findings, const YamlNode& node);
/// The keys `from` and `until` of a map with other keys.
Spell read_spell_keys(Findings& findings, const Keys& keys);

/// Warns of cameras and range sensors whose rate is higher than that of the steps. `bodies` is the list of a scenario
/// without errors.
void check_rates(Findings& findings, const YamlNode& bodies, const Scenario& scenario);

/// The `tolerances` list.
void read_tolerances(Findings& findings, const YamlNode& node, Scenario& scenario);

/// The `expect` list. After the duration.
void read_expectations(Findings& findings, const YamlNode& node, Scenario& scenario);
/// The expressions of an expectation whose condition is set, and what belongs to them.
void read_expressions(Findings& findings, const Keys& keys, const Scenario& scenario, Expectation& expectation);
void read_margin(Findings& findings, const Keys& keys, Expectation& expectation);

/// The `vary` map. `root`: the whole scenario, which states the nominal values.
void read_variations(Findings& findings, const YamlNode& node, const YamlNode& root, Scenario& scenario);
/// The place of the value at a path, also of a default; none: it is reported. The scenario has been read.
std::optional<Variation> place_of(Findings& findings, const YamlNode& root, const Scenario& scenario,
                                  const std::string& path);

/// The index of the body of that name in scenario.bodies; reports it if there is none.
std::optional<int> find_body(Findings& findings, const YamlNode& at, std::string_view name, const Scenario& scenario);

/// The index of the body's link; reports it if there is none. body.model must not be null.
std::optional<int> find_link(Findings& findings, const YamlNode& at, const std::string& name, const ScenarioBody& body);

/// The span of time of `what`, "push": from <= t < until. Reports mistakes, and warns of a span after the end of the
/// run.
struct Span {
  double from = 0.0;   // [s]
  double until = 0.0;  // [s]
};
std::optional<Span> read_span(Findings& findings, const Keys& keys, const Scenario& scenario, std::string_view what);

}  // namespace rehearse
