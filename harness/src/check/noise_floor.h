// NoiseFloor: how far runs of one scenario stray from each other though nothing changed that anybody would mend: a last
// bit of the initial state, the C library's mathematics, the code that the renderer compiles. Tolerances have to lie
// above it, and a fault is what lies far above it.
//
// It is measured on the levels of a check. On controller and plant it is a number per channel and unit: the largest
// difference over all perturbations. In the closed loop it grows, with contacts a thousandfold a second and more; there
// the measure is the horizon, the time at which the first perturbed run leaves the scenario's tolerances.
//
// It is kept beside the golden as `<Suite>.<Test>.noise`, text for a review, and says what it was measured with.
#pragma once

#include <rehearse/check.h>
#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// A reason to stray, and what it did.
struct Perturbation {
  std::string name;                                        // "last bits, pattern 1"
  std::string not_made;                                    // why it couldn't be made on this machine; empty: it was
  bool controller = false, plant = false, closed = false;  // levels it was made on
  std::optional<double> horizon;                           // when its closed run left the tolerances [s]; none: never
  std::optional<Divergence> beyond;  // first on controller or plant beyond tolerance; of a fresh measurement only
};

/// The numbers of one unit in one channel.
struct ChannelNoise {
  std::string channel;               // topic
  std::string unit;                  // of pictures also "of 255" and "of pixels", see SeriesComparison
  std::optional<double> controller;  // largest difference; none: not of this level
  std::optional<double> plant;
  double tolerance = 0.0;  // the tightest that was in force
};

struct NoiseFloor {
  std::string scenario;
  std::string recording;      // hash of the recording it was measured around, see hash_of_recording()
  double duration = 0.0;      // of that recording [s]
  mcap::StringMap made_with;  // versions and processor, as in provenance
  std::vector<Perturbation> perturbations;
  std::vector<ChannelNoise> channels;  // in the order of the recording
  /// How much larger the closed runs' differences become in a second; none: not even twice.
  std::optional<double> growth;

  /// The earliest of all perturbations [s]; none: no closed run left the tolerances, or none was made.
  std::optional<double> horizon() const;
  /// The largest noise of that unit over all channels and both levels; never less than the last bit of 1.
  double of_unit(const std::string& unit) const;
};

struct NoiseOptions {
  int patterns = 3;               // of last bits
  bool closed = true;             // measure the closed loop too
  HostOptions host;               // of all runs
  std::filesystem::path scratch;  // a folder for traces; emptied of them again
  /// The program that makes runs in a process of its own: `PROGRAM golden noise --perturbed FOLDER ...`.
  std::filesystem::path program;
  /// Called before each run with its name, the runs done and all; null: not.
  std::function<void(const std::string& name, int done, int all)> progress;
};

/// Runs the scenario under each perturbation and compares with `recording`, a run of it by this process. Fails if a run
/// can't be made.
Result<NoiseFloor> measure_noise(const Scenario& scenario, const Trace& recording, const Simulation& simulation,
                                 const NoiseOptions& options);

/// The facts of provenance that noise depends on, and the processor it was measured on.
inline constexpr const char* noise_facts[] = {"rehearse", "physics", "libc", "compiler", "renderer", "processor"};

/// As a file holds it.
std::string to_yaml(const NoiseFloor& noise);
/// Written beside the old one, synced, and renamed over it.
Result<void> write_noise_floor(const NoiseFloor& noise, const std::filesystem::path& file);
Result<NoiseFloor> load_noise_floor(const std::filesystem::path& file);

/// As CompareOptions wants it: the noise of each series that the golden has. Empty if it was measured of another
/// golden.
std::map<std::string, double, std::less<>> noise_of_series(const NoiseFloor& noise, const Trace& golden);

/// Up to when [s] a closed run is comparable with that golden, by the noise file beside it: 0.8 of the measured
/// horizon, since a perturbation that wasn't tried may leave the tolerances earlier. None: there is no file, it was
/// measured of another golden, or no run left.
std::optional<double> estimated_horizon(const Trace& golden);

/// 16 hexadecimal digits: of all the numbers in a recording, and the times of its messages.
std::string hash_of_recording(const Trace& trace);

/// A tolerance more than this above the noise of its unit is doubtful. By default tolerances lie 10 to 10^7 above what
/// was measured on the sample scenarios (scenario.h), and those that SR1's scenario states, for closed loops of other
/// compilers, up to 2 * 10^8. The smallest faults that were tried lie 10^7 above: what lies beyond 10^9 hides such.
inline constexpr double doubtful_tolerance = 1e9;  // times the noise

/// What there is to say of the tolerances in force, as comparisons with the golden found them: those below the noise,
/// those that a rule sets more than `doubtful` times above it, and if the noise was measured with other versions or
/// another golden. Sentences.
std::vector<std::string> noise_remarks(const NoiseFloor& noise, const Trace& golden,
                                       const std::vector<const Comparison*>& comparisons,
                                       double doubtful = doubtful_tolerance);

}  // namespace rehearse
