// The digest of a golden: a recording as words and numbers, for reviews.
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
#include <numeric>
#include <vector>

#include "base/hashing.h"
#include "core/compare/divergence_text.h"
#include "core/compare/series_rules.h"
#include "core/kinds/channel_name.h"
#include "core/trace/event_stream.h"
#include "core/trace/run_facts.h"
#include "core/trace/trace_windows.h"

namespace rehearse {
namespace {

using Out = std::back_insert_iterator<std::string>;

/// The number with at most five digits, none of them below the tolerance of the unit: a line changes only if the run
/// changes.
std::string number_text(double value, const std::string& series, const std::string& unit) {
  if (!std::isfinite(value)) return fmt::format("{}", value);
  const double least = tolerance_of(series, unit, {}).atol;
  const double rounded = least > 0.0 ? std::round(value / least) * least : value;
  const std::string text = fmt::format("{:.5g}", rounded);
  return text == "-0" ? "0" : text;
}

/// A value of a series.
struct Cell {
  std::uint64_t bits = 0;
  double number = 0.0;
};

std::string cell_text(const TraceChannel& channel, std::size_t column, const Cell& cell) {
  const TraceColumn& series = channel.columns[column];
  switch (series.kind) {
    case CellKind::floating:
      return number_text(cell.number, series_of(channel, series), unit_of(channel.metadata, series.element));
    case CellKind::signed_integer: return fmt::format("{}", static_cast<std::int64_t>(cell.bits));
    case CellKind::unsigned_integer: return fmt::format("{}", cell.bits);
    case CellKind::boolean: return cell.bits ? "true" : "false";
  }
  return "";
}

bool is_range(const TraceColumn& column) { return column.element.starts_with("ranges/"); }

/// True for a value of a contact point of a link; `count` has the number of points.
bool is_contact(const TraceChannel& channel, const TraceColumn& column) {
  return channel.type == msg::Contacts::type_name && column.element != "contacts/count";
}

bool is_hash(const TraceColumn& column) { return column.element.ends_with("_hash"); }

/// The digest of a series over the run.
class SeriesDigest {
 public:
  void take(const TraceChannel& channel, std::size_t column) {
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      const Cell cell{channel.bits(row, column), channel.number(row, column)};
      if (rows_++ == 0) first_ = least_ = most_ = cell;
      last_ = cell;
      not_numbers_ += std::isnan(cell.number) ? 1 : 0;
      if (!(cell.number >= least_.number)) least_ = cell;
      if (!(cell.number <= most_.number)) most_ = cell;
    }
  }

  /// Appends one line.
  void describe(const TraceChannel& channel, std::size_t column, std::string& text) const {
    if (rows_ == 0) return;
    const TraceColumn& series = channel.columns[column];
    const std::string unit = unit_of(channel.metadata, series.element);
    fmt::format_to(Out(text), "  {} [{}] first {} last {} min {} max {}", series.element, unit.empty() ? "-" : unit,
                   cell_text(channel, column, first_), cell_text(channel, column, last_),
                   cell_text(channel, column, least_), cell_text(channel, column, most_));
    if (not_numbers_ > 0) fmt::format_to(Out(text), " NaN {} times", not_numbers_);
    text += '\n';
  }

 private:
  std::size_t rows_ = 0, not_numbers_ = 0;
  Cell first_, last_, least_, most_;
};

/// The digest of a channel's messages over the run.
class ChannelDigest {
 public:
  void take(const TraceChannel& channel) {
    messages_ += channel.messages();
    times_.add(channel.times.data(), channel.times.size() * sizeof(std::uint64_t));
    series_.resize(channel.columns.size());
    for (std::size_t column = 0; column < channel.columns.size(); ++column) {
      if (is_range(channel.columns[column]))
        take_range(channel, column);
      else if (is_contact(channel, channel.columns[column]))
        take_contact(channel, column);
      else if (!is_hash(channel.columns[column]))
        series_[column].take(channel, column);
    }
  }

  std::uint64_t hash_of_times() const { return times_.value(); }

  void describe(const TraceChannel& channel, std::string& text) const {
    fmt::format_to(Out(text), "\n{} {}: {} {}\n", channel.topic, channel.type, messages_,
                   is_picture(channel) ? "pictures" : "messages");
    for (std::size_t column = 0; column < series_.size(); ++column) series_[column].describe(channel, column, text);
    const auto beams = std::ranges::count_if(channel.columns, is_range);
    if (beams > 0)
      fmt::format_to(Out(text), "  ranges of {} beams [m] min {} max {}, nothing {} times\n", beams,
                     number_text(nearest_, "", "m"), number_text(farthest_, "", "m"), nothing_);
    if (std::ranges::any_of(channel.columns, [&](const TraceColumn& column) { return is_contact(channel, column); }))
      fmt::format_to(Out(text), "  at a point at most {} N along an axis, {} m deep\n", number_text(force_, "", "N"),
                     number_text(depth_, "", "m"));
  }

