// Schemas and payloads in the encodings beside that of ROS 2. The payloads are written byte by byte here.
#include "core/ros2msg/message_format.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::ros2msg {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Texts = std::vector<std::string>;

std::string text_of(const Value& value) {
  switch (value.kind) {
    case Value::Kind::signed_integer: return fmt::format("{}={}", value.path, value.integer);
    case Value::Kind::unsigned_integer: return fmt::format("{}={}u", value.path, value.unsigned_integer);
    case Value::Kind::boolean: return fmt::format("{}={}", value.path, value.unsigned_integer != 0);
    case Value::Kind::floating: return fmt::format("{}={:.17g}", value.path, value.number);
    case Value::Kind::text: return fmt::format("{}='{}'", value.path, value.text);
    case Value::Kind::blob: break;
  }
  std::string digits;
  for (const std::byte byte : value.blob) digits += fmt::format("{:02x}", std::to_integer<int>(byte));
  return fmt::format("{}=<{}>", value.path, digits);
}

/// A channel's format with its schema.
struct Form {
  std::string encoding;
  mcap::Schema schema;

  /// The values of a payload, and the problem as the last text.
  Texts values(std::string_view payload) const {
    auto parsed = schema_of(encoding, schema);
    if (!parsed) return {parsed.errors()[0].message};
    Decoder decoder(*std::move(parsed));
    Texts values;
    decoder.decode(std::as_bytes(std::span(payload.data(), payload.size())),
                   [&](const Value& value) { values.push_back(text_of(value)); });
    if (!decoder.problem().empty()) values.push_back("problem: " + decoder.problem());
    return values;
  }
  std::string problem() const {
    const auto parsed = schema_of(encoding, schema);
    return parsed ? "" : parsed.errors()[0].message;
  }
};

Form form(const std::string& encoding, const std::string& schema_encoding, const std::string& type,
          const std::string& text) {
  return {encoding, {1, type, schema_encoding, text}};
}

template <class Number>
std::string raw(Number number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}
std::string counted(std::string_view text) { return raw(static_cast<std::uint32_t>(text.size())) + std::string(text); }

TEST(MessageFormat, IsKnownByBothEncodings) {
  const mcap::Schema schema{1, "a/B", "ros2msg", "int32 x"};
  EXPECT_TRUE(is_decodable("cdr", &schema));
  EXPECT_FALSE(is_decodable("json", &schema));
  EXPECT_FALSE(is_decodable("cdr", nullptr));
  EXPECT_EQ(form("flatbuffer", "flatbuffer", "a", "").problem(),
            "messages of encoding 'flatbuffer' with a schema in 'flatbuffer' can't be decoded");
  EXPECT_FALSE(problem_of({1, "a", "flatbuffer", "?"}));
  EXPECT_TRUE(problem_of({1, "a", "ros1msg", "?"}));
}

// --- ROS 1

const std::string joint_state_of_ros1 =
    "Header header\nstring[] name # of joints\nfloat64[] position\nbyte[2] codes\nstring LIMIT=a # = b\n"
    "time[] at\nuint8[] data\n"
    "================================================================================\nMSG: std_msgs/Header\n"
    "uint32 seq\ntime stamp\nstring frame_id\n";

std::string ros1_payload() {
  return raw<std::uint32_t>(7) + raw<std::uint32_t>(12) + raw<std::uint32_t>(340) + counted("base") +
         raw<std::uint32_t>(2) + counted("HIP") + counted("") + raw<std::uint32_t>(1) + raw(0.25) + "\x01\xff" +
         raw<std::uint32_t>(1) + raw<std::uint32_t>(5) + raw<std::uint32_t>(6) + counted("\x0a\x0b");
}

TEST(Ros1Messages, AreDecodedWithTheNamesOfRos2) {
  EXPECT_THAT(form("ros1", "ros1msg", "sensor_msgs/JointState", joint_state_of_ros1).values(ros1_payload()),
              ElementsAre("header/seq=7u", "header/stamp/sec=12", "header/stamp/nanosec=340u", "header/frame_id='base'",
                          "name/0='HIP'", "name/1=''", "position/0=0.25", "codes/0=1", "codes/1=-1", "at/0/sec=5",
                          "at/0/nanosec=6u", "data=<0a0b>"));
}

TEST(Ros1Messages, ThatEndTooEarlyAreReportedWithTheirField) {
  const Form joints = form("ros1", "ros1msg", "sensor_msgs/JointState", joint_state_of_ros1);
  const std::string whole = ros1_payload();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THAT(joints.values(whole.substr(0, size)).back(), HasSubstr("problem: ends at byte")) << size;
  EXPECT_EQ(joints.values(whole.substr(0, 14)).back(), "problem: ends at byte 12, within header/frame_id");
}

