// A small writer of bags of ROS 1, from the public description of their version 2.0.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace rehearse::test::ros1 {

template <class Number>
inline std::string raw(Number number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}
inline std::string block(const std::string& bytes) { return raw(static_cast<std::uint32_t>(bytes.size())) + bytes; }
inline std::string field(const std::string& name, const std::string& value) { return block(name + "=" + value); }
inline std::string record(const std::string& fields, const std::string& data) { return block(fields) + block(data); }
inline std::string op(char kind) { return field("op", std::string(1, kind)); }
inline std::string time_of(std::uint32_t seconds, std::uint32_t nanoseconds) { return raw(seconds) + raw(nanoseconds); }

inline const std::string joint_state =
    "Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";

inline std::string connection(std::uint32_t id, const std::string& topic) {
  return record(op(7) + field("conn", raw(id)) + field("topic", topic),
                field("topic", topic) + field("type", "sensor_msgs/JointState") + field("md5sum", "3066dcd7") +
                    field("message_definition", joint_state) + field("callerid", "/robot"));
}

/// The position of KNEE, stamped and recorded at 100.5 s and so many milliseconds.
inline std::string message(std::uint32_t connection, std::uint32_t milliseconds, double position) {
  const std::string time = time_of(100, 500'000'000 + milliseconds * 1'000'000);
  const std::string payload = raw<std::uint32_t>(0) + time + block("base") + raw<std::uint32_t>(1) + block("KNEE") +
                              raw<std::uint32_t>(1) + raw(position) + raw<std::uint32_t>(0) + raw<std::uint32_t>(0);
  return record(op(2) + field("conn", raw(connection)) + field("time", time), payload);
}

/// `stored`: the records in that compression.
inline std::string chunk_of(const std::string& records, const std::string& compression, const std::string& stored) {
  return record(
      op(5) + field("compression", compression) + field("size", raw(static_cast<std::uint32_t>(records.size()))),
      stored);
}

inline std::string header(const std::string& more = "") {
  return "#ROSBAG V2.0\n" +
         record(op(3) + field("index_pos", raw<std::uint64_t>(0)) + field("conn_count", raw<std::uint32_t>(1)) +
                    field("chunk_count", raw<std::uint32_t>(1)) + more,
                std::string(200, ' '));
}

}  // namespace rehearse::test::ros1
