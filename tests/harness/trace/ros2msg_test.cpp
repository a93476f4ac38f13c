#include <rehearse/cdr.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/ros2msg/ros2msg.h"

using namespace rehearse;
using ros2msg::FieldType;
using ros2msg::Primitive;
using testing::HasSubstr;

namespace {

ros2msg::Schema parse(std::string_view text) {
  auto schema = ros2msg::Schema::parse("test/msg/Type", text, "schema");
  EXPECT_TRUE(schema) << (schema ? "" : to_string(schema.errors()));
  return schema ? std::move(*schema) : ros2msg::Schema{{{"failed", {}, {}}}};
}

std::string complaint_about(std::string_view text) {
  const auto schema = ros2msg::Schema::parse("test/msg/Type", text, "schema");
  return schema ? "" : to_string(schema.errors());
}

/// "path=value path=value", then " !" if the decoder gave up.
std::string decode(std::string_view schema_text, const CdrWriter& payload) {
  ros2msg::Decoder decoder(parse(schema_text));
  std::ostringstream out;
  const bool ok = decoder.decode(payload.bytes(), [&](const ros2msg::Value& value) {
    using Kind = ros2msg::Value::Kind;
    out << value.path << '=';
    switch (value.kind) {
      case Kind::signed_integer: out << value.integer; break;
      case Kind::unsigned_integer: out << value.unsigned_integer; break;
      case Kind::boolean: out << (value.unsigned_integer != 0 ? "true" : "false"); break;
      case Kind::floating: out << value.number; break;
      case Kind::text: out << '"' << value.text << '"'; break;
      case Kind::blob: out << value.blob.size() << " bytes"; break;
    }
    out << ' ';
  });
  out << (ok ? "" : "!");
  return out.str();
}

constexpr std::string_view nested = R"(# A comment
Pair[2] pairs
Header header   # std_msgs/Header
other/Deep deep
====================
MSG: test/Pair
int8 a
uint16 b
====================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
====================
MSG: other/Deep
bool yes
)";

TEST(Ros2msg, TakesADefinitionThatIsRepeatedAlike) {
  EXPECT_EQ(complaint_about("A a\n===\nMSG: test/A\nbool x\n===\nMSG: test/A\nbool x # again\n"), "");
}

/// The fields of an event of a service, with their types' names.
std::string fields_of_event(std::string_view text) {
  const auto schema = ros2msg::Schema::parse("test/srv/Sum_Event", text, "schema");
  if (!schema) return to_string(schema.errors());
  std::string fields;
  for (const ros2msg::Definition& definition : schema->definitions)
    for (const ros2msg::FieldDefinition& field : definition.fields) fields += definition.name + "/" + field.name + " ";
  return fields;
}

TEST(Ros2msg, TakesTheEventsOfAServiceInBothForms) {
  const std::string fields =
      "test/srv/Sum_Event/info test/srv/Sum_Event/request test/srv/Sum_Event/response test/srv/Sum_Request/a "
      "test/srv/Sum_Request/b test/srv/Sum_Response/sum service_msgs/ServiceEventInfo/event_type "
      "service_msgs/ServiceEventInfo/stamp service_msgs/ServiceEventInfo/client_gid "
      "service_msgs/ServiceEventInfo/sequence_number builtin_interfaces/Time/sec builtin_interfaces/Time/nanosec ";
  EXPECT_EQ(fields_of_event("int64 a\nint64 b\n---\nint64 sum\n"), fields);
  EXPECT_EQ(fields_of_event("=====\nSRV: test/srv/Sum\nint64 a\nint64 b\n---\nint64 sum\n"), fields);
}

TEST(Ros2msg, GivesAnEmptyRequestItsByte) {
  EXPECT_THAT(fields_of_event("---\nA a\n===\nMSG: test/A\nbool x\n"),
              HasSubstr("test/srv/Sum_Request/structure_needs_at_least_one_member test/srv/Sum_Response/a"));
}

}  // namespace

