// ControllerHost: loads, initialises and calls the controllers of a scenario, in Choreonoid's order.
//
// It is independent of physics: in each tick it reads an Observation and returns a Command. Recording and replaying use
// it in the same way. Every failure of a controller (it throws, crashes, never returns, refuses) is reported in
// failure() or in an event.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/messages.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>

#include <cnoid/SimpleController>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "call_clock.h"
#include "controller_io.h"
#include "controller_library.h"
#include "core/guard/guarded_call.h"
#include "core/guard/process_guard.h"
#include "host_joystick.h"
#include "read_backs.h"
#include "timing.h"
#include "unread_inputs.h"
#include "variables.h"

namespace rehearse {

/// One controller of a run.
struct HostedController {
  std::string label;      // "SR1/SR1Minimum"
  int body = 0;           // index into Scenario::bodies
  int parent = -1;        // index of the controller whose body it shares; -1: none
  bool optional = false;  // the run continues if it refuses
  const ScenarioController* specification = nullptr;

  std::shared_ptr<ControllerLibrary> library;
  /// Null: the run has no joystick. It contains slots whose code is in the library.
  std::unique_ptr<HostJoystick> joystick;
  std::unique_ptr<cnoid::SimpleController> controller;
  std::unique_ptr<ControllerIo> io;
  std::unique_ptr<cnoid::SimpleControllerConfig> config;
  std::shared_ptr<IoBody> io_body;

  bool configured = false;
  bool running = false;  // it takes part: it was initialised and started
  /// True if control() is called in each tick: it takes part, and is no child of a child.
  bool is_called() const { return running && specification->is_called; }
  bool delayed = true;                       // after initialize(): its commands act one tick late
  std::vector<DeviceOutput> early_outputs;   // of its body, from initialize()
  std::map<std::string, std::string> files;  // files that it opened to read: content by name (opened_files.h)
  ControllerVariables variables;             // set in the current tick
  std::deque<std::string> last_lines;        // the last lines that it wrote
  CallClock clock;                           // of control()
  ControlCosts costs;                        // if the run counts them

  /// Its inputs and outputs in the current tick.
  struct Tick {
    bool has_input = false;                    // its inputs were passed to it
    bool has_output = false;                   // control() returned, and its outputs were read
    bool result = false;                       // the result of control()
    bool delayed = true;                       // the commands of this tick act one tick late
    std::vector<DeviceOutput> device_outputs;  // of its body; for a child those of its parent
    msg::ControlCost cost;                     // of the last call, control(), if the run counts costs
  } tick;
  /// True if the commands of this tick don't act at the time that the recording's channels state. Commands to devices
  /// act after the step in either mode.
  bool acts_at_another_time() const { return tick.has_output && io->outputs().size > 0 && tick.delayed != delayed; }

  /// Reports that are made once per controller.
  struct Reported {
    std::set<Trespass::Kind> trespasses;
    bool enabled_too_late = false;
    std::vector<bool> odd_outputs;  // by output number: it was not finite
    std::size_t outside = 0;        // the number of waits for something outside of the process
  } reported;
};

/// The file of the library that a controller of the scenario is loaded from. `label`: "BODY/NAME".
Result<std::filesystem::path> library_of(const Scenario& scenario, const ScenarioController& specification,
                                         const std::string& label, const HostOptions& options);
/// note_on_builds() of that library.
std::string note_on_builds_of(const Scenario& scenario, const ScenarioController& specification,
                              const std::string& label, const HostOptions& options);

/// The beginning of a linked library's name in ControllerHost::files_read().
inline constexpr const char* linked_library_prefix = "the library ";

class ControllerHost {
 public:
  /// Finds and loads the libraries and creates the controllers. Fails with the place in the scenario.
  static Result<std::unique_ptr<ControllerHost>> create(const Scenario& scenario, const HostOptions& options);
  ~ControllerHost();
  ControllerHost(const ControllerHost&) = delete;
  ControllerHost& operator=(const ControllerHost&) = delete;

  /// Calls configure() and initialize() of all, bodies in scenario order, parents before their children; then the
  /// tables of inputs and outputs are fixed. Returns the command of the first step: drives set, targets at the initial
  /// posture, no effort; with the scenario's `initial_commands` what initialize() wrote, as in Choreonoid's AIST item
  /// (its ODE item resets it).
  Command initialize(const Observation& initial);
  /// From now on controllers read what they command (ReadBacks): a world moves by it.
  void read_back() { read_backs_.begin(); }
  /// Calls start() of all initialised controllers.
  void start();
  /// Begins a tick: copies the inputs of all, and calls their slots for changed devices. False if one failed.
  bool input(std::int64_t tick, const Observation& seen);
  /// Calls control() and reads the outputs of all. False if one failed: the run ends here.
  bool control();
  /// True if there is a controller, and control() of all that take part returned false in this tick.
  bool all_done() const;
  /// Writes the outputs of the controllers without (or with) delay into the command, in order. The last controller
  /// overrides earlier ones, external wrenches are summed. A number that isn't finite is reported once and never passed
  /// on: the earlier command stays. The earlier commands stay, too, of a controller whose commands are lost.
  void output(Timing timing, Command& command);
  /// Calls stop() of all, children first, and unconfigure(). `end`: the tick after the last step; its time is the time
  /// that they see.
  void stop(std::int64_t end);

