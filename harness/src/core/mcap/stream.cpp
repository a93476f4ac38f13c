#include "stream.h"

#include <utility>

namespace rehearse::mcap {

StreamReader::StreamReader(ReadBytes source, std::string name, ReaderOptions options)
    : options_(options),
      damage_(std::move(name)),
      pass_(std::move(source), options.max_chunk_size, options.check_crcs, damage_),
      chunk_opener_(options) {}

Result<std::unique_ptr<StreamReader>> StreamReader::open(const std::filesystem::path& file, ReaderOptions options) {
  auto input = Input::open(file);
  if (!input) return input.errors();
  const auto shared = std::make_shared<Input>(std::move(*input));  // a std::function is copied
  return open_source([shared](std::span<std::byte> target) { return shared->read(target); }, shared->name(), options);
}

Result<std::unique_ptr<StreamReader>> StreamReader::open_source(ReadBytes source, std::string name,
                                                                ReaderOptions options) {
  std::unique_ptr<StreamReader> reader(new StreamReader(std::move(source), std::move(name), options));
  const Bytes start = reader->pass_.begin();
  if (!reader->pass_.failure().empty()) return reader->pass_.failure();
  if (begins_with_magic(start)) return reader;
  return error_in(reader->name(), describe_start(start));
}

Result<void> StreamReader::for_each_message(const Reader::OnMessage& callback) {
  REHEARSE_ASSERT(!was_read_, "a stream is read once");
  was_read_ = true;
  const ChannelSet all{{}};
  Delivery delivery{contents_, damage_, chunk_opener_, chunk_buffer_, all, callback};
  read_frame(pass_, options_.check_crcs, contents_, damage_,
             [&](const Record& record) { return take(record, delivery); });
  Diagnostics problems = damage_.list();
  problems.insert(problems.end(), pass_.failure().begin(), pass_.failure().end());
  if (problems.empty()) return {};
  return problems;
}

/// Processes a record of the data section. False: stop.
bool StreamReader::take(const Record& record, Delivery& delivery) {
  switch (record.opcode) {
    case op::header: contents_.learn_header(record, damage_); return true;
    case op::message: return delivery.deliver(record);
    case op::chunk: return !read_chunk_head(record, damage_) || delivery.deliver_chunk(record);
    case op::attachment: read_attachment(record, options_.check_crcs, damage_); return true;  // for its damage only
    case op::metadata: read_metadata(record, damage_); return true;
    default: contents_.learn(record, damage_); return true;
  }
}

}  // namespace rehearse::mcap
