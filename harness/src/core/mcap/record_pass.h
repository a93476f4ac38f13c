// The pass over the outermost records of a file, from front to back, which every tool makes. A pass over a mapped file
// can continue after damage (resync.h finds the place); a pass over a stream never goes back. chunks.h reads the
// records in a chunk. Internal.
#pragma once

#include <functional>

#include "chunks.h"
#include "contents.h"
#include "file_view.h"

namespace rehearse::mcap {

class RecordPass {
 public:
  virtual ~RecordPass() = default;
  RecordPass(const RecordPass&) = delete;
  RecordPass& operator=(const RecordPass&) = delete;

  /// The next record, valid until the next call. False: the bytes at offset() are no whole record.
  bool next(Record& record);
  /// Offset of the next record.
  std::uint64_t offset() const { return offset_ + last_.size(); }
  /// Offset of the latest record; after the end of the pass: offset().
  std::uint64_t passed() const { return offset_; }

  /// The CRC of the present section, up to the latest record; 0 if it isn't computed.
  std::uint32_t crc() const { return crc_; }
  bool counts() const { return counts_; }
  /// Begins a section after the latest record. `counts`: its CRC is computed.
  void begin_section(bool counts);

  /// Describes the bytes from offset() on, after next() has returned false.
  virtual CutPlace look_at_cut() = 0;
  /// Passes the latest record and reads the bytes after it: up to the magic's size and one byte more.
  Bytes look_at_tail();

 protected:
  RecordPass(std::uint64_t begin, bool counts) : offset_(begin), counts_(counts) {}
  virtual bool find(Record& record) = 0;
  /// Bytes of the file from passed() on: `count` bytes, or fewer at the end.
  virtual Bytes look(std::uint64_t count) = 0;
  virtual void move_on(std::uint64_t /*count*/) {}
  /// Passes the bytes, which begin at passed(), the offset of the latest record.
  void pass(Bytes bytes);

 private:
  std::uint64_t offset_;
  Bytes last_;  // the latest record
  bool counts_;
  std::uint32_t crc_ = 0;
};

/// The pass over a mapped file, from the end of its magic bytes on. Releases the memory of passed bytes.
class MappedPass final : public RecordPass {
 public:
  /// `counts`: the CRC of the data section is computed; `begin`: the offset of its first record.
  MappedPass(const FileView& view, Bytes file, bool counts = false, Progress progress = {},
             std::uint64_t begin = magic.size());
  /// Continues at that offset. Skipped bytes are included in the CRC.
  void go_on_at(std::uint64_t offset);
  CutPlace look_at_cut() override;

 private:
  bool find(Record& record) override;
  Bytes look(std::uint64_t count) override;

  Bytes file_;
  PassedBytes memory_;
};

/// Fills the front of the given bytes, and returns the number of bytes: at least one; 0 is the end.
using ReadBytes = std::function<Result<std::size_t>(std::span<std::byte>)>;

/// The pass over a stream. It keeps one record in memory. A record larger than `most_held` is left out and reported to
/// `damage`.
class StreamPass final : public RecordPass {
 public:
  StreamPass(ReadBytes source, std::uint64_t most_held, bool counts, DamageLog& damage);
  /// The first bytes, up to the magic's size; records begin after them.
  Bytes begin();
  CutPlace look_at_cut() override;
  /// The error that ended the stream, if any.
  const Diagnostics& failure() const { return failure_; }

 private:
  bool find(Record& record) override;
  Bytes look(std::uint64_t count) override;
  void move_on(std::uint64_t count) override;
  bool leave_out(std::uint64_t length);
  void remember(Bytes piece);
  void make_room();

  ReadBytes source_;
  const std::uint64_t most_held_;
  DamageLog& damage_;
  RawBuffer buffer_;  // received bytes that aren't passed are from begin_ to end_
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool ended_ = false;
  Diagnostics failure_;
  std::vector<std::byte> last_bytes_;        // last bytes of the omitted record
  std::optional<std::uint64_t> cut_record_;  // offset of a record that was omitted when the stream ended
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
