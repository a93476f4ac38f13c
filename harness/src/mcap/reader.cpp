#include "reader_impl.h"

#include <fmt/format.h>

namespace rehearse::mcap {

std::optional<MessageHead> parse_message_head(Bytes body) {
  if (body.size() < message_head) return std::nullopt;
  MessageHead head;
  std::memcpy(&head.channel, body.data(), 2);
  std::memcpy(&head.sequence, body.data() + 2, 4);
  std::memcpy(&head.log_time, body.data() + 6, 8);
  std::memcpy(&head.publish_time, body.data() + 14, 8);
  return head;
}

Diagnostic Reader::Impl::damaged(std::string message) const {
  Diagnostic diagnostic = error(std::move(message));
  diagnostic.file = name_;
  return diagnostic;
}

Result<Bytes> Reader::Impl::open_chunk(const ChunkHead& head, std::uint64_t offset, RawBuffer& buffer) {
  if (head.uncompressed_size > options_.max_chunk_size) {
    return damaged(
        fmt::format("damaged: the chunk at byte {} says that it holds {} bytes decompressed; {} is the limit", offset,
                    head.uncompressed_size, options_.max_chunk_size));
  }
  auto records = decompressor_.decompress(head.compression, head.records, head.uncompressed_size, buffer);
  if (!records) {
    return damaged(fmt::format("damaged: the chunk at byte {} can't be decompressed: {}", offset,
                               records.errors().front().message));
  }
  if (options_.check_crcs && head.uncompressed_crc != 0 && head.uncompressed_crc != crc32(*records)) {
    return damaged(fmt::format("damaged: the CRC of the chunk at byte {} doesn't match", offset));
  }
  return records;
}

Message Reader::Impl::read_message(const Record& record, DamageLog& damage) {
  Message message;
  const auto head = parse_message_head(record.body);
  if (!head) {
    damage.add(fmt::format("damaged: the message at byte {} is too short", record.chunk.value_or(record.offset)));
    return message;
  }
  const auto channel = channels_.find(head->channel);
  if (channel == channels_.end()) {
    damage.add(fmt::format("damaged: a message at byte {} is of channel {}, which isn't defined",
                           record.chunk.value_or(record.offset), head->channel));
    return message;
  }
  message.channel = &channel->second;
  message.sequence = head->sequence;
  message.log_time = head->log_time;
  message.publish_time = head->publish_time;
  message.data = record.body.subspan(message_head);
  message.location = {record.chunk.value_or(record.offset), record.chunk ? record.offset : 0, record.chunk.has_value()};
  return message;
}

void Reader::Impl::check_data_crc(DamageLog& damage) {
  if (!options_.check_crcs || !data_crc_) return;
  if (!data_crc_matches_) data_crc_matches_ = crc32(bytes_.first(data_end_)) == *data_crc_;
  if (!*data_crc_matches_) damage.add("damaged: the CRC of the data section doesn't match");
}

Result<void> Reader::Impl::verdict(const DamageLog& pass) const {
  Diagnostics all = damage_.list();
  all.insert(all.end(), pass.list().begin(), pass.list().end());
  if (all.empty()) return {};
  return all;
}

bool Reader::Impl::deliver(const Record& record, const OnMessage& callback, const ChannelSet& channels,
                           DamageLog& damage) {
  const auto head = parse_message_head(record.body);
  if (head && !channels.has(head->channel)) return true;
  const Message message = read_message(record, damage);
  return message.channel == nullptr || callback(message);
}

bool Reader::Impl::pass_over_chunk(const Record& record, const OnMessage& callback, const ChannelSet& channels,
                                   DamageLog& damage) {
  const auto head = parse_chunk(record.body);
  if (!head) return true;  // known since scan()
  const auto records = open_chunk(*head, record.offset, pass_buffer_);
  if (!records) {
    damage.add(records.errors().front().message);
    return true;
  }
  RecordWalker inside(*records);
  Record inner;
  inner.chunk = record.offset;
  while (inside.next(inner)) {
    if (inner.opcode == op::message) {
      if (!deliver(inner, callback, channels, damage)) return false;
    } else {
      learn(inner, damage);
    }
  }
  if (!inside.at_end()) {
    damage.add(fmt::format("damaged: the records of the chunk at byte {} aren't whole", record.offset));
  }
  return true;
}

Result<void> Reader::Impl::for_each_message(const OnMessage& callback, const ChannelSet& channels) {
  DamageLog damage(name_);
  RecordWalker walker(bytes_.first(data_end_), magic.size());
  Record record;
  while (walker.next(record)) {
    bool more = true;
    if (record.opcode == op::message) more = deliver(record, callback, channels, damage);
    if (record.opcode == op::chunk) more = pass_over_chunk(record, callback, channels, damage);
    if (!more) return verdict(damage);
  }
  check_data_crc(damage);
  return verdict(damage);
}

Result<void> Reader::Impl::for_each_record(const OnRecord& callback) {
  DamageLog damage(name_);
  RecordWalker walker(bytes_, magic.size());
  Record record;
  while (walker.next(record)) {
    if (!callback(record)) return verdict(damage);
    const auto head = record.opcode == op::chunk ? parse_chunk(record.body) : std::nullopt;
    if (head) {
      const auto records = open_chunk(*head, record.offset, pass_buffer_);
      if (!records) {
        damage.add(records.errors().front().message);
        continue;
      }
      RecordWalker inside(*records);
      Record inner;
      inner.chunk = record.offset;
      while (inside.next(inner)) {
        if (!callback(inner)) return verdict(damage);
      }
    }
    if (record.opcode == op::footer) break;
  }
  return verdict(damage);
}

Result<Message> Reader::Impl::message_at(const Location& location) {
  const Diagnostic nothing_there = damaged(fmt::format("there is no message at byte {}", location.record));
  if (location.record >= bytes_.size()) return nothing_there;
  RecordWalker walker(bytes_, location.record);
  Record record;
  if (!walker.next(record)) return nothing_there;
  if (location.chunked) {
    const auto head = record.opcode == op::chunk ? parse_chunk(record.body) : std::nullopt;
    if (!head) return nothing_there;
    if (at_chunk_ != location.record) {
      at_chunk_ = 0;
      auto records = open_chunk(*head, location.record, at_buffer_);
      if (!records) return records.errors();
      at_records_ = *records;
      at_chunk_ = location.record;
    }
    if (location.inside >= at_records_.size()) return nothing_there;
    RecordWalker inside(at_records_, location.inside);
    if (!inside.next(record)) return nothing_there;
    record.chunk = location.record;
  }
  if (record.opcode != op::message) return nothing_there;
  DamageLog damage(name_);
  const Message message = read_message(record, damage);
  if (message.channel == nullptr) return damage.list();
  return message;
}

Result<std::unique_ptr<Reader>> Reader::open(const std::filesystem::path& file, ReaderOptions options) {
  auto view = FileView::open(file);
  if (!view) return view.errors();
  const Bytes bytes = view->bytes();
  auto impl = std::make_unique<Impl>(std::move(*view), bytes, file.string(), options);
  if (auto scanned = impl->scan(); !scanned) return scanned.errors();
  return std::unique_ptr<Reader>(new Reader(std::move(impl)));
}

Result<std::unique_ptr<Reader>> Reader::open_bytes(Bytes bytes, std::string name, ReaderOptions options) {
  auto impl = std::make_unique<Impl>(FileView(), bytes, std::move(name), options);
  if (auto scanned = impl->scan(); !scanned) return scanned.errors();
  return std::unique_ptr<Reader>(new Reader(std::move(impl)));
}

Reader::Reader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Reader::~Reader() = default;

const std::string& Reader::name() const { return impl_->name_; }
const std::string& Reader::profile() const { return impl_->profile_; }
const std::string& Reader::library() const { return impl_->library_; }
std::uint64_t Reader::size() const { return impl_->bytes_.size(); }
const Diagnostics& Reader::damage() const { return impl_->damage_.list(); }
const std::map<std::uint16_t, Schema>& Reader::schemas() const { return impl_->schemas_; }
const std::map<std::uint16_t, Channel>& Reader::channels() const { return impl_->channels_; }
const std::vector<Attachment>& Reader::attachments() const { return impl_->attachments_; }
const std::vector<Metadata>& Reader::metadata() const { return impl_->metadata_; }
const std::optional<Statistics>& Reader::statistics() const { return impl_->statistics_; }

const Schema* Reader::schema_of(const Channel& channel) const {
  const auto found = impl_->schemas_.find(channel.schema_id);
  return found == impl_->schemas_.end() ? nullptr : &found->second;
}

Result<void> Reader::for_each_message(const OnMessage& callback, std::span<const std::uint16_t> channels) {
  return impl_->for_each_message(callback, ChannelSet(channels));
}

Result<void> Reader::for_each_message_in_order(const OnMessage& callback, std::span<const std::uint16_t> channels) {
  return impl_->for_each_message_in_order(callback, ChannelSet(channels));
}

Result<void> Reader::for_each_record(const OnRecord& callback) { return impl_->for_each_record(callback); }

Result<Message> Reader::message_at(const Location& location) { return impl_->message_at(location); }

}  // namespace rehearse::mcap