TEST(Ros1Messages, WithoutFieldsHaveNoBytes) {
  EXPECT_THAT(form("ros1", "ros1msg", "std_msgs/Empty", "").values(""), IsEmpty());
  const std::string many = "Empty[4000000000] many\n====\nMSG: a/Empty\n";
  EXPECT_THAT(form("ros1", "ros1msg", "a/Many", many).values(""), IsEmpty()) << "and take no time";
}

TEST(Ros1Messages, WithAWrongDefinitionAreRefusedWithItsLine) {
  const auto parsed = schema_of("ros1", {1, "a/B", "ros1msg", "int32 x\nNothing y\n"}, "schema a/B");
  ASSERT_FALSE(parsed);
  EXPECT_EQ(to_string(parsed.errors()[0]), "schema a/B:2: error: type Nothing is used but not defined");
}

// --- IDL

const std::string idl =
    "================================================================================\n"
    "IDL: robot_msgs/msg/State\n"
    "// generated from rosidl_adapter\n#include \"builtin_interfaces/msg/Time.idl\"\n"
    "module robot_msgs {\n  module msg {\n    module State_Constants {\n      const uint8 MODE = 3;\n    };\n"
    "    typedef double double__2[2];\n"
    "    @verbatim (language=\"comment\", text=\"one; { two\" \"three\")\n"
    "    struct State {\n      builtin_interfaces::msg::Time stamp;\n"
    "      @default (value=TRUE)\n      boolean on;\n      sequence<robot_msgs::msg::Wheel, 3> wheels;\n"
    "      double__2 pair; /* of\n numbers */\n      sequence<octet> data;\n      string<5> name;\n"
    "      unsigned long long count;\n      long offsets[2];\n    };\n  };\n};\n"
    "================================================================================\n"
    "IDL: robot_msgs/msg/Wheel\nmodule robot_msgs { module msg { struct Wheel { float speed; }; }; };\n";

TEST(IdlMessages, AreDecodedAsCdr) {
  // numbers are aligned to their size, counted from behind the first four bytes
  const std::string payload = std::string("\0\1\0\0", 4) + raw<std::int32_t>(12) + raw<std::uint32_t>(34) +
                              std::string("\1\0\0\0", 4) + raw<std::uint32_t>(1) + raw(0.5F) + std::string(4, '\0') +
                              raw(1.5) + raw(2.5) + counted("\x07") + std::string(3, '\0') +
                              counted(std::string("ab\0", 3)) + std::string(1, '\0') + raw<std::uint64_t>(9) +
                              raw<std::int32_t>(-1) + raw<std::int32_t>(4);
  EXPECT_THAT(form("cdr", "ros2idl", "robot_msgs/msg/State", idl).values(payload),
              ElementsAre("stamp/sec=12", "stamp/nanosec=34u", "on=true", "wheels/0/speed=0.5", "pair/0=1.5",
                          "pair/1=2.5", "data=<07>", "name='ab'", "count=9u", "offsets/0=-1", "offsets/1=4"));
}

TEST(IdlMessages, WithAWrongDefinitionAreRefused) {
  const auto problem = [](const std::string& text) { return form("cdr", "ros2idl", "a/msg/B", text).problem(); };
  EXPECT_EQ(problem("module a { module msg { struct C { long x; }; }; };"), "it doesn't define a/msg/B");
  EXPECT_EQ(problem("module a { module msg { struct B { long x }; }; };"), "\"}\" where ';' is expected");
  EXPECT_EQ(problem("union a {};"), "\"union\" is neither a module, a struct, a constant nor a typedef");
  EXPECT_EQ(problem("module a { module msg { struct B { sequence<sequence<long>> x; }; }; };"),
            "a sequence of sequences");
  EXPECT_EQ(problem("module a { module msg { struct B { long x[2][3]; }; }; };"), "field x has several dimensions");
  EXPECT_EQ(problem("module a { module msg { struct B { a::msg::D x; }; }; };"), "type a/D is used but not defined");
  EXPECT_EQ(problem("module a { module msg { struct B { wstring x; }; }; };"),
            "type wstring can't be decoded: its encoding depends on the middleware");
  for (std::size_t size = 0; size < idl.size(); ++size)  // ends, whatever is cut
    form("cdr", "ros2idl", "robot_msgs/msg/State", idl.substr(0, size)).problem();
}

// --- JSON

