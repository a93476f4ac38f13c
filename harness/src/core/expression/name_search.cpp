#include "name_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/names.h"

namespace rehearse {
namespace {

constexpr std::size_t most_shown = 6;

std::size_t segments_of(std::string_view name) { return static_cast<std::size_t>(std::ranges::count(name, '/')) + 1; }

/// The last segments of a name.
std::string_view ending_of(std::string_view name, std::size_t segments) {
  for (std::size_t at = name.size(); at > 0; --at)
    if (name[at - 1] == '/' && --segments == 0) return name.substr(at);
  return name;
}

/// The names with the most similar ending of equal length.
std::string nearest(std::string_view wanted, const std::vector<std::string>& names) {
  std::set<std::string> endings;
  for (const std::string& name : names) endings.emplace(ending_of(name, segments_of(wanted)));
  const auto near = near_names(wanted, {endings.begin(), endings.end()});
  return near.empty() ? "" : fmt::format("did you mean '{}'?", fmt::join(near, "' or '"));
}

}  // namespace

bool ends_with_segments(std::string_view name, std::string_view ending) {
  if (ending.empty() || !name.ends_with(ending)) return false;
  return name.size() == ending.size() || name[name.size() - ending.size() - 1] == '/';
}

Result<std::size_t> find_name(std::string_view wanted, const std::vector<std::string>& names, std::string_view kind) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == wanted) return i;
    if (ends_with_segments(names[i], wanted)) found.push_back(i);
  }
  if (found.size() == 1) return found.front();
  if (found.empty()) return error(fmt::format("there is no {} '{}'", kind, wanted), nearest(wanted, names));
  std::vector<std::string> candidates;
  for (const std::size_t index : found) candidates.push_back(names[index]);
  return error(fmt::format("'{}' may be one of {} {}", wanted, found.size(), kind), listed(candidates, most_shown));
}

}  // namespace rehearse