TEST(Ros2msg, ParsesShapesAndBounds) {
  const auto fields =
      parse("int32 a\nfloat64[] b\nuint8[3] c\nint16[<=5] d\nstring<=7 e\nstring<=7[<=2] f\n").definitions[0].fields;
  ASSERT_EQ(fields.size(), 6u);
  EXPECT_EQ(fields[0].type.shape, FieldType::Shape::single);
  EXPECT_EQ(fields[1].type.shape, FieldType::Shape::sequence);
  EXPECT_EQ(fields[1].type.count, 0u);
  EXPECT_EQ(fields[2].type.shape, FieldType::Shape::array);
  EXPECT_EQ(fields[2].type.count, 3u);
  EXPECT_EQ(fields[3].type.shape, FieldType::Shape::sequence);
  EXPECT_EQ(fields[3].type.count, 5u);
  EXPECT_EQ(fields[4].type.string_bound, 7u);
  EXPECT_EQ(fields[5].type.count, 2u);
  EXPECT_EQ(fields[5].type.string_bound, 7u);
}

TEST(Ros2msg, ParsesConstants) {
  const auto constants = parse("uint8 INT8=1\nint32 X = -123 # why\nstring S=\"a # b\"\n").definitions[0].constants;
  ASSERT_EQ(constants.size(), 3u);
  EXPECT_EQ(constants[0].name, "INT8");
  EXPECT_EQ(constants[1].value, "-123");
  EXPECT_EQ(constants[2].value, "a # b");
}

TEST(Ros2msg, ParsesDefaults) {
  const auto fields = parse("uint8 x 42\nint16[] y [1, 2]\nstring s 'it # is'\n").definitions[0].fields;
  EXPECT_EQ(fields[0].default_value, "42");
  EXPECT_EQ(fields[1].default_value, "[1, 2]");
  EXPECT_EQ(fields[2].default_value, "'it # is'");
}

TEST(Ros2msg, TakesBothFormsOfATypeName) {
  const auto schema = ros2msg::Schema::parse("test/Type", "other/msg/A a\n===\nMSG: other/A\nbool x\n");
  ASSERT_TRUE(schema);
  EXPECT_EQ(schema->definitions[1].name, "other/A");
}

TEST(Ros2msg, KnowsTimeWithoutItsDefinition) {
  CdrWriter payload;
  payload.put(std::int32_t{-1});
  payload.put(std::uint32_t{2});
  EXPECT_EQ(decode("builtin_interfaces/Time t\n", payload), "t/sec=-1 t/nanosec=2 ");
}

TEST(Ros2msg, DecodesNestedMessages) {
  CdrWriter payload;
  for (const int i : {1, 2}) {
    payload.put(static_cast<std::int8_t>(-i));
    payload.put(static_cast<std::uint16_t>(i));
  }
  payload.put(std::int32_t{3});
  payload.put(std::uint32_t{4});
  payload.put(std::string_view("map"));
  payload.put(true);
  EXPECT_EQ(decode(nested, payload),
            "pairs/0/a=-1 pairs/0/b=1 pairs/1/a=-2 pairs/1/b=2 header/stamp/sec=3 header/stamp/nanosec=4 "
            "header/frame_id=\"map\" deep/yes=true ");
}

TEST(Ros2msg, DecodesEveryPrimitive) {
  CdrWriter payload;
  payload.put(true);
  payload.put(std::int8_t{-8});
  payload.put(std::uint8_t{200});
  payload.put(std::int16_t{-16});
  payload.put(std::uint16_t{16});
  payload.put(std::int32_t{-32});
  payload.put(std::uint32_t{32});
  payload.put(std::int64_t{-64});
  payload.put(~std::uint64_t{0});
  payload.put(0.5f);
  payload.put(0.25);
  payload.put(std::string_view("s"));
  EXPECT_EQ(decode("bool a\nint8 b\nuint8 c\nint16 d\nuint16 e\nint32 f\nuint32 g\nint64 h\nuint64 i\nfloat32 j\n"
                   "float64 k\nstring l\n",
                   payload),
            "a=true b=-8 c=200 d=-16 e=16 f=-32 g=32 h=-64 i=18446744073709551615 j=0.5 k=0.25 l=\"s\" ");
}

