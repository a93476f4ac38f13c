#include <fmt/format.h>
#include <rehearse/campaign.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "campaign_folder.h"
#include "case_values.h"
#include "finished_cases.h"
#include "result_lines.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr double share_of_twice = 0.02;

}  // namespace

Result<Campaign> Campaign::open(const fs::path& folder) { return CampaignFolder::read(folder); }

std::vector<std::string> Campaign::values_of(std::int64_t number) const { return values_->of(number); }

std::vector<std::string> Campaign::with_links(std::vector<std::string> values) const {
  return values_->with_links(std::move(values));
}

bool Campaign::runs_twice(std::int64_t number) const {
  return number == 0 || uniform_number(options_.seed, number, "") < share_of_twice;
}

Result<std::string> Campaign::text_of(std::int64_t number) const { return scenario_.varied_text(values_of(number)); }

Result<void> Campaign::check_number(std::int64_t number) const {
  if (number >= 0 && number < options_.cases) return {};
  return error_in(folder_.string(), fmt::format("there is no case {}", number),
                  fmt::format("expected a number from 0 to {}", options_.cases - 1));
}

Result<void> Campaign::read_results(const std::function<void(const CaseResult&)>& take) const {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator entry(folder_, failed), end; !failed && entry != end; entry.increment(failed))
    if (entry->path().filename().string().starts_with("results") && entry->path().extension() == ".jsonl")
      files.push_back(entry->path());
  if (failed) return error_in(folder_.string(), fmt::format("it can't be read: {}", failed.message()));
  std::ranges::sort(files);
  for (const fs::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    std::int64_t number = 0;
    for (std::string line; std::getline(stream, line);) {
      ++number;
      const bool is_whole = !stream.eof();
      const auto result = result_of_line(line);
      if (result && check_number(result->number))
        take(*result);
      else if (is_whole)
        return error_in(file.string(), fmt::format("line {} is no result of this campaign", number));
    }
  }
  return {};
}

Result<std::vector<std::int64_t>> Campaign::unfinished_slices(std::int64_t count) const {
  FinishedCases done(*this);
  REHEARSE_TRY(read_results([&](const CaseResult& result) { done.take(result); }));
  std::vector<std::int64_t> unfinished;
  for (Slice slice{1, count}; slice.index <= count; ++slice.index) {
    const auto lacks = [&](std::int64_t number, const std::vector<bool>& results, bool again) {
      for (; number < options_.cases; number += count)
        if (!results[static_cast<std::size_t>(number)] && (!again || runs_twice(number))) return true;
      return false;
    };
    if (lacks(slice.first_case(), done.first, false) || lacks(slice.first_second_run(), done.again, true))
      unfinished.push_back(slice.index);
  }
  return unfinished;
}

}  // namespace rehearse
