// The pass over the outermost records of a file, from front to back, which every tool makes. It can continue after
// damage (resync.h finds the place). chunks.h reads the records in a chunk. Internal.
#pragma once

#include <functional>

#include "chunks.h"
#include "contents.h"
#include "file_view.h"

namespace rehearse::mcap {

/// Releases the memory of passed bytes.
class RecordPass {
 public:
  /// `counts`: the CRC of the data section is computed; `begin`: the offset of its first record.
  RecordPass(const FileView& view, Bytes file, bool counts = false, Progress progress = {},
             std::uint64_t begin = magic.size());

  /// The next record, valid until the next call. False: the bytes at offset() are no whole record.
  bool next(Record& record);
  /// Offset of the next record.
  std::uint64_t offset() const { return offset_ + last_.size(); }
  /// Continues at that offset. Skipped bytes are included in the CRC.
  void go_on_at(std::uint64_t offset);

  /// The CRC of the present section, up to the latest record; 0 if it isn't computed.
  std::uint32_t crc() const { return crc_; }
  bool counts() const { return counts_; }
  /// Begins a section after the latest record. `counts`: its CRC is computed.
  void begin_section(bool counts);

  /// Describes the bytes from offset() on, after next() has returned false.
  CutPlace look_at_cut() const;
  /// Passes the latest record. Returns the bytes after it: up to the magic's size and one byte more.
  Bytes look_at_tail();

 private:
  /// Passes the bytes, which begin with the latest record.
  void pass(Bytes bytes);

  Bytes file_;
  PassedBytes memory_;
  std::uint64_t offset_ = 0;  // offset of the latest record; after the end of the pass: offset()
  Bytes last_;                // the latest record
  bool counts_;
  std::uint32_t crc_ = 0;
};

/// The parts of a file around its messages.
struct Frame {
  std::uint64_t data_end = 0;  // offset of DataEnd, of a Footer without one, or of the first incomplete record
  std::optional<std::uint32_t> data_crc;  // CRC that DataEnd states
  bool summary_has_channels = false;
};

/// Passes over a whole file. `take` gets the records of the data section, and ends the pass by false. The contents of
/// the summary are added to `contents` if its CRC matches.
Frame read_frame(RecordPass& pass, bool check_crcs, Contents& contents, DamageLog& damage,
                 const std::function<bool(const Record&)>& take);

/// The channels that a pass delivers.
class ChannelSet {
 public:
  explicit ChannelSet(std::span<const std::uint16_t> channels) : all_(channels.empty()), chosen_(all_ ? 0 : 0x10000) {
    for (const std::uint16_t channel : channels) chosen_[channel] = true;
  }
  bool has(std::uint16_t channel) const { return all_ || chosen_[channel]; }

 private:
  bool all_;
  std::vector<bool> chosen_;
};

/// Delivers messages, inside and outside of chunks. False from a callback ends the pass.
struct Delivery {
  Contents& contents;  // gets the definitions in chunks
  DamageLog& damage;
  ChunkOpener& opener;
  RawBuffer& buffer;  // for the records of a chunk
  const ChannelSet& channels;
  const Reader::OnMessage& message;

  bool deliver(const Record& message);
  /// Delivers the messages of a chunk. A chunk that is too short was reported when its header was read.
  bool deliver_chunk(const Record& chunk);
};

}  // namespace rehearse::mcap