TEST(Ros2msg, DecodesByteArraysAsOneBlob) {
  CdrWriter payload;
  payload.put(std::uint32_t{3});
  for (const std::uint8_t byte : {1, 2, 3, 4, 5}) payload.put(byte);
  EXPECT_EQ(decode("byte[] a\nuint8[2] b\n", payload), "a=3 bytes b=2 bytes ");
}

TEST(Ros2msg, ReadsTheByteOfAnEmptyMessage) {
  CdrWriter payload;
  payload.put(std::uint8_t{0});
  payload.put(std::uint8_t{7});
  EXPECT_EQ(decode("Empty e\nuint8 x\n===\nMSG: test/Empty\nint32 ONLY_A_CONSTANT=1\n", payload), "x=7 ");
}

TEST(Ros2msg, KnowsHeaderAndDurationWithoutTheirDefinitions) {
  CdrWriter payload;
  payload.put(std::int32_t{1});
  payload.put(std::uint32_t{2});
  payload.put(std::string_view("map"));
  payload.put(std::int32_t{-3});
  payload.put(std::uint32_t{4});
  EXPECT_EQ(decode("std_msgs/Header header\nbuiltin_interfaces/msg/Duration d\n", payload),
            "header/stamp/sec=1 header/stamp/nanosec=2 header/frame_id=\"map\" d/sec=-3 d/nanosec=4 ");
}

TEST(Ros2msg, PrefersTheHeaderOfItsOwnPackage) {
  CdrWriter payload;
  payload.put(std::uint8_t{7});
  EXPECT_EQ(decode("Header h\n=\nMSG: test/Header\nuint8 x\n==\nMSG: std_msgs/Header\nstring y\n", payload), "h/x=7 ");
}

TEST(Ros2msg, TakesOtherPeoplesLineEndsBlanksAndComments) {
  CdrWriter payload;
  payload.put(std::uint8_t{65});
  payload.put(std::uint8_t{2});
  payload.put(std::string_view("x"));
  EXPECT_EQ(decode("\r\n# first\r\n\tchar  c\t# a # b\r\nbyte b 0x02\r\nstring s don't # it's a comment\r\n", payload),
            "c=65 b=2 s=\"x\" ");
}

TEST(Ros2msg, DecodesVersion2WithTheSizesOfItsArrays) {
  // float64 at 4; two strings behind their size of 4 + 4 + 2 + padding 2 + 4 + 2 bytes
  const std::uint8_t bytes[] = {0,  7, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0,   0, 0xf0, 0x3f,  //
                                18, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 'a', 0, 0,    0,    2, 0, 0, 0, 'b', 0};
  std::vector<std::string> seen;
  ros2msg::Decoder decoder(parse("uint8 x\nfloat64 y\nstring[] s\n"));
  EXPECT_TRUE(decoder.decode(std::as_bytes(std::span(bytes)), [&](const ros2msg::Value& value) {
    seen.push_back(value.kind == ros2msg::Value::Kind::text ? std::string(value.text) : std::to_string(value.number));
  })) << decoder.problem();
  EXPECT_THAT(seen, testing::ElementsAre("0.000000", "1.000000", "a", "b"));
}