  const std::vector<HostedController>& controllers() const { return controllers_; }
  /// Of the controllers that were called in a tick.
  std::vector<ControlTimes> control_times() const;
  bool counts_costs() const { return counts_costs_; }
  /// Warnings of inputs that a controller reads in ticks and never enabled; before stop(). No recording contains them.
  std::vector<std::string> unread_inputs() const { return unread_inputs_.found(controllers_); }
  /// Files that the controllers have opened to read, as "BODY/NAME: file" and their content, and the libraries that
  /// they link (linked_libraries()), as "BODY/NAME: the library file".
  std::map<std::string, std::string> files_read() const;
  /// The contents of the files that a recording contains, by the names of the attachments (opened_files.h).
  const std::map<std::string, std::string>& input_copies() const { return input_copies_; }
  /// Hashes of all inputs and of all outputs of the controllers in this tick. The outputs are everything by which a
  /// controller acts on the loop: results, commands, the time at which they act, commands to devices. Everything else
  /// (what is enabled, the drives of joints) is fixed after initialize().
  std::uint64_t input_hash(const Observation& seen) const;
  std::uint64_t output_hash() const;

  /// The first failure that ends the run: a controller threw, crashed, hung or refused.
  const std::optional<Diagnostic>& failure() const { return failure_; }
  /// The end of the call that failed; returned: the failure is no failed call.
  CallEnd failed_by() const { return failed_by_; }
  /// True if a controller that isn't optional refused to configure, initialise or start; failure() then reports this.
  bool any_refused() const { return refused_; }
  /// True if a controller was given options different from the scenario's.
  bool has_other_options() const { return other_options_; }
  /// The events since the last call, in order; includes the controllers' messages (severity note).
  std::vector<msg::Event> take_events();

 private:
  ControllerHost() = default;
  /// True unless it is in no-delay mode; of a child its parent's mode counts.
  bool is_delayed(const HostedController& hosted) const;
  Result<void> add(const ScenarioController& specification, int body, int parent);
  /// Extent of the checks around a call: the whole process, or only those without cost.
  enum class HowOften { once, in_ticks };
  bool call(HostedController& hosted, const char* function, const std::function<void()>& code,
            HowOften how_often = HowOften::once);
  bool call_alone(HostedController& hosted, const char* function, const std::function<void()>& code,
                  HowOften how_often);
  bool let_threads_run(HostedController& hosted, const char* function, std::int64_t until = 0);
  bool ends_well(HostedController& hosted, const char* function, const CallOutcome& outcome);
  void tell_threads(HostedController& hosted);
  void tell_unknown_delays(const HostedController& hosted);
  void tell_trespasses(HostedController& hosted, const char* function, const CallOutcome& outcome);
  const std::string& label_of_failed(const HostedController& called, const CallOutcome& outcome) const;
  void keep_libraries_of_threads();
  void take_late_failure(const HostedController& hosted);
  void refuse(HostedController& hosted, const char* function);
  void take_opened_files(HostedController& hosted);
  void show_joystick(const Observation& seen);
  void event(Severity severity, const std::string& source, std::string text);
  static std::string last_words(const HostedController& hosted);
  void collect_messages(HostedController& hosted, CallEnd end);
  void configure(HostedController& hosted);
  void initialize(HostedController& hosted, const Observation& initial);
  void output_of_initialize(Command& command);
  void set_drives(std::size_t index, Command& command);
  void tell_shared_joints(std::size_t index);
  void tell_shared_joint(const HostedController& before, const HostedController& hosted, const IoField& field);
  bool pass_infos();
  void take_device_outputs(HostedController& hosted);
  void apply_device_output(const HostedController& hosted, const DeviceOutput& output, Command& command);
  void apply(std::size_t index, Timing timing, Command& command);

  RunEnvironment environment_;  // declared first: libraries that are closed may still change it
  const Scenario* scenario_ = nullptr;
  HostOptions options_;
  // Declared before the members that may contain objects with code in these libraries, so closed after them.
  std::vector<std::shared_ptr<ControllerLibrary>> libraries_;
  std::vector<cnoid::BodyPtr> bodies_before_;  // by scenario body: the bodies for configure()
  std::vector<HostedController> controllers_;  // in order of their calls
  ReadBacks read_backs_;
  std::map<std::string, std::string> input_copies_;
  std::vector<msg::Event> events_;
  std::optional<Diagnostic> failure_;
  CallEnd failed_by_ = CallEnd::returned;
  const void* thread_failed_of_ = nullptr;  // thread count of the library whose thread failed
  bool refused_ = false;
  bool other_options_ = false;
  bool counts_costs_ = false;
  bool stopped_ = false;
  long run_ = 0;             // number of the run in this process, for debuggers
  bool controlled_ = false;  // at least one tick was made
  std::int64_t tick_ = 0;
  UnreadInputs unread_inputs_;
};

/// Appends events as diagnostics, except the controllers' own messages.
void append_remarks(const std::vector<msg::Event>& events, Diagnostics& remarks);

/// The initial state of a scenario: joints as given, links by forward kinematics, all at rest.
Observation initial_observation(const Scenario& scenario);

}  // namespace rehearse
