// The implementation of Reader. Internal; reader.cpp opens a file and passes over it, by_summary.cpp opens it by its
// summary, order.cpp sorts by time.
#pragma once

#include <rehearse/mcap.h>

#include <algorithm>
#include <set>

#include "record_pass.h"

namespace rehearse::mcap {

/// The CRC of a data section, computed from its front on.
class DataCrc {
 public:
  explicit DataCrc(Bytes data) : data_(data) {}
  /// Includes the bytes of the section before `end`.
  void include(std::uint64_t end) {
    end = std::min<std::uint64_t>(end, data_.size());  // a record grows if another program writes into the file
    if (end <= end_) return;
    crc_ = crc32(data_.subspan(end_, end - end_), crc_);
    end_ = end;
  }
  std::uint64_t end() const { return end_; }  // end of the included bytes
  std::uint32_t value() const { return crc_; }

 private:
  Bytes data_;
  std::uint64_t end_ = 0;
  std::uint32_t crc_ = 0;
};

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
  bool can_copy_chunks();
  std::optional<StoredChunk> stored_chunk(const Chunk& chunk);

  FileView file_;
  Bytes bytes_;
  std::string name_;
  ReaderOptions options_;
  Contents contents_;
  std::vector<Attachment> attachments_;
  std::vector<Metadata> metadata_;
  DamageLog damage_;
  ChunkOpener chunk_opener_;

  /// The data section has a CRC that wasn't checked yet, and the options don't forbid it.
  bool has_unchecked_data_crc() const { return options_.check_crcs && frame_.data_crc && !data_crc_matches_; }
  DataCrc data_crc() const { return DataCrc(bytes_.first(frame_.data_end)); }
  /// False, and adds to `damage`, if the data section's CRC doesn't match; computed once.
  bool check_data_crc(DamageLog& damage) { return check_data_crc(damage, data_crc()); }
  bool check_data_crc(DamageLog& damage, DataCrc begun);  // `begun`: a part of the CRC is computed
  /// All damage found by opening and by a pass.
  Result<void> verdict(const DamageLog& pass) const;
  Diagnostic damaged(std::string message) const;

  // The results of the walk, if it was made.
  bool walked_ = false;
  Frame frame_;
  std::vector<Chunk> chunks_;  // in file order
  /// The channels that the message indexes of a chunk state.
  struct ChunkChannels {
    std::vector<std::uint16_t> ids;
    bool known = true;  // all of them had a definition before the index

    bool has_any_of(const ChannelSet& channels) const {
      return !known || std::ranges::any_of(ids, [&](std::uint16_t id) { return channels.has(id); });
    }
  };
  std::vector<ChunkChannels> chunk_channels_;  // parallel to chunks_
  std::set<std::uint16_t> unknown_channels_;   // unknown at the time of their message indexes
  bool loose_messages_ = false;                // some messages are in no chunk

  /// True if a pass may leave out chunks by their message indexes: these list as many messages of each channel as the
  /// statistics state, and the CRC of the data section covers the chunks that aren't opened.
  bool indexes_list_all_messages() const;

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

  std::map<std::uint16_t, std::uint64_t> indexed_;  // number of messages of each channel in the message indexes
  RawBuffer pass_buffer_;
  RawBuffer at_buffer_;  // for message_at(): the chunk that was read last
  Bytes at_records_;
  Bytes at_body_;               // body of that chunk's record
  std::uint64_t at_chunk_ = 0;  // offset of that chunk; 0: none
  Bytes stored_;                // bytes of the chunk that stored_chunk() returned last
  std::optional<bool> data_crc_matches_;
};

}  // namespace rehearse::mcap