TEST(Ros2msg, SaysWhyItGivesUp) {
  const auto problem = [](std::string_view schema, std::vector<std::uint8_t> bytes) {
    ros2msg::Decoder decoder(parse(schema));
    EXPECT_FALSE(decoder.decode(std::as_bytes(std::span(bytes)), [](const ros2msg::Value&) {}));
    return decoder.problem();
  };
  EXPECT_EQ(problem("uint32 a\n", {0, 1, 0}), "isn't CDR: it has 3 bytes, fewer than the four of the encapsulation");
  EXPECT_EQ(problem("uint32 a\n", {'{', '}', 0, 0}), "isn't CDR: it begins with 0x7b7d");
  EXPECT_THAT(problem("uint32 a\n", {0, 3, 0, 0}), HasSubstr("a type that may change"));
  EXPECT_EQ(problem("uint8[] n\nPair[2] p\n===\nMSG: test/Pair\nuint8 a\nuint32 b\n",
                    {0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3}),
            "ends at byte 17, within p/1/b");
  EXPECT_EQ(problem("int8[<=1] a\n", {0, 1, 0, 0, 2, 0, 0, 0, 1, 2}),
            "breaks its schema: a has 2 elements of at most 1");
}

TEST(Ros2msg, IsNotKeptBusyByEmptyMessagesThatAreNotThere) {
  CdrWriter payload;
  EXPECT_EQ(decode("Empty[4000000000] e\n===\nMSG: test/Empty\n", payload), "!");
}

TEST(Ros2msg, ChecksDefaultsAgainstTheirTypes) {
  EXPECT_THAT(complaint_about("bool a\nuint8 b 256\n"),
              HasSubstr("schema:2: error: field b: the default '256' is no uint8"));
  EXPECT_THAT(complaint_about("int8 a -129\n"), HasSubstr("is no int8"));
  EXPECT_THAT(complaint_about("uint64 a -1\n"), HasSubstr("is no uint64"));
  EXPECT_THAT(complaint_about("bool a yes\n"), HasSubstr("is no bool"));
  EXPECT_THAT(complaint_about("float64 a 1,5\n"), HasSubstr("is no float64"));
  EXPECT_THAT(complaint_about("int32[2] a [1]\n"), HasSubstr("has 1 elements and should have 2"));
  EXPECT_THAT(complaint_about("int32[<=2] a [1, 2, 3]\n"), HasSubstr("has 3 elements of at most 2"));
  EXPECT_THAT(complaint_about("int32[] a [1, x]\n"), HasSubstr("'x' is no int32"));
  EXPECT_THAT(complaint_about("int32[] a 1\n"), HasSubstr("is no list in brackets"));
  EXPECT_THAT(complaint_about("string<=3 a \"four\"\n"), HasSubstr("4 characters of at most 3"));
  EXPECT_THAT(complaint_about("A a 1\n===\nMSG: test/A\n"), HasSubstr("a message has no default"));
  EXPECT_EQ(
      complaint_about("bool a true\nint64 b -9223372036854775808\nuint64 c 18446744073709551615\nfloat32 d -.5e3\n"
                      "int8[] e []\nstring[<=2] f [\"a,b\", 'c']\nfloat64[2] g [1, +2.5]\nint8 h -0x80\n"),
      "");
}

TEST(Ros2msg, ChecksConstantsAgainstTheirTypes) {
  EXPECT_THAT(complaint_about("uint8 X=-1\n"), HasSubstr("schema:1: error: constant X: the value '-1' is no uint8"));
  EXPECT_THAT(complaint_about("int32 X=1.5\n"), HasSubstr("is no int32"));
  EXPECT_THAT(complaint_about("int32 X=1\nint32 X=2\n"), HasSubstr("schema:2: error: constant X is declared twice"));
  EXPECT_EQ(parse("string S=it's a text\n").definitions[0].constants[0].value, "it's a text");
}

TEST(Ros2msg, GivesUpWhenABoundIsBroken) {
  CdrWriter sequence, text;
  sequence.put_sequence(std::span<const std::int16_t>(std::array<std::int16_t, 3>{1, 2, 3}));
  text.put(std::string_view("four"));
  EXPECT_EQ(decode("int16[<=2] x\n", sequence), "!");
  EXPECT_EQ(decode("string<=3 x\n", text), "!");
}

