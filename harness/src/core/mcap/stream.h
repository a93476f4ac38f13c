// Reads MCAP from front to back: from a pipe, a socket, standard input, or a file that is still being written.
//
// A StreamReader reads bytes as they arrive and never goes back. A message is delivered when its chunk is complete; one
// record and one decompressed chunk are kept in memory. It reports the same damage as a Reader, in file order, and
// checks every CRC. There is one difference: a message before the definition of its channel is reported and left out.
// Internal.
#pragma once

#include <filesystem>
#include <memory>

#include "record_pass.h"

namespace rehearse::mcap {

class StreamReader {
 public:
  /// Opens the file ("-": standard input) and reads its first bytes. Fails if it can't be read, or isn't MCAP. A record
  /// larger than `max_chunk_size` is reported and left out.
  static Result<std::unique_ptr<StreamReader>> open(const std::filesystem::path& file, ReaderOptions options = {});
  /// Reads bytes from any source; `name` is their name in messages.
  static Result<std::unique_ptr<StreamReader>> open_source(ReadBytes source, std::string name,
                                                           ReaderOptions options = {});
  StreamReader(const StreamReader&) = delete;
  StreamReader& operator=(const StreamReader&) = delete;

  /// Delivers the messages in file order, to the end or until the callback returns false; once. Fails with all damage
  /// if anything was damaged; all undamaged messages were delivered.
  Result<void> for_each_message(const Reader::OnMessage& callback);

  const std::string& name() const { return damage_.file(); }  // name of the stream in messages

  // The contents read so far. Empty before for_each_message().
  const std::string& profile() const { return contents_.profile; }
  const std::string& library() const { return contents_.library; }
  const std::map<std::uint16_t, Schema>& schemas() const { return contents_.schemas; }
  const std::map<std::uint16_t, Channel>& channels() const { return contents_.channels; }
  /// The schema of a channel; null if it has none.
  const Schema* schema_of(const Channel& channel) const { return contents_.schema_of(channel); }
  const std::optional<Statistics>& statistics() const { return contents_.statistics; }  // read last, with the summary

 private:
  StreamReader(ReadBytes source, std::string name, ReaderOptions options);
  bool take(const Record& record, Delivery& delivery);

  const ReaderOptions options_;
  DamageLog damage_;
  StreamPass pass_;
  ChunkOpener chunk_opener_;
  RawBuffer chunk_buffer_;
  Contents contents_;
  bool was_read_ = false;
};

}  // namespace rehearse::mcap
