#include "cut_files.h"
#include "reader_impl.h"

#include <fmt/format.h>

#include <algorithm>

namespace rehearse::mcap {

Diagnostic Reader::Impl::damaged(std::string message) const {
  Diagnostic diagnostic = error(std::move(message));
  diagnostic.file = name_;
  return diagnostic;
}

void Reader::Impl::check_data_crc(DamageLog& damage) {
  if (!options_.check_crcs || !data_crc_) return;
  if (!data_crc_matches_) {
    constexpr std::uint64_t step = std::uint64_t{1} << 20;
    PassedBytes passed(file_, bytes_);
    std::uint32_t crc = 0;
    for (std::uint64_t offset = 0; offset < data_end_; offset += step) {
      crc = crc32(bytes_.subspan(offset, std::min(step, data_end_ - offset)), crc);
      passed.pass(offset);
    }
    data_crc_matches_ = crc == *data_crc_;
  }
  if (!*data_crc_matches_) damage.add("damaged: the CRC of the data section doesn't match");
}

Result<void> Reader::Impl::verdict(const DamageLog& pass) const {
  Diagnostics all;
  if (was_cut(bytes_))
    all.push_back(damaged("another program cut the file while it was read: what is missing was read as zeros"));
  all.insert(all.end(), damage_.list().begin(), damage_.list().end());
  all.insert(all.end(), pass.list().begin(), pass.list().end());
  if (all.empty()) return {};
  return all;
}

bool Reader::Impl::deliver(const Record& record, const OnMessage& callback, const ChannelSet& channels,
                           DamageLog& damage) {
  const auto head = parse_message_head(record.body);
  if (head && !channels.has(head->channel)) return true;
  const Message message = contents_.read_message(record, damage);
  return message.channel == nullptr || callback(message);
}

bool Reader::Impl::pass_over_chunk(const Record& record, const OnMessage& callback, const ChannelSet& channels,
                                   DamageLog& damage) {
  const auto head = parse_chunk(record.body);
  if (!head) return true;  // known since the walk
  const auto records = chunk_opener_.open(*head, record.offset, pass_buffer_);
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
      contents_.learn(inner, damage);
    }
  }
  if (!inside.at_end()) {
    damage.add(fmt::format("damaged: the records of the chunk at byte {} aren't whole", record.offset));
  }
  return true;
}

Result<void> Reader::Impl::for_each_message(const OnMessage& callback, const ChannelSet& channels) {
  walk_if_not_yet();
  DamageLog damage(name_);
  RecordWalker walker(bytes_.first(data_end_), magic.size());
  PassedBytes passed(file_, bytes_);
  Record record;
  while (walker.next(record)) {
    passed.pass(record.offset);
    bool more = true;
    if (record.opcode == op::message) more = deliver(record, callback, channels, damage);
    if (record.opcode == op::chunk) more = pass_over_chunk(record, callback, channels, damage);
    if (!more) return verdict(damage);
  }
  check_data_crc(damage);
  return verdict(damage);
}

Result<void> Reader::Impl::for_each_record(const OnRecord& callback) {
  walk_if_not_yet();
  DamageLog damage(name_);
  RecordWalker walker(bytes_, magic.size());
  Record record;
  while (walker.next(record)) {
    if (!callback(record)) return verdict(damage);
    const auto head = record.opcode == op::chunk ? parse_chunk(record.body) : std::nullopt;
    if (head) {
      const auto records = chunk_opener_.open(*head, record.offset, pass_buffer_);
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
      auto records = chunk_opener_.open(*head, location.record, at_buffer_);
      if (!records) return damaged(records.errors().front().message);
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
  const Message message = contents_.read_message(record, damage);
  if (message.channel == nullptr) return damage.list();
  return message;
}

Result<std::unique_ptr<Reader>> Reader::open(const std::filesystem::path& file, ReaderOptions options) {
  auto view = FileView::open(file);
  if (!view) return view.errors();
  const Bytes bytes = view->bytes();
  std::string name = view->name();
  auto impl = std::make_unique<Impl>(std::move(*view), bytes, std::move(name), options);
  if (auto opened = impl->open(); !opened) return opened.errors();
  return std::unique_ptr<Reader>(new Reader(std::move(impl)));
}

Result<std::unique_ptr<Reader>> Reader::open_bytes(Bytes bytes, std::string name, ReaderOptions options) {
  auto impl = std::make_unique<Impl>(FileView(), bytes, std::move(name), options);
  if (auto opened = impl->open(); !opened) return opened.errors();
  return std::unique_ptr<Reader>(new Reader(std::move(impl)));
}

Reader::Reader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Reader::~Reader() = default;

const std::string& Reader::name() const { return impl_->name_; }
const std::string& Reader::profile() const { return impl_->contents_.profile; }
const std::string& Reader::library() const { return impl_->contents_.library; }
std::uint64_t Reader::size() const { return impl_->bytes_.size(); }
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

Result<void> Reader::for_each_message_in_order(const OnMessage& callback, std::span<const std::uint16_t> channels) {
  return impl_->for_each_message_in_order(callback, ChannelSet(channels));
}

Result<void> Reader::for_each_record(const OnRecord& callback) { return impl_->for_each_record(callback); }

Result<Message> Reader::message_at(const Location& location) { return impl_->message_at(location); }

}  // namespace rehearse::mcap
