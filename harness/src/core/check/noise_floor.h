// NoiseFloor: the differences between runs of one scenario that perturbations without a fault cause: a different last
// bit of the initial state, of the C library's mathematics, or of the code that the renderer compiles. Tolerances must
// be above it, and a fault is a difference far above it.
//
// It is measured on the levels of a check. On controller and plant it is a number per channel and unit: the largest
// difference over all perturbations. In the closed loop it grows, with contacts a thousandfold a second and more; there
// the measure is the horizon, the time at which the first perturbed run leaves the scenario's tolerances.
//
// It is stored beside the golden as `<Suite>.<Test>.noise`, a text for reviews, with the versions and the processor of
// the measurement.
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

#include "core/form/form.h"

namespace rehearse {

/// A perturbation, and its effect.
struct Perturbation {
  std::string name;                                        // "last bits, pattern 1"
  std::string not_made;                                    // why it couldn't be made on this machine; empty: it was
  bool controller = false, plant = false, closed = false;  // levels it was made on
  std::optional<double> horizon;                           // when its closed run left the tolerances [s]; none: never
  std::optional<Divergence> beyond;  // first on controller or plant beyond tolerance; of a fresh measurement only
};

/// The noise of all numbers of one unit in one channel.
struct ChannelNoise {
  std::string channel;               // topic
  std::string unit;                  // of pictures also "of 255" and "of pixels", see SeriesComparison
  std::optional<double> controller;  // largest difference; none: not on this level
  std::optional<double> plant;
  double tolerance = 0.0;  // the tightest tolerance in force
};

struct NoiseFloor {
  std::string scenario;
  std::string recording;      // hash of the recording that was perturbed, see hash_of_recording()
  double duration = 0.0;      // of that recording [s]
  mcap::StringMap made_with;  // versions and processor, as in provenance
  std::vector<Perturbation> perturbations;
  std::vector<ChannelNoise> channels;  // in the order of the recording
  /// The factor by which differences of closed runs grow in a second; none: it isn't above 2.
  std::optional<double> growth;

  /// The earliest horizon of all perturbations [s]; none: no closed run left the tolerances, or none was made.
  std::optional<double> horizon() const;
  /// The largest noise of that unit over all channels and both levels; never less than the last bit of 1.
  double of_unit(const std::string& unit) const;
};

struct NoiseOptions {
  int patterns = 3;               // of last bits
  bool closed = true;             // measure the closed loop too
  HostOptions host;               // of all runs
  std::filesystem::path scratch;  // a folder for traces, which are removed
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

/// The text of a noise file.
std::string to_yaml(const NoiseFloor& noise);
/// The keys of such a file.
const Form& noise_file_form();
/// Writes a file beside the old one, syncs it, and renames it over the old one.
Result<void> write_noise_floor(const NoiseFloor& noise, const std::filesystem::path& file);
Result<NoiseFloor> load_noise_floor(const std::filesystem::path& file);

/// The noise of each series of the golden, for CompareOptions. Empty if the noise was measured for a different golden.
std::map<std::string, double, std::less<>> noise_of_series(const NoiseFloor& noise, const Trace& golden);

/// The time up to which a closed run is comparable with the golden [s], from the noise file beside it. It is 0.8 of the
/// measured horizon, since a perturbation that wasn't tried may leave the tolerances earlier. None: there is no file,
/// it was measured for a different golden, or no run left the tolerances.
std::optional<double> estimated_horizon(const Trace& golden);

/// 16 hexadecimal digits: of all the numbers in a recording, and the times of its messages.
std::string hash_of_recording(const Trace& trace);

/// A tolerance above this multiple of the noise of its unit is doubtful. Default tolerances are 10 to 10^7 times the
/// noise that was measured on the sample scenarios (scenario.h). Those of SR1's scenario, for closed loops of other
/// compilers, are up to 2 * 10^8 times the noise. The smallest faults that were tried are 10^7 times the noise: a
/// tolerance beyond 10^9 hides them.
inline constexpr double doubtful_tolerance = 1e9;  // times the noise

/// Remarks on the tolerances that comparisons with the golden applied: those below the noise, and those that a rule
/// sets more than `doubtful` times above it. Further remarks if the noise was measured with other versions or for a
/// different golden. Sentences.
std::vector<std::string> noise_remarks(const NoiseFloor& noise, const Trace& golden,
                                       const std::vector<const Comparison*>& comparisons,
                                       double doubtful = doubtful_tolerance);

}  // namespace rehearse