 private:
  /// Counts the smallest and largest distance of a beam, and the beams without a hit.
  void take_range(const TraceChannel& channel, std::size_t column) {
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      const double range = channel.number(row, column);
      nothing_ += std::isinf(range) ? 1 : 0;
      if (!std::isfinite(range)) continue;  // NaN: there was no scan
      nearest_ = std::min(nearest_, range);
      farthest_ = std::max(farthest_, range);
    }
  }

  /// Keeps the largest force and depth of the contacts of a link.
  void take_contact(const TraceChannel& channel, std::size_t column) {
    const bool force = channel.columns[column].element.find("/force/") != std::string::npos;
    const bool depth = channel.columns[column].element.ends_with("/depth");
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      const double value = channel.number(row, column);
      if (force && std::abs(value) > force_) force_ = std::abs(value);
      if (depth && value > depth_) depth_ = value;
    }
  }

  std::size_t messages_ = 0;
  RunningHash times_;
  std::vector<SeriesDigest> series_;                                           // by column
  std::size_t nothing_ = 0;                                                    // beams without a hit
  double nearest_ = std::numeric_limits<double>::infinity(), farthest_ = 0.0;  // [m]
  double force_ = 0.0, depth_ = 0.0;                                           // the largest [N], [m]
};

/// A hash of all recorded data, so that the text identifies this recording.
Result<std::uint64_t> hash_of_channels(const Trace& trace, const std::vector<std::size_t>& all,
                                       const std::vector<ChannelDigest>& digests) {
  std::vector<RunningHash> of_tables;
  std::vector<std::uint64_t> of_payloads;
  for (const ChannelDigest& digest : digests) {
    of_tables.emplace_back(digest.hash_of_times());
    of_payloads.push_back(digest.hash_of_times());
  }
  Diagnostics unread;
  for_each_window(trace, all, [&](const Trace& window) {
    for (const std::size_t i : all) {
      const TraceChannel& channel = window.channels()[i];
      of_tables[i].add(channel.cells.data(), channel.cells.size() * sizeof(std::uint64_t));
      for (std::size_t message = 0; trace.channels()[i].columns.empty() && message < channel.locations.size();
           ++message) {
        const auto payload = window.payload(channel, message);
        if (payload)
          of_payloads[i] = hash_bytes(payload->data(), payload->size(), of_payloads[i]);
        else if (unread.empty())
          unread = payload.errors();
      }
    }
    return true;
  });
  if (!unread.empty()) return unread;
  std::uint64_t hash = 0;
  for (const std::size_t i : all) {
    const std::uint64_t of_channel = trace.channels()[i].columns.empty() ? of_payloads[i] : of_tables[i].value();
    hash = hash_bytes(&of_channel, sizeof of_channel, hash);
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
  std::vector<std::size_t> all(trace.channels().size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<ChannelDigest> digests(all.size());
  for_each_window(trace, all, [&](const Trace& window) {
    for (const std::size_t i : all) digests[i].take(window.channels()[i]);
    return true;
  });
  const auto hash = REHEARSE_TRY(hash_of_channels(trace, all, digests));
  std::string text = fmt::format("{} of a recording; derived from it, not to be edited\n\n", digest_form);
  std::vector<Acceptance> history = history_of(trace.metadata());
  if (!history.empty()) text += acceptance_text(history.back()) + "\n";
  text += "provenance\n";
  describe_facts(trace, records::provenance, text);
  if (trace.find_metadata(records::state_rate)) {
    text += "\nstate, of which samples are kept\n";
    describe_facts(trace, records::state_rate, text);
  }
  text += "\noutcome\n";
  describe_facts(trace, records::outcome, text);
  fmt::format_to(Out(text), "  content: {}\n", hash_text(hash));
  if (history.size() > 1) {
    history.pop_back();
    text += "\naccepted before\n" + history_text(history);
  }
  text += "\nevents\n";
  EventStream events(trace);
  while (const msg::Event* event = events.next())
    fmt::format_to(Out(text), "  tick {} {} {}: {}\n", event->tick, event->severity, event->source, event->text);
  for (const std::size_t i : all) digests[i].describe(trace.channels()[i], text);
  return text;
}

}  // namespace rehearse
