// The messages of controllers and harness in a report. Internal.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "report_blobs.h"
#include "report_run.h"

namespace rehearse {

/// Writes the messages of one or two runs, read one by one: those nearest to a tick into the object, all of them into
/// blobs if there are more.
class MessageWriter {
 public:
  struct Limits {
    std::uint64_t listed = 5'000;         // messages in the object
    std::uint64_t in_blob = 5'000;        // messages in a blob
    std::uint64_t of_blobs = 14'000'000;  // coded bytes of all blobs; base64 makes them a third larger
  };

  /// `golden` may be null. Messages that a report leaves out become an omission.
  MessageWriter(BlobWriter& blobs, const ReportedRun& actual, const ReportedRun* golden,
                std::vector<std::string>& omitted)
      : MessageWriter(blobs, actual, golden, omitted, Limits()) {}
  MessageWriter(BlobWriter& blobs, const ReportedRun& actual, const ReportedRun* golden,
                std::vector<std::string>& omitted, const Limits& limits)
      : blobs_(blobs), actual_(actual), golden_(golden), omitted_(omitted), limits_(limits) {}

  /// Sets `events`, and `messages` if the object doesn't list all messages. `tick`: the one of interest.
  void write(ReportJson& object, std::int64_t tick);

 private:
  struct Extent {
    std::uint64_t all = 0;
    std::uint64_t before = 0;  // messages before the tick of interest
  };
  Extent extent_of(std::int64_t tick) const;

  BlobWriter& blobs_;
  const ReportedRun& actual_;
  const ReportedRun* golden_;
  std::vector<std::string>& omitted_;
  const Limits limits_;
};

}  // namespace rehearse
