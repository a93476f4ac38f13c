// The pass over the outermost records of a file, from front to back. Every tool makes it: a pass over a mapped file can
// go on behind damage (resync.h says where), a pass over a stream never goes back. What is in a chunk: chunks.h.
// Internal.
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

  /// The next record, valid until the next call. False: what begins at offset() is no whole record.
  bool next(Record& record);
  /// Where the next record begins.
  std::uint64_t offset() const { return offset_ + last_.size(); }
  /// Where the latest record begins; behind the end of the pass: offset().
  std::uint64_t passed() const { return offset_; }

  /// The CRC of the section that is passed, up to the latest record; 0 while nothing is counted.
  std::uint32_t crc() const { return crc_; }
  bool counts() const { return counts_; }
  /// A section begins behind the latest record. `counts`: its CRC is computed.
  void begin_section(bool counts);

  /// After next() was false: what the bytes from offset() on look like.
  virtual CutPlace look_at_cut() = 0;
  /// Passes the latest record and looks at what follows it: up to the magic's size and one byte more.
  Bytes look_at_tail();

 protected:
  RecordPass(std::uint64_t begin, bool counts) : offset_(begin), counts_(counts) {}
  virtual bool find(Record& record) = 0;
  /// Bytes of the file from passed() on: as many as asked for, or as there are.
  virtual Bytes look(std::uint64_t count) = 0;
  virtual void move_on(std::uint64_t /*count*/) {}
  /// Passes the bytes, which begin at passed(), where the latest record does.
  void pass(Bytes bytes);

 private:
  std::uint64_t offset_;
  Bytes last_;  // the latest record
  bool counts_;
  std::uint32_t crc_ = 0;
};

/// Over a mapped file, from behind its magic bytes on. Lets go of the memory that was passed.
class MappedPass final : public RecordPass {
 public:
  /// `counts`: the CRC of the data section is computed, in which `begin` is where records begin.
  MappedPass(const FileView& view, Bytes file, bool counts = false, Progress progress = {},
             std::uint64_t begin = magic.size());
  /// Goes on at that byte. What is left out counts for the CRC.
  void go_on_at(std::uint64_t offset);
  CutPlace look_at_cut() override;

 private:
  bool find(Record& record) override;
  Bytes look(std::uint64_t count) override;

  Bytes file_;
  PassedBytes memory_;
};

/// Fills the front of the bytes given, and says how many came: at least one; 0 is the end.
using ReadBytes = std::function<Result<std::size_t>(std::span<std::byte>)>;

/// Over bytes as they come. Holds one record; one that is larger than `most_held` is left out, and `damage` gets that.
class StreamPass final : public RecordPass {
 public:
  StreamPass(ReadBytes source, std::uint64_t most_held, bool counts, DamageLog& damage);
  /// The first bytes, up to the magic's size; behind them records begin.
  Bytes begin();
  CutPlace look_at_cut() override;
  /// Why no more bytes came, if that was an error.
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
  RawBuffer buffer_;  // what came and isn't passed is from begin_ to end_
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool ended_ = false;
  Diagnostics failure_;
  std::vector<std::byte> last_bytes_;        // of what was left out
  std::optional<std::uint64_t> cut_record_;  // offset of a record that was being left out when the bytes ended
};

/// What stands around the messages of a file.
struct Frame {
  std::uint64_t data_end = 0;             // offset of DataEnd, of a Footer without one, or of what is no whole record
  std::optional<std::uint32_t> data_crc;  // as DataEnd states it
  bool summary_has_channels = false;
};

/// Passes over a whole file. `take` gets the records of the data section, `seen` (may be null) all of them before;
/// either may end the pass by false. What the summary says is learned if its CRC matches.
Frame read_frame(RecordPass& pass, bool check_crcs, Contents& contents, DamageLog& damage,
                 const std::function<bool(const Record&)>& take, const Reader::OnRecord& seen = {});

/// Which channels a pass delivers.
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

/// Delivers messages, by themselves and out of chunks. False from a callback ends it.
struct Delivery {
  Contents& contents;  // learns what chunks define
  DamageLog& damage;
  ChunkOpener& opener;
  RawBuffer& buffer;  // for the records of a chunk
  const ChannelSet& channels;
  const Reader::OnMessage& message;  // may be null
  const Reader::OnRecord& record;    // of the records in chunks; may be null

  bool deliver(const Record& message);
  /// A chunk that is too short was told of when its head was read.
  bool deliver_chunk(const Record& chunk);
};

}  // namespace rehearse::mcap
