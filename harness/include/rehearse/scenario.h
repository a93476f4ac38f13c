// Scenario: everything that decides a run, as a YAML file states it. fixtures/README.md describes the file form.
//
// Loading checks the file by itself and against the models that it names: every mistake is a Diagnostic with file, line
// and column, all of them in one go. A loaded scenario can be run; whether a controller's library loads is found out
// then.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/scene_settings.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// A joystick that a scenario moves. Its reading is a function of time alone.
/// Everything rests at 0 and unpressed until it is told otherwise, and stays where it was told to be.
class JoystickScript {
 public:
  /// From the time `at` [s] on, the axis goes in a straight line from where it is to the position `to`, within `over`
  /// [s]; at once if that is 0. A way it is still on ends there. `at` is after that of the axis's last move.
  void move(std::size_t axis, double at, double over, double to);
  /// From the time `at` [s] on, the button is pressed, or not. `at` is after that of the button's last press.
  void press(std::size_t button, double at, bool pressed);

  /// Whether the axis is at that position at a time [s], and not just passing it.
  bool rests(std::size_t axis, double time, double position) const;
  bool is_pressed(std::size_t button, double time) const;

  /// When the axis (the button) was last told anything [s]; below 0 if never.
  double last_move(std::size_t axis) const;
  double last_press(std::size_t button) const;

  /// At a time [s]; positions rounded to the nearest single-precision number.
  JoystickReading at(double time) const;

 private:
  struct Move {
    double at;
    double over;
    double from;
    double to;
  };
  struct Press {
    double at;
    bool pressed;
  };
  double position(std::size_t axis, double time) const;

  // Each in order of time.
  std::array<std::vector<Move>, joystick_axes.size()> moves_;
  std::array<std::vector<Press>, joystick_buttons.size()> presses_;
};

struct UrdfOptions;

// Sensor noise: how far what controllers read is from the truth, as a scenario's `noise:` has it.
//
// A reading is truth + bias + stddev * n, with n from the standard normal distribution, or it is missing (dropout). n
// is a function of the scenario's seed, the sensor's name, the tick and the number's place in the reading, and of
// nothing else: noise at one sensor changes no other's, and a run that goes on from a checkpoint finds the same.

/// Something that a sensor or joint measures.
struct MeasuredQuantity {
  std::string_view name;
  std::string_view unit;
  int axes;  // 3: x, y, z, each with a bias of its own; 1: all numbers are alike
};

/// Of a Gyro angular_velocity, of an Accelerometer acceleration, of an Imu both, of a ForceSensor force and torque, of
/// a ContactSensor force, of a RangeSensor range, of a camera color, and depth if it measures it; of lights none.
std::vector<MeasuredQuantity> quantities_of(const Device& device);

/// displacement, velocity and effort. Their unit is "rad or m" and so on.
inline constexpr std::size_t joint_quantity_count = 3;
extern const std::array<MeasuredQuantity, joint_quantity_count> joint_quantities;

/// In the unit of the quantity.
struct Noise {
  double stddev = 0.0;
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  // of a quantity without axes: x

  bool changes_nothing() const { return stddev == 0.0 && bias.isZero(0.0); }
};

struct DeviceNoise {
  std::vector<Noise> quantities;  // as quantities_of() has them; empty: none
  /// Share of the readings that don't come, 0 to 1: of the beams of a RangeSensor (they find nothing), of a
  /// RangeCamera's depths (they find nothing); of any other sensor, of its readings as a whole.
  double dropout = 0.0;

  bool changes_nothing() const;
};

struct JointNoise {
  std::array<Noise, joint_quantity_count> quantities;

  bool changes_nothing() const;
};

/// What a scenario's noise does to a body. Empty lists: nothing.
struct BodyNoise {
  std::vector<DeviceNoise> devices;  // by device index
  std::vector<JointNoise> joints;    // by joint id

  /// Whether controllers read any joint otherwise than it is.
  bool disturbs_joints() const;
};

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
/// moment. Of events: one that matches happens in the span, or none does. check.h judges a run by it.
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

// Tolerance: how far a value may be from its golden, and which rule decides that.
//
// A number x passes against its golden g if |x - g| <= max(atol, rtol * scale). The scale is the largest |g| of its
// series; of a vector with elements x, y and z, the largest norm: an axis along which nothing moves is not judged by
// its own noise. A scenario states rules (`tolerances:`); what no rule speaks of has the default of its unit.
//
// A rule may allow for time: with `lead` and `lag`, x passes at time t if it is within that bound of anything between
// the least and the greatest that the golden is from t - lag to t + lead; an orientation, of any that it passes
// through. The span ends where the record does. With both 0, which is the default, only the same tick counts.
//
// Events (contacts, limits, what control() returns, messages) may be off by whole `ticks`.

struct Tolerance {
  double atol = 0.0;                        // in the unit of the series
  double rtol = 0.0;                        // of the scale
  double lead = 0.0;                        // [s]
  double lag = 0.0;                         // [s]
  std::optional<int> ticks = std::nullopt;  // events: how far off they may be; none: no rule says
  double pixel_share = 0.0;  // pictures: share of the pixels that may differ by more than is allowed to each, 0 to 1
  double pixel_delta = 0.0;  // pictures: difference of a colour [of 255] that still counts as equal
  /// Pictures: the same share within any square of 16 x 16 pixels. It tells an object that is gone from speckle.
  double pixel_window = 0.25;

  /// The largest difference that passes, for a series of that scale.
  double bound(double scale) const { return std::max(atol, rtol * scale); }
  bool allows_for_time() const { return lead > 0.0 || lag > 0.0; }
};

/// What a series may differ by if no rule speaks of it, by its unit. Beside it what was measured: the largest noise
/// (`rehearse golden noise`) of all sample scenarios over ten seconds each, on the plant level, where a difference
/// lives for 0.1 s:
///
///   unit                                    default             noise, and where
///   rad, quaternion (an angle [rad])        1e-9                7e-13   the arm with a grasp
///   m                                       1e-9                3e-13   its fingers
///   unit vector (each element)              1e-9                0       they round with the orientations
///   rad/s                                   1e-7                3e-10   its turntable
///   m/s                                     1e-7                8e-11   its fingers
///   rad/s², m/s²                            1e-4                3e-8    SR1 in free fall
///   N·m                                     1e-3                5e-5    what the grasping arm needs to go by position
///   N                                       1e-4                1e-7    SR1 in free fall
///   range: of a laser [m]                   1e-9, rtol 2^-23    a last bit of single precision, if it is on the edge
///   depth: a distance in a picture [m]      rtol 1e-3, share    1e-4 of it: a step of the depth buffer, 5 m away
///   pixels                                  2 of 255, share     1 of 255
///   camera: matrices of a camera_info       1e-9                7e-13   a URDF whose numbers have 15 digits
///   any other, none                         0: the same bits
///
/// The share of a picture's pixels that may differ by more is 0.0005: edges fall on the next pixel. A command that a
/// controller computes in another arithmetic differs by less than a state does. Between noise and default lie 10 to
/// 10^7, and the smallest faults that were tried (1 g more of 30 kg, 1 % less friction) differ by 10^2 to 10^7 times
/// the default and more.
///
/// In the closed loop noise grows, with contacts a thousandfold a second and more: there the same numbers hold up to
/// the scenario's horizon only.
Tolerance default_tolerance(std::string_view unit);

/// The last rule that matches the series decides. What it doesn't state, and what no rule matches, is as by default.
Tolerance tolerance_of(std::string_view series, std::string_view unit, const std::vector<ToleranceRule>& rules);

}  // namespace rehearse
