// The messages that an export is made of, passed over as often as it takes. Internal.
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

  /// Chosen channels, in the order of their ids.
  std::vector<const mcap::Channel*> channels() const;
  const mcap::Schema* schema_of(const mcap::Channel& channel) const { return reader_->schema_of(channel); }

  /// The chosen messages in order of log time; ends early if the callback fails, with what it said. Damage of the file
  /// ends nothing: it is kept.
  Result<void> pass(const std::function<Result<void>(const mcap::Message&)>& callback);
  /// How many passes there will be, for the progress; 2 if nobody says.
  void expect_passes(int passes) { passes_ = passes; }

  const Diagnostics& damage() const { return damage_; }
  /// Keeps a problem of the data that only costs a message; the first fifty.
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
