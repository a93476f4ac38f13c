#include "report_run.h"

#include <algorithm>
#include <array>

#include "base/hashing.h"
#include "core/trace/trace_windows.h"

namespace rehearse {
namespace {

const JudgedValues::Column nothing_found;

/// The name that a comparison uses for the four columns of an orientation.
std::string_view stem_of(std::string_view element) { return element.substr(0, element.rfind('/')); }

}  // namespace

void ChannelSummary::take(const TraceChannel& piece) {
  messages += piece.messages();
  for (std::size_t message = 0; message < piece.messages(); ++message) {
    const std::array<std::uint64_t, 2> both{piece.times[message], piece.hashes[message]};
    first_time = std::min(first_time, both[0]);
    last_time = std::max(last_time, both[0]);
    hash = hash_bytes(both.data(), sizeof both, hash);
  }
  ranges.resize(piece.columns.size());
  for (std::size_t row = 0; row < piece.rows(); ++row)
    for (std::size_t column = 0; column < ranges.size(); ++column) ranges[column].take(piece.number(row, column));
}

Result<ReportedRun> ReportedRun::read(const std::filesystem::path& file) {
  ReportedRun run;
  const auto take = [&run](const Trace& piece) {
    run.clock.take(piece);
    run.channels.resize(piece.channels().size());
    for (std::size_t i = 0; i < run.channels.size(); ++i) run.channels[i].take(piece.channels()[i]);
  };
  auto trace = REHEARSE_TRY(
      load_pieces(file, nullptr, take, Trace::usual_piece_size, PieceOrder::of_file, Trace::Damage::tolerate));
  run.clock.put_in_order();
  run.file = file;
  run.trace = std::move(trace);
  return run;
}

void JudgedValues::mark(std::int64_t tick) {
  if (clock_.empty()) return;
  const std::int64_t place = tick - clock_.tick_at(clock_.first_time());
  if (place < 0) return;
  const auto at = static_cast<std::size_t>(place);
  if (at >= beyond_.size()) beyond_.resize(at + 1);
  beyond_[at] = true;
}

void JudgedValues::take(const DifferingValue& value) {
  const std::size_t message = value.channel.earlier + value.message;
  if (value.columns.empty()) pixels_[{value.place, message}] = value.pixels;
  if (!value.beyond) return;
  mark(clock_.tick_at(value.channel.times[value.message]));
  if (value.columns.empty()) return;
  std::vector<Column>& columns = columns_[value.place];
  columns.resize(value.channel.columns.size());
  for (const std::size_t index : value.columns) {
    Column& column = columns[index];
    if (column.last != message) ++column.beyond;
    column.last = message;
  }
}

void JudgedValues::conclude(const Comparison& comparison) {
  for (const auto* channels : {&comparison.channels, &comparison.same}) {
    for (const ChannelComparison& compared : *channels) {
      const auto channel =
          std::ranges::find_if(channels_, [&](const TraceChannel& known) { return known.topic == compared.channel; });
      if (channel == channels_.end() || compared.of_events || channel->columns.empty()) continue;
      std::map<std::string_view, double> tolerances;
      for (const SeriesComparison& series : compared.series) tolerances[series.element] = series.tolerance;
      std::vector<Column>& columns = columns_[static_cast<std::size_t>(channel - channels_.begin())];
      columns.resize(channel->columns.size());
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const std::string& element = channel->columns[i].element;
        auto found = tolerances.find(element);
        if (found == tolerances.end()) found = tolerances.find(stem_of(element));
        if (found != tolerances.end()) columns[i].tolerance = found->second;
      }
    }
  }
  for (const EventDifference& event : comparison.event_differences)
    if (event.beyond) mark(event.actual ? *event.actual : *event.expected);
}

const JudgedValues::Column& JudgedValues::of(std::size_t place, std::size_t column) const {
  const std::vector<Column>& columns = columns_[place];
  return columns.empty() ? nothing_found : columns[column];
}

std::int64_t JudgedValues::pixels(std::size_t place, std::size_t message) const {
  const auto found = pixels_.find({place, message});
  return found == pixels_.end() ? 0 : found->second;
}

std::vector<std::pair<std::int64_t, std::int64_t>> JudgedValues::spans(std::size_t most) const {
  std::vector<std::pair<std::int64_t, std::int64_t>> spans;
  if (clock_.empty()) return spans;
  const std::int64_t first = clock_.tick_at(clock_.first_time());
  for (std::size_t i = 0; i < beyond_.size(); ++i) {
    if (!beyond_[i]) continue;
    const std::int64_t tick = first + static_cast<std::int64_t>(i);
    if (!spans.empty() && spans.back().second == tick)
      ++spans.back().second;
    else
      spans.emplace_back(tick, tick + 1);
  }
  if (spans.size() <= most) return spans;
  std::vector<std::int64_t> gaps;  // the widest gaps remain
  for (std::size_t i = 1; i < spans.size(); ++i) gaps.push_back(spans[i].first - spans[i - 1].second);
  std::ranges::sort(gaps);
  // Gaps of this width are joined, too: of several equal ones none remains.
  const std::int64_t narrowest = gaps[gaps.size() - most];
  std::vector<std::pair<std::int64_t, std::int64_t>> joined{spans.front()};
  for (std::size_t i = 1; i < spans.size(); ++i) {
    if (spans[i].first - spans[i - 1].second > narrowest)
      joined.push_back(spans[i]);
    else
      joined.back().second = spans[i].second;
  }
  return joined;
}

}  // namespace rehearse
