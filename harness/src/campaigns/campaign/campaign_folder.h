// The files of a campaign's folder. Internal.
#pragma once

#include <rehearse/campaign.h>

#include <filesystem>
#include <string>

#include "model/file_descriptor.h"

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

/// True if the options have the same effect on a campaign.
bool are_same(const CampaignOptions& a, const CampaignOptions& b);

/// Locks out other processes until it is destroyed: shared with those that work on slices, or alone.
class CampaignLock {
 public:
  static Result<CampaignLock> take(const std::filesystem::path& folder, bool shared);

 private:
  explicit CampaignLock(int descriptor) : descriptor_(descriptor) {}
  FileDescriptor descriptor_;
};

}  // namespace rehearse
