#include "urdf_findings.h"

#include <rehearse/urdf.h>

#include <fmt/format.h>

#include <algorithm>

namespace rehearse::urdf {
namespace {

void sort_by_line(Diagnostics& diagnostics) {
  std::stable_sort(diagnostics.begin(), diagnostics.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.line < b.line; });
}

/// Length of the UTF-8 sequence at the start of `text`, 0 if there is no good one.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return 0;
  unsigned low = 0x80;
  unsigned high = 0xBF;
  if (lead == 0xE0) low = 0xA0;
  if (lead == 0xED) high = 0x9F;
  if (lead == 0xF0) low = 0x90;
  if (lead == 0xF4) high = 0x8F;
  if (byte(1) < low || byte(1) > high) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  return length;
}

}  // namespace

void Findings::error(int line, std::string message, std::string hint) {
  add(Severity::error, line, std::move(message), std::move(hint));
}

void Findings::repair(int line, std::string message, std::string hint) {
  add(strict_ ? Severity::error : Severity::repair, line, std::move(message), std::move(hint));
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

Diagnostics Findings::errors() const {
  Diagnostics errors;
  std::copy_if(found_.begin(), found_.end(), std::back_inserter(errors),
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
  std::copy_if(found_.begin(), found_.end(), std::back_inserter(report),
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

std::string printable(std::string_view text, std::size_t longest) {
  std::string shown;
  while (!text.empty()) {
    if (shown.size() >= longest) {
      shown += "...";
      break;
    }
    const std::size_t length = utf8_length(text);
    const unsigned char first = static_cast<unsigned char>(text.front());
    const bool is_visible = length > 0 && first >= 0x20 && first != 0x7F;
    shown += is_visible ? text.substr(0, length) : std::string_view("?");
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return shown;
}

std::string in_quotes(std::string_view text, std::size_t longest) { return "'" + printable(text, longest) + "'"; }

std::string tag(std::string_view name) { return "<" + printable(name) + ">"; }

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace rehearse::urdf
