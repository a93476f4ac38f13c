// The implementation of Reader. Internal; reader.cpp opens a file and passes over it, by_summary.cpp opens it by its
// summary, order.cpp sorts by time.
#pragma once

#include <rehearse/mcap.h>

#include <set>

#include "record_pass.h"

namespace rehearse::mcap {

class Reader::Impl {
 public:
  Impl(FileView file, Bytes bytes, std::string name, ReaderOptions options)
      : file_(std::move(file)),
        bytes_(bytes),
        name_(std::move(name)),
        options_(options),
        damage_(name_),
        chunk_opener_(options) {
    if (file_.converted()) damage_.add(file_.converted()->damage);
  }

  /// Opens the file as the options state.
  Result<void> open();
  /// Makes the walk if it is missing; called before a pass over everything.
  void walk_if_not_yet();

  // reader.cpp
  Result<void> for_each_message(const OnMessage& callback, const ChannelSet& channels);
  Result<Message> message_at(const Location& location);

  FileView file_;
  Bytes bytes_;
  std::string name_;
  ReaderOptions options_;
  Contents contents_;
  std::vector<Attachment> attachments_;
  std::vector<Metadata> metadata_;
  DamageLog damage_;
  ChunkOpener chunk_opener_;

  /// False, and adds to `damage`, if the data section's CRC doesn't match; computed once.
  bool check_data_crc(DamageLog& damage);
  /// All damage found by opening and by a pass.
  Result<void> verdict(const DamageLog& pass) const;
  Diagnostic damaged(std::string message) const;

  // The results of the walk, if it was made.
  bool walked_ = false;
  Frame frame_;
  std::vector<Chunk> chunks_;  // in file order
  /// The channels that the message indexes of a chunk state.
  enum class ChunkChannels : std::uint8_t { not_said, known, unknown };
  std::vector<ChunkChannels> chunk_channels_;  // parallel to chunks_
  std::set<std::uint16_t> unknown_channels_;   // unknown at the time of their message indexes
  bool loose_messages_ = false;                // some messages are in no chunk

  /// True if a pass may leave out chunks by their message indexes: these list as many messages of each channel as the
  /// statistics state, and the CRC of the data section covers the chunks that aren't opened.
  bool indexes_list_all_messages() const;
  /// True if a message index of the chunk at that offset is of one of the channels.
  bool is_indexed(std::uint64_t chunk, const ChannelSet& channels) const;

 private:
  // by_summary.cpp
  bool open_by_summary();
  std::optional<std::uint64_t> find_summary() const;

  // reader.cpp
  void take_in(const Record& record);
  void take_in_chunk(const Record& record);
  void take_in_message_index(const Record& record);
  bool knows_all_definitions() const;
  void learn_from_chunks();
  void learn_from_chunk(const Chunk& place);

  std::map<std::uint16_t, std::uint64_t> indexed_;  // number of messages by channel, by the message indexes
  RawBuffer pass_buffer_;
  RawBuffer at_buffer_;  // for message_at(): the chunk that was read last
  Bytes at_records_;
  Bytes at_body_;               // of that chunk's record
  std::uint64_t at_chunk_ = 0;  // 0: none
  std::optional<bool> data_crc_matches_;
};

}  // namespace rehearse::mcap
