// The text of a scenario with other values, or without a key.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>

#include "base/names.h"
#include "scenario_parts.h"
#include "scenario_values.h"
#include "scenario_variations.h"

namespace rehearse {
namespace {

/// The text for a value that isn't in quotes or in an option string.
std::string yaml_scalar(const std::string& value) {
  const bool is_plain = !value.empty() && std::ranges::all_of(value, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_./+-").find(c) != std::string_view::npos;
  });
  return is_plain ? value : '"' + value + '"';
}

/// Puts a value into the place of a variation in the text.
Result<void> put_value(const Variation& variation, const std::string& value, std::string& text) {
  const bool can_be_written = std::ranges::none_of(
      value, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == '"' || c == '\'' || c == '\\'; });
  if (!can_be_written)
    return at(variation.place,
              error(fmt::format("'{}' has a value with quotes, backslashes or control characters", variation.name)));
  std::string_view rest;
  const bool is_number = leading_number(value, rest) && rest.empty();
  text.replace(variation.begin, variation.end - variation.begin,
               variation.before + (is_number || variation.in_text ? value : yaml_scalar(value)) + variation.after);
  return {};
}

}  // namespace

Result<std::string> Scenario::varied_text(const std::vector<std::string>& values) const {
  REHEARSE_ASSERT(values.size() == variations.size(), "a value for each variation");
  std::vector<std::size_t> order(variations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return variations[a].begin > variations[b].begin; });
  std::string varied = text;
  for (const std::size_t i : order) {  // from the end on, so that the other places stay
    if (values[i].empty() || values[i] == variations[i].nominal) continue;
    REHEARSE_TRY(put_value(variations[i], values[i], varied));
  }
  return varied;
}

Result<std::string> text_with(const std::string& text, const std::string& file, const std::string& path,
                              const std::string& value) {
  const auto root = REHEARSE_TRY(parse_yaml(text, file));
  Findings findings(file);
  Scenario scenario;
  scenario.file = file;
  scenario.text = text;
  const auto place = place_of(findings, *root, scenario, path);
  if (!place) return findings.errors();
  std::string changed = text;
  REHEARSE_TRY(put_value(*place, value, changed));
  return changed;
}

Result<std::string> text_without(const std::string& text, const std::string& file, const std::string& key) {
  const auto root = REHEARSE_TRY(parse_yaml(text, file));
  const auto begin_of = [&](int line) {
    std::size_t at = 0;
    for (int i = 1; i < line && at != std::string::npos; ++i) at = text.find('\n', at) + 1;
    return at;
  };
  for (std::size_t i = 0; i < root->keys.size(); ++i) {
    if (root->keys[i]->text != key) continue;
    const std::size_t begin = begin_of(root->keys[i]->line);
    const bool is_last = i + 1 == root->keys.size();
    return text.substr(0, begin) + (is_last ? "" : text.substr(begin_of(root->keys[i + 1]->line)));
  }
  return text;
}

}  // namespace rehearse
