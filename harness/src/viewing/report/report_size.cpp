// Estimates the size of a report before it is made.
#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "report_page.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

// The size of a report relative to the bytes in a recording.
constexpr double of_pictures = 4.0 / 3.0;  // base64 of the same bytes
constexpr double of_numbers = 1.3;

/// The span and the size of a recording, from its index.
struct Extent {
  double begin = 0.0, end = 0.0;  // [s]
  double bytes = 0.0;             // in its report

  double of_span(double from, double until) const {
    const double length = end - begin;
    if (!(length > 0.0)) return bytes;
    const double covered = std::min(until, end) - std::max(from, begin);
    return bytes * std::clamp(covered / length, 0.0, 1.0);
  }
};

Result<Extent> extent_of(const fs::path& file) {
  mcap::ReaderOptions quick;
  quick.opening = mcap::Opening::by_summary;
  const auto reader = mcap::Reader::open(file, quick);
  if (!reader) return reader.errors();
  Extent extent;
  std::uint64_t first = ~std::uint64_t{0}, last = 0;
  for (const mcap::Chunk& chunk : (*reader)->chunks()) {
    first = std::min(first, chunk.start_time);
    last = std::max(last, chunk.end_time);
    extent.bytes += static_cast<double>(chunk.stored_size) * (chunk.compression.empty() ? of_pictures : of_numbers);
  }
  if (first > last) return extent;
  extent.begin = static_cast<double>(first) / 1e9;
  extent.end = static_cast<double>(last) / 1e9;
  return extent;
}

double size_of(const std::vector<Extent>& extents, double from, double until) {
  double bytes = 0.0;
  for (const Extent& extent : extents) bytes += extent.of_span(from, until);
  return bytes;
}

/// A tick's time and its three hashes.
struct TickMark {
  std::uint64_t time = 0;  // [ns]
  std::uint64_t state = 0, input = 0, output = 0;

  bool operator==(const TickMark&) const = default;
};

/// The marks of a recording up to that time [s].
std::vector<TickMark> tick_marks(const fs::path& file, double until) {
  std::vector<TickMark> marks;
  const auto reader = mcap::Reader::open(file);
  if (!reader) return marks;
  std::vector<std::uint16_t> chosen;
  for (const auto& [id, channel] : (*reader)->channels()) {
    const mcap::Schema* schema = (*reader)->schema_of(channel);
    if (schema && schema->name == msg::Tick::type_name) chosen.push_back(id);
  }
  if (chosen.empty()) return marks;
  const auto end = static_cast<std::uint64_t>(until * 1e9);
  (void)(*reader)->for_each_message(  // damage is reported when the file is loaded
      [&](const mcap::Message& message) {
        CdrReader cdr(message.data);
        msg::Tick tick;
        if (msg::decode(cdr, tick))
          marks.push_back({message.log_time, tick.state_hash, tick.input_hash, tick.output_hash});
        return message.log_time <= end;
      },
      chosen);
  return marks;
}

/// The time of the first tick with different hashes [s]; none: there is none, or nothing to compare. Stops reading at
/// the first difference, which is mostly early.
std::optional<double> first_difference(std::span<const fs::path> traces, double length) {
  if (traces.size() < 2) return std::nullopt;
  for (double until = 60.0;; until *= 4.0) {
    const auto actual = tick_marks(traces[0], until), golden = tick_marks(traces[1], until);
    const auto [a, g] = std::mismatch(actual.begin(), actual.end(), golden.begin(), golden.end());
    if (a != actual.end() && g != golden.end()) return static_cast<double>(a->time) / 1e9;
    if (until >= length || a != actual.end() || g != golden.end()) return std::nullopt;
  }
}

std::string megabytes(double bytes) { return fmt::format("{:.0f} MB", std::ceil(bytes / 1e6)); }

}  // namespace

Result<void> check_report_size(std::span<const fs::path> traces, const fs::path& report, const ReportOptions& options) {
  std::vector<Extent> extents;
  for (const fs::path& trace : traces) {
    auto extent = extent_of(trace);
    if (!extent) return extent.errors();
    extents.push_back(*extent);
  }
  const double from = options.from.value_or(0.0), until = options.until.value_or(Scenario::max_duration);
  const double bytes = size_of(extents, from, until);
  const auto most = static_cast<double>(options.max_size);
  if (bytes <= most) return {};
  constexpr double usual_length = 60.0;  // [s]
  double begin = std::max(from, extents[0].begin);
  double length = usual_length;
  while (length > 0.001 && size_of(extents, begin, begin + length) > 0.5 * most) length /= 2.0;
  std::optional<double> wanted;
  if (options.verdict && options.verdict->first)
    wanted = options.verdict->first->time;
  else
    wanted = first_difference(traces, extents[0].end);
  if (wanted && *wanted > begin + 0.5 * length) begin = std::floor(1e3 * (*wanted - 0.5 * length)) / 1e3;
  begin = std::max(begin, 0.0);
  std::string command = "rehearse report";
  for (const fs::path& trace : traces) command += " " + trace.string();
  return error_in(traces[0].string(),
                  fmt::format("the report would have about {}, and browsers open files above {} slowly",
                              megabytes(bytes), megabytes(most)),
                  fmt::format("take a part of it: {} -o {} --from {:g} --until {:g}", command, report.string(), begin,
                              begin + length));
}

}  // namespace rehearse
