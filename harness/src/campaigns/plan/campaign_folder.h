// The files of a campaign's folder. Internal.
#pragma once

#include <rehearse/campaign.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/file_descriptor.h"

namespace rehearse {

inline constexpr int campaign_version = 1;

std::filesystem::path plan_file(const std::filesystem::path& folder);
std::filesystem::path facts_file(const std::filesystem::path& folder);
/// The file of a slice's results; none: of the whole campaign.
std::filesystem::path result_file(const std::filesystem::path& folder, const std::optional<Slice>& slice);
std::filesystem::path trace_folder(const std::filesystem::path& folder);
/// The file of a failure's recording, as violated-17.mcap.
std::filesystem::path kept_trace_file(const std::filesystem::path& folder, const CaseResult& result);
/// The number of the case whose kept recording has this name; none: it is no recording of a case with this verdict.
std::optional<std::int64_t> case_of_kept_trace(const std::filesystem::path& file, CaseVerdict verdict);

/// The number of failures with which the work on a campaign ended (SweepOptions::most_failures); 0: it didn't end so.
std::int64_t ending_failures(const std::filesystem::path& folder);
Result<void> set_ending_failures(const std::filesystem::path& folder, std::int64_t failures);

/// True if the options have the same effect on a campaign.
bool are_same(const CampaignOptions& a, const CampaignOptions& b);

/// Writes and reads the files of a campaign, and makes Campaign objects of them.
class CampaignFolder {
 public:
  /// Fails if the folder contains a campaign or other files; makes it if there is none.
  static Result<void> check_unused(const std::filesystem::path& folder);
  /// A campaign without files and without a nominal run. Fails if the scenario varies nothing, or a value is invalid.
  static Result<Campaign> begin(Scenario scenario, const std::filesystem::path& folder, const CampaignOptions& options);
  static Result<void> check_bounds(const Campaign& campaign);
  /// Sets the result of the nominal run, which this process has just made, and writes the files.
  static Result<void> write_new(Campaign& campaign, CaseResult nominal, std::map<std::string, std::string> libraries,
                                std::vector<std::string> expectations);
  static Result<Campaign> read(const std::filesystem::path& folder);
  /// True once for a campaign that this process has begun.
  static bool take_new(Campaign& campaign);

 private:
  static Result<void> write(Campaign& campaign);
  static void set_nominal(Campaign& campaign, CaseResult result, std::map<std::string, std::string> libraries,
                          std::vector<std::string> expectations);
  static Result<Campaign> read_facts(const std::filesystem::path& folder, const nlohmann::ordered_json& facts);
};

/// Locks out other processes until it is destroyed: shared with those that work on slices, or alone.
class CampaignLock {
 public:
  static Result<CampaignLock> take(const std::filesystem::path& folder, bool shared);

 private:
  explicit CampaignLock(int descriptor) : descriptor_(descriptor) {}
  FileDescriptor descriptor_;
};

}  // namespace rehearse
