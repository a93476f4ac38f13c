#include "urdf_findings.h"

#include <rehearse/urdf.h>

#include <fmt/format.h>

#include <algorithm>

namespace rehearse::urdf {
namespace {

void sort_by_line(Diagnostics& diagnostics) {
  std::ranges::stable_sort(diagnostics, [](const Diagnostic& a, const Diagnostic& b) { return a.line < b.line; });
}

/// The hint of a repair that is an error.
std::string strict_hint(const std::string& hint) {
  return (hint.empty() ? "" : hint + "; ") + "strict loading repairs nothing";
}

}  // namespace

void Findings::error(int line, std::string message, std::string hint) {
  add(Severity::error, line, std::move(message), std::move(hint));
}

void Findings::repair(int line, std::string message, std::string hint) {
  if (strict_) return error(line, std::move(message), strict_hint(hint));
  add(Severity::repair, line, std::move(message), std::move(hint));
}

void Findings::warning(int line, std::string message, std::string hint) {
  add(Severity::warning, line, std::move(message), std::move(hint));
}

void Findings::note(int line, std::string message, std::string hint) {
  add(Severity::note, line, std::move(message), std::move(hint));
}

void Findings::counted(int line, const std::string& sentence) {
  Passed& passed = counted_[sentence];
  if (passed.count++ == 0) passed.line = line;
}

bool Findings::take(const Findings& part, const std::string& what) {
  if (part.has_error()) {
    for (const Diagnostic& found : part.found_) {
      if (found.severity != Severity::error) continue;
      warning(found.line, fmt::format("{} is left out: {}", what, found.message), found.hint);
    }
    return true;
  }
  for (const Diagnostic& found : part.found_) {
    if (found.severity == Severity::repair)
      repair(found.line, found.message, found.hint);
    else
      add(found.severity, found.line, found.message, found.hint);
  }
  for (const auto& [sentence, passed] : part.counted_) {
    const auto [known, is_new] = counted_.emplace(sentence, passed);
    if (!is_new) known->second.count += passed.count;
  }
  return false;
}

Diagnostics Findings::errors() const {
  Diagnostics errors;
  std::ranges::copy_if(found_, std::back_inserter(errors),
                       [](const Diagnostic& diagnostic) { return diagnostic.severity == Severity::error; });
  sort_by_line(errors);
  constexpr std::size_t most = max_urdf_errors;
  if (errors.size() > most) {
    const std::size_t more = errors.size() - most;
    errors.resize(most);
    errors.push_back({Severity::note, file_, 0, 0, fmt::format("{} more errors are not listed", more), {}});
  }
  return errors;
}

Diagnostics Findings::report() const {
  Diagnostics report;
  std::ranges::copy_if(found_, std::back_inserter(report),
                       [](const Diagnostic& diagnostic) { return diagnostic.severity != Severity::error; });
  for (const auto& [sentence, passed] : counted_) {
    const std::string times = passed.count > 1 ? fmt::format(", here and in {} other places", passed.count - 1) : "";
    report.push_back({Severity::note, file_, passed.line, 0, sentence + times, {}});
  }
  sort_by_line(report);
  return report;
}

void Findings::add(Severity severity, int line, std::string message, std::string hint) {
  if (severity == Severity::error) ++error_count_;
  found_.push_back({severity, file_, line, 0, std::move(message), std::move(hint)});
}

std::string tag(std::string_view name) { return "<" + printable(name) + ">"; }

}  // namespace rehearse::urdf
