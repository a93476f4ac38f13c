// The digest of a golden: a recording in words and numbers, for reviews.
#include <fmt/format.h>
#include <rehearse/golden.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include "compare/compare_parts.h"
#include "trace/hashing.h"

namespace rehearse {
namespace {

using Out = std::back_insert_iterator<std::string>;

/// Five digits, and none below the tolerance of the unit: a line is another one only if the run is.
std::string number_text(double value, const std::string& series, const std::string& unit) {
  if (!std::isfinite(value)) return fmt::format("{}", value);
  const double least = tolerance_of(series, unit, {}).atol;
  const double rounded = least > 0.0 ? std::round(value / least) * least : value;
  const std::string text = fmt::format("{:.5g}", rounded);
  return text == "-0" ? "0" : text;
}

std::string cell_text(const TraceChannel& channel, std::size_t row, std::size_t column) {
  const std::uint64_t bits = channel.bits(row, column);
  const TraceColumn& series = channel.columns[column];
  switch (series.kind) {
    case CellKind::floating:
      return number_text(std::bit_cast<double>(bits), series_of(channel, series),
                         unit_of(channel.metadata, series.element));
    case CellKind::signed_integer: return fmt::format("{}", static_cast<std::int64_t>(bits));
    case CellKind::unsigned_integer: return fmt::format("{}", bits);
    case CellKind::boolean: return bits ? "true" : "false";
  }
  return "";
}

/// One line: what a series does over the run.
void describe_series(const TraceChannel& channel, std::size_t column, std::string& text) {
  const TraceColumn& series = channel.columns[column];
  const std::size_t rows = channel.rows();
  if (rows == 0) return;
  std::size_t least = 0, most = 0, not_numbers = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    const double value = channel.number(row, column);
    not_numbers += std::isnan(value) ? 1 : 0;
    if (!(value >= channel.number(least, column))) least = row;
    if (!(value <= channel.number(most, column))) most = row;
  }
  const std::string unit = unit_of(channel.metadata, series.element);
  fmt::format_to(Out(text), "  {} [{}] first {} last {} min {} max {}", series.element, unit.empty() ? "-" : unit,
                 cell_text(channel, 0, column), cell_text(channel, rows - 1, column), cell_text(channel, least, column),
                 cell_text(channel, most, column));
  if (not_numbers > 0) fmt::format_to(Out(text), " NaN {} times", not_numbers);
  text += '\n';
}

bool is_range(const TraceColumn& column) { return column.element.starts_with("ranges/"); }

/// Of one of the points that touch a link; how many there are stands beside them.
bool is_contact(const TraceChannel& channel, const TraceColumn& column) {
  return channel.type == msg::Contacts::type_name && column.element != "contacts/count";
}

/// One line for all points that touch a link: how hard and how deep.
void describe_contacts(const TraceChannel& channel, std::string& text) {
  double most = 0.0, deepest = 0.0;
  bool any = false;
  for (std::size_t column = 0; column < channel.columns.size(); ++column) {
    if (!is_contact(channel, channel.columns[column])) continue;
    any = true;
    const bool force = channel.columns[column].element.find("/force/") != std::string::npos;
    const bool depth = channel.columns[column].element.ends_with("/depth");
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      const double value = channel.number(row, column);
      if (force && std::abs(value) > most) most = std::abs(value);
      if (depth && value > deepest) deepest = value;
    }
  }
  if (any)
    fmt::format_to(Out(text), "  at a point at most {} N along an axis, {} m deep\n", number_text(most, "", "N"),
                   number_text(deepest, "", "m"));
}

