#include "reader_impl.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace rehearse::mcap {

Diagnostic Reader::Impl::damaged(std::string message) const { return error_in(name_, std::move(message)); }

Result<void> Reader::Impl::open() {
  if (!begins_with_magic(bytes_)) return not_mcap(name_, bytes_);
  if (options_.opening == Opening::walk || !open_by_summary()) walk_if_not_yet();
  return {};
}

void Reader::Impl::walk_if_not_yet() {
  if (walked_) return;
  walked_ = true;
  attachments_.clear();
  metadata_.clear();
  chunks_.clear();
  chunk_channels_.clear();
  indexed_.clear();
  RecordPass pass(file_, bytes_);
  frame_ = read_frame(pass, options_.check_crcs, contents_, damage_, [this](const Record& record) {
    take_in(record);
    return true;
  });
  if (!knows_all_definitions()) learn_from_chunks();
}

void Reader::Impl::take_in(const Record& record) {
  switch (record.opcode) {
    case op::header: contents_.learn_header(record, damage_); break;
    case op::schema:
    case op::channel: contents_.learn(record, damage_); break;
    case op::message: loose_messages_ = true; break;
    case op::chunk: take_in_chunk(record); break;
    case op::message_index: take_in_message_index(record); break;
    case op::attachment:
      if (auto attachment = read_attachment(record, options_.check_crcs, damage_))
        attachments_.push_back(std::move(*attachment));
      break;
    case op::metadata:
      if (auto metadata = read_metadata(record, damage_)) metadata_.push_back(std::move(*metadata));
      break;
    default: break;  // records of later versions of the format
  }
}

void Reader::Impl::take_in_chunk(const Record& record) {
  const auto head = read_chunk_head(record, damage_);
  if (!head) return;
  chunks_.push_back({record.offset, head->start_time, head->end_time, std::string(head->compression),
                     head->records.size(), head->uncompressed_size});
  chunk_channels_.emplace_back();
}

/// The record is a message index of the chunk before it.
void Reader::Impl::take_in_message_index(const Record& record) {
  ByteReader in(record.body);
  const auto channel = in.get<std::uint16_t>();
  const auto size = in.get<std::uint32_t>();  // size of the entries [bytes]
  if (chunk_channels_.empty() || !in.ok()) return;
  indexed_[channel] += size / index_entry_size;
  ChunkChannels& before = chunk_channels_.back();
  before.ids.push_back(channel);
  const auto known = contents_.channels.find(channel);
  if (known == contents_.channels.end()) {
    before.known = false;
    unknown_channels_.insert(channel);
  } else if (known->second.schema_id != 0 && contents_.schema_of(known->second) == nullptr) {
    before.known = false;
  }
}

bool Reader::Impl::indexes_list_all_messages() const {
  const auto& said = contents_.statistics;
  if (!options_.check_crcs || !frame_.data_crc || !said) return false;
  std::uint64_t all = 0;
  for (const auto& [channel, count] : indexed_) all += count;
  return all == said->message_count && std::ranges::all_of(said->channel_message_counts, [this](const auto& stated) {
           const auto indexed = indexed_.find(stated.first);
           return stated.second == (indexed == indexed_.end() ? 0 : indexed->second);
         });
}

/// True if the summary repeats all definitions that may be only in chunks.
bool Reader::Impl::knows_all_definitions() const {
  const auto& said = contents_.statistics;
  const bool all_counted =
      !said || (contents_.channels.size() >= said->channel_count && contents_.schemas.size() >= said->schema_count);
  return frame_.summary_has_channels && all_counted && contents_.has_all_schemas();
}

/// Files without a summary may define their channels only inside of their chunks. A chunk whose messages all belong to
/// known channels, according to its indexes, need not be opened for this.
void Reader::Impl::learn_from_chunks() {
  PassedBytes passed(file_, bytes_);
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < chunks_.size(); ++i) {
    passed.pass(chunks_[i].offset);
    if (chunk_channels_[i].known && !chunk_channels_[i].ids.empty()) {
      others.push_back(i);
    } else {
      learn_from_chunk(chunks_[i]);
    }
  }
  const auto is_known = [this](std::uint16_t channel) { return contents_.channels.contains(channel); };
  if (std::ranges::all_of(unknown_channels_, is_known)) return;
  for (const std::size_t i : others) learn_from_chunk(chunks_[i]);
}

void Reader::Impl::learn_from_chunk(const Chunk& place) {
  DamageLog ignored(name_);  // a pass over the messages reports it
  Record record;
  if (!RecordWalker(bytes_, place.offset).next(record)) return;
  RecordWalker inside(chunk_opener_.open(record, pass_buffer_).records);
  while (inside.next(record)) contents_.learn(record, ignored);
}

bool Reader::Impl::check_data_crc(DamageLog& damage, DataCrc begun) {
  if (has_unchecked_data_crc()) {
    constexpr std::uint64_t step = std::uint64_t{1} << 20;
    PassedBytes passed(file_, bytes_);
    while (begun.end() < frame_.data_end) {
      passed.pass(begun.end());
      begun.include(std::min(begun.end() + step, frame_.data_end));
    }
    data_crc_matches_ = begun.value() == *frame_.data_crc;
  }
  if (!data_crc_matches_ || *data_crc_matches_) return true;
  damage.add("damaged: the CRC of the data section doesn't match");
  return false;
}

Result<void> Reader::Impl::verdict(const DamageLog& pass) const {
  Diagnostics all;
  if (was_cut(bytes_))
    all.push_back(damaged("another program cut the file while it was read: the missing bytes were read as zeros"));
  all.insert(all.end(), damage_.list().begin(), damage_.list().end());
  all.insert(all.end(), pass.list().begin(), pass.list().end());
  if (all.empty()) return {};
  return all;
}

