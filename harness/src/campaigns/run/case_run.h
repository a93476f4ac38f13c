// One run of a case, and its judgement. Internal.
#pragma once

#include <rehearse/sweep.h>

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

struct CaseRun {
  CaseResult result;
  std::vector<std::string> expectations;         // as text
  std::map<std::string, std::string> libraries;  // of controllers, with their hashes; by BODY/NAME
};

/// Runs a scenario in this process. `file`: the place to which its paths are relative. The recording is written to
/// `trace`, and stays. Fails if the environment prevents the run, as a full disk does: nothing is known of the case.
Result<CaseRun> run_case(const std::filesystem::path& file, const std::string& text, const CampaignOptions& options,
                         const std::filesystem::path& trace, const Simulation& simulation);

/// Runs a scenario with this text in a process of its own. `file`: the place to which its paths are relative. `trace`:
/// the file of its recording; empty: it is not kept. Fails if a signal interrupts it, or if the environment prevents
/// it.
Result<CaseRun> run_alone(const Campaign& campaign, const std::string& text, const std::filesystem::path& file,
                          const std::filesystem::path& trace, const Simulation& simulation);
/// As this, with other options than the campaign's. `folder`: that of the campaign, where the run has its files.
Result<CaseRun> run_alone(const std::filesystem::path& folder, const CampaignOptions& options, const std::string& text,
                          const std::filesystem::path& file, const std::filesystem::path& trace,
                          const Simulation& simulation);

/// The result of a case whose process ended without a verdict.
CaseResult ended_case(std::int64_t number, CaseVerdict verdict, std::string sentence);

/// True if a line of a controller states an error: its first word is "error", in any case, as in "[ERROR] no map".
bool is_error_line(std::string_view line);

}  // namespace rehearse
