#include <rehearse/mcap_stream.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "byte_window.h"
#include "chunk_opener.h"
#include "contents.h"
#include "frame.h"
#include "input.h"

namespace rehearse::mcap {

class StreamReader::Impl {
 public:
  Impl(ReadBytes source, std::string called, ReaderOptions options)
      : name(std::move(called)),
        options_(options),
        window_(std::move(source)),
        chunk_opener_(options),
        damage_(name),
        summary_damage_(name) {}

  Result<void> open();
  Result<void> read(const StreamHandlers& handlers);
  std::uint64_t position() const { return window_.offset(); }

  const std::string name;
  Contents contents;

 private:
  enum class Step { more, stop, cut };

  Step next(Record& record);
  Step skip(const Record& record, std::uint64_t length);
  void remember(Bytes piece);
  void count(Bytes bytes);
  bool take_in(const Record& record);
  bool read_chunk(const Record& record);
  bool deliver(const Record& record);
  void end_data(const Record& record);
  void read_summary_record(const Record& record);
  void end_summary(const Record& record);
  void report_cut();
  Result<void> verdict() const;

  const ReaderOptions options_;
  ByteWindow window_;
  ChunkOpener chunk_opener_;
  DamageLog damage_;
  RawBuffer chunk_buffer_;
  const StreamHandlers* handlers_ = nullptr;  // during read()

