// Scenario: all settings that determine a run, as a YAML file states them. The page reference/scenario.md describes the
// file format.
//
// Loading checks the file itself and compares it with the models that it names. Every mistake is a Diagnostic with
// file, line and column; all mistakes are reported together. A loaded scenario can be run; a run reports controllers
// whose library can't be loaded.
#pragma once

#include <rehearse/actuator.h>
#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/sensor_errors.h>
#include <rehearse/world_settings.h>

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

/// A joystick that a scenario moves. Its reading is a function of time alone. All axes rest at 0 and all buttons are
/// released until the script moves or presses them; each keeps its last position or state.
class JoystickScript {
 public:
  /// From the time `at` [s] on, the axis moves linearly from its present position to `to`, within `over` [s]; at once
  /// if that is 0. A move that is not finished ends there. `at` must be later than that of the axis's last move.
  void move(std::size_t axis, double at, double over, double to);
  /// From the time `at` [s] on, the button is pressed or released. `at` must be later than that of the button's last
  /// press.
  void press(std::size_t button, double at, bool pressed);

  /// Whether the axis rests at that position at a time [s]; false if it only passes it.
  bool rests(std::size_t axis, double time, double position) const;
  bool is_pressed(std::size_t button, double time) const;

  /// The time of the last move of the axis (the last press of the button) [s]; below 0 if there is none.
  double last_move(std::size_t axis) const;
  double last_press(std::size_t button) const;

  /// The reading at a time [s]; positions are rounded to the nearest single-precision number.
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

  // In order of time for each axis and button.
  std::array<std::vector<Move>, joystick_axes.size()> moves_;
  std::array<std::vector<Press>, joystick_buttons.size()> presses_;
};

struct UrdfOptions;

/// A place in the scenario file, for messages that arise only when the scenario runs.
struct Place {
  std::string file;  // as the user named it
  int line = 0;      // 1-based
  int column = 0;    // 1-based
};

/// The diagnostic with that place added.
Diagnostic at(const Place& place, Diagnostic diagnostic);

/// `threads:` of a controller: how the threads that it starts run.
struct ThreadRules {
  bool are_free = false;  // as the kernel lets them; else in turns
  /// By the name of a thread, or of the function with which it begins: how much later it goes on when it was woken [s].
  std::map<std::string, double> delays = {};
};

struct ScenarioController {
  std::string name;                          // unique within its body; names the channels
  std::string library;                       // a name (SR1MinimumController) or a path relative to the scenario
  std::string options;                       // the controller's own option string
  bool delay = true;                         // commands act one tick late
  bool optional = false;                     // the run continues without it if it refuses to take part
  ThreadRules threads;                       // of its own threads
  bool is_called = true;                     // false: a child of a child, which is started and stopped only
  std::vector<ScenarioController> children;  // they use their parent's body; those of a child follow it
  std::vector<Spell> lost;                   // faults: its commands of these times don't arrive
  Place place;                               // of its library

  /// Whether its commands of the tick at `time` don't arrive [s].
  bool loses(double time, double time_step) const;
};

/// `collision:` of a body: its meshes in contacts, or no contacts at all.
struct BodyContact {
  MeshContact meshes = MeshContact::automatic;
  bool touches = true;  // false: its shapes pass through those of all bodies
  bool operator==(const BodyContact&) const = default;
};

struct ScenarioBody {
  std::string name;                             // unique; names the channels
  std::string title;                            // name for controllers; empty: `name`
  std::string model_file;                       // a URDF or a heightmap, as written; empty for an inline shape
  std::map<std::string, std::string> packages;  // directories of the model's meshes by package, as written
  std::shared_ptr<const Model> model;           // never null in a loaded scenario
  bool fixed = false;                           // the root link is fixed to the world, by the scenario or by the model
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            // of the root link [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // of the root link, unit
  bool kinematic = false;                                        // it follows its commands exactly, without dynamics
  /// Joints stop at their limits unless this is false. If the scenario states it, recordings contain the limits.
  std::optional<bool> joint_limits;
  bool effort_limits = false;                                  // commanded efforts are clamped to their limits
  bool drive_limits = true;                                    // drives keep to the limits of effort and velocity
  BodyContact contact;                                         // of its shapes
  bool self_collision = false;                                 // all links of the body can collide with each other
  std::vector<double> joints;                                  // initial displacement by joint id [rad] or [m]
  Eigen::Vector3d linear_velocity = Eigen::Vector3d::Zero();   // initial, of the root link's origin, world [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // initial, of the root link, world [rad/s]
  std::vector<double> joint_velocities;                        // initial, by joint id [rad/s] or [m/s]
  std::vector<std::string> materials;  // by link index, empty names: none; an empty list: no link has one
  std::vector<ScenarioController> controllers;
  /// By joint id, without the keys of their random numbers; nullopt: the joint is ideal. An empty list: all are.
  std::vector<std::optional<Actuator>> actuators;
  std::vector<MassFault> mass_faults;  // of its links
  BodyErrors errors;                   // of its sensors and joints
  Place place;                         // of its name
};

