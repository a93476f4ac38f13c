// Scenario: everything that decides a run, as a YAML file states it. fixtures/README.md describes the file form.
//
// Loading checks the file by itself and against the models that it names: every mistake is a Diagnostic with file, line
// and column, all of them in one go. A loaded scenario can be run; whether a controller's library loads is found out
// then.
#pragma once

#include <rehearse/joystick_script.h>
#include <rehearse/look.h>
#include <rehearse/model.h>
#include <rehearse/sensor_noise.h>
#include <rehearse/solver_settings.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct UrdfOptions;

/// The place of something in the scenario file, for messages that come up only when it runs.
struct Place {
  std::string file;  // as the user named it
  int line = 0;      // 1-based
  int column = 0;    // 1-based
};

/// The diagnostic with that place.
Diagnostic at(const Place& place, Diagnostic diagnostic);

struct ScenarioController {
  std::string name;                         // unique within its body; names the channels
  std::string library;                      // a name (SR1MinimumController) or a path relative to the scenario
  std::string options;                      // the controller's own option string
  bool delay = true;                        // commands act one tick late
  bool optional = false;                    // the run goes on without it if it refuses to take part
  std::vector<ScenarioController> children;  // share their parent's body; one level
  Place place;                              // of its library
};

struct ScenarioBody {
  std::string name;                         // unique; names the channels
  std::string model_file;                   // as written; empty for an inline shape
  std::map<std::string, std::string> packages;  // where the model's meshes are: directories by package, as written
  std::shared_ptr<const Model> model;       // never null in a loaded scenario
  bool fixed = false;                       // the root link is fixed to the world, by the scenario or by the model
  Eigen::Vector3d position = Eigen::Vector3d::Zero();                // of the root link [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();      // of the root link, unit
  bool kinematic = false;                   // it moves as it is commanded, without dynamics
  bool joint_limits = false;                // its joints stop at their limits
  bool effort_limits = false;               // commanded efforts are clamped to their limits
  bool trimesh = false;                     // meshes of links that never move are touched as they are
  bool self_collision = false;              // all its links touch each other
  std::vector<double> joints;               // initial displacement by joint id [rad] or [m]
  std::vector<ScenarioController> controllers;
  BodyNoise noise;                          // of its sensors and joints
  Place place;                              // of its name
};

/// A force and torque on a link over a span of time: from <= t < until.
struct Push {
  int body = 0;                                        // index into Scenario::bodies
  int link = 0;                                        // index into its model's links
  Eigen::Vector3d force = Eigen::Vector3d::Zero();     // world [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();    // world [N·m]
  Eigen::Vector3d point = Eigen::Vector3d::Zero();     // where the force acts, link frame [m]
  double from = 0.0;                                   // [s]
  double until = 0.0;                                  // [s]
};

/// How far the channels that match may be from the golden: |x - g| <= max(atol, rtol * scale).
struct ToleranceRule {
  std::string channel;          // a glob over series names, as `SR1/*/q`; * stands for any text, slashes included
  std::optional<double> atol;   // in the channel's unit
  std::optional<double> rtol;   // of the largest magnitude of the channel in the golden
  std::optional<double> lead;   // the value may be what the golden becomes up to so much later [s]
  std::optional<double> lag;    // the value may be what the golden was up to so much before [s]
  std::optional<int> ticks;     // events: how far they may be from the golden's [ticks]
  std::optional<double> pixel_window;  // images: the same within any square of 16 x 16 pixels, 0 to 1
  std::optional<double> pixel_share;  // images: share of pixels that may differ, 0 to 1
  std::optional<double> pixel_delta;  // images: difference of a colour channel [0..255] that still counts as equal
  Place place;                        // of its channel
};

/// A property that a run has to have, however its values compare with the golden's. Of series: each that matches, and
/// at least one, is within the bounds in the whole span, or with `sometime` in one sample of it, or with `at` in one
/// moment. Of events: one that matches happens in the span, or none does. expectation.h judges a run by it.
struct Expectation {
  enum class Subject { series, event, no_event };

  Subject subject = Subject::series;
  std::string pattern;           // a glob over series names, or over an event's "SEVERITY SOURCE: TEXT"
  bool absolute = false;         // the magnitude is bounded
  std::optional<double> since;   // what is bounded is the change since then [s]
  std::optional<double> above;   // the bound itself is wrong; in the series' unit, angles in [rad]
  std::optional<double> below;   // likewise
  std::optional<double> near;    // the bounds of near and within are right; both are there, or none
  std::optional<double> within;  // of near
  bool angle = false;            // a bound was given as an angle: the series has to be one
  bool degrees = false;          // and is told in degrees
  bool sometime = false;         // one sample of the span is enough
  std::optional<double> from;    // of the span [s], itself included; nullopt: the beginning of the run
  std::optional<double> until;   // of the span [s], itself included; nullopt: its end
  std::optional<double> at;      // instead of the span: the latest sample at that time or before [s]
  bool at_end = false;           // instead of the span: the last sample
  Place place;                   // of its pattern
};

struct Scenario {
  static constexpr double max_duration = 86400.0;  // [s]
  static constexpr double min_time_step = 1e-5;    // [s]
  static constexpr double max_time_step = 0.1;     // [s]

  std::string file;                     // as the user named it
  std::string text;                     // the file's bytes
  std::string name;                     // `name:`, or the file's name without .yaml
  std::string golden;                   // `golden:` Suite.Test, or empty
  double duration = 0.0;                // [s]
  double time_step = 0.001;             // [s]
  std::uint32_t seed = 0;
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};  // [m/s²]
  SolverSettings solver;
  std::string options;                  // simulator-wide option string, before each controller's own
  std::vector<ScenarioBody> bodies;
  std::vector<Push> pushes;
  std::optional<JoystickScript> joystick;  // nullopt: there is none
  Look look;                            // of all pictures
  /// Cameras that run, as "Body/Camera"; nullopt: all.
  std::optional<std::vector<std::string>> cameras;
  bool record_frames = true;            // pictures go into the trace
  std::vector<ToleranceRule> tolerances;  // in file order; the last that matches wins
  std::optional<double> horizon;          // values are compared with the golden's up to then [s]; nullopt: not stated
  std::vector<Expectation> expectations;  // `expect:`, in file order
  Diagnostics warnings;                 // of the scenario and its models

  /// lround(duration / time_step), as Choreonoid counts.
  std::int64_t ticks() const;

  /// Whether that camera of that body draws in this run.
  bool runs_camera(const std::string& body, const std::string& camera) const;

  /// Reads, checks, and loads the models. Every mistake in one go and in document order, at most 20 of the scenario's
  /// own; a model that can't be used is one of them, followed by the model's own. What the models had repaired or
  /// warned of comes back in `warnings`.
  static Result<Scenario> load(const std::filesystem::path& file);

  /// Where the models of a scenario come from: given `model:` as the scenario has it, and how a body wants it loaded, the
  /// model, or why there is none. The directories of packages are as the scenario has them. A diagnostic without a file
  /// is told at the place of that `model:`.
  using ModelSource = std::function<Result<Model>(const std::string& model_file, const UrdfOptions& options)>;

  /// The same from text that is already in memory, as in a recording; `file` stands in messages and in Scenario::file.
  static Result<Scenario> parse(std::string text, const std::string& file, const ModelSource& models);
};

/// The `tolerances` of a YAML file, which is a scenario (then nothing else of it is read) or has no other key.
Result<std::vector<ToleranceRule>> load_tolerances(const std::filesystem::path& file);

}  // namespace rehearse
