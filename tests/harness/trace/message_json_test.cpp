#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/trace/message_json.h"

using namespace rehearse;
using testing::HasSubstr;

namespace {

ros2msg::Decoder decoder_of(std::string_view schema) {
  return ros2msg::Decoder(std::move(*ros2msg::Schema::parse("test/msg/Type", schema)));
}

std::string json(std::string_view schema, const CdrWriter& payload) {
  auto decoder = decoder_of(schema);
  const auto text = ros2msg::to_json(decoder, payload.bytes());
  return text ? *text : text.errors()[0].message;
}

std::string line(std::string_view schema, const CdrWriter& payload) {
  auto decoder = decoder_of(schema);
  const auto text = ros2msg::to_line(decoder, payload.bytes());
  return text ? *text : text.errors()[0].message;
}

std::string json_of(double number) {
  std::string text;
  append_json(text, number);
  return text;
}

std::string json_of(std::string_view string) {
  std::string text;
  append_json(text, string);
  return text;
}

std::string base64_of(std::string_view bytes) {
  std::string text;
  append_base64(text, std::as_bytes(std::span(bytes.data(), bytes.size())));
  return text;
}

}  // namespace

TEST(MessageJson, NestsAsTheSchemaDoes) {
  CdrWriter cdr;
  msg::encode(msg::TFMessage{{{{{1, 2}, "WORLD"}, "WAIST", {{1, 2, 3}, {0, 0, 0, 1}}}}}, cdr);
  EXPECT_EQ(json(msg::schema_text<msg::TFMessage>(), cdr),
            R"({"transforms":[{"header":{"stamp":{"sec":1,"nanosec":2},"frame_id":"WORLD"},"child_frame_id":"WAIST",)"
            R"("transform":{"translation":{"x":1.0,"y":2.0,"z":3.0},"rotation":{"x":0.0,"y":0.0,"z":0.0,"w":1.0}}}]})");
}

TEST(MessageJson, KeepsEmptyArraysAndMessages) {
  CdrWriter cdr;
  cdr.put(std::uint8_t{0});
  cdr.put(std::uint32_t{0});
  cdr.put(std::uint32_t{0});
  EXPECT_EQ(json("Empty e\nfloat64[] a\nEmpty[] b\n===\nMSG: test/Empty\n", cdr), R"({"e":{},"a":[],"b":[]})");
  EXPECT_EQ(json("", CdrWriter()), "the payload ends at byte 4");
}

TEST(MessageJson, WritesIntegersInFull) {
  CdrWriter cdr;
  cdr.put(std::numeric_limits<std::int64_t>::min());
  cdr.put(std::numeric_limits<std::uint64_t>::max());
  cdr.put(true);
  EXPECT_EQ(json("int64 a\nuint64 b\nbool c\n", cdr),
            R"({"a":-9223372036854775808,"b":18446744073709551615,"c":true})");
}

TEST(MessageJson, WritesNumbersSoThatTheSameBitsAreRead) {
  for (const double number : {0.1, -0.0, 0.0, 1.0, 1e23, 5e-324, 1.7976931348623157e308, 1.0 / 3.0, 123456789.0,
                              static_cast<double>(0.1f), 4503599627370497.5}) {
    const auto read = nlohmann::json::parse(json_of(number));
    EXPECT_TRUE(read.is_number_float()) << json_of(number);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read.get<double>()), std::bit_cast<std::uint64_t>(number))
        << json_of(number);
  }
  EXPECT_EQ(json_of(-0.0), "-0.0");
  EXPECT_EQ(json_of(1e23), "1e+23");
  EXPECT_EQ(json_of(std::numeric_limits<double>::quiet_NaN()), "\"NaN\"");
  EXPECT_EQ(json_of(std::numeric_limits<double>::infinity()), "\"Infinity\"");
  EXPECT_EQ(json_of(-std::numeric_limits<double>::infinity()), "\"-Infinity\"");
  CdrWriter cdr;
  cdr.put(0.1f);
  EXPECT_EQ(json("float32 a\n", cdr), R"({"a":0.10000000149011612})");
}