/// A force and torque on a link over a span of time: from <= t < until.
struct Push {
  int body = 0;                                      // index into Scenario::bodies
  int link = 0;                                      // index into its model's links
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // world [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // world [N·m]
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   // point of attack of the force, link frame [m]
  double from = 0.0;                                 // [s]
  double until = 0.0;                                // [s]
};

/// The allowed difference of the matching channels from the golden: |x - g| <= max(atol, rtol * scale).
struct ToleranceRule {
  std::string channel;                 // a glob over series names, as `SR1/*/q`; * matches any text, slashes included
  std::optional<double> atol;          // in the channel's unit
  std::optional<double> rtol;          // of the largest magnitude of the channel in the golden
  std::optional<double> lead;          // the value may equal the golden's value up to so much later [s]
  std::optional<double> lag;           // the value may equal the golden's value up to so much earlier [s]
  std::optional<int> ticks;            // events: allowed distance from the golden's events [ticks]
  std::optional<double> pixel_window;  // images: as pixel_share, within any square of 16 x 16 pixels, 0 to 1
  std::optional<double> pixel_share;   // images: share of pixels that may differ, 0 to 1
  std::optional<double> pixel_delta;   // images: difference of a colour channel [0..255] that still counts as equal
  Place place;                         // of its channel
};

/// A property that a run must have, independent of the golden's values. For series: at least one series matches, and
/// each matching series is within the bounds in the whole span. With `sometime` it is so in one sample of the span;
/// with `at`, at one time. For events: a matching event happens in the span, or no matching event does. check.h judges
/// a run by it.
struct Expectation {
  enum class Subject { series, event, no_event, expression };
  enum class Quantifier { always, eventually, never };
  /// The distance from a violation that is demanded, in the unit of what is compared (angles in [rad]), or as a share
  /// of the bound.
  struct Margin {
    double least = 0.0;
    bool is_share = false;
    bool angle = false;  // it was given as an angle
    std::string text;    // as written: "10 %"
  };
  /// A limit of a joint's model.
  struct Limit {
    double value = 0.0;
    std::string unit;
  };

  Subject subject = Subject::series;
  std::string pattern;           // a glob over series names, or over an event's "SEVERITY SOURCE: TEXT"
  bool absolute = false;         // the bound applies to the magnitude
  std::optional<double> since;   // the bound applies to the change since this time [s]
  std::optional<double> above;   // a value equal to the bound violates it; in the series' unit, angles in [rad]
  std::optional<double> below;   // likewise
  std::optional<double> near;    // a value equal to the bound of near and within is right; both are given, or none
  std::optional<double> within;  // allowed distance from near
  bool angle = false;            // a bound was given as an angle: the series must be an angle
  bool degrees = false;          // messages state the values in degrees
  bool sometime = false;         // one sample in the span is enough
  std::optional<double> from;    // start of the span, included [s]; nullopt: the beginning of the run
  std::optional<double> until;   // end of the span, included [s]; nullopt: the end of the run
  std::optional<double> at;      // instead of the span: the latest sample up to that time [s]
  bool at_end = false;           // instead of the span: the last sample
  std::optional<Margin> margin;  // demanded of a run

  // Of an expression; the page concepts/expectations.md states what they mean.
  Quantifier quantifier = Quantifier::always;
  std::string expression;               // a condition
  std::string after, except;            // conditions; empty: none
  std::optional<double> delay;          // `within` [s]
  std::optional<double> lasting;        // `for` [s]
  std::vector<std::string> names;       // patterns of the series that it names
  std::map<std::string, Limit> limits;  // "JOINT LIMIT": the limits that it names

  Place place;  // of its pattern or expression
};

/// The distribution of a varied value.
enum class Distribution {
  uniform,      // between two bounds
  log_uniform,  // its logarithm is uniform
  normal,       // truncated at two bounds
  choice,       // one of several values, each as likely
  grid,         // all combinations of the grids' values, in order of the cases
  from_file,    // a row of a file, in order of the cases
  linked,       // computed from other parameters
};

