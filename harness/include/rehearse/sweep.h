// Runs the cases of a campaign in worker processes, one in each. This library doesn't simulate: the caller passes a
// Simulation.
#pragma once

#include <rehearse/campaign.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// The state of the work on a campaign.
struct SweepProgress {
  std::int64_t done = 0, all = 0, failed = 0;
  double seconds = 0.0;   // wall time since the work began [s]
  std::int64_t here = 0;  // number of cases since then
};

struct SweepOptions {
  std::size_t jobs = 1;        // worker processes
  std::optional<Slice> slice;  // none: the whole campaign
  bool backwards = false;      // cases in the opposite order; results don't depend on it
  std::int64_t most_failures =
      std::numeric_limits<std::int64_t>::max();  // the work ends when so many cases have failed
  /// Called after each case; null: not. False ends the work, which can be resumed.
  std::function<bool(const SweepProgress&)> progress;
};

/// Runs the nominal scenario once, and writes the plan into the folder, which must be empty or new. Fails if the
/// scenario varies nothing, if a bound of a distribution is no valid value, or if the nominal scenario can't run.
Result<Campaign> create_campaign(const std::filesystem::path& scenario, const std::filesystem::path& folder,
                                 const CampaignOptions& options, const Simulation& simulation);

/// Runs all cases that have no result. Fails if another process works here, if the nominal run differs from that in
/// the plan, if results can't be written, or if the environment prevents a case (a full disk): it gets no result.
Result<void> run_cases(Campaign& campaign, const SweepOptions& options, const Simulation& simulation);

/// A scenario that has failed once, and is kept in a project.
struct KeptFailure {
  std::filesystem::path file;  // relative to the working directory
  CaseResult result;
};

/// Runs the failures that the project of the campaign's scenario keeps (the *.yaml below its folders `failures` and
/// `fixtures/failures`), by path, each in a process of its own. They are judged as cases, without a golden. None: there
/// is no project. Fails if a signal interrupts it, or if the environment prevents it.
Result<std::vector<KeptFailure>> run_kept_failures(const Campaign& campaign, const Simulation& simulation);

struct TextRun {
  CaseResult result;
  std::vector<std::string> changed;  // controllers whose libraries have changed since the campaign began, by BODY/NAME
};

/// Runs a scenario with this text in a process of its own, and judges it. `trace`: the file of the recording; empty:
/// it is not kept. Fails if a signal interrupts it, or if the environment prevents it.
Result<TextRun> run_text(const Campaign& campaign, const std::string& text, const std::filesystem::path& trace,
                         const Simulation& simulation);

}  // namespace rehearse