TEST(Ros2msg, DeliversWhatIsThereAndGivesUpAtTheEnd) {
  CdrWriter payload;
  payload.put(std::uint8_t{1});
  EXPECT_EQ(decode("uint8 a\nuint32 b\n", payload), "a=1 !");
}

TEST(Ros2msg, GivesUpOnACountThatCannotBe) {
  CdrWriter payload;
  payload.put(std::uint32_t{0x7fffffff});
  EXPECT_EQ(decode("float64[] a\n", payload), "!");
}

TEST(Ros2msg, NamesTheLineOfAnUnknownType) {
  EXPECT_EQ(complaint_about("bool a\n\nMystery b\n"), "schema:3: error: type Mystery is used but not defined\n");
}

TEST(Ros2msg, NamesTheLineOfATypeThatContainsItself) {
  EXPECT_EQ(complaint_about("A a\n===\nMSG: test/A\nbool x\nB[] b\n===\nMSG: test/B\nA a\n"),
            "schema:8: error: type test/A contains itself\n");
}

TEST(Ros2msg, RefusesWhatIsNoFieldAndNoConstant) {
  EXPECT_THAT(complaint_about("bool\n"), HasSubstr("schema:1: error: \"bool\" is neither a field nor a constant"));
  EXPECT_THAT(complaint_about("bool 1a\n"), HasSubstr("neither a field nor a constant"));
  EXPECT_THAT(complaint_about("bool a-b\n"), HasSubstr("no name for a field"));
  EXPECT_THAT(complaint_about("int32[x] a\n"), HasSubstr("\"int32[x]\" is no type"));
  EXPECT_THAT(complaint_about("int32[0] a\n"), HasSubstr("is no type"));
  EXPECT_THAT(complaint_about("int32] a\n"), HasSubstr("is no type"));
  EXPECT_THAT(complaint_about("string<=x a\n"), HasSubstr("is no type"));
  EXPECT_THAT(complaint_about("wstring a\n"), HasSubstr("type wstring can't be decoded"));
}

TEST(Ros2msg, RefusesNamesThatComeTwice) {
  EXPECT_THAT(complaint_about("bool a\nint8 a\n"), HasSubstr("schema:2: error: field a is declared twice"));
  EXPECT_THAT(complaint_about("A a\n===\nMSG: test/A\nbool x\n===\nMSG: test/A\nint8 x\n"),
              HasSubstr("type test/A is defined twice, differently"));
}

TEST(Ros2msg, RefusesConstantsThatAreNone) {
  EXPECT_THAT(complaint_about("int32[] X=1\n"), HasSubstr("constant X can't be of type int32[]"));
  EXPECT_THAT(complaint_about("int32 X=\n"), HasSubstr("constant X has no value"));
}

TEST(Ros2msg, MissesTheHeadingAfterASeparator) {
  EXPECT_THAT(complaint_about("bool a\n===\nbool b\n"),
              HasSubstr("schema:3: error: no line \"MSG: package/Name\" follows"));
  EXPECT_THAT(complaint_about("bool a\n===\n"), HasSubstr("the text ends before the expected line"));
}

TEST(Ros2msg, SaysAllMistakesInOneGo) {
  const auto schema = ros2msg::Schema::parse("a/A", "X a\nY b\nbool\n");
  ASSERT_FALSE(schema);
  EXPECT_EQ(schema.errors().size(), 3u);
}

TEST(Ros2msg, RefusesTypesThatAreNestedTooDeep) {
  std::string text = "T0 a\n";
  for (int i = 0; i < 500; ++i) {
    text += "===\nMSG: test/T" + std::to_string(i) + "\nT" + std::to_string(i + 1) + " a\n";
  }
  text += "===\nMSG: test/T500\nbool x\n";
  EXPECT_THAT(complaint_about(text), HasSubstr("nested more than 64 deep"));
}
