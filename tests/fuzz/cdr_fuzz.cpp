// For any bytes, a payload is decoded as far as possible, and nothing outside of it is read. The first byte determines
// the kind of input. Normally it is a payload of one of the schemas below. From 0x80 on it is a schema, up to a zero
// byte, and its payload; 0xf0 to 0xff are values to write and read again.
#include <rehearse/messages.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/ros2msg/ros2msg.h"
#include "core/trace/message_json.h"

using namespace rehearse;

namespace {

using Bytes = std::span<const std::byte>;

/// All shapes that a schema can have.
const std::vector<std::string>& schemas() {
  static const std::vector<std::string> texts{
      msg::schema_text<msg::JointState>(),
      msg::schema_text<msg::TFMessage>(),
      msg::schema_text<msg::PointCloud2>(),
      msg::schema_text<msg::CameraInfo>(),
      msg::schema_text<msg::Tick>(),
      msg::schema_text<msg::Contacts>(),
      "bool a\nint8 b\nuint8 c\nint16 d\nuint16 e\nint32 f\nuint32 g\nint64 h\nuint64 i\nfloat32 j\nfloat64 k\nstring "
      "l\n",
      "bool[] a\nint8[3] b\nbyte[<=5] c\nint16[] d\nuint16[2] e\nint32[] f\nuint32[<=1000] g\nint64[] h\nuint64[2] i\n"
      "float32[] j\nfloat64[3] k\nstring[] l\nstring<=5[<=3] m\nchar n\n",
      "Empty a\nEmpty[] b\nEmpty[4000000000] c\n===\nMSG: fuzz_msgs/Empty\n",
      "A[] a\n===\nMSG: fuzz_msgs/A\nB[4] b\nuint8 x\n===\nMSG: fuzz_msgs/B\nC[<=2] c\nfloat64 y\n===\nMSG: "
      "fuzz_msgs/C\nstring s\nint16 z\n",
      "uint8[4000000000] a\nfloat64[4000000000] b\n"};
  return texts;
}

/// Checks that the JSON is valid, and unchanged after parsing and writing.
void check_json(const std::string& text) {
  const auto read = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!read.is_object() || !nlohmann::ordered_json::accept(read.dump())) std::abort();
}

/// Touches every byte, so that a view that points anywhere else is noticed.
void decode(std::string_view schema_text, Bytes payload) {
  auto schema = ros2msg::Schema::parse("fuzz_msgs/msg/Fuzz", schema_text);
  if (!schema) return;
  ros2msg::Decoder decoder(std::move(*schema));
  std::uint64_t sum = 0, size = 0;
  decoder.decode(payload, [&](const ros2msg::Value& value) {
    for (const char c : value.text) sum += static_cast<std::uint8_t>(c);
    for (const std::byte byte : value.blob) sum += std::to_integer<std::uint64_t>(byte);
    size += 1 + value.text.size() + value.blob.size();
    if (size > 2 * payload.size() + 16) std::abort();  // more than the payload has
  });
  constexpr std::size_t limit = 1 << 20;
  if (const auto json = ros2msg::to_json(decoder, payload, limit)) check_json(*json);
  static_cast<void>(ros2msg::to_line(decoder, payload));
}

/// Checks that a decoded message can be encoded, and is equal when it is decoded again.
template <class Message>
void rewrite(Bytes payload) {
  Message message;
  CdrReader reader(payload);
  if (!msg::decode(reader, message)) return;
  CdrWriter first;
  msg::encode(message, first);
  const std::vector<std::byte> bytes(first.bytes().begin(), first.bytes().end());
  Message again;
  CdrReader second(bytes);
  if (!msg::decode(second, again) || second.left() != 0) std::abort();
  first.reset();
  msg::encode(again, first);
  if (first.bytes().size() != bytes.size() || std::memcmp(first.bytes().data(), bytes.data(), bytes.size()) != 0) {
    std::abort();
  }
}

/// Takes values of one type after the other from the bytes, writes them, and expects to read the same bits.
class RoundTrip {
 public:
  explicit RoundTrip(Bytes bytes) : bytes_(bytes) {}

  void run() {
    const Bytes all = bytes_;
    while (const auto kind = take<std::uint8_t>()) step(*kind, true);
    reader_ = CdrReader(writer_.bytes());
    bytes_ = all;
    while (const auto kind = take<std::uint8_t>()) step(*kind, false);
    if (!reader_.ok() || reader_.left() != 0) std::abort();
  }

 private:
  void step(std::uint8_t kind, bool writes) {
    switch (kind % 8) {
      case 0: return pass<std::uint8_t>(writes);
      case 1: return pass<std::int16_t>(writes);
      case 2: return pass<std::uint32_t>(writes);
      case 3: return pass<std::int64_t>(writes);
      case 4: return pass<float>(writes);
      case 5: return pass<double>(writes);
      case 6: return pass_text(kind / 8, writes);
      default: return pass_sequence(kind / 8, writes);
    }
  }

  template <class T>
  std::optional<T> take() {
    if (bytes_.size() < sizeof(T)) return bytes_ = {}, std::nullopt;
    T value;
    std::memcpy(&value, bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
    return value;
  }

  template <class T>
  void pass(bool writes) {
    const auto value = take<T>();
    if (!value) return;
    if (writes) return writer_.put(*value);
    const T read = reader_.get<T>();
    if (std::memcmp(&read, &*value, sizeof(T)) != 0) std::abort();
  }

  void pass_text(std::size_t size, bool writes) {
    std::string text;
    while (text.size() < size) {
      const auto character = take<char>();
      if (!character) break;
      text += *character;
    }
    if (writes) return writer_.put(std::string_view(text));
    if (reader_.get_string() != text) std::abort();
  }

  void pass_sequence(std::size_t size, bool writes) {
    std::vector<double> values;
    while (values.size() < size) {
      const auto value = take<double>();
      if (!value) break;
      values.push_back(*value);
    }
    if (writes) return writer_.put_sequence(std::span<const double>(values));
    std::vector<double> read;
    reader_.get_sequence(read);
    if (read.size() != values.size()) std::abort();
    if (!read.empty() && std::memcmp(read.data(), values.data(), 8 * read.size()) != 0) std::abort();
  }

  Bytes bytes_;
  CdrWriter writer_;
  CdrReader reader_{Bytes{}};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes bytes(reinterpret_cast<const std::byte*>(data) + 1, size - 1);
  if (data[0] >= 0xf0) {
    RoundTrip(bytes).run();
  } else if (data[0] >= 0x80) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t end = std::min(text.find('\0'), text.size());
    decode(text.substr(0, end), bytes.subspan(std::min(end + 1, bytes.size())));
  } else {
    decode(schemas()[data[0] % schemas().size()], bytes);
    rewrite<msg::JointState>(bytes);
    rewrite<msg::TFMessage>(bytes);
    rewrite<msg::PointCloud2>(bytes);
    rewrite<msg::CameraInfo>(bytes);
    rewrite<msg::Tick>(bytes);
    rewrite<msg::Contacts>(bytes);
  }
  return 0;
}
