// Fuzz tests: a search for inputs that break a controller, without physics.
//
//   #include <rehearse/fuzz.h>
//
//   FUZZ_CONTROLLER(Hold, NeverBeyondItsLimits, "Hold", "models/arm.urdf")
//       .joint("SHOULDER", q.in(-1, 1), dq.in(-3, 3))
//       .ticks(200).expect("always: abs(Arm/SHOULDER/u) < 20 N·m").seeds("Hold.*");
//
// A run gives the controller a sequence of inputs: a value of each stated input at each tick, within its range. The
// search mutates sequences and keeps those that reach something new: code (if the controller is built with
// rehearse_add_simple_controller(NAME ... FUZZ)), a recorded variable (rehearse_variable.h), a larger command, or a
// smaller margin of an expectation. It has a seed and a count of runs, and reads no clock: the same build finds the
// same on every machine, whatever the number of its processes. The runs are made in worker processes, so that a
// controller which crashes, hangs or takes all memory ends a run and not the test.
//
// A finding is shrunk: fewer ticks, fewer inputs, rounder numbers. It becomes two files in the folder `failures`
// beside the goldens: NAME.inputs, a text that lists the changes of inputs, and NAME.mcap, a recording of them for
// `rehearse step` and `rehearse replay`. The test runs all of its kept findings first, and fails while one of them
// fails. A scenario can't state inputs without physics, and a test in C++ would have to be compiled before it repeats
// anything: hence a text, which ctest and `rehearse fuzz` read.
//
// C++17. For the words q, dq, ddq and u, the macro opens the namespace rehearse::fuzz_words in the source.
#pragma once

#include <rehearse/gtest.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// A range of an input, both ends included, in the unit of the quantity.
struct FuzzRange {
  enum class Quantity { q, dq, ddq, u };
  Quantity quantity = Quantity::q;
  double low = 0.0, high = 0.0;
};

/// A quantity of a joint.
struct FuzzQuantity {
  FuzzRange::Quantity quantity;
  /// [rad], [rad/s], [rad/s²], [N·m]; of a sliding joint [m], [m/s], [m/s²], [N].
  constexpr FuzzRange in(double low, double high) const { return {quantity, low, high}; }
};

/// The range of all values of a device; none: within_limits().
using FuzzDeviceRange = std::optional<std::pair<double, double>>;

namespace fuzz_words {
inline constexpr FuzzQuantity q{FuzzRange::Quantity::q}, dq{FuzzRange::Quantity::dq}, ddq{FuzzRange::Quantity::ddq},
    u{FuzzRange::Quantity::u};
/// The range of a device: angular velocities of 10 rad/s, specific forces of 50 m/s², forces of 1000 N, torques of
/// 100 N·m, magnetic fields of 100 µT, up to 8 points of contact, and the distances of a range sensor.
inline FuzzDeviceRange within_limits() { return std::nullopt; }
/// All values of a device, in their units.
inline FuzzDeviceRange in(double low, double high) { return std::pair(low, high); }
}  // namespace fuzz_words

/// A controller, its inputs, and what is expected of each run.
struct FuzzPlan {
  struct Joint {
    std::string name;
    std::vector<FuzzRange> ranges;  // empty: q and dq within the limits of the model, without limits 3 rad and 10 rad/s
  };
  struct Device {
    std::string name;
    FuzzDeviceRange range;
  };
  std::string name;                     // of the test, Suite.Test; it names the findings
  std::string library, model;           // as of a ControllerBench: relative to the test's fixtures
  std::string options;                  // the controller's option string
  double time_step = 0.001;             // [s]
  std::map<std::string, double> start;  // displacement of joints before the first tick [rad] or [m]; 0 for all others
  std::vector<Joint> joints;
  std::vector<Device> devices;
  int ticks = 100;                        // of a run
  std::vector<std::string> expectations;  // "always: CONDITION", "never: CONDITION" or "eventually: CONDITION"
  std::string seeds;                      // a pattern of names of goldens whose inputs begin the search; empty: none
  bool limits = true;            // efforts, velocities and displacements that are commanded keep to the model's limits
  bool realtime = false;         // control() must be real-time safe after the first tick (EXPECT_REALTIME)
  double call_limit = 1.0;       // wall time of a call; a longer one hangs [s]
  double memory_limit = 1000.0;  // of a process with the controller [MB]
  std::int64_t runs = 2000;      // of a search in ctest
  std::uint64_t seed = 0;
};

/// Inputs that break a controller.
struct FuzzFinding {
  std::string kind;      // "not finite", "beyond a limit", "violated", "threw", "crashed", "hung", "ended the process",
                         // "took too much memory", "not repeated", "not real-time safe"
  std::string sentence;  // what happened, with its tick
  std::int64_t run = 0;  // of the search, from 0 on
  std::int64_t tick = 0;                // at which it happened
  int ticks_before = 0, ticks = 0;      // of the inputs, before and after shrinking
  int inputs_before = 0, inputs = 0;    // that aren't constantly at their start
  int changes_before = 0, changes = 0;  // of values from tick to tick, the first included
  bool repeats = false;                 // a second run of the recorded inputs gave the same bits
  std::string file;                     // NAME.inputs
  std::string recording;                // NAME.mcap; empty: the process ended before it was complete
  std::string text;                     // the content of `file`
};

