// The outputs of the controllers of one replay, bit for bit, in a file. It is written through mapped memory, without an
// open descriptor, so that a controller can't damage it. If a call ends the process, the file is complete up to this
// call, and names it.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/replay.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rehearse {

struct OutputsHead;

class OutputsWriter {
 public:
  /// Creates the file, or replaces it. Fails if it can't be created.
  static Result<OutputsWriter> create(const std::filesystem::path& file);
  ~OutputsWriter();
  OutputsWriter(OutputsWriter&& other) noexcept;
  OutputsWriter& operator=(OutputsWriter&&) = delete;

  /// Sets the fields of the rows. Must be called once.
  void begin(const std::vector<OutputField>& fields);
  void add(std::int64_t tick, const std::vector<std::uint64_t>& row);
  /// Report the begin and the end of a call into a controller.
  void enter(const char* controller, const char* function, std::int64_t tick);
  void leave();
  /// False if the disk was full; then rows are missing.
  bool complete() const { return complete_; }

 private:
  OutputsWriter(std::filesystem::path file, std::byte* memory, std::size_t size);
  OutputsHead& head() const;
  bool grow(std::size_t size);

  std::filesystem::path file_;  // absolute
  std::byte* memory_ = nullptr;
  std::size_t size_ = 0;  // of the file and of the mapped memory
  bool complete_ = true;
};

/// The call into a controller during which its process ended.
struct UnfinishedCall {
  std::string controller, function;
  std::int64_t tick = 0;
};

/// An outputs file after its process has ended.
class Outputs {
 public:
  static Result<Outputs> read(const std::filesystem::path& file);

  /// Empty if the replay ended before the controllers had started.
  const std::vector<OutputField>& fields() const { return fields_; }
  std::int64_t rows() const { return static_cast<std::int64_t>(words_.size() / width()); }
  std::int64_t tick(std::int64_t row) const { return static_cast<std::int64_t>(words_[at(row)]); }
  /// The words of a row, one for each of fields().
  std::span<const std::uint64_t> row(std::int64_t row) const { return {&words_[at(row) + 1], fields_.size()}; }
  const std::optional<UnfinishedCall>& unfinished() const { return unfinished_; }

 private:
  std::size_t width() const { return fields_.size() + 1; }  // the tick, and its outputs
  std::size_t at(std::int64_t row) const { return static_cast<std::size_t>(row) * width(); }

  std::vector<OutputField> fields_;
  std::vector<std::uint64_t> words_;
  std::optional<UnfinishedCall> unfinished_;
};

/// A number that changes with each call into a controller; none if the file doesn't exist yet.
std::optional<std::uint64_t> heartbeat_of(const std::filesystem::path& file);

/// The first place where two replays of the same recording differ, for one controller, or for all if it is empty.
/// `expected` is the first's, `actual` the second's. Outputs that only one replay made, because the other ended, are a
/// difference too.
std::optional<Divergence> first_difference(const Outputs& expected, const Outputs& actual, double time_step,
                                           const std::string& controller);

}  // namespace rehearse
