#include "message_finder.h"

#include <algorithm>
#include <tuple>

#include "core/mcap/reader_impl.h"

namespace rehearse {
namespace {

using Entry = MessageFinder::Content::Entry;

/// Enough for a tick and the one before in each group of chunks. A chunk of Rehearse has 0.8 MB, others up to 1 GiB.
constexpr std::size_t fewest_cached = 4;
constexpr std::size_t most_cached = 16;
constexpr std::size_t cached_bytes = std::size_t{24} << 20;

bool before(const Entry& a, const Entry& b) {
  return std::tie(a.channel, a.time, a.offset) < std::tie(b.channel, b.time, b.offset);
}

/// The entries of a channel from `begin` to `end`, both included.
std::pair<std::size_t, std::size_t> span_of(const std::vector<Entry>& entries, std::uint16_t channel,
                                            std::uint64_t begin, std::uint64_t end) {
  const auto lower = std::lower_bound(entries.begin(), entries.end(), Entry{channel, begin, 0, 0}, before);
  const auto upper = std::upper_bound(lower, entries.end(), Entry{channel, end, ~std::uint64_t{0}, 0}, before);
  return {static_cast<std::size_t>(lower - entries.begin()), static_cast<std::size_t>(upper - entries.begin())};
}

MessageFinder::Found found(const std::shared_ptr<const MessageFinder::Content>& content, std::size_t entry) {
  const Entry& at = content->entries[entry];
  return {at.time, content->records.subspan(at.offset, at.size), content};
}

}  // namespace

Result<std::unique_ptr<MessageFinder>> MessageFinder::open(const std::filesystem::path& file) {
  auto reader = REHEARSE_TRY(mcap::Reader::open(file));
  std::unique_ptr<MessageFinder> finder(new MessageFinder(std::move(reader)));
  for (const mcap::Chunk& chunk : finder->reader_->chunks()) finder->places_.push_back({chunk, 0, false, false, {}});
  std::ranges::stable_sort(finder->places_,
                           [](const Place& a, const Place& b) { return a.chunk.start_time < b.chunk.start_time; });
  std::uint64_t latest_end = 0;
  for (Place& place : finder->places_) place.latest_end = latest_end = std::max(latest_end, place.chunk.end_time);
  return finder;
}

/// The index of the first chunk that begins after that time.
std::size_t MessageFinder::begin_after(std::uint64_t time) const {
  const auto after = std::upper_bound(places_.begin(), places_.end(), time,
                                      [](std::uint64_t t, const Place& place) { return t < place.chunk.start_time; });
  return static_cast<std::size_t>(after - places_.begin());
}

/// Reading a few bytes of the file also loads neighbouring pages, as many as the system chooses.
void MessageFinder::let_go(std::uint64_t begin, std::uint64_t end) const {
  constexpr std::uint64_t neighbours = 128 * 1024;
  const mcap::Bytes bytes = reader_->impl().bytes_;
  begin -= std::min(begin, neighbours);
  end = std::min<std::uint64_t>(end + neighbours, bytes.size());
  reader_->impl().file_.forget(bytes.subspan(begin, end - begin));
}

/// True if the channel may be in the chunk, according to its message indexes.
bool MessageFinder::may_have(Place& place, std::uint16_t channel) {
  if (!place.learned) {
    place.learned = true;
    mcap::RecordWalker walker(reader_->impl().bytes_, place.chunk.offset);
    mcap::Record record;
    walker.next(record);  // skips the chunk itself
    while (walker.next(record) && record.opcode == mcap::op::message_index) {
      mcap::ByteReader reader(record.body);
      const auto id = reader.get<std::uint16_t>();
      if (reader.get<std::uint32_t>() == 0 || !reader.ok()) continue;
      place.has_index = true;
      place.channels.push_back(id);
    }
    std::ranges::sort(place.channels);
    let_go(place.chunk.offset, walker.offset());
  }
  return !place.has_index || std::ranges::binary_search(place.channels, channel);
}

std::shared_ptr<const MessageFinder::Content> MessageFinder::content(std::size_t place) {
  ++uses_;
  for (Cached& cached : cache_) {
    if (cached.place != place) continue;
    cached.used = uses_;
    return cached.content;
  }
  std::size_t held = 0;
  for (const Cached& cached : cache_) held += cached.content->records.size();
  while (cache_.size() >= most_cached || (cache_.size() >= fewest_cached && held > cached_bytes)) {
    const auto oldest =
        std::ranges::min_element(cache_, [](const Cached& a, const Cached& b) { return a.used < b.used; });
    held -= oldest->content->records.size();
    cache_.erase(oldest);
  }
  cache_.push_back({place, uses_, open_chunk(places_[place])});
  return cache_.back().content;
}

/// A chunk that can't be opened is reported once, and has no messages.
std::shared_ptr<const MessageFinder::Content> MessageFinder::open_chunk(const Place& place) {
  const auto content = std::make_shared<Content>();
  mcap::ChunkOpener& opener = reader_->impl().chunk_opener_;
  mcap::RecordWalker walker(reader_->impl().bytes_, place.chunk.offset);
  mcap::Record record;
  if (!walker.next(record) || record.opcode != mcap::op::chunk) return content;
  const mcap::OpenedChunk opened = opener.open(record, content->buffer);
  if (opened.fault == mcap::OpenedChunk::Fault::too_short) return content;
  if (!opened.ok()) {
    Diagnostic finding = error_in(reader_->name(), opener.describe(opened));
    const bool known =
        std::ranges::any_of(damage_, [&](const Diagnostic& other) { return other.message == finding.message; });
    if (!known) damage_.push_back(std::move(finding));
    return content;
  }
  content->records = opened.records;
  if (!opened.head.compression.empty())  // otherwise the records are in the file itself
    let_go(place.chunk.offset, walker.offset());
  mcap::RecordWalker inside(opened.records);
  while (inside.next(record)) {
    const auto message = record.opcode == mcap::op::message ? mcap::parse_message_head(record.body) : std::nullopt;
    if (!message) continue;
    const std::uint64_t data = record.offset + mcap::record_head + mcap::message_head;
    content->entries.push_back({message->channel, message->log_time, data, record.body.size() - mcap::message_head});
  }
  std::ranges::stable_sort(content->entries, before);
  return content;
}

std::vector<MessageFinder::Found> MessageFinder::at(std::uint16_t channel, std::uint64_t time) {
  std::vector<std::pair<std::uint64_t, std::vector<Found>>> by_offset;  // chunks in their order in the file
  for (std::size_t place = begin_after(time); place > 0 && places_[place - 1].latest_end >= time; --place) {
    Place& at = places_[place - 1];
    if (at.chunk.end_time < time || !may_have(at, channel)) continue;
    const auto content = this->content(place - 1);
    const auto [begin, end] = span_of(content->entries, channel, time, time);
    std::vector<Found> here;
    for (std::size_t entry = begin; entry < end; ++entry) here.push_back(found(content, entry));
    if (!here.empty()) by_offset.emplace_back(at.chunk.offset, std::move(here));
  }
  std::ranges::stable_sort(by_offset, [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Found> all;
  for (auto& [offset, here] : by_offset) all.insert(all.end(), here.begin(), here.end());
  return all;
}

std::optional<MessageFinder::Found> MessageFinder::latest(std::uint16_t channel, std::uint64_t time,
                                                          std::uint64_t earliest) {
  std::optional<Found> best;
  std::uint64_t best_offset = 0;
  for (std::size_t place = begin_after(time); place > 0; --place) {
    const std::uint64_t bound = best ? best->time : earliest;
    if (places_[place - 1].latest_end < bound) break;
    Place& at = places_[place - 1];
    if (at.chunk.end_time < bound || !may_have(at, channel)) continue;
    const auto content = this->content(place - 1);
    const auto [begin, end] = span_of(content->entries, channel, bound, time);
    if (begin == end) continue;
    const bool later = !best || content->entries[end - 1].time > best->time || at.chunk.offset > best_offset;
    if (!later) continue;
    best = found(content, end - 1);
    best_offset = at.chunk.offset;
  }
  return best;
}

std::optional<MessageFinder::Found> MessageFinder::next(std::uint16_t channel, std::uint64_t time) {
  std::optional<Found> best;
  const auto look_at = [&](std::size_t place) {
    Place& at = places_[place];
    if (at.chunk.end_time < time || !may_have(at, channel)) return;
    const auto content = this->content(place);
    const auto [begin, end] = span_of(content->entries, channel, time, ~std::uint64_t{0});
    if (begin < end && (!best || content->entries[begin].time < best->time)) best = found(content, begin);
  };
  const std::size_t after = begin_after(time);
  for (std::size_t place = after; place > 0 && places_[place - 1].latest_end >= time; --place) look_at(place - 1);
  for (std::size_t place = after; place < places_.size(); ++place) {
    if (best && places_[place].chunk.start_time > best->time) break;
    look_at(place);
  }
  return best;
}

}  // namespace rehearse
