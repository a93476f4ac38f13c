// The first pass of recover() over a file: finds the data that can be saved. Internal.
#pragma once

#include "record_pass.h"
#include "recover.h"
#include "resync.h"

namespace rehearse::mcap {

/// A span of the file whose records are accepted.
struct SavedRun {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  bool trusted = true;  // false: a damaged or cut chunk, of which only the messages that seem whole are saved
};

class Survey {
 public:
  /// `recovery` gets the losses.
  Survey(const FileView& file, const RecoverOptions& options, Recovery& recovery);

  Contents contents;  // statistics: from a summary whose CRC matches
  ChannelGroups groups;
  std::vector<SavedRun> runs;  // in file order

 private:
  /// Why a record isn't saved; empty: it is saved.
  using Fault = std::string;

  void read_summary();
  void walk();
  bool pass_record(const Record& record);
  bool ends_file(const Record& record);
  bool is_cut_chunk(std::uint64_t offset) const;
  Fault judge(const Record& record);
  Fault judge_chunk(const Record& record);
  Fault judge_attachment(const Record& record) const;
  Fault learn(const Record& definition);
  void pass_chunk_records(Bytes records, std::string_view compression);
  void count_lost(const Record& message_index);
  void save(std::uint64_t begin, std::uint64_t end, bool trusted = true);
  void lose(std::uint64_t begin, std::uint64_t end, std::string what);
  void finish_data(const Record& data_end);

  const Bytes file_;
  MappedPass pass_;
  const RecoverOptions& options_;
  Recovery& recovery_;
  Resync resync_;
  ChunkOpener opener_;
  RawBuffer buffer_;
  bool summary_decides_ = false;  // definitions of a summary whose CRC matches were read
  bool in_summary_ = false;       // the pass is after DataEnd
  bool chunk_was_lost_ = false;   // the following message indexes belong to a lost chunk
  std::uint64_t private_records_ = 0;
};

}  // namespace rehearse::mcap
