#include <rehearse/messages.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <concepts>
#include <map>

#include "core/ros2msg/ros2msg.h"

using namespace rehearse;

namespace {

using AllMessages =
    testing::Types<msg::JointState, msg::Imu, msg::Image, msg::CompressedImage, msg::CameraInfo, msg::LaserScan,
                   msg::PointCloud2, msg::PoseStamped, msg::TwistStamped, msg::AccelStamped, msg::WrenchStamped,
                   msg::TFMessage, msg::Joy, msg::Tick, msg::DeviceState, msg::Contacts, msg::ContactForce,
                   msg::JointAccelerations, msg::Event, msg::Checkpoint>;

/// Sets every field to a different value, and records each with the path that ros2msg::Decoder should report.
class Filler {
 public:
  template <msg::MessageStruct T>
  void fill(T& message, const std::string& path) {
    msg::for_each_field(message, [&](std::string_view name, auto& field) {
      fill(field, path.empty() ? std::string(name) : path + "/" + std::string(name));
    });
  }
  template <CdrNumber T>
  void fill(T& value, const std::string& path) {
    if constexpr (std::same_as<T, bool>) {
      value = true;
    } else if constexpr (std::integral<T>) {
      value = static_cast<T>(0x0123456789abcdefull * ++count_);
    } else {
      value = static_cast<T>(0.1) * static_cast<T>(++count_);
    }
    expected[path] = print(value);
  }
  void fill(std::string& text, const std::string& path) { expected[path] = text = "text " + std::to_string(++count_); }
  void fill(std::vector<bool>& values, const std::string& path) {
    values = {true, false, true};
    for (std::size_t i = 0; i < values.size(); ++i) expected[path + "/" + std::to_string(i)] = print(bool(values[i]));
  }
  void fill(std::vector<std::uint8_t>& values, const std::string& path) {
    values = {'b', 'l', 'o', 'b'};
    expected[path] = "blob";
  }
  template <class T>
  void fill(std::vector<T>& values, const std::string& path) {
    values.resize(3);
    for (std::size_t i = 0; i < values.size(); ++i) fill(values[i], path + "/" + std::to_string(i));
  }
  template <class T, std::size_t N>
  void fill(std::array<T, N>& values, const std::string& path) {
    for (std::size_t i = 0; i < N; ++i) fill(values[i], path + "/" + std::to_string(i));
  }

  template <class T>
  static std::string print(T value) {
    if constexpr (std::floating_point<T>) return std::to_string(std::bit_cast<std::uint64_t>(double{value}));
    return std::to_string(value);
  }

  std::map<std::string, std::string> expected;

 private:
  int count_ = 0;
};

std::string print(const ros2msg::Value& value) {
  using Kind = ros2msg::Value::Kind;
  switch (value.kind) {
    case Kind::signed_integer: return Filler::print(value.integer);
    case Kind::unsigned_integer:
    case Kind::boolean: return Filler::print(value.unsigned_integer);
    case Kind::floating: return Filler::print(value.number);
    case Kind::text: return std::string(value.text);
    case Kind::blob: return {reinterpret_cast<const char*>(value.blob.data()), value.blob.size()};
  }
  return "?";
}

template <class T>
class Messages : public testing::Test {};
TYPED_TEST_SUITE(Messages, AllMessages);

}  // namespace

TYPED_TEST(Messages, AreEncodedAsTheirSchemaSays) {
  auto schema = ros2msg::Schema::parse(TypeParam::type_name, msg::schema_text<TypeParam>());
  ASSERT_TRUE(schema) << to_string(schema.errors());
  TypeParam message;
  Filler filler;
  filler.fill(message, "");
  CdrWriter writer;
  msg::encode(message, writer);

  std::map<std::string, std::string> found;
  ros2msg::Decoder decoder(std::move(*schema));
  EXPECT_TRUE(
      decoder.decode(writer.bytes(), [&](const ros2msg::Value& value) { found.emplace(value.path, print(value)); }));
  EXPECT_EQ(found, filler.expected);
}

TYPED_TEST(Messages, DecodeToWhatWasEncoded) {
  TypeParam message;
  Filler().fill(message, "");
  CdrWriter writer, again;
  msg::encode(message, writer);
  TypeParam decoded;
  CdrReader reader(writer.bytes());
  EXPECT_TRUE(msg::decode(reader, decoded));
  EXPECT_EQ(reader.left(), 0u);
  msg::encode(decoded, again);
  EXPECT_TRUE(std::ranges::equal(writer.bytes(), again.bytes()));
}

TYPED_TEST(Messages, DoNotDecodeWhenCutAnywhere) {
  TypeParam message;
  Filler().fill(message, "");
  CdrWriter writer;
  msg::encode(message, writer);
  for (std::size_t size = 0; size < writer.bytes().size(); ++size) {
    TypeParam decoded;
    CdrReader reader(writer.bytes().first(size));
    EXPECT_FALSE(msg::decode(reader, decoded)) << size << " bytes of " << writer.bytes().size();
  }
}

TEST(MessageSchema, IsTheTextThatRosToolsKnow) {
  EXPECT_EQ(msg::schema_text<msg::JointState>(),
            "std_msgs/Header header\n"
            "string[] name\n"
            "float64[] position\n"
            "float64[] velocity\n"
            "float64[] effort\n" +
                std::string(80, '=') +
                "\nMSG: std_msgs/Header\n"
                "builtin_interfaces/Time stamp\n"
                "string frame_id\n" +
                std::string(80, '=') +
                "\nMSG: builtin_interfaces/Time\n"
                "int32 sec\n"
                "uint32 nanosec\n");
}

TEST(MessageSchema, DefinesATypeOnceThatIsUsedTwice) {
  const std::string text = msg::schema_text<msg::Imu>();
  const auto first = text.find("MSG: geometry_msgs/Vector3\n");
  EXPECT_NE(first, std::string::npos);
  EXPECT_EQ(text.find("MSG: geometry_msgs/Vector3\n", first + 1), std::string::npos);
}

TEST(MessageTime, SplitsNanoseconds) {
  const auto time = msg::Time::from_ns(12'000'000'034);
  EXPECT_EQ(time.sec, 12);
  EXPECT_EQ(time.nanosec, 34u);
  EXPECT_EQ(time.to_ns(), 12'000'000'034u);
}

TEST(MessageDecoding, ReusesTheMemoryOfTheMessage) {
  msg::JointState message, decoded;
  message.name = {"A_JOINT_WITH_A_LONG_NAME_0", "A_JOINT_WITH_A_LONG_NAME_1"};
  message.position = {1.0, 2.0};
  CdrWriter writer;
  msg::encode(message, writer);
  CdrReader once(writer.bytes()), twice(writer.bytes());
  EXPECT_TRUE(msg::decode(once, decoded));
  const void* names = decoded.name.data();
  const void* first_name = decoded.name[0].data();
  const void* positions = decoded.position.data();
  EXPECT_TRUE(msg::decode(twice, decoded));
  EXPECT_EQ(decoded.name.data(), names);
  EXPECT_EQ(decoded.name[0].data(), first_name);
  EXPECT_EQ(decoded.position.data(), positions);
}