const std::string json_schema = R"({"type": "object", "properties": {
  "stamp": {"$ref": "#/definitions/time"}, "name": {"type": "array", "items": {"type": "string"}},
  "position": {"type": "array", "items": {"type": "number"}}, "count": {"type": ["integer", "null"]},
  "on": {"type": "boolean"}, "data": {"type": "string", "contentEncoding": "base64"}, "any": {},
  "wheels": {"type": "array", "items": {"type": "object", "properties": {"speed": {"type": "number"}}}}},
  "definitions": {"time": {"type": "object",
                           "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}}}})";

TEST(JsonMessages, AreDecodedByTheirSchema) {
  const Form state = form("json", "jsonschema", "State", json_schema);
  EXPECT_THAT(state.values(R"({"on": true, "count": 3.0, "position": [0.1, 2], "name": ["HI\u0050"], "other": [1],
                               "stamp": {"sec": 12, "nsec": 34}, "data": "Cgs=", "any": 1,
                               "wheels": [{"speed": -1e3}]})"),
              ElementsAre("stamp/sec=12", "stamp/nanosec=34u", "name/0='HIP'", "position/0=0.10000000000000001",
                          "position/1=2", "count=3", "on=true", "data=<0a0b>", "wheels/0/speed=-1000"));
  EXPECT_THAT(state.values(R"({"count": null})"), IsEmpty()) << "properties may be left out";
}

TEST(JsonMessages, HaveNumbersBeyondTheRangeOfADouble) {
  const Form state = form("json", "jsonschema", "State", json_schema);
  EXPECT_THAT(state.values(R"({"name": ["1e400 \"1e400"], "position": [1e400, -1.5E+4000, 1e-400, "NaN", 2]})"),
              ElementsAre("name/0='1e400 \"1e400'", "position/0=inf", "position/1=-inf", "position/2=0",
                          "position/3=nan", "position/4=2"));
  EXPECT_THAT(state.values(R"({"position": [0001e400]})"), ElementsAre("problem: isn't JSON"));
}

TEST(JsonMessages, ThatBreakTheirSchemaAreReported) {
  const Form state = form("json", "jsonschema", "State", json_schema);
  EXPECT_THAT(state.values("{"), ElementsAre("problem: isn't JSON"));
  EXPECT_THAT(state.values("[]"),
              ElementsAre("problem: breaks its schema: the message is of type array, not an object"));
  EXPECT_THAT(state.values(R"({"position": [1, "x"]})"),
              ElementsAre("position/0=1", "problem: breaks its schema: position/1 is of type string, not number"));
  EXPECT_THAT(state.values(R"({"count": 1.5})"),
              ElementsAre("problem: breaks its schema: count is of type number, not integer"));
  EXPECT_THAT(state.values(R"({"count": 18446744073709551615})"),
              ElementsAre(HasSubstr("beyond the integers of 64 bits")));
  EXPECT_THAT(state.values(R"({"data": "?"})"), ElementsAre("problem: breaks its schema: data isn't base64"));
}

