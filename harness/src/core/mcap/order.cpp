// Orders messages of overlapping chunks by log time.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "base/quiet_thread.h"
#include "reader_impl.h"

namespace rehearse::mcap {
namespace {

/// A message that is not delivered yet.
struct Waiting {
  std::uint64_t log_time = 0;
  std::uint64_t offset = 0;  // offset of its record, in the file or in the decompressed chunk
};

/// A sequence of messages sorted by time: a decompressed chunk, or all messages outside of chunks.
struct MessageRun {
  std::optional<std::uint64_t> chunk;
  Bytes mapped;  // the chunk's record, if the chunk isn't compressed and its records are read from the mapped file
  RawBuffer buffer;
  Bytes records;
  std::vector<Waiting> order;
  std::size_t next = 0;

  bool done() const { return next == order.size(); }
  std::uint64_t time() const { return order[next].log_time; }
  std::uint64_t file_offset() const { return chunk.value_or(order[next].offset); }
  /// Loads the message after the next one into the cache of this processor: the worker wrote it on another processor.
  void prefetch() const;
};

/// A chunk that a thread opens while the messages before it are delivered.
struct ChunkAhead {
  Chunk place;
  std::unique_ptr<MessageRun> run;
  Bytes body;  // body of the chunk's record; empty: the record is missing
  OpenedChunk opened;
  std::vector<Record> definitions;  // all records of the chunk except messages
  bool in_span = true;              // its messages are in the span of time that the chunk states
  bool is_whole = true;             // its last record is complete
};

/// The messages of a file, one after the other, by (log time, position in the file). A chunk is opened at the time of
/// its first message and released after its last.
class MessageOrder {
 public:
  /// The three objects must outlive this. Messages before `from` [ns] are left out.
  MessageOrder(Reader::Impl& reader, const ChannelSet& channels, DamageLog& damage, std::uint64_t from);
  MessageOrder(const MessageOrder&) = delete;
  MessageOrder& operator=(const MessageOrder&) = delete;

  /// The record of the next message; false if there is none left, or not enough memory.
  bool next(Record& record);
  /// Checks the CRC of the data section; if it doesn't match, finds the damage in chunks of other channels too.
  void check_data_crc();
  /// Removes the message that next() returned.
  void advance();

 private:
  static bool later(const std::unique_ptr<MessageRun>& a, const std::unique_ptr<MessageRun>& b) {
    return std::pair(a->time(), a->file_offset()) > std::pair(b->time(), b->file_offset());
  }
  void collect_loose();
  void choose_ahead();
  void read_ahead();
  void open_ahead();
  void open_next_chunk();
  void collect(ChunkAhead& chunk, std::uint64_t begin = 0) const;
  void add(std::unique_ptr<MessageRun> run);
  void let_go(std::unique_ptr<MessageRun> run);

