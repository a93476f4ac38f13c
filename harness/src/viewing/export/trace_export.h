// Exports any MCAP file to formats of other programs: tables (CSV), pictures (PNG, JPEG), a video.
//
// A table has a line of column names, each with its unit in brackets if the file states it, and a line per message: log
// time [s] to the nanosecond, then values, separated by commas, quoted as in RFC 4180. A number has enough digits to be
// read back with the same bits; NaN, Infinity and -Infinity are written as these words; booleans are 1 and 0. A cell
// without a value in a message is empty; for the types that trace.h lists it is NaN. Those types have columns with the
// names of their series. All types then have a column for each further field, named by its path, texts included. Bytes
// have a column only if it is requested: else the report lists the fields of bytes.
//
// Files are read twice, first for the columns, and never kept in memory: memory grows with columns, not with messages.
// A file that exists is replaced only if it is of the same kind; this is checked for all tables before anything is
// written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/trace/select.h"

namespace rehearse {

struct ExportOptions {
  mcap::Selection selection;
  bool bytes = false;  // tables have columns of bytes, in base64
  /// Of a joined table: the topic whose messages make the rows; empty: the ticks of a recording of Rehearse.
  std::string clock = {};
  /// Called with the number of exported messages and the number of all messages; both passes count.
  std::function<void(std::int64_t, std::int64_t)> progress;
};

/// The files written for one topic.
struct ExportedTopic {
  std::filesystem::path file;  // the table; of pictures: the table of their times
  std::string topic;           // empty: all topics
  std::int64_t rows = 0;
  std::int64_t columns = 0;   // number of columns, time included
  std::int64_t pictures = 0;  // number of pictures, in the folder beside the table with the table's name
};

/// Fields of a topic's messages without a column.
struct LeftOutFields {
  std::string topic;
  std::vector<std::string> fields;  // paths, with * for the number of an element
};

/// The reason why nothing was written for a topic.
struct SkippedTopic {
  std::string topic;
  std::string why;
};

struct ExportReport {
  std::vector<ExportedTopic> written;
  std::vector<SkippedTopic> skipped;
  std::vector<LeftOutFields> left_out;
  Diagnostics damage;  // damage of the file, and messages that don't fit their schemas; all other data was written
};

/// Writes a table for each topic, into a folder that is made if it doesn't exist.
Result<ExportReport> export_tables(const std::filesystem::path& trace, const std::filesystem::path& folder,
                                   const ExportOptions& options);

/// Writes one table of all series. A row per tick has all messages with the log time of a /tick; if /tick isn't
/// selected, a row per tick that has any selected message. With a clock, a row
/// per message of that topic has the last values of all series up to its log time; cells before the first are empty.
Result<ExportReport> export_joined(const std::filesystem::path& trace, const std::filesystem::path& file,
                                   const ExportOptions& options);

/// Writes each picture as a file, in a folder for each topic, and beside it a table of their times. CompressedImage:
/// unchanged, PNG or JPEG. Image: PNG with the same values: rgb8, rgba8, mono8, mono16, 16UC1, and bgr8 and bgra8 in
/// the order that PNG uses. 32FC1, distances [m]: 16-bit grey in millimetres, as in ROS: 0 without a measurement, 65535
/// for larger distances.
Result<ExportReport> export_frames(const std::filesystem::path& trace, const std::filesystem::path& folder,
                                   const ExportOptions& options);

/// Writes the pictures of the only selected topic with pictures as a video with their mean rate: .mp4, .mkv, .webm,
/// .gif, .apng or .webp. Needs ffmpeg.
Result<ExportReport> export_video(const std::filesystem::path& trace, const std::filesystem::path& file,
                                  const ExportOptions& options);

}  // namespace rehearse