TEST(JsonMessages, WithASchemaOfNoObjectAreRefused) {
  const auto problem = [](const std::string& text) { return form("json", "jsonschema", "A", text).problem(); };
  EXPECT_EQ(problem("?"), "the schema isn't a JSON object");
  EXPECT_EQ(problem("{}"), "") << "messages of any properties: none is read";
  EXPECT_EQ(problem(R"({"properties": {"a": {"$ref": "#/definitions/b"}}})"),
            "property 'A/a' has a '$ref' that leads nowhere");
  EXPECT_EQ(problem(R"({"properties": {"b": {"$ref": "#/properties/b"}}})"),
            "property 'A/b' has a '$ref' that leads nowhere");
  EXPECT_EQ(problem(R"({"properties": {"o": {"$ref": "#/definitions/o"}},
                        "definitions": {"o": {"properties": {"o": {"$ref": "#/definitions/o"}}}}})"),
            "objects are nested too deeply");
}

// --- protobuf

std::string varint(std::uint64_t number) {
  std::string bytes;
  for (; number >= 0x80; number >>= 7) bytes += static_cast<char>((number & 0x7f) | 0x80);
  return bytes + static_cast<char>(number);
}
std::string tag(int field, int wire) { return varint(static_cast<std::uint64_t>(field << 3 | wire)); }
std::string number_field(int field, std::uint64_t number) { return tag(field, 0) + varint(number); }
std::string text_field(int field, const std::string& text) { return tag(field, 2) + varint(text.size()) + text; }
template <class Number>
std::string fixed_field(int field, Number number) {
  return tag(field, sizeof number == 8 ? 1 : 5) + raw(number);
}

/// A field of a descriptor.
std::string described(const std::string& name, int number, int type, bool repeated = false,
                      const std::string& type_name = "") {
  return text_field(2, text_field(1, name) + number_field(3, static_cast<std::uint64_t>(number)) +
                           number_field(4, repeated ? 3 : 1) + number_field(5, static_cast<std::uint64_t>(type)) +
                           (type_name.empty() ? "" : text_field(6, type_name)));
}
std::string file_of(const std::string& package, const std::string& messages) {
  return text_field(1, text_field(1, "x.proto") + text_field(2, package) + messages);
}

const std::string descriptors =
    file_of("google.protobuf",
            text_field(4, text_field(1, "Timestamp") + described("seconds", 1, 3) + described("nanos", 2, 5))) +
    file_of("robot",
            text_field(4, text_field(1, "State") + described("stamp", 1, 11, false, ".google.protobuf.Timestamp") +
                              described("position", 2, 1, true) + described("name", 3, 9, true) +
                              described("count", 4, 17) + described("on", 5, 8) + described("data", 6, 12) +
                              described("wheels", 7, 11, true, ".robot.State.Wheel") +
                              described("parent", 8, 11, false, ".robot.State") + described("id", 9, 7) +
                              text_field(3, text_field(1, "Wheel") + described("speed", 1, 2))));

TEST(ProtobufMessages, AreDecodedByTheirDescriptor) {
  const Form state = form("protobuf", "protobuf", "robot.State", descriptors);
  const std::string payload = text_field(3, "HIP") + fixed_field(2, 0.5) + number_field(99, 1) +
                              text_field(1, number_field(1, 12) + number_field(2, 34)) + text_field(3, "KNEE") +
                              text_field(2, raw(1.5) + raw(2.5)) + number_field(4, 3) + number_field(5, 1) +
                              text_field(6, "\x0a\x0b") + text_field(7, fixed_field(1, 0.25F)) + text_field(7, "") +
                              fixed_field(9, std::uint32_t{4000000000});
  EXPECT_THAT(state.values(payload),
              ElementsAre("stamp/sec=12", "stamp/nanosec=34u", "position/0=0.5", "position/1=1.5", "position/2=2.5",
                          "name/0='HIP'", "name/1='KNEE'", "count=-2", "on=true", "data=<0a0b>", "wheels/0/speed=0.25",
                          "wheels/1/speed=0", "id=4000000000u"));
  EXPECT_THAT(state.values(""),
              ElementsAre("stamp/sec=0", "stamp/nanosec=0u", "count=0", "on=false", "data=<>", "id=0u"))
      << "what is left out has its default";
}

/// As some writers write them: without a dot at their beginning.
TEST(ProtobufMessages, MayNameTypesInTheirScope) {
  const std::string messages =
      text_field(4, text_field(1, "Outer") + described("near", 1, 11, false, "Inner") +
                        described("far", 2, 11, false, "Other") + described("whole", 3, 11, false, "b.Outer.Inner") +
                        text_field(3, text_field(1, "Inner") + described("x", 1, 5))) +
      text_field(4, text_field(1, "Other") + described("y", 1, 5));
  EXPECT_THAT(
      form("protobuf", "protobuf", "a.b.Outer", file_of("a.b", messages)).values(text_field(2, number_field(1, 7))),
      ElementsAre("near/x=0", "far/y=7", "whole/x=0"));
}

TEST(ProtobufMessages, ThatAreCutOrOfAnotherTypeAreReported) {
  const Form state = form("protobuf", "protobuf", "robot.State", descriptors);
  EXPECT_THAT(state.values("\x80").back(), HasSubstr("the message ends within a field, or isn't protobuf"));
  EXPECT_THAT(state.values(tag(6, 2) + varint(5) + "abc").back(), HasSubstr("ends within a field"));
  EXPECT_THAT(state.values(number_field(6, 1)).back(), HasSubstr("data has another type"));
  EXPECT_THAT(state.values(text_field(2, "abc")).back(), HasSubstr("position ends within a number"));
  EXPECT_THAT(state.values(tag(3, 3)).back(), HasSubstr("ends within a field, or isn't protobuf")) << "a group";
}

TEST(ProtobufMessages, WithoutADescriptorAreRefused) {
  EXPECT_EQ(form("protobuf", "protobuf", "robot.Other", descriptors).problem(),
            "the schema doesn't define the message robot.Other");
  EXPECT_EQ(form("protobuf", "protobuf", "robot.State", "\xff").problem(),
            "the schema isn't a FileDescriptorSet of protobuf");
  for (std::size_t size = 0; size < descriptors.size(); ++size)  // ends, whatever is cut
    form("protobuf", "protobuf", "robot.State", descriptors.substr(0, size)).problem();
}

}  // namespace
}  // namespace rehearse::ros2msg
