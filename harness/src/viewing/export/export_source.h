// The source messages of an export, which may be read several times. Internal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "trace_export.h"

namespace rehearse {

class ExportSource {
 public:
  static Result<ExportSource> open(const std::filesystem::path& trace, const ExportOptions& options);

  /// Selected channels, in the order of their ids.
  std::vector<const mcap::Channel*> channels() const;
  /// True for a recording of Rehearse, also if its ticks aren't selected.
  bool has_ticks() const;
  const mcap::Schema* schema_of(const mcap::Channel& channel) const { return reader_->schema_of(channel); }

  /// Delivers the selected messages in order of log time. If the callback fails, the pass ends with its error. Damage
  /// of the file doesn't end the pass: it is stored.
  Result<void> pass(const std::function<Result<void>(const mcap::Message&)>& callback);
  /// Sets the number of passes, for the progress; the default is 2.
  void expect_passes(int passes) { passes_ = passes; }

  const Diagnostics& damage() const { return damage_; }
  /// Stores a problem that concerns a single message; only the first fifty are stored.
  void note(const mcap::Channel& channel, std::string message);

 private:
  ExportSource(std::unique_ptr<mcap::Reader> reader, mcap::Selector selector, const ExportOptions& options);

  std::unique_ptr<mcap::Reader> reader_;
  mcap::Selector selector_;
  std::function<void(std::int64_t, std::int64_t)> progress_;
  std::int64_t all_ = 0;  // messages of the file, 0: unknown
  std::int64_t done_ = 0;
  int passes_ = 2;
  bool has_passed_ = false;
  Diagnostics damage_;
};

}  // namespace rehearse
