// The commit and the date of a check.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/guard/child_process.h"
#include "history.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// True for a text that has digits where `form` has 0, and otherwise its letters.
bool has_form(std::string_view text, std::string_view form) {
  return std::ranges::equal(text, form, [](char c, char of_form) {
    return of_form == '0' ? std::isdigit(static_cast<unsigned char>(c)) != 0 : c == of_form;
  });
}

bool is_date(std::string_view text) {
  if (!has_form(text, "0000-00-00") && !has_form(text, "0000-00-00T00:00:00Z")) return false;
  const std::string_view month = text.substr(5, 2), day = text.substr(8, 2);
  return month >= "01" && month <= "12" && day >= "01" && day <= "31";
}

/// The lines that git prints for these words; none: there is no git, or it fails.
std::optional<std::string> git(const fs::path& folder, std::vector<std::string> words) {
  const fs::path program = find_program("git");
  if (program.empty()) return std::nullopt;
  words.insert(words.begin(), program.string());
  constexpr double limit = 30.0;  // [s]
  const auto printed = output_of({.words = std::move(words),
                                  .environment = environment_with({{"GIT_OPTIONAL_LOCKS", "0"}}),
                                  .errors = ChildProcess::Errors::discarded,
                                  .folder = folder},
                                 limit);
  if (!printed || printed->status != 0) return std::nullopt;
  return printed->text;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// True if git lists a change besides that of the history. `status`: of `git status --porcelain -z`.
bool has_changes(const std::string& status, const fs::path& top, const fs::path& history) {
  const std::string own = fs::weakly_canonical(history).lexically_relative(top).generic_string();
  std::istringstream stream(status);
  for (std::string entry; std::getline(stream, entry, '\0');)
    if (entry.size() > 3 && entry.substr(3) != own) return true;
  return false;
}

}  // namespace

Result<HistoryStamp> stamp_of(std::string commit, std::string date, const fs::path& folder, const fs::path& history) {
  if (!date.empty() && !is_date(date))
    return error(fmt::format("the date of a history is '{}'", date), "write it as 2026-11-27 or 2026-11-27T06:50:00Z");
  HistoryStamp stamp{std::move(commit), false, std::move(date)};
  if (!stamp.commit.empty()) return stamp;
  const auto head = git(folder, {"rev-parse", "--verify", "--quiet", "HEAD"});
  const auto top = git(folder, {"rev-parse", "--show-toplevel"});
  if (!head || !top || first_line(*head).empty()) return stamp;
  stamp.commit = first_line(*head);
  const auto status = git(folder, {"status", "--porcelain", "-z", "--untracked-files=all"});
  stamp.changed = !status || has_changes(*status, first_line(*top), history);
  return stamp;
}

}  // namespace rehearse
