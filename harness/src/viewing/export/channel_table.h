// The messages of a channel as rows of a table. Internal.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/trace/message_rest.h"
#include "core/trace/trace_rows.h"

namespace rehearse {

class ChannelTable {
 public:
  struct Column {
    std::string name;
    std::string unit;  // empty: not stated
  };

  virtual ~ChannelTable() = default;
  /// Fails if its messages have no table: encodings that aren't decoded, an invalid schema. `bytes`: bytes get a
  /// column, too, in base64.
  static Result<std::unique_ptr<ChannelTable>> make(const mcap::Channel& channel, const mcap::Schema* schema,
                                                    bool bytes = false);

  /// Reads a message; columns that occur first in it are added. False if the message doesn't fit its schema.
  virtual bool read(mcap::Bytes payload) = 0;
  /// Appends the cells of the last message, each after a comma; empty cells for columns that were added later.
  virtual void append_row(std::string& line) const = 0;
  virtual std::vector<Column> columns() const = 0;
  /// Fields without a column, with * for the number of an element: data, points/*/tag.
  virtual std::set<std::string> left_out() const = 0;
};

/// A channel whose numbers have names as in a Trace. Its single row contains the numbers of the last message.
class SeriesTable final : public ChannelTable {
 public:
  /// Null if the messages have no series. `any_schema`: also types without a specific table in trace.h.
  static Result<std::unique_ptr<SeriesTable>> make(const mcap::Channel& channel, const mcap::Schema* schema,
                                                   bool any_schema);

  bool read(mcap::Bytes payload) override;
  void append_row(std::string& line) const override;
  std::vector<Column> columns() const override;
  std::set<std::string> left_out() const override { return left_out_; }
  TraceChannel& channel() { return rows_.table; }

 private:
  SeriesTable(const mcap::Channel& channel, const mcap::Schema* schema) : rows_(channel, schema) {}

  ChannelRows rows_;
  std::unique_ptr<ros2msg::Decoder> decoder_;  // null: the schema is unknown
  std::unique_ptr<ColumnFields> columns_;
  std::set<std::string> left_out_;  // fields of the first message without a column
  bool has_read_ = false;
};

/// Appends a cell of a row; quoted if necessary.
void append_cell(std::string& line, std::string_view text);
/// Appends the time in seconds with nine digits after the point.
void append_seconds(std::string& line, std::uint64_t ns);

}  // namespace rehearse