/// A parameter that a campaign varies (`vary:`, campaign.h). Runs by record() and checks use the nominal value.
struct Variation {
  std::string name;
  std::string path;  // of the value in the scenario: bodies.Box.position[0]
  Distribution distribution = Distribution::uniform;
  bool integer = false;             // whole numbers only; uniform, log_uniform, normal, linked
  double low = 0.0, high = 0.0;     // uniform, log_uniform, normal: both included
  double mean = 0.0, stddev = 1.0;  // normal, before truncation
  std::vector<std::string> values;  // choice, grid; as written
  std::string file, column;         // from_file: a CSV beside the scenario, and a name in its first line
  std::string expression;           // linked
  std::string nominal;              // the value that the scenario states, as written, without a unit; or a default
  std::size_t begin = 0, end = 0;   // its place in Scenario::text [bytes]
  bool in_text = false;             // the place is within quotes, or in an option string
  std::string before, after;        // what is written around a value whose key the scenario doesn't state
  Place place;                      // of its name
};

/// The settings of its world, of which `connections` are those after `joints:` and `welds:`, and everything else.
struct Scenario : WorldSettings {
  static constexpr double max_duration = 86400.0;  // [s]
  static constexpr double min_time_step = 1e-5;    // [s]
  static constexpr double max_time_step = 0.1;     // [s]

  std::string file;    // as the user named it
  std::string text;    // the file's bytes
  std::string name;    // `name:`, or the file's name without .yaml
  std::string golden;  // `golden:` Suite.Test, or empty
  /// `golden: {state: 100 Hz}`: rate at which the golden keeps the state of the world [Hz]; nullopt: every tick.
  std::optional<double> golden_state_rate;
  double duration = 0.0;          // [s]
  bool ends_when_done = false;    // the run ends after the step in which every control() returned false
  bool initial_commands = false;  // what initialize() writes into commands acts in the first step
  bool planar = false;            // root links that aren't fixed stay in the plane of x and z in which they begin
  std::string options;            // option string of the simulator, before each controller's option string
  std::vector<ScenarioBody> bodies;
  std::vector<Push> pushes;
  std::optional<JoystickScript> joystick;  // nullopt: the scenario has none
  Look look;                               // of all pictures
  /// Cameras that take pictures, as "Body/Camera"; nullopt: all.
  std::optional<std::vector<std::string>> cameras;
  bool record_frames = true;              // pictures are written into the trace
  std::vector<ToleranceRule> tolerances;  // in file order; the last that matches wins
  bool counts_costs = false;              // `realtime: counts`: the costs of control() are recorded
  std::optional<double> horizon;  // values are compared with the golden's up to this time [s]; nullopt: not stated
  std::vector<Expectation> expectations;  // `expect:`, in file order
  std::vector<Variation> variations;      // `vary:`, in file order
  Diagnostics warnings;                   // of the scenario and its models

  /// lround(duration / time_step), as Choreonoid counts ticks.
  std::int64_t ticks() const;

  /// Whether that camera of that body takes pictures in this run.
  bool runs_camera(const std::string& body, const std::string& camera) const;
  /// Whether any camera of any body takes pictures.
  bool runs_a_camera() const;

  /// Reads and checks the file, and loads the models. All mistakes are reported together, in document order, at most 20
  /// of the scenario itself. A model that can't be used is one of them, followed by the model's mistakes. Repairs and
  /// warnings of the models are in `warnings`.
  static Result<Scenario> load(const std::filesystem::path& file);
  /// As load() of a file with this text in the place of `file`.
  static Result<Scenario> load_text(std::string text, const std::filesystem::path& file);

  /// The text with other values in the places of the variations, one for each. An empty value leaves the nominal one.
  /// All else, comments included, stays as written. Fails if a value can't be written there.
  Result<std::string> varied_text(const std::vector<std::string>& values) const;

  /// The source of the models of a scenario. It gets `model:` as written in the scenario, and load options for the
  /// body; it returns the model, or an error. The directories of packages are as written in the scenario. A diagnostic
  /// without a file is reported at the place of that `model:`.
  using ModelSource = std::function<Result<Model>(const std::string& model_file, const UrdfOptions& options)>;

  /// The source of the bytes of a heightmap's file, as written in the scenario.
  using FileSource = std::function<Result<std::string>(const std::string& file)>;

