// Ros1Bag: a bag of ROS 1 (.bag, version 2.0), read from its beginning to its end. Its index isn't used, so a bag that
// was not closed is read, too.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/mcap/codec.h"

namespace rehearse::bag {

/// The messages of one publisher on a topic.
struct Ros1Connection {
  std::uint32_t id = 0;
  std::string topic;
  std::string type;         // as sensor_msgs/JointState
  std::string definition;   // ros1msg
  mcap::StringMap details;  // what else its publisher stated: md5sum, callerid, latching
};

class Ros1Bag {
 public:
  /// `bytes`: the whole file, which must live as long as this. Fails if it is a bag of another version, or encrypted.
  static Result<std::unique_ptr<Ros1Bag>> open(mcap::Bytes bytes, std::string name);

  using OnConnection = std::function<void(const Ros1Connection&)>;
  /// `connection`: its id; `time`: of the arrival at the recorder [ns].
  using OnMessage = std::function<Result<void>(std::uint32_t connection, std::uint64_t time, mcap::Bytes data)>;
  /// Delivers each connection before its first message, and all messages in the order of the file. Damaged chunks and
  /// records are reported at the end; all readable messages are delivered. An error of a callback ends the pass.
  Result<void> for_each_message(const OnConnection& on_connection, const OnMessage& on_message);

 private:
  Ros1Bag(mcap::Bytes bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  struct Record;
  struct Pass;
  static bool read_record(mcap::Bytes bytes, std::size_t& at, Record& record);
  bool take(const Record& record, Pass& pass);
  bool take_chunk(const Record& record, Pass& pass);
  void take_connection(const Record& record, Pass& pass);
  bool take_message(const Record& record, Pass& pass);
  Result<mcap::Bytes> decompress(const Record& chunk);

  mcap::Bytes bytes_;
  std::string name_;
  mcap::Decompressor decompressor_;
  mcap::RawBuffer buffer_;
};

}  // namespace rehearse::bag