struct FuzzOptions {
  std::int64_t runs = 2000;  // rounded up to whole rounds of 16
  double seconds = 0.0;      // more than 0: the search ends after this wall time instead [s]
  std::uint64_t seed = 0;
  int jobs = 1;           // worker processes; the result doesn't depend on it
  bool guided = true;     // false: each run has new random inputs
  int most_findings = 4;  // the search ends when it has so many different ones, or 8 hung runs
  bool shrinks = true;    // false: findings stay as they were found, and no file is written
  std::string folder;     // of the files of findings; empty: none are written
  std::string state;      // file that keeps the search, to go on with it; empty: it begins anew
};

struct FuzzResult {
  std::int64_t runs = 0;          // of the search, those before it was resumed included
  std::int64_t resumed_from = 0;  // runs that the state had
  std::int64_t kept = 0;          // sequences that reached something new
  std::int64_t points = 0;        // places of instrumented code that were reached; 0: the controller has none
  std::vector<FuzzFinding> findings;
  double seconds = 0.0;  // wall time [s]
};

/// A kept finding that was run again.
struct KeptInputs {
  std::string file;
  std::string sentence;  // why it fails; empty: it passes now
};

/// Searches for inputs that break the controller. Throws std::runtime_error if the plan has a mistake, if the
/// controller can't be loaded, or if the controller fails before the first tick.
FuzzResult search_inputs(const FuzzPlan& plan, const FuzzOptions& options);

/// Runs the findings NAME-*.inputs of the folder again, in the order of their names. Throws as search_inputs(), and if
/// a file has a mistake.
std::vector<KeptInputs> run_kept_inputs(const FuzzPlan& plan, const std::string& folder);

/// Builds a plan. FUZZ_CONTROLLER registers it as a test.
class Fuzz {
 public:
  Fuzz(std::string suite, std::string test, std::string library, std::string model, const char* file, int line)
      : suite_(std::move(suite)), test_(std::move(test)), file_(file), line_(line) {
    plan_.name = suite_ + "." + test_;
    plan_.library = std::move(library);
    plan_.model = std::move(model);
  }
  /// The inputs of a joint.
  template <class... Ranges>
  Fuzz& joint(const std::string& name, const Ranges&... ranges) {
    plan_.joints.push_back({name, {ranges...}});
    return *this;
  }
  /// The readings of a device, new in each tick.
  Fuzz& device(const std::string& name, FuzzDeviceRange range = {}) {
    plan_.devices.push_back({name, range});
    return *this;
  }
  Fuzz& ticks(int count) { return plan_.ticks = count, *this; }
  Fuzz& expect(const std::string& expectation) { return plan_.expectations.push_back(expectation), *this; }
  Fuzz& seeds(const std::string& goldens) { return plan_.seeds = goldens, *this; }
  Fuzz& options(const std::string& options) { return plan_.options = options, *this; }
  Fuzz& time_step(double seconds) { return plan_.time_step = seconds, *this; }
  /// The displacement of a joint before the first tick [rad] or [m].
  Fuzz& start(const std::string& joint, double displacement) { return plan_.start[joint] = displacement, *this; }
  Fuzz& runs(std::int64_t count) { return plan_.runs = count, *this; }
  Fuzz& seed(std::uint64_t seed) { return plan_.seed = seed, *this; }
  Fuzz& call_limit(double seconds) { return plan_.call_limit = seconds, *this; }
  Fuzz& memory_limit(double megabytes) { return plan_.memory_limit = megabytes, *this; }
  Fuzz& without_limits() { return plan_.limits = false, *this; }
  Fuzz& realtime() { return plan_.realtime = true, *this; }

  const FuzzPlan& plan() const { return plan_; }
  const std::string& suite() const { return suite_; }
  const std::string& test() const { return test_; }
  const char* file() const { return file_; }
  int line() const { return line_; }

 private:
  std::string suite_, test_;
  const char* file_;
  int line_;
  FuzzPlan plan_;
};

namespace internal {

/// Runs the kept findings and the search of a test. A mistake of the plan is a verdict, too.
TestVerdict run_fuzz_test(const FuzzPlan& plan);

class FuzzTest : public ::testing::Test {
 public:
  explicit FuzzTest(const Fuzz& fuzz) : fuzz_(fuzz) {}
  void TestBody() override {
    const TestVerdict verdict = run_fuzz_test(fuzz_.plan());
    if (!verdict.passed) ADD_FAILURE_AT(fuzz_.file(), fuzz_.line()) << verdict.message;
  }

 private:
  Fuzz fuzz_;
};

struct FuzzRegistration {
  FuzzRegistration(const Fuzz& fuzz) {  // NOLINT: a chain of calls ends here
    ::testing::RegisterTest(fuzz.suite().c_str(), fuzz.test().c_str(), nullptr, nullptr, fuzz.file(), fuzz.line(),
                            [fuzz]() -> ::testing::Test* { return new FuzzTest(fuzz); });
  }
};

}  // namespace internal
}  // namespace rehearse

/// A test that searches for inputs which break a controller; calls of Fuzz follow. In ctest it runs its kept findings
/// and `runs` runs of the search; `rehearse fuzz SUITE.TEST` goes on.
#define FUZZ_CONTROLLER(suite, test, library, model)                                   \
  using namespace ::rehearse::fuzz_words; /* NOLINT */                                 \
  static const ::rehearse::internal::FuzzRegistration rehearse_fuzz_##suite##_##test = \
      ::rehearse::Fuzz(#suite, #test, library, model, __FILE__, __LINE__)