  /// Parses text that is already in memory, as in a recording; `file` is used in messages and in Scenario::file.
  /// Without `files` a heightmap is an error.
  static Result<Scenario> parse(std::string text, const std::string& file, const ModelSource& models,
                                const FileSource& files = {});
};

/// The `tolerances` of a YAML file: a scenario, of which nothing else is read, or a file without other keys.
Result<std::vector<ToleranceRule>> load_tolerances(const std::filesystem::path& file);

// Tolerance: the allowed difference of a value from its golden, and the rule that determines it.
//
// A number x passes against its golden g if |x - g| <= max(atol, rtol * scale). The scale is the largest |g| of its
// series. For a vector with elements x, y and z it is the largest norm, so that an axis without motion is not judged by
// its own noise. A number in an array of varying length is in no series: its own |g| is the scale. A scenario states
// rules (`tolerances:`). A series without a rule has the default of its unit.
//
// A rule may allow for time, with `lead` and `lag`. At time t the golden's values from t - lag to t + lead have a least
// and a greatest one. x passes if it is within that bound of any value between these two. An orientation passes if it
// is within the bound of any orientation of the golden in this span. The span ends where the recording ends. With both
// 0, which is the default, only the same tick counts.
//
// Events (contacts, limits, what control() returns, messages) may be off by whole `ticks`.

struct Tolerance {
  double atol = 0.0;                        // in the unit of the series
  double rtol = 0.0;                        // of the scale
  double lead = 0.0;                        // [s]
  double lag = 0.0;                         // [s]
  std::optional<int> ticks = std::nullopt;  // events: allowed distance [ticks]; none: no rule states it
  double pixel_share = 0.0;  // pictures: share of the pixels that may differ by more than pixel_delta, 0 to 1
  double pixel_delta = 0.0;  // pictures: difference of a colour [of 255] that still counts as equal
  /// Pictures: as pixel_share, within any square of 16 x 16 pixels. It separates a missing object from speckle.
  double pixel_window = 0.25;

  /// The largest difference that passes, for a series with that scale.
  double bound(double scale) const { return std::max(atol, rtol * scale); }
};

/// The tolerance of a series without a rule, by its unit. The table also has the measured noise: the largest of all
/// sample scenarios (`rehearse golden noise`). It was measured over ten seconds each, on the plant level, where a
/// difference lasts for 0.1 s:
///
///   unit                                    default             noise, and where
///   rad, quaternion (an angle [rad])        1e-9                7e-13   the arm with a grasp
///   m                                       1e-9                3e-13   its fingers
///   unit vector (each element)              1e-9                0       they round with the orientations
///   rad/s                                   1e-7                3e-10   its turntable
///   m/s                                     1e-7                8e-11   its fingers
///   rad/s², m/s²                            1e-4                3e-8    SR1 in free fall
///   N·m                                     1e-3                5e-5    the grasping arm under position control
///   N                                       1e-4                1e-7    SR1 in free fall
///   float32 distance: of a laser [m]        1e-9, rtol 2^-23    a last bit of single precision, if it is on the edge
///   distance in a picture [m]               rtol 1e-3, share    1e-4 of it: a step of the depth buffer, 5 m away
///   T                                       1e-12               4e-17   of 50 µT, by the noise of an orientation
///   pixels                                  2 of 255, share     1 of 255
///   figure of a camera: a camera_info       1e-9                7e-13   a URDF whose numbers have 15 digits
///   any other, none                         0: the same bits
///
/// The share of a picture's pixels that may differ by more is 0.0005: edges move to the next pixel. A command that a
/// controller computes in different arithmetic differs by less than a state does. The defaults are 10 to 10^7 times the
/// noise. The smallest faults that were tried (1 g more of 30 kg, 1 % less friction) differ by 10^2 to 10^7 times the
/// default and more.
///
/// In the closed loop noise grows, with contacts fast. There tolerances are valid up to the scenario's horizon only.
Tolerance default_tolerance(std::string_view unit);

/// The last rule that matches the series, which decides; null: none does.
const ToleranceRule* rule_for(std::string_view series, const std::vector<ToleranceRule>& rules);

/// True for a rule whose pattern contains /output/ or /variable/, or ends with /u: an effort is a command. On the
/// golden's inputs, controllers must repeat their commands bit for bit; only such a rule allows differences.
bool is_for_commands(const ToleranceRule& rule);

/// The tolerance by the last rule that matches the series. Members that this rule doesn't state have their default, as
/// have all members if no rule matches.
Tolerance tolerance_of(std::string_view series, std::string_view unit, const std::vector<ToleranceRule>& rules);

}  // namespace rehearse
