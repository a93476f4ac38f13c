// Bags for tests: databases written by libsqlite3 with the statements of rosbag2's storage, metadata.yaml as rosbag2
// writes it, and files compressed by libzstd.
#pragma once

#include <rehearse/logs.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <zstd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse::test {

namespace fs = std::filesystem;

inline const bool bags_are_read = (read_rosbag2_logs(), true);

template <class T>
Buffer encoded(const T& message) {
  CdrWriter writer;
  msg::encode(message, writer);
  return {writer.bytes().begin(), writer.bytes().end()};
}

/// A message of the joint KNEE.
inline Buffer joint_state(double position) {
  msg::JointState state;
  state.name = {"KNEE"};
  state.position = {position};
  return encoded(state);
}

inline Buffer compressed(std::span<const std::byte> bytes) {
  Buffer out(ZSTD_compressBound(bytes.size()));
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3));
  return out;
}
inline void write_text(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

/// A database as rosbag2 makes it, in one of the four versions of its tables.
class Database {
 public:
  explicit Database(const fs::path& file, int version = 4) {
    EXPECT_EQ(sqlite3_open(file.c_str(), &database_), SQLITE_OK);
    run("PRAGMA synchronous = OFF");
    const std::string profiles = version >= 2 ? ", offered_qos_profiles TEXT NOT NULL" : "";
    const std::string hash = version >= 4 ? ", type_description_hash TEXT NOT NULL DEFAULT ''" : "";
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT "
        "NOT NULL" +
        profiles + hash + ")");
    run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data "
        "BLOB "
        "NOT NULL)");
    run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
    if (version >= 3) {
      run("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)");
      run("CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL)");
      run("INSERT INTO schema VALUES(" + std::to_string(version) + ", 'rolling')");
    }
    if (version >= 4)
      run("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL, "
          "encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL)");
    has_profiles_ = version >= 2;
  }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const std::string& statement) {
    EXPECT_EQ(sqlite3_exec(database_, statement.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database_) << "\n"
        << statement;
  }
  void topic(int id, const std::string& name, const std::string& type, const std::string& format = "cdr") {
    run("INSERT INTO topics(id, name, type, serialization_format" +
        std::string(has_profiles_ ? ", offered_qos_profiles" : "") + ") VALUES(" + std::to_string(id) + ", '" + name +
        "', '" + type + "', '" + format + "'" + (has_profiles_ ? ", '- history: 3'" : "") + ")");
  }
  void definition(const std::string& type, const std::string& text, const std::string& encoding = "ros2msg") {
    run("INSERT INTO message_definitions VALUES(NULL, '" + type + "', '" + encoding + "', '" + text + "', '')");
  }
  void message(int topic, std::int64_t time, std::span<const std::byte> data) {
    sqlite3_stmt* insert = nullptr;
    ASSERT_EQ(sqlite3_prepare_v2(database_, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", -1,
                                 &insert, nullptr),
              SQLITE_OK);
    sqlite3_bind_int(insert, 1, topic);
    sqlite3_bind_int64(insert, 2, time);
    sqlite3_bind_blob(insert, 3, data.data(), static_cast<int>(data.size()), SQLITE_TRANSIENT);
    EXPECT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_finalize(insert);
  }

 private:
  sqlite3* database_ = nullptr;
  bool has_profiles_ = true;
};

/// Overwrites a page of the table of messages with zeros: the first one behind that fraction of the file.
inline void zero_page(const fs::path& file, double fraction) {
  constexpr std::size_t page = 4096;
  constexpr std::byte leaf_of_table{0x0d};
  Buffer bytes = read_bytes(file);
  std::size_t at = static_cast<std::size_t>(fraction * static_cast<double>(bytes.size() / page)) * page;
  while (at < bytes.size() && bytes[at] != leaf_of_table) at += page;
  ASSERT_LT(at, bytes.size());
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), page, std::byte{0});
  write_bytes(file, bytes);
}

/// An MCAP file with messages of the joint KNEE on /joint_states: `count` from that time on, a millisecond apart. The
/// position is the time in milliseconds.
inline void write_joints(const fs::path& file, std::uint64_t first_ms, std::uint64_t count) {
  auto writer = mcap::Writer::create(file);
  ASSERT_TRUE(writer);
  const auto schema = (*writer)->add_schema(msg::JointState::type_name, "ros2msg", msg::schema_text<msg::JointState>());
  const auto channel = (*writer)->add_channel(schema, "/joint_states", "cdr");
  for (std::uint64_t i = first_ms; i < first_ms + count; ++i)
    EXPECT_TRUE((*writer)->write(channel, i * 1'000'000, i * 1'000'000, joint_state(static_cast<double>(i))));
  EXPECT_TRUE((*writer)->close());
}

struct Metadata {
  std::string storage = "mcap";
  std::vector<std::string> files = {};
  std::uint64_t messages = 0;
  std::string mode = "", format = "";  // of the compression
};

/// metadata.yaml in the form of rosbag2's version 5 (Humble).
inline void write_metadata(const fs::path& folder, const Metadata& metadata) {
  std::string files;
  for (const std::string& file : metadata.files) files += "    - " + file + "\n";
  write_text(folder / "metadata.yaml",
             "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: " + metadata.storage +
                 "\n  duration:\n    nanoseconds: 9000000\n  starting_time:\n    nanoseconds_since_epoch: 0\n"
                 "  message_count: " +
                 std::to_string(metadata.messages) +
                 "\n  topics_with_message_count:\n    - topic_metadata:\n        name: /joint_states\n"
                 "        type: sensor_msgs/msg/JointState\n        serialization_format: cdr\n"
                 "        offered_qos_profiles: \"\"\n      message_count: " +
                 std::to_string(metadata.messages) + "\n  compression_format: \"" + metadata.format +
                 "\"\n  compression_mode: \"" + metadata.mode + "\"\n  relative_file_paths:\n" + files);
}

}  // namespace rehearse::test