  Reader::Impl& reader_;
  const ChannelSet& channels_;
  const std::uint64_t from_;  // [ns]
  DamageLog& damage_;
  PassedBytes passed_;         // includes the bytes between chunks
  std::vector<Chunk> chunks_;  // chunks with messages to deliver, by start time, then offset
  std::vector<Chunk> others_;  // chunks without messages to deliver
  std::size_t next_chunk_ = 0;
  std::size_t next_ahead_ = 0;                      // index of the next chunk to open ahead
  bool has_advanced_ = false;                       // a message after the first is requested
  bool has_worker_ = false;                         // chunks are opened ahead: they take longer than to start a thread
  std::vector<std::unique_ptr<MessageRun>> heap_;   // the earliest on top
  std::vector<std::unique_ptr<MessageRun>> spare_;  // kept for their memory
  std::uint64_t held_ = 0;                          // bytes of open chunks
  const bool counts_;                               // the CRC of the data section is computed
  // used by the worker while calls are pending
  ChunkOpener opener_;
  std::array<ChunkAhead, 2> ahead_;  // chunk i of chunks_ is at i % 2
  std::size_t next_open_ = 0;        // index in chunks_ of the next chunk to open
  DataCrc data_crc_;
  QuietWorker worker_;
};

void MessageRun::prefetch() const {
  constexpr std::size_t line = 64, most = 1024;  // [bytes]
  if (next + 2 >= order.size()) return;
  const std::uint64_t begin = order[next + 1].offset;
  const std::uint64_t end = std::min(order[next + 2].offset, begin + most);
  for (std::uint64_t at = begin; at < end; at += line) __builtin_prefetch(records.data() + at);
}

/// Limit for overlapping chunks, decompressed [bytes]: a few chunks of the largest allowed size.
std::uint64_t most_held(const ReaderOptions& options) {
  constexpr std::uint64_t most = std::uint64_t{1} << 30;
  return std::min(most, 4 * options.max_chunk_size);
}

MessageOrder::MessageOrder(Reader::Impl& reader, const ChannelSet& channels, DamageLog& damage, std::uint64_t from)
    : reader_(reader),
      channels_(channels),
      from_(from),
      damage_(damage),
      passed_(reader.file_, reader.bytes_),
      counts_(reader.has_unchecked_data_crc()),
      opener_(reader.options_),
      data_crc_(reader.data_crc()),
      worker_([this] { open_ahead(); }) {
  const bool by_index = reader.indexes_list_all_messages();
  for (std::size_t i = 0; i < reader.chunks_.size(); ++i) {
    const Chunk& chunk = reader.chunks_[i];
    const bool is_read = chunk.end_time >= from && (!by_index || reader.chunk_channels_[i].has_any_of(channels));
    (is_read ? chunks_ : others_).push_back(chunk);
  }
  std::ranges::stable_sort(chunks_, [](const Chunk& a, const Chunk& b) { return a.start_time < b.start_time; });
  constexpr std::uint64_t small = std::uint64_t{1} << 18;  // [bytes]
  std::uint64_t all = 0;
  for (const Chunk& chunk : chunks_) all += chunk.size;
  has_worker_ = all > small;
  if (reader.loose_messages_) collect_loose();
}

void MessageOrder::check_data_crc() {
  if (reader_.check_data_crc(damage_, data_crc_)) return;
  RawBuffer buffer;
  for (const Chunk& place : others_) {
    Record record;
    if (!RecordWalker(reader_.bytes_, place.offset).next(record)) continue;
    if (const OpenedChunk opened = opener_.open(record, buffer); !opened.ok()) damage_.add(opener_.describe(opened));
  }
}

void MessageOrder::collect_loose() {
  ChunkAhead loose;
  loose.place.end_time = std::numeric_limits<std::uint64_t>::max();
  loose.run = std::make_unique<MessageRun>();
  loose.run->records = reader_.bytes_.first(reader_.frame_.data_end);
  collect(loose, magic.size());
  add(std::move(loose.run));
}

void MessageOrder::choose_ahead() {
  ChunkAhead& ahead = ahead_[next_ahead_ % ahead_.size()];
  ahead = {};
  ahead.place = chunks_[next_ahead_++];
  if (spare_.empty()) {
    ahead.run = std::make_unique<MessageRun>();
  } else {
    ahead.run = std::move(spare_.back());
    spare_.pop_back();
  }
}

void MessageOrder::read_ahead() {
  constexpr std::uint64_t large = std::uint64_t{16} << 20;  // larger chunks are opened one at a time [bytes]
  if (!has_worker_) return;
  while (next_ahead_ < std::min(next_chunk_ + ahead_.size(), chunks_.size())) {
    if (worker_.pending() > 0 && chunks_[next_ahead_].size > large) return;
    choose_ahead();
    worker_.begin();
  }
}

/// The other messages of the file are not touched.
void MessageOrder::open_ahead() {
  ChunkAhead& ahead = ahead_[next_open_++ % ahead_.size()];
  Record record;
  if (!RecordWalker(reader_.bytes_, ahead.place.offset).next(record) || !parse_chunk(record.body)) return;
  ahead.body = record.body;
  ahead.opened = opener_.open(record, ahead.run->buffer);
  // Chunks may be in any order. The bytes before one that is far away are left to check_data_crc(), which releases
  // them.
  constexpr std::uint64_t most = std::uint64_t{16} << 20;  // [bytes]
  if (counts_ && end_of(record) <= data_crc_.end() + most) data_crc_.include(end_of(record));
  if (!ahead.opened.ok()) return;
  ahead.run->records = ahead.opened.records;
  collect(ahead);
}

void MessageOrder::open_next_chunk() {
  if (worker_.pending() > 0) {
    worker_.finish();
  } else {
    choose_ahead();
    open_ahead();
  }
  ChunkAhead now = std::move(ahead_[next_chunk_++ % ahead_.size()]);
  passed_.pass(now.place.offset);
  if (has_advanced_) read_ahead();
  if (now.body.empty()) {
    // The walk has found this chunk: since then a different process has truncated the file.
    damage_.add(fmt::format("damaged: the chunk at byte {} is missing", now.place.offset));
    return;
  }
  if (!now.opened.ok()) {
    damage_.add(opener_.describe(now.opened));
    return;
  }
  now.run->chunk = now.place.offset;
  if (now.opened.head.compression.empty())
    now.run->mapped = now.body;
  else if (!passed_.releases(now.place.offset))
    reader_.file_.forget(now.body);  // the buffer contains all of it
  for (const Record& definition : now.definitions) reader_.contents_.learn(definition, damage_);
  if (!now.in_span) {
    damage_.add(fmt::format("damaged: messages of the chunk at byte {} are outside of the time that it states",
                            now.place.offset));
  }
  if (!now.is_whole) {
    damage_.add(fmt::format("damaged: the records of the chunk at byte {} aren't whole", now.place.offset));
  }
  add(std::move(now.run));
}

/// Finds the messages to deliver in the records from `begin` on.
void MessageOrder::collect(ChunkAhead& chunk, std::uint64_t begin) const {
  MessageRun& run = *chunk.run;
  run.order.clear();
  run.next = 0;
  RecordWalker walker(run.records, begin);
  Record record;
  while (walker.next(record)) {
    if (record.opcode != op::message) {
      chunk.definitions.push_back(record);
      continue;
    }
    const auto head = parse_message_head(record.body);
    if (!head || !channels_.has(head->channel)) continue;
    if (head->log_time >= from_) run.order.push_back({head->log_time, record.offset});
    chunk.in_span = chunk.in_span && chunk.place.start_time <= head->log_time && head->log_time <= chunk.place.end_time;
  }
  chunk.is_whole = walker.at_end();
  const auto earlier = [](const Waiting& a, const Waiting& b) { return a.log_time < b.log_time; };
  if (!std::ranges::is_sorted(run.order, earlier)) {
    std::ranges::stable_sort(run.order, earlier);
  }
}

void MessageOrder::add(std::unique_ptr<MessageRun> run) {
  if (run->done()) return let_go(std::move(run));
  if (run->chunk) held_ += run->records.size();
  heap_.push_back(std::move(run));
  std::push_heap(heap_.begin(), heap_.end(), later);
}

void MessageOrder::let_go(std::unique_ptr<MessageRun> run) {
  if (!run->mapped.empty()) reader_.file_.forget(std::exchange(run->mapped, {}));
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
  MessageRun& run = *heap_.front();
  run.prefetch();
  RecordWalker walker(run.records, run.order[run.next].offset);
  if (!walker.next(record)) {  // collect() has read it before
    damage_.add("damaged: messages are missing");
    return false;
  }
  record.chunk = run.chunk;
  return true;
}

void MessageOrder::advance() {
  if (!std::exchange(has_advanced_, true)) read_ahead();
  std::pop_heap(heap_.begin(), heap_.end(), later);
  MessageRun& run = *heap_.back();
  ++run.next;
  if (!run.done()) {
    std::push_heap(heap_.begin(), heap_.end(), later);
    return;
  }
  if (run.chunk) held_ -= run.records.size();
  let_go(std::move(heap_.back()));
  heap_.pop_back();
}

}  // namespace

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
