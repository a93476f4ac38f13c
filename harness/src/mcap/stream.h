// Reading MCAP front to back: from a pipe, a socket, standard input, or a file that is still being written.
//
// A StreamReader takes bytes as they come and never goes back: a message is delivered when the chunk that it is in has
// come, and what is held is one record and one decompressed chunk. It tells the same damage as a Reader, in the order
// in which it comes by; it checks every CRC. Only what a Reader knows beforehand isn't known here: a message whose
// channel is defined behind it is told of and left out. Internal.
#pragma once

#include <filesystem>
#include <memory>

#include "record_pass.h"

namespace rehearse::mcap {

/// What is wanted of a stream, as it comes; what isn't set is passed over. Each returns false to stop. What it is given
/// is valid during the call only, but for a Message's channel.
struct StreamHandlers {
  Reader::OnMessage message;
  std::function<bool(const Attachment&)> attachment;
  std::function<bool(const Metadata&)> metadata;
  Reader::OnRecord record;  // every record: a chunk before what is in it, the summary's last; those behind an error too
};

class StreamReader {
 public:
  /// Opens the file ("-": standard input) and reads its first bytes. Fails if it can't be read, or isn't MCAP.
  /// No record larger than `max_chunk_size` is held: such a one is told of and left out.
  static Result<std::unique_ptr<StreamReader>> open(const std::filesystem::path& file, ReaderOptions options = {});
  /// The same of bytes from anywhere; `name` is what messages call them.
  static Result<std::unique_ptr<StreamReader>> open_source(ReadBytes source, std::string name,
                                                           ReaderOptions options = {});
  StreamReader(const StreamReader&) = delete;
  StreamReader& operator=(const StreamReader&) = delete;

  /// Reads to the end, or until told to stop; once. Fails if anything was damaged, with all of it: whatever is whole
  /// was delivered.
  Result<void> read(const StreamHandlers& handlers);
  /// The same of messages only, in file order.
  Result<void> for_each_message(const Reader::OnMessage& callback);

  const std::string& name() const { return damage_.file(); }  // as messages call the stream
  /// [bytes] that were read so far, and understood.
  std::uint64_t position() const { return pass_.passed(); }

  // What was met so far. Before read() there is nothing.
  const std::string& profile() const { return contents_.profile; }
  const std::string& library() const { return contents_.library; }
  const std::map<std::uint16_t, Schema>& schemas() const { return contents_.schemas; }
  const std::map<std::uint16_t, Channel>& channels() const { return contents_.channels; }
  /// The schema of a channel; null if it has none.
  const Schema* schema_of(const Channel& channel) const { return contents_.schema_of(channel); }
  const std::optional<Statistics>& statistics() const { return contents_.statistics; }  // comes last, with the summary

 private:
  StreamReader(ReadBytes source, std::string name, ReaderOptions options);
  bool take(const Record& record, const StreamHandlers& handlers, Delivery& delivery);

  const ReaderOptions options_;
  DamageLog damage_;
  StreamPass pass_;
  ChunkOpener chunk_opener_;
  RawBuffer chunk_buffer_;
  Contents contents_;
  bool was_read_ = false;
};

}  // namespace rehearse::mcap
