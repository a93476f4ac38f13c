#include "names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace rehearse {
namespace {

constexpr std::size_t max_names_listed = 16;

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

// Levenshtein's distance; for one above `most`, any number above `most`.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t most) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
    const std::size_t least = *std::ranges::min_element(row);  // it never decreases from row to row
    if (least > most) return least;
  }
  return row[b.size()];
}

}  // namespace

std::string listed(const std::vector<std::string>& words, std::size_t most) {
  const auto shown = static_cast<std::ptrdiff_t>(std::min(words.size(), most));
  std::string text = fmt::format("{}", fmt::join(words.begin(), words.begin() + shown, ", "));
  if (words.size() > most) text += fmt::format(" and {} more", words.size() - most);
  return text;
}

std::vector<std::string> near_names(std::string_view wanted, const std::vector<std::string>& names) {
  constexpr std::size_t longest = 100;  // limits the time for a hostile key
  if (wanted.size() > longest) return {};
  const std::string wanted_letters = lower(wanted);  // `Knee` for `KNEE` is the most common mistake
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const std::string& name : names) {
    const std::size_t shorter = std::min(wanted.size(), name.size());
    const std::size_t longer = std::max(wanted.size(), name.size());
    const std::size_t most = std::max<std::size_t>(1, shorter / 3);
    if (longer - shorter > most) continue;
    const std::size_t distance = edit_distance(wanted_letters, lower(name), most);
    if (distance <= most) near.emplace_back(distance, name);
  }
  std::ranges::stable_sort(near, [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> result;
  for (std::size_t i = 0; i < std::min<std::size_t>(near.size(), 3); ++i) result.push_back(near[i].second);
  return result;
}

std::string name_hint(std::string_view wanted, const std::vector<std::string>& names, std::string_view kind) {
  return near_hint(near_names(wanted, names), names, kind);
}

std::string near_hint(const std::vector<std::string>& near, const std::vector<std::string>& names,
                      std::string_view kind) {
  if (names.empty()) return fmt::format("there are no {}", kind);
  if (!near.empty()) return fmt::format("did you mean '{}'?", fmt::join(near, "' or '"));
  return fmt::format("known {}: {}", kind, listed(names, max_names_listed));
}

}  // namespace rehearse