TEST(MessageJson, WritesBytesInBase64) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64_of("\xff\xfe\xfd"), "//79");
  CdrWriter cdr;
  cdr.put_sequence(std::span<const std::uint8_t>(std::array<std::uint8_t, 2>{1, 2}));
  cdr.put_array(std::span<const std::int8_t>(std::array<std::int8_t, 2>{-1, 2}));
  EXPECT_EQ(json("byte[] a\nint8[2] b\n", cdr), R"({"a":"AQI=","b":[-1,2]})");
}

TEST(MessageJson, EscapesText) {
  EXPECT_EQ(json_of("a \"b\" \\ / \n\t\r\x01\x7f"), R"("a \"b\" \\ / \n\t\r\u0001\u007f")");
  EXPECT_EQ(json_of("höher 漢 🤖"), "\"höher 漢 🤖\"");
  EXPECT_EQ(json_of(std::string_view("a\0b", 3)), R"("a\u0000b")");
}

TEST(MessageJson, ReplacesWhatIsNotUtf8) {
  const std::string replaced = "\xef\xbf\xbd";
  EXPECT_EQ(json_of("a\xff"
                    "b"),
            "\"a" + replaced + "b\"");
  EXPECT_EQ(json_of("\xc3"), "\"" + replaced + "\"");                                // cut
  EXPECT_EQ(json_of("\xc0\xaf"), "\"" + replaced + replaced + "\"");                 // too long
  EXPECT_EQ(json_of("\xed\xa0\x80"), "\"" + replaced + replaced + replaced + "\"");  // half of a pair
  EXPECT_EQ(json_of("\xf4\x90\x80\x80").size(), 2 + 4 * replaced.size());            // beyond the last character
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const std::string text{static_cast<char>(first), static_cast<char>(second), 'x'};
      EXPECT_TRUE(nlohmann::json::accept(json_of(text))) << first << ' ' << second;
    }
  }
}

TEST(MessageJson, SaysWhereAPayloadEnds) {
  CdrWriter cdr;
  cdr.put(std::uint32_t{3});
  EXPECT_EQ(json("string a\n", cdr), "the payload ends at byte 8, within a");
}

TEST(MessageJson, StopsAtALimit) {
  CdrWriter cdr;
  cdr.put_sequence(std::span<const std::int8_t>(std::vector<std::int8_t>(10000, -100)));
  auto decoder = decoder_of("int8[] a\n");
  EXPECT_FALSE(ros2msg::to_json(decoder, cdr.bytes(), 1000));
  EXPECT_TRUE(ros2msg::to_json(decoder, cdr.bytes(), 100000));
}

TEST(MessageLine, ShowsFieldsAndTheBeginningOfArrays) {
  CdrWriter cdr;
  cdr.put_sequence(std::span<const std::uint8_t>(std::vector<std::uint8_t>(5000)));
  cdr.put_sequence(std::span<const std::int16_t>(std::vector<std::int16_t>(100, 7)));
  cdr.put(std::string_view("WAIST\x1b[31m"));
  EXPECT_EQ(line("uint8[] data\nint16[] x\nstring s\n", cdr),
            R"(data=(5000 bytes) x=[7 7 7 7 7 7 7 7 ... 100 in all] s="WAIST\u001b[31m")");
}

TEST(MessageLine, LeavesOutMessagesOfLongArraysWithAllThatIsInThem) {
  CdrWriter cdr;
  cdr.put(std::uint32_t{10});
  for (std::int8_t i = 0; i < 10; ++i) {
    cdr.put(std::int8_t{i});
    cdr.put_sequence(std::span<const std::int8_t>(std::vector<std::int8_t>(9, i)));
  }
  cdr.put(true);
  const std::string text = line("A[] a\nbool last\n===\nMSG: test/A\nint8 n\nint8[] more\n", cdr);
  EXPECT_THAT(text, testing::StartsWith("a=[{n=0 more=[0 0 0 0 0 0 0 0 ... 9 in all]} {n=1 "));
  EXPECT_THAT(text, testing::EndsWith("{n=7 more=[7 7 7 7 7 7 7 7 ... 9 in all]} ... 10 in all] last=true"));
}
