#include "order.h"

#include <fmt/format.h>

#include <algorithm>

#include "quiet_thread.h"

namespace rehearse::mcap {
namespace {

/// Limit for overlapping chunks, decompressed [bytes]: a few chunks of the largest allowed size.
std::uint64_t most_held(const ReaderOptions& options) {
  constexpr std::uint64_t most = std::uint64_t{1} << 30;
  return std::min(most, 4 * options.max_chunk_size);
}

}  // namespace

MessageOrder::MessageOrder(Reader::Impl& reader, const ChannelSet& channels, DamageLog& damage, std::uint64_t from)
    : reader_(reader),
      channels_(channels),
      from_(from),
      damage_(damage),
      passed_(reader.file_, reader.bytes_),
      opener_(reader.options_) {
  const bool by_index = reader.indexes_list_all_messages();
  PassedBytes indexes(reader.file_, reader.bytes_);
  for (const Chunk& chunk : reader.chunks_) {
    indexes.pass(chunk.offset);
    const bool is_read = chunk.end_time >= from && (!by_index || reader.is_indexed(chunk.offset, channels));
    (is_read ? chunks_ : others_).push_back(chunk);
  }
  std::stable_sort(chunks_.begin(), chunks_.end(),
                   [](const Chunk& a, const Chunk& b) { return a.start_time < b.start_time; });
  if (reader.loose_messages_) collect_loose();
}

void MessageOrder::check_data_crc() {
  if (reader_.check_data_crc(damage_)) return;
  RawBuffer buffer;
  for (const Chunk& place : others_) {
    Record record;
    if (!RecordWalker(reader_.bytes_, place.offset).next(record)) continue;
    if (const OpenedChunk opened = opener_.open(record, buffer); !opened.ok()) damage_.add(opener_.describe(opened));
  }
}

void MessageOrder::collect_loose() {
  auto run = std::make_unique<Run>();
  run->records = reader_.bytes_.first(reader_.frame_.data_end);
  RecordWalker walker(run->records, magic.size());
  collect(*run, walker, nullptr);
  add(std::move(run));
}

MessageOrder::~MessageOrder() {
  if (thread_.joinable()) thread_.join();
}

/// The other messages of the file are not touched. `ahead` has the place.
void MessageOrder::open(ChunkAhead& ahead) {
  Record record;
  ahead.body = {};
  if (!RecordWalker(reader_.bytes_, ahead.place.offset).next(record) || !parse_chunk(record.body)) return;
  ahead.body = record.body;
  ahead.opened = opener_.open(record, ahead.run->buffer);
}

void MessageOrder::open_ahead() {
  ahead_.place = chunks_[next_chunk_];
  if (spare_.empty()) {
    ahead_.run = std::make_unique<Run>();
  } else {
    ahead_.run = std::move(spare_.back());
    spare_.pop_back();
  }
  const bool is_first = next_chunk_ == 0;  // nothing else can be done meanwhile
  if (is_first)
    open(ahead_);
  else
    thread_ = start_quiet_thread([this] { open(ahead_); });
}

void MessageOrder::open_next_chunk() {
  if (thread_.joinable())
    thread_.join();
  else
    open_ahead();
  if (thread_.joinable()) thread_.join();
  ChunkAhead now = std::move(ahead_);
  passed_.pass(now.place.offset);
  if (++next_chunk_ < chunks_.size()) open_ahead();
  if (now.body.empty()) {
    // The walk has found it: a different process truncates the file.
    damage_.add(fmt::format("damaged: the chunk at byte {} is gone", now.place.offset));
    return;
  }
  if (!now.opened.ok()) {
    damage_.add(opener_.describe(now.opened));
    return;
  }
  now.run->order.clear();
  now.run->next = 0;
  now.run->chunk = now.place.offset;
  now.run->compressed = now.body;
  if (!now.opened.head.compression.empty()) reader_.file_.forget(now.body);  // the buffer contains all of it
  now.run->records = now.opened.records;
  RecordWalker inside(now.run->records);
  collect(*now.run, inside, &now.place);
  if (!inside.at_end()) {
    damage_.add(fmt::format("damaged: the records of the chunk at byte {} aren't whole", now.place.offset));
  }
  add(std::move(now.run));
}

void MessageOrder::collect(Run& run, RecordWalker& walker, const Chunk* place) {
  Record record;
  bool in_span = true;
  while (walker.next(record)) {
    if (record.opcode != op::message) {
      if (place != nullptr) reader_.contents_.learn(record, damage_);
      continue;
    }
    const auto head = parse_message_head(record.body);
    if (!head || !channels_.has(head->channel)) continue;
    if (head->log_time >= from_) run.order.push_back({head->log_time, record.offset});
    in_span =
        in_span && (place == nullptr || (place->start_time <= head->log_time && head->log_time <= place->end_time));
  }
  if (!in_span) {
    damage_.add(
        fmt::format("damaged: messages of the chunk at byte {} are outside of the time that it states", place->offset));
  }
  const auto earlier = [](const Waiting& a, const Waiting& b) { return a.log_time < b.log_time; };
  if (!std::is_sorted(run.order.begin(), run.order.end(), earlier)) {
    std::stable_sort(run.order.begin(), run.order.end(), earlier);
  }
}

void MessageOrder::add(std::unique_ptr<Run> run) {
  if (run->done()) return let_go(std::move(run));
  if (run->chunk) held_ += run->records.size();
  heap_.push_back(std::move(run));
  std::push_heap(heap_.begin(), heap_.end(), later);
}

void MessageOrder::let_go(std::unique_ptr<Run> run) {
  if (run->chunk) reader_.file_.forget(run->compressed);  // its records may be in the mapped file
  spare_.push_back(std::move(run));
}

bool MessageOrder::next(Record& record) {
  while (next_chunk_ < chunks_.size() && (heap_.empty() || chunks_[next_chunk_].start_time <= heap_.front()->time())) {
    const std::uint64_t needed = held_ + chunks_[next_chunk_].size;
    if (held_ > 0 && needed > most_held(reader_.options_)) {
      damage_.add(fmt::format("{} bytes of chunks overlap in time: too much to put in order", needed));
      return false;
    }
    open_next_chunk();
  }
  if (heap_.empty()) return false;
  Run& run = *heap_.front();
  RecordWalker walker(run.records, run.order[run.next].offset);
  if (!walker.next(record)) {  // collect() has read it before
    damage_.add("damaged: messages are gone");
    return false;
  }
  record.chunk = run.chunk;
  return true;
}

void MessageOrder::advance() {
  std::pop_heap(heap_.begin(), heap_.end(), later);
  Run& run = *heap_.back();
  ++run.next;
  if (!run.done()) {
    std::push_heap(heap_.begin(), heap_.end(), later);
    return;
  }
  if (run.chunk) held_ -= run.records.size();
  let_go(std::move(heap_.back()));
  heap_.pop_back();
}

struct OrderedMessages::State {
  State(Reader::Impl& source, std::span<const std::uint16_t> chosen, std::uint64_t from)
      : reader(source), channels(chosen), damage(source.name_), order(source, channels, damage, from) {}

