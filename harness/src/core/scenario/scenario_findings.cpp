#include "scenario_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <tuple>

namespace rehearse {
namespace {

constexpr std::size_t max_errors = 20;

}  // namespace

void Findings::error(const YamlNode& at, std::string message, std::string hint, Diagnostics details) {
  Finding finding{at.line, at.column, {}};
  finding.lines.push_back({Severity::error, file_, at.line, at.column, std::move(message), std::move(hint)});
  std::move(details.begin(), details.end(), std::back_inserter(finding.lines));
  errors_.push_back(std::move(finding));
}

void Findings::warning(const YamlNode& at, std::string message, std::string hint) {
  pass_through(at, {{Severity::warning, file_, at.line, at.column, std::move(message), std::move(hint)}});
}

void Findings::pass_through(const YamlNode& at, Diagnostics warnings) {
  if (!warnings.empty()) warnings_.push_back({at.line, at.column, std::move(warnings)});
}

std::vector<Findings::Finding> Findings::in_document_order(std::vector<Finding> findings) {
  std::ranges::stable_sort(findings, [](const Finding& a, const Finding& b) {
    return std::tie(a.line, a.column) < std::tie(b.line, b.column);
  });
  return findings;
}

Diagnostics Findings::errors() const {
  Diagnostics told;
  const std::vector<Finding> sorted = in_document_order(errors_);
  for (std::size_t i = 0; i < std::min(sorted.size(), max_errors); ++i)
    told.insert(told.end(), sorted[i].lines.begin(), sorted[i].lines.end());
  if (sorted.size() > max_errors) {
    const std::size_t rest = sorted.size() - max_errors;
    told.push_back(
        {Severity::note, file_, 0, 0, fmt::format("{} more error{} not shown", rest, rest == 1 ? "" : "s"), ""});
  }
  return told;
}

Diagnostics Findings::warnings() const {
  Diagnostics told;
  for (const Finding& finding : in_document_order(warnings_))
    told.insert(told.end(), finding.lines.begin(), finding.lines.end());
  return told;
}

void Findings::set_default(const YamlNode& map, std::string_view key, std::vector<std::string> elements) {
  defaults_[{&map, std::string(key)}] = std::move(elements);
}

const std::vector<std::string>* Findings::find_default(const YamlNode& map, const std::string& key) const {
  const auto found = defaults_.find({&map, key});
  return found == defaults_.end() ? nullptr : &found->second;
}

std::vector<std::string> Findings::unstated_keys(const YamlNode& map) const {
  std::vector<std::string> keys;
  for (auto at = defaults_.lower_bound({&map, ""}); at != defaults_.end() && at->first.first == &map; ++at)
    keys.push_back(at->first.second);
  for (auto at = absent_maps_.lower_bound({&map, ""}); at != absent_maps_.end() && at->first.first == &map; ++at)
    keys.push_back(at->first.second);
  return keys;
}

const YamlNode& Findings::absent_map(const YamlNode& map, const std::string& key) {
  YamlNodePtr& absent = absent_maps_[{&map, key}];
  if (!absent) {
    YamlNode empty;
    empty.kind = YamlNode::Kind::map;
    absent = std::make_shared<const YamlNode>(std::move(empty));
  }
  return *absent;
}

const YamlNode* Findings::find_absent_map(const YamlNode& map, const std::string& key) const {
  const auto found = absent_maps_.find({&map, key});
  return found == absent_maps_.end() ? nullptr : found->second.get();
}

}  // namespace rehearse