/// One line for all beams of a range sensor: how near and how far they met something, and how often nothing.
void describe_ranges(const TraceChannel& channel, std::string& text) {
  std::size_t beams = 0, nothing = 0;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0;
  for (std::size_t column = 0; column < channel.columns.size(); ++column) {
    if (!is_range(channel.columns[column])) continue;
    ++beams;
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      const double range = channel.number(row, column);
      nothing += std::isinf(range) ? 1 : 0;
      if (!std::isfinite(range)) continue;  // not a number: there was no scan
      nearest = std::min(nearest, range);
      farthest = std::max(farthest, range);
    }
  }
  if (beams > 0)
    fmt::format_to(Out(text), "  ranges of {} beams [m] min {} max {}, nothing {} times\n", beams,
                   number_text(nearest, "", "m"), number_text(farthest, "", "m"), nothing);
}

bool is_hash(const TraceColumn& column) { return column.element.ends_with("_hash"); }

Result<std::uint64_t> hash_of_table(const TraceChannel& channel) {
  const std::uint64_t times = hash_bytes(channel.times.data(), channel.times.size() * sizeof(std::uint64_t));
  return hash_bytes(channel.cells.data(), channel.cells.size() * sizeof(std::uint64_t), times);
}

Result<std::uint64_t> hash_of_payloads(const Trace& trace, const TraceChannel& channel) {
  std::uint64_t hash = hash_bytes(channel.times.data(), channel.times.size() * sizeof(std::uint64_t));
  for (std::size_t i = 0; i < channel.locations.size(); ++i) {
    const auto payload = trace.payload(channel, i);
    if (!payload) return payload.errors();
    hash = hash_bytes(payload->data(), payload->size(), hash);
  }
  return hash;
}

void describe_channel(const TraceChannel& channel, std::string& text) {
  fmt::format_to(Out(text), "\n{} {}: {} {}\n", channel.topic, channel.type, channel.messages(),
                 is_picture(channel) ? "pictures" : "messages");
  for (std::size_t column = 0; column < channel.columns.size(); ++column)
    if (!is_hash(channel.columns[column]) && !is_range(channel.columns[column]) &&
        !is_contact(channel, channel.columns[column]))
      describe_series(channel, column, text);
  describe_ranges(channel, text);
  describe_contacts(channel, text);
}

/// Of all that was recorded, so that the text belongs to this recording and no other.
Result<std::uint64_t> hash_of_channels(const Trace& trace) {
  std::uint64_t hash = 0;
  for (const TraceChannel& channel : trace.channels()) {
    const auto of_channel = channel.columns.empty() ? hash_of_payloads(trace, channel) : hash_of_table(channel);
    if (!of_channel) return of_channel;
    hash = hash_bytes(&*of_channel, sizeof *of_channel, hash);
  }
  return hash;
}

void describe_facts(const Trace& trace, const char* metadata, std::string& text) {
  const mcap::StringMap* facts = trace.find_metadata(metadata);
  if (!facts) return;
  for (const auto& [fact, value] : *facts) fmt::format_to(Out(text), "  {}: {}\n", fact, value);
}

}  // namespace

Result<std::string> digest_of(const Trace& trace) {
  const auto hash = hash_of_channels(trace);
  if (!hash) return hash.errors();
  std::string text = fmt::format("{} of a recording; derived from it, not to be edited\n\n", digest_form);
  std::vector<Acceptance> history = history_of(trace.metadata());
  if (!history.empty()) text += acceptance_text(history.back()) + "\n";
  text += "provenance\n";
  describe_facts(trace, records::provenance, text);
  text += "\noutcome\n";
  describe_facts(trace, records::outcome, text);
  fmt::format_to(Out(text), "  content: {}\n", hash_text(*hash));
  if (history.size() > 1) {
    history.pop_back();
    text += "\naccepted before\n" + history_text(history);
  }
  text += "\nevents\n";
  for (const msg::Event& event : trace.events())
    fmt::format_to(Out(text), "  tick {} {} {}: {}\n", event.tick, event.severity, event.source, event.text);
  for (const TraceChannel& channel : trace.channels()) describe_channel(channel, text);
  return text;
}

}  // namespace rehearse
