// rehearse info of files of other programs: large files, files from a pipe, files with payloads that aren't text.
#include "../harness/bag/ros1_files.h"
#include "../harness/mcap/large_file.h"
#include "command.h"

#include <gmock/gmock.h>
#include <rehearse/mcap.h>
#include <unistd.h>

namespace rehearse::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class InfoOfAnyFile : public Command {
 protected:
  static mcap::Bytes bytes_of(std::string_view text) {
    return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
  }

  /// Two channels, three messages a second apart.
  void write_log(const std::string& name, std::uint64_t start, const std::string& topic = "/numbers") const {
    mcap::WriterOptions options;
    options.profile = "";
    options.library = "a robot's recorder";
    const auto writer = std::move(*mcap::Writer::create(folder() / name, options));
    const auto numbers = writer->add_channel(0, topic, "json");
    const auto pictures = writer->add_channel(0, "/pictures", "png", {}, mcap::pictures);
    ASSERT_TRUE(writer->add_metadata(topic, {{topic, topic}}));
    ASSERT_TRUE(writer->write(numbers, start, start, bytes_of("{}")));
    ASSERT_TRUE(writer->write(pictures, start + 1'000'000'000, start, bytes_of("png")));
    ASSERT_TRUE(writer->write(numbers, start + 2'000'000'000, start, bytes_of("{}")));
    ASSERT_TRUE(writer->close());
  }
};

TEST_F(InfoOfAnyFile, TellsADateOfWallClockTime) {
  write_log("log.mcap", 1'714'566'896'123'456'789);
  const std::string text = done({"info", "log.mcap"}).out;
  EXPECT_THAT(text, HasSubstr("\nlibrary      a robot's recorder\nprofile      none\nmessages     3 in 2 channels\n"
                              "duration     2 s\nstart        2024-05-01 12:34:56.123456789 UTC\n"
                              "end          2024-05-01 12:34:58.123456789 UTC\n"));
  EXPECT_THAT(text, ContainsRegex("\ncompression  none: 1 chunk, .*\n             zstd: 2 chunks, "));
}

TEST_F(InfoOfAnyFile, TellsDefinitionsIfItIsAsked) {
  auto writer = std::move(*mcap::Writer::create(folder() / "some.mcap"));
  writer->add_channel(writer->add_schema("a/msg/B", "ros2msg", "int32 x\nint32 y"), "/b", "cdr");
  writer->add_channel(writer->add_schema("a.C", "protobuf", std::string("\x0a\0", 2)), "/c", "protobuf");
  writer->add_channel(writer->add_schema("a/msg/D", "", ""), "/d", "cdr");
  ASSERT_TRUE(writer->close());
  const std::string text = done({"info", "some.mcap", "--schemas"}).out;
  EXPECT_THAT(text, HasSubstr("\nschema a/msg/B of encoding ros2msg\n    int32 x\n    int32 y\n"));
  EXPECT_THAT(text, HasSubstr("\nschema a.C of encoding protobuf\n    2 bytes\n"));
  EXPECT_THAT(text, HasSubstr("\nschema a/msg/D of no encoding\n"));
  EXPECT_THAT(done({"info", "some.mcap"}).out, Not(HasSubstr("int32 x")));
}

/// Tables, definitions, differences and messages of a bag of ROS 1.
TEST_F(InfoOfAnyFile, AndOtherVerbsReadABagOfRos1) {
  for (const auto& [name, last] : {std::pair("a.bag", 0.5), {"b.bag", 0.75}}) {
    const std::string records = ros1::connection(3, "/joints") + ros1::message(3, 0, 0.25) + ros1::message(3, 1, last);
    std::ofstream(folder() / name, std::ios::binary) << ros1::header() << ros1::chunk_of(records, "none", records);
  }
  EXPECT_THAT(done({"info", "a.bag", "--schemas"}).out,
              AllOf(HasSubstr("form         bag of ROS 1 (version 2.0)\n"), HasSubstr("profile      ros1\n"),
                    HasSubstr("schema sensor_msgs/JointState of encoding ros1msg\n    Header header\n")));
  EXPECT_THAT(done({"cat", "a.bag"}).out, HasSubstr(R"(frame_id="base"} name=["KNEE"] position=[0.25])"));
  EXPECT_THAT(done({"doctor", "a.bag"}).out, HasSubstr("no findings"));
  done({"export", "a.bag", "-o", "tables"});
  EXPECT_THAT(read_file(folder() / "tables/joints.csv"), HasSubstr("0.5"));
  const Outcome differ = rehearse({"diff", "a.bag", "b.bag"});
  EXPECT_EQ(differ.status, 1);
  EXPECT_THAT(differ.out, HasSubstr("/joints position/0 is 0.75, expected 0.5"));
  done({"filter", "a.bag", "-o", "a.mcap"});
  EXPECT_EQ(rehearse({"diff", "a.bag", "a.mcap"}).status, 0);
}

TEST_F(InfoOfAnyFile, TellsAProgramOfChunks) {
  write_log("log.mcap", 0);
  const nlohmann::json info = done({"info", "log.mcap", "--json"}).json();
  EXPECT_EQ(info["read"], "all");
  EXPECT_EQ(info["begin_ns"], 0);
  EXPECT_EQ(info["end_ns"], 2'000'000'000);
  ASSERT_EQ(info["compression"].size(), 2u);
  EXPECT_EQ(info["compression"][0]["compression"], "none");
  EXPECT_EQ(info["compression"][0]["stored_bytes"], info["compression"][0]["bytes"]);
  EXPECT_EQ(info["compression"][1]["chunks"], 2) << "a second apart";
}

TEST_F(InfoOfAnyFile, ReadsStandardInput) {
  write_log("log.mcap", 0);
  for (const char* from : {"cat log.mcap |", "< log.mcap"}) {
    const Outcome outcome = run("/bin/sh", {"-c", std::string(from) + " " + quoted(command.string()) + " info -"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("file         standard input\n"));
    EXPECT_THAT(outcome.out, HasSubstr("messages     3 in 2 channels\n"));
  }
}

TEST_F(InfoOfAnyFile, TextOfAFileSteersNoTerminalAndBreaksNoJson) {
  write_log("log.mcap", 0, "/\xff\x1b[2J\xc3\x28\n!");
  const std::string text = done({"info", "log.mcap"}).out;
  EXPECT_THAT(text, HasSubstr("  /\\xff\\x1b[2J\\xc3(\\x0a!  "));
  EXPECT_THAT(text, HasSubstr("(\\x0a!: /\\xff\\x1b[2J\\xc3(\n    !\n")) << "values may have lines";
  const nlohmann::json info = done({"info", "log.mcap", "--json"}).json();
  EXPECT_EQ(info["channels"][0]["topic"], "/\xef\xbf\xbd\x1b[2J\xef\xbf\xbd(\n!");
}

/// The content of an indexed file is known from its end: neither time nor memory grows with the messages.
TEST_F(InfoOfAnyFile, MakesNoPassOverALargeFile) {
  LargeFile large(folder() / "large.mcap", 10'000'000'000);
  ASSERT_TRUE(large.ok()) << "no room for it in " << folder();
  const Outcome outcome = rehearse({"info", "large.mcap"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("size         10.0 GB\n"));
  EXPECT_THAT(outcome.out, HasSubstr("messages     " + std::to_string(large.messages()) + " in 30 channels\n"));
  EXPECT_THAT(outcome.out, HasSubstr("from the file's summary; --full reads the whole file"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("payload ")));
  const nlohmann::json info = done({"info", "large.mcap", "--json"}).json();
  EXPECT_EQ(info["read"], "summary");
  EXPECT_EQ(info["messages"], large.messages());
  EXPECT_EQ(info["channels"][29]["messages"], large.messages() / 30);
  EXPECT_TRUE(info["channels"][29]["bytes"].is_null() && info["events"].is_null());
#if !defined(__SANITIZE_ADDRESS__)
  EXPECT_LT(memory_of({"info", "large.mcap"}), 20'000) << "kB; pages of the file count";
#endif
}

}  // namespace
}  // namespace rehearse::test
