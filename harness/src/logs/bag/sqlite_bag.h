// SqliteBag: a file of rosbag2's storage sqlite3 (.db3), read only.
//
// The tables that are read: topics (id, name, type, serialization_format, and from schema version 2 on
// offered_qos_profiles), messages (topic_id, timestamp, data), and from version 4 on message_definitions.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rehearse::bag {

struct Topic {
  std::string name;
  std::string type;                  // as sensor_msgs/msg/JointState; of a service's events example/srv/Name_Event
  std::string serialization_format;  // as cdr
  std::string qos_profiles;          // YAML; empty: not stated
};

struct Definition {
  std::string encoding;  // "ros2msg" or "ros2idl"
  std::string text;
};

/// One message. The data is valid during the callback only.
struct Message {
  std::int64_t id = 0;     // id of its row
  std::size_t topic = 0;   // index into topics()
  std::uint64_t time = 0;  // time of its arrival at the recorder [ns]
  std::span<const std::byte> data;
};

class SqliteBag {
 public:
  /// Opens a database, with the changes in its files `-wal` and `-journal`; creates and changes no file beside it.
  /// Fails if the file isn't a database, or lacks one of the tables or columns.
  static Result<std::unique_ptr<SqliteBag>> open(const std::filesystem::path& file, const std::string& name);
  ~SqliteBag();
  SqliteBag(const SqliteBag&) = delete;
  SqliteBag& operator=(const SqliteBag&) = delete;

  /// The files of a database: itself, and those beside it that contain changes.
  static std::vector<std::filesystem::path> files_of(const std::filesystem::path& file);

  int schema_version() const;                // 1 to 4
  const std::vector<Topic>& topics() const;  // in the order of their rows
  /// The definition of a message type in the file, of an event of a service that of the service; null: it has none.
  const Definition* definition_of(const std::string& type) const;

  using OnMessage = std::function<Result<void>(const Message&)>;
  /// Delivers all messages in the order of their rows, which is the order of recording. If SQLite can't read some, or
  /// their ids don't rise, the messages are read from the file's pages. Rows that are no messages (of an unknown topic,
  /// without a time or bytes) and damaged parts are reported at the end. An error of the callback ends the pass.
  Result<void> for_each_message(const OnMessage& callback);

  /// The number of messages that the last pass couldn't deliver; nullopt: unknown.
  std::optional<std::uint64_t> lost_messages() const;

  /// The findings of SQLite's own check of the whole file; empty: the file is whole.
  std::vector<std::string> examine();

 private:
  class Pass;
  struct Impl;
  explicit SqliteBag(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse::bag
