// The files of a campaign's folder. Internal.
#pragma once

#include <rehearse/campaign.h>

#include <filesystem>
#include <string>

namespace rehearse {

inline constexpr int campaign_version = 1;

std::filesystem::path plan_file(const std::filesystem::path& folder);
std::filesystem::path facts_file(const std::filesystem::path& folder);
/// The file of a slice's results; none: of the whole campaign.
std::filesystem::path result_file(const std::filesystem::path& folder, const std::optional<Slice>& slice);
std::filesystem::path trace_file(const std::filesystem::path& folder, std::int64_t number);

/// Locks out other processes until it is destroyed: shared with those that work on slices, or alone.
class CampaignLock {
 public:
  static Result<CampaignLock> take(const std::filesystem::path& folder, bool shared);
  CampaignLock(CampaignLock&& other) noexcept;
  CampaignLock& operator=(CampaignLock&&) = delete;
  ~CampaignLock();

 private:
  explicit CampaignLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace rehearse