  Reader::Impl& reader;
  const ChannelSet channels;
  DamageLog damage;
  MessageOrder order;
  Message message;
  bool has_message = false;  // a message to remove from `order` by the next call
  bool ended = false;
};

OrderedMessages::OrderedMessages(Reader& reader, std::span<const std::uint16_t> channels, std::uint64_t from) {
  reader.impl().walk_if_not_yet();
  state_ = std::make_unique<State>(reader.impl(), channels, from);
}

OrderedMessages::~OrderedMessages() = default;

const Message* OrderedMessages::next() {
  State& state = *state_;
  Record record;
  do {
    if (std::exchange(state.has_message, false)) state.order.advance();
    state.ended = !state.order.next(record);
    if (state.ended) return nullptr;
    state.has_message = true;
    state.message = state.reader.contents_.read_message(record, state.damage);
  } while (state.message.channel == nullptr);
  return &state.message;
}

Result<void> OrderedMessages::verdict() {
  if (state_->ended) state_->order.check_data_crc();
  return state_->reader.verdict(state_->damage);
}

Result<void> Reader::for_each_message_in_order(const OnMessage& callback, std::span<const std::uint16_t> channels) {
  OrderedMessages messages(*this, channels);
  while (const Message* message = messages.next())
    if (!callback(*message)) break;
  return messages.verdict();
}

}  // namespace rehearse::mcap