Result<void> Reader::Impl::for_each_message(const OnMessage& callback, const ChannelSet& channels) {
  walk_if_not_yet();
  DamageLog damage(name_);
  Delivery delivery{contents_, damage, chunk_opener_, pass_buffer_, channels, callback};
  RecordPass pass(file_, bytes_.first(frame_.data_end));
  const bool by_index = indexes_list_all_messages();
  std::size_t chunk = 0;  // index in chunks_
  Record record;
  while (pass.next(record)) {
    bool more = true;
    if (record.opcode == op::message) more = delivery.deliver(record);
    if (record.opcode == op::chunk) {
      while (chunk < chunks_.size() && chunks_[chunk].offset < record.offset) ++chunk;
      const bool is_left_out = by_index && chunk < chunks_.size() && !chunk_channels_[chunk].has_any_of(channels);
      if (!is_left_out) more = delivery.deliver_chunk(record);
    }
    if (!more) return verdict(damage);
  }
  check_data_crc(damage);
  return verdict(damage);
}

Result<Message> Reader::Impl::message_at(const Location& location) {
  const Diagnostic nothing_there = damaged(fmt::format("there is no message at byte {}", location.record));
  if (location.record >= bytes_.size()) return nothing_there;
  RecordWalker walker(bytes_, location.record);
  Record record;
  if (!walker.next(record)) return nothing_there;
  if (location.chunked) {
    if (record.opcode != op::chunk) return nothing_there;
    if (at_chunk_ != location.record) {
      at_chunk_ = 0;
      file_.forget(std::exchange(at_body_, record.body));
      const OpenedChunk opened = chunk_opener_.open(record, at_buffer_);
      if (opened.fault == OpenedChunk::Fault::too_short) return nothing_there;
      if (!opened.ok()) return damaged(chunk_opener_.describe(opened));
      at_records_ = opened.records;
      at_chunk_ = location.record;
    }
    if (location.inside >= at_records_.size()) return nothing_there;
    RecordWalker inside(at_records_, location.inside);
    if (!inside.next(record)) return nothing_there;
    record.chunk = location.record;
  }
  if (record.opcode != op::message) return nothing_there;
  DamageLog damage(name_);
  const Message message = contents_.read_message(record, damage);
  if (message.channel == nullptr) return damage.list();
  return message;
}

bool Reader::Impl::can_copy_chunks() {
  walk_if_not_yet();
  if (was_cut(bytes_) || !damage_.list().empty() || loose_messages_ || !indexes_list_all_messages()) return false;
  DamageLog ignored(name_);  // a pass over the messages reports it
  return check_data_crc(ignored);
}

std::optional<StoredChunk> Reader::Impl::stored_chunk(const Chunk& chunk) {
  const std::uint64_t offset = chunk.offset;  // the walk lists the chunks again
  walk_if_not_yet();
  file_.forget(std::exchange(stored_, {}));
  auto stored = StoredChunk::parse(bytes_.first(frame_.data_end), offset);
  if (stored) stored_ = stored->bytes;
  return stored;
}

Result<std::unique_ptr<Reader>> Reader::open(const std::filesystem::path& file, ReaderOptions options) {
  auto view = REHEARSE_TRY(FileView::open(file));
  const Bytes bytes = view.bytes();
  std::string name = view.name();
  auto impl = std::make_unique<Impl>(std::move(view), bytes, std::move(name), options);
  REHEARSE_TRY(impl->open());
  return std::unique_ptr<Reader>(new Reader(std::move(impl)));
}

Result<std::unique_ptr<Reader>> Reader::open_bytes(Bytes bytes, std::string name, ReaderOptions options) {
  auto impl = std::make_unique<Impl>(FileView(), bytes, std::move(name), options);
  REHEARSE_TRY(impl->open());
  return std::unique_ptr<Reader>(new Reader(std::move(impl)));
}

Reader::Reader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Reader::~Reader() = default;

const std::string& Reader::name() const { return impl_->name_; }
const std::string& Reader::profile() const { return impl_->contents_.profile; }
const std::string& Reader::library() const { return impl_->contents_.library; }
std::uint64_t Reader::size() const {
  return impl_->file_.converted() ? impl_->file_.converted()->size : impl_->bytes_.size();
}
const std::string& Reader::form() const {
  static const std::string usual = "MCAP";
  return impl_->file_.converted() ? impl_->file_.converted()->form : usual;
}
bool Reader::opened_by_summary() const { return !impl_->walked_; }
const Diagnostics& Reader::damage() const { return impl_->damage_.list(); }
const std::map<std::uint16_t, Schema>& Reader::schemas() const { return impl_->contents_.schemas; }
const std::map<std::uint16_t, Channel>& Reader::channels() const { return impl_->contents_.channels; }
const std::vector<Attachment>& Reader::attachments() const { return impl_->attachments_; }
const std::vector<Metadata>& Reader::metadata() const { return impl_->metadata_; }
const std::vector<Chunk>& Reader::chunks() const { return impl_->chunks_; }
const std::optional<Statistics>& Reader::statistics() const { return impl_->contents_.statistics; }

const Schema* Reader::schema_of(const Channel& channel) const { return impl_->contents_.schema_of(channel); }

Result<void> Reader::for_each_message(const OnMessage& callback, std::span<const std::uint16_t> channels) {
  return impl_->for_each_message(callback, ChannelSet(channels));
}

Result<Message> Reader::message_at(const Location& location) { return impl_->message_at(location); }

bool Reader::can_copy_chunks() { return impl_->can_copy_chunks(); }
std::optional<StoredChunk> Reader::stored_chunk(const Chunk& chunk) { return impl_->stored_chunk(chunk); }

}  // namespace rehearse::mcap
