#include "recorded_ticks.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/kinds/channel_name.h"

namespace rehearse {

RecordedTicks::RecordedTicks(MessageFinder& finder) {
  for (const auto& [id, channel] : finder.reader().channels())
    sources_.push_back(std::make_unique<Source>(finder, channel));
  recorded_channels_ = sources_.size();
  for (const std::unique_ptr<Source>& source : sources_) learn(*source);
  name_all();
}

RecordedTicks::Source::Source(MessageFinder& in, const mcap::Channel& channel)
    : finder(in),
      id(channel.id),
      rows(channel, in.reader().schema_of(channel)),
      varies(rows.has_rows() && (!rows.is_typed() || rows.table.type == msg::Contacts::type_name)) {}

void RecordedTicks::add_replayed(MessageFinder& variables) {
  for (const auto& [id, channel] : variables.reader().channels()) {
    if (ChannelName::parse(channel.topic).kind != ChannelKind::variable) continue;
    auto source = std::make_unique<Source>(variables, channel);
    learn(*source);
    const auto same = [&topic = channel.topic](const std::unique_ptr<Source>& other) {
      return other->rows.table.topic == topic;
    };
    const auto known = std::ranges::find_if(sources_, same);
    if (known == sources_.end()) {
      sources_.push_back(std::move(source));
    } else if ((*known)->rows.table.type == source->rows.table.type) {
      (*known)->replayed = std::move(source);
    }
  }
  name_all();
}

/// Reads the first message, the last, and one between.
void RecordedTicks::learn(Source& source) {
  if (!source.rows.has_rows()) return;
  const auto first = source.finder.next(source.id, 0);
  if (!first) return;
  read(source, *first);
  const auto last = source.finder.latest(source.id, never);
  if (!last || last->time == first->time) return;
  if (const auto middle = source.finder.latest(source.id, first->time + (last->time - first->time) / 2, first->time))
    read(source, *middle);
  read(source, *last);
}

void RecordedTicks::learn_all() {
  if (learned_all_) return;
  learned_all_ = true;
  for (const std::unique_ptr<Source>& source : sources_) {
    if (!source->varies) continue;
    for (auto found = source->finder.next(source->id, 0); found;
         found = source->finder.next(source->id, found->time + 1))
      read(*source, *found);
  }
  name_all();
}

void RecordedTicks::name_all() {
  std::vector<TraceChannel*> tables;
  for (const std::unique_ptr<Source>& source : sources_) tables.push_back(&source->rows.table);
  series_.clear();
  names_.clear();
  name_series(tables, series_);
}

const std::vector<std::string>& RecordedTicks::names() {
  if (names_.empty())
    for (const auto& [name, place] : series_) names_.push_back(name);
  return names_;
}

/// Reads a message into the table's only row. False: it doesn't fit its type.
bool RecordedTicks::read(Source& source, const MessageFinder::Found& found) {
  return source.rows.replace(found.time, found.data);
}

const RecordedTicks::Row* RecordedTicks::row(std::size_t channel, std::uint64_t time) {
  return row(*sources_[channel], time);
}

const RecordedTicks::Row* RecordedTicks::replayed_row(std::size_t channel, std::uint64_t time) {
  return has_replayed_rows(channel) ? row(*sources_[channel]->replayed, time) : nullptr;
}

const RecordedTicks::Row* RecordedTicks::row(Source& source, std::uint64_t time) {
  if (!source.rows.has_rows()) return nullptr;
  Row* best = nullptr;  // the latest row that isn't later
  Row* oldest = &source.recent.front();
  for (Row& row : source.recent) {
    if (row.used < oldest->used) oldest = &row;
    if (row.time != never && row.time <= time && (!best || row.time > best->time)) best = &row;
  }
  if (best) best->used = ++uses_;
  if (best && time <= best->until) return best;
  if (!best && time < source.none_until) return nullptr;
  const std::uint64_t earliest = best ? best->until + 1 : source.none_until;
  const auto found = source.finder.latest(source.id, time, earliest);
  if (!found) {
    if (best) best->until = time;
    if (!best) source.none_until = std::max(source.none_until, time + 1);
    return best;
  }
  const std::size_t columns = source.rows.table.columns.size();
  if (oldest == best) oldest = &source.recent.back() == best ? &source.recent.front() : &source.recent.back();
  if (read(source, *found)) {
    oldest->cells = source.rows.table.cells;
  } else {
    oldest->cells.assign(source.rows.table.columns.size(), std::bit_cast<std::uint64_t>(std::nan("")));
  }
  if (source.rows.table.columns.size() != columns) name_all();
  oldest->time = found->time;
  oldest->until = time;
  oldest->used = ++uses_;
  return oldest;
}

double RecordedTicks::number(std::size_t channel, std::size_t column, const Row& row) const {
  if (column >= row.cells.size()) return std::nan("");
  const std::uint64_t bits = row.cells[column];
  switch (sources_[channel]->rows.table.columns[column].kind) {
    case CellKind::floating: return std::bit_cast<double>(bits);
    case CellKind::signed_integer: return static_cast<double>(static_cast<std::int64_t>(bits));
    case CellKind::unsigned_integer:
    case CellKind::boolean: break;
  }
  return static_cast<double>(bits);
}

}  // namespace rehearse