  std::size_t whole_ = 0;                       // bytes of the record that was delivered last
  std::vector<std::byte> last_;                 // the last bytes of what was left out
  std::optional<std::uint64_t> cut_record_;     // offset of a record that was being left out when the bytes ended
  bool started_ = false;                        // the Header, or what is in its place, has come
  std::uint32_t crc_ = 0;                       // of the section so far: data, then summary
  std::optional<std::uint64_t> summary_start_;  // behind DataEnd
  DamageLog summary_damage_;                    // counts only if the summary is what was written
  std::optional<Statistics> stated_;
};

Result<void> StreamReader::Impl::open() {
  window_.hold(magic.size());
  if (!window_.failure().empty()) return window_.failure();
  const Bytes start = window_.held().first(std::min(window_.held().size(), magic.size()));
  if (!begins_with_magic(start)) {
    Diagnostic refusal = error(describe_start(start));
    refusal.file = name;
    return refusal;
  }
  count(start);
  window_.take(start.size());
  return {};
}

void StreamReader::Impl::count(Bytes bytes) {
  if (options_.check_crcs) crc_ = crc32(bytes, crc_);
}

/// The next record that is whole, its bytes in the window until the next call. Nothing of it is counted so far.
StreamReader::Impl::Step StreamReader::Impl::next(Record& record) {
  window_.take(std::exchange(whole_, 0));
  while (true) {
    if (!window_.hold(record_head)) return Step::cut;
    ByteReader in(window_.held());
    record.opcode = in.get<std::uint8_t>();
    const auto length = in.get<std::uint64_t>();
    if (record.opcode == 0) return Step::cut;
    record.offset = window_.offset();
    constexpr std::uint64_t chunk_frame = 4096;  // more than stands in a chunk beside its records
    if (length <= options_.max_chunk_size + chunk_frame) {
      if (!window_.hold(record_head + length)) return Step::cut;
      record.body = window_.held().subspan(record_head, length);
      whole_ = record_head + length;
      return Step::more;
    }
    if (skip(record, length) == Step::cut) return Step::cut;
  }
}

/// Leaves out a record that is too large to hold.
StreamReader::Impl::Step StreamReader::Impl::skip(const Record& record, std::uint64_t length) {
  cut_record_ = record.offset;
  std::uint64_t left = record_head;
  left += std::min(length, ~left);
  while (left > 0) {
    if (!window_.hold(1)) return Step::cut;
    const Bytes piece = window_.held().first(std::min<std::uint64_t>(left, window_.held().size()));
    count(piece);
    remember(piece);
    left -= piece.size();
    window_.take(piece.size());
  }
  cut_record_.reset();
  damage_.add(fmt::format("the record at byte {} has {} bytes; no more than {} are held of a stream: it was left out",
                          record.offset, length, options_.max_chunk_size));
  return Step::more;
}

void StreamReader::Impl::remember(Bytes piece) {
  piece = piece.last(std::min(piece.size(), magic.size()));
  last_.insert(last_.end(), piece.begin(), piece.end());
  if (last_.size() > magic.size()) last_.erase(last_.begin(), last_.end() - magic.size());
}

Result<void> StreamReader::Impl::read(const StreamHandlers& handlers) {
  REHEARSE_ASSERT(handlers_ == nullptr, "a stream is read once");
  handlers_ = &handlers;
  Record record;
  while (true) {
    const Step step = next(record);
    if (step == Step::cut) {
      report_cut();
      break;
    }
    if (handlers.record && !handlers.record(record)) break;
    if (!started_ && record.opcode != op::header) damage_.add("damaged: the first record isn't a Header");
    started_ = true;
    if (record.opcode == op::footer) {
      end_summary(record);
      break;
    }
    if (summary_start_) {
      read_summary_record(record);
    } else if (record.opcode == op::data_end) {
      end_data(record);
      continue;
    } else if (!take_in(record)) {
      break;
    }
    count(window_.held().first(whole_));
  }
  return verdict();
}

/// A record of the data section. False: stop.
bool StreamReader::Impl::take_in(const Record& record) {
  switch (record.opcode) {
    case op::header: contents.learn_header(record, damage_); return true;
    case op::message: return deliver(record);
    case op::chunk: return read_chunk(record);
    case op::attachment: {
      const auto attachment = read_attachment(record, options_.check_crcs, damage_);
      return !attachment || !handlers_->attachment || handlers_->attachment(*attachment);
    }
    case op::metadata: {
      const auto metadata = read_metadata(record, damage_);
      return !metadata || !handlers_->metadata || handlers_->metadata(*metadata);
    }
    default: contents.learn(record, damage_); return true;
  }
}

bool StreamReader::Impl::deliver(const Record& record) {
  const Message message = contents.read_message(record, damage_);
  return message.channel == nullptr || !handlers_->message || handlers_->message(message);
}

bool StreamReader::Impl::read_chunk(const Record& record) {
  const auto head = parse_chunk(record.body);
  if (!head) {
    damage_.add(fmt::format("damaged: the chunk at byte {} is too short for what it says", record.offset));
    return true;
  }
  const auto records = chunk_opener_.open(*head, record.offset, chunk_buffer_);
  if (!records) {
    damage_.add(records.errors().front().message);
    return true;
  }
  RecordWalker inside(*records);
  Record inner;
  inner.chunk = record.offset;
  while (inside.next(inner)) {
    if (handlers_->record && !handlers_->record(inner)) return false;
    if (inner.opcode == op::message) {
      if (!deliver(inner)) return false;
    } else {
      contents.learn(inner, damage_);
    }
  }
  if (!inside.at_end())
    damage_.add(fmt::format("damaged: the records of the chunk at byte {} aren't whole", record.offset));
  return true;
}

void StreamReader::Impl::end_data(const Record& record) {
  const auto stated = read_data_end(record, damage_);
  if (options_.check_crcs && stated && *stated != crc_)
    damage_.add("damaged: the CRC of the data section doesn't match");
  summary_start_ = record.offset + whole_;
  crc_ = 0;
}

void StreamReader::Impl::read_summary_record(const Record& record) {
  if (record.opcode == op::statistics) stated_ = parse_statistics(record.body);
  contents.learn(record, summary_damage_);
}

void StreamReader::Impl::end_summary(const Record& record) {
  const std::uint64_t start = summary_start_.value_or(record.offset);
  if (!summary_start_) crc_ = 0;  // a file without DataEnd
  if (const auto footer = read_footer(record, start, damage_)) {
    count(window_.held().first(footer_covered));
    if (options_.check_crcs && footer->summary_crc != 0 && footer->summary_crc != crc_) {
      damage_.add(fmt::format("damaged: the CRC of the summary at byte {} doesn't match", start));
    } else {
      damage_.add(summary_damage_);
      contents.statistics = stated_;
    }
  }
  window_.take(std::exchange(whole_, 0));
  window_.hold(magic.size() + 1);
  check_tail(window_.held(), window_.offset(), damage_);
}

/// Reads what is left, to say what it looks like.
void StreamReader::Impl::report_cut() {
  CutPlace cut;
  cut.record = cut_record_.value_or(window_.offset());
  cut.zeros_only = !cut_record_;
  if (!cut_record_) last_.clear();
  while (window_.hold(1)) {
    const Bytes piece = window_.held();
    cut.zeros_only = cut.zeros_only && is_all_zero(piece);
    remember(piece);
    window_.take(piece.size());
  }
  cut.size = window_.offset();
  cut.ends_with_magic = begins_with_magic(last_);
  damage_.add(describe_cut(cut));
}

Result<void> StreamReader::Impl::verdict() const {
  Diagnostics all = damage_.list();
  all.insert(all.end(), window_.failure().begin(), window_.failure().end());
  if (all.empty()) return {};
  return all;
}

Result<std::unique_ptr<StreamReader>> StreamReader::open(const std::filesystem::path& file, ReaderOptions options) {
  auto input = Input::open(file);
  if (!input) return input.errors();
  const auto shared = std::make_shared<Input>(std::move(*input));  // a std::function is copied
  return open_source([shared](std::span<std::byte> target) { return shared->read(target); }, shared->name(), options);
}

Result<std::unique_ptr<StreamReader>> StreamReader::open_source(ReadBytes source, std::string name,
                                                                ReaderOptions options) {
  auto impl = std::make_unique<Impl>(std::move(source), std::move(name), options);
  if (auto opened = impl->open(); !opened) return opened.errors();
  return std::unique_ptr<StreamReader>(new StreamReader(std::move(impl)));
}

StreamReader::StreamReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

StreamReader::~StreamReader() = default;

Result<void> StreamReader::read(const StreamHandlers& handlers) { return impl_->read(handlers); }

Result<void> StreamReader::for_each_message(const Reader::OnMessage& callback) {
  return impl_->read({callback, {}, {}, {}});
}

const std::string& StreamReader::name() const { return impl_->name; }
std::uint64_t StreamReader::position() const { return impl_->position(); }
const std::string& StreamReader::profile() const { return impl_->contents.profile; }
const std::string& StreamReader::library() const { return impl_->contents.library; }
const std::map<std::uint16_t, Schema>& StreamReader::schemas() const { return impl_->contents.schemas; }
const std::map<std::uint16_t, Channel>& StreamReader::channels() const { return impl_->contents.channels; }
const Schema* StreamReader::schema_of(const Channel& channel) const { return impl_->contents.schema_of(channel); }
const std::optional<Statistics>& StreamReader::statistics() const { return impl_->contents.statistics; }

}  // namespace rehearse::mcap
