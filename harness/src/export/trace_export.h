// Recordings as what other programs read: tables (CSV), pictures (PNG, JPEG), a video. Of any MCAP file.
//
// A table has a line of column names, each with its unit in brackets if the file states it, and a line a message: log
// time [s] to the nanosecond, then values, separated by commas, quoted as RFC 4180 has it. A number is written with as
// many digits as it takes to read the same bits; NaN, Infinity and -Infinity are written so; booleans are 1 and 0; a
// cell that a message has no value for is empty, or, of the types that trace.h gives names, NaN. Those types have
// columns named as their series are; then, as any other type, one for each further field, named by its path, texts
// included. Bytes have no column: what is left out is named.
//
// Files are read twice, first for the columns, and never held: memory grows with columns, not with messages. A file
// that exists is replaced only if it is of the same kind, and nothing is written before that is known of all tables.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "trace/select.h"

namespace rehearse {

struct ExportOptions {
  mcap::Selection selection;
  /// Told how many of how many messages are done; both passes count.
  std::function<void(std::int64_t, std::int64_t)> progress;
};

/// What was written of one topic.
struct ExportedTopic {
  std::filesystem::path file;  // the table; of pictures that of their times
  std::string topic;           // empty: of all
  std::int64_t rows = 0;
  std::int64_t columns = 0;   // time included
  std::int64_t pictures = 0;  // in the folder beside the table, named alike
};

/// Fields of a topic's messages that no column holds.
struct LeftOutFields {
  std::string topic;
  std::vector<std::string> fields;  // with * for the number of an element
};

/// Why nothing was written of a topic.
struct SkippedTopic {
  std::string topic;
  std::string why;
};

struct ExportReport {
  std::vector<ExportedTopic> written;
  std::vector<SkippedTopic> skipped;
  std::vector<LeftOutFields> left_out;
  Diagnostics damage;  // of the file, and messages that don't fit their schemas; the rest was written
};

/// A table for each topic, into a folder that is made if it isn't there.
Result<ExportReport> export_tables(const std::filesystem::path& trace, const std::filesystem::path& folder,
                                   const ExportOptions& options);

/// One table of all series, a row a tick: whatever has the log time of a /tick. Needs a recording of ours.
Result<ExportReport> export_joined(const std::filesystem::path& trace, const std::filesystem::path& file,
                                   const ExportOptions& options);

/// Each picture as a file, in a folder for each topic, and beside that a table of their times. CompressedImage: as it
/// is, PNG or JPEG. Image: PNG with the same values: rgb8, rgba8, mono8, mono16, 16UC1, and bgr8 and bgra8 in the order
/// that PNG has. 32FC1, distances [m]: 16-bit grey in millimetres, as ROS has it: 0 where nothing was measured, 65535
/// where it was farther.
Result<ExportReport> export_frames(const std::filesystem::path& trace, const std::filesystem::path& folder,
                                   const ExportOptions& options);

/// The pictures of the one topic with pictures that is chosen as a video of their mean rate: .mp4, .mkv, .webm, .gif,
/// .apng or .webp. Needs ffmpeg.
Result<ExportReport> export_video(const std::filesystem::path& trace, const std::filesystem::path& file,
                                  const ExportOptions& options);

}  // namespace rehearse
