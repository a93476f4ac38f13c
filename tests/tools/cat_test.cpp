// rehearse cat: messages of any file, one per line.
#include <gmock/gmock.h>

#include "command.h"
#include "mixed_file.h"

namespace rehearse::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class Cat : public Command {
 protected:
  Cat() { write_mixed_file(folder() / "mixed.mcap"); }

  static std::vector<nlohmann::json> lines_of(const Outcome& outcome) {
    std::vector<nlohmann::json> lines;
    std::istringstream text(outcome.out);
    for (std::string line; std::getline(text, line);) {
      lines.push_back(nlohmann::json::parse(line, nullptr, false));
      EXPECT_FALSE(lines.back().is_discarded()) << line;
    }
    return lines;
  }
  std::vector<nlohmann::json> json(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "cat");
    arguments.push_back("--json");
    return lines_of(done(arguments));
  }
  static std::vector<std::string> topics(const std::vector<nlohmann::json>& lines) {
    std::vector<std::string> topics;
    for (const auto& line : lines) topics.push_back(line.at("topic"));
    return topics;
  }
  /// Runs the command in a shell, for pipes.
  Outcome shell(const std::string& line) const { return run("/bin/sh", {"-c", line}); }
};

TEST_F(Cat, PrintsAnObjectForEveryMessageInOrderOfTime) {
  const auto lines = json({"mixed.mcap"});
  EXPECT_THAT(topics(lines),
              ElementsAre("/joints", "/joints", "/proto", "/strange", "/short", "/bare", "/json", "/json", "/joints"));
  EXPECT_EQ(lines[0].at("log_time"), wall_clock);
  EXPECT_EQ(lines[0].at("publish_time"), wall_clock + 1);
  EXPECT_EQ(lines[1].at("sequence"), 1);
  EXPECT_EQ(lines[0].size(), 5u);
}

TEST_F(Cat, DecodesMessagesExactly) {
  const Outcome outcome = done({"cat", "mixed.mcap", "--json", "--topics", "/joints"});
  const auto lines = lines_of(outcome);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].at("message").dump(),
            R"({"effort":[],"header":{"frame_id":"base","stamp":{"nanosec":2,"sec":1}},"name":["KNEE","ANKLE"],)"
            R"("position":[0.0,-0.0],"velocity":[]})");
  EXPECT_EQ(lines[1].at("message").at("position")[0], 0.1);
  EXPECT_EQ(lines[2].at("message").at("position")[0], "NaN");
}

TEST_F(Cat, PassesJsonOnAndSaysWhereItIsNone) {
  const Outcome outcome = done({"cat", "mixed.mcap", "--json", "--topics", "/json"});
  EXPECT_THAT(outcome.out, HasSubstr(R"("message":{"a":[1,2.50,"x y"],"n":12345678901234567890}})"));
  EXPECT_EQ(lines_of(outcome)[1].at("error"), "the payload isn't JSON");
  EXPECT_EQ(lines_of(outcome)[1].at("data"), "e25vdCBqc29u");
}

TEST_F(Cat, GivesBytesOfWhatItDoesNotDecode) {
  const auto lines = json({"mixed.mcap", "--topics", "/proto", "/strange", "/short", "/bare"});
  EXPECT_EQ(lines[0].at("data"), "//4=");
  EXPECT_EQ(lines[0].at("encoding"), "protobuf");
  EXPECT_EQ(lines[0].at("schema"), "foo.Bar");
  EXPECT_THAT(lines[0].at("error"), HasSubstr("schema foo.Bar: error: the schema isn't a FileDescriptorSet of protobuf"));
  EXPECT_EQ(lines[1].at("data"), "AAEAAAc=");
  EXPECT_THAT(lines[1].at("error"), HasSubstr("schema a/msg/B:1: error: type Unknown is used but not defined"));
  EXPECT_EQ(lines[2].at("error"), "the payload ends at byte 8, within header/stamp/nanosec");
  EXPECT_EQ(lines[3].at("data"), "");
  EXPECT_EQ(lines[3].at("schema"), nullptr);
}

TEST_F(Cat, TellsPeopleTheFieldsInALine) {
  const std::string text = done({"cat", "mixed.mcap"}).out;
  EXPECT_THAT(text, StartsWith(R"(1700000000.123456789 /joints header={stamp={sec=1 nanosec=2} frame_id="base"} )"
                               R"(name=["KNEE" "ANKLE"] position=[0.0 -0.0] velocity=[] effort=[])"
                               "\n"));
  EXPECT_THAT(text, HasSubstr("/proto (2 bytes of encoding \"protobuf\": schema foo.Bar: error: the schema isn't a "
                              "FileDescriptorSet of protobuf)\n"));
  EXPECT_THAT(text, HasSubstr("/short (8 bytes of encoding \"cdr\": the payload ends at byte 8"));
}

TEST_F(Cat, ChoosesByTopicTimeAndNumber) {
  EXPECT_THAT(topics(json({"mixed.mcap", "--topics", "/j*"})),
              ElementsAre("/joints", "/joints", "/json", "/json", "/joints"));
  EXPECT_THAT(topics(json({"--topics", "/proto", "/bare", "--", "mixed.mcap"})), ElementsAre("/proto", "/bare"));
  EXPECT_THAT(topics(json({"mixed.mcap", "--from", "+0.0011", "--until", "+0.0013"})),
              ElementsAre("/proto", "/strange"));
  EXPECT_THAT(topics(json({"mixed.mcap", "--from", "1700000000.125456789"})), ElementsAre("/joints"));
  EXPECT_THAT(topics(json({"mixed.mcap", "--limit", "2"})), ElementsAre("/joints", "/joints"));
  EXPECT_THAT(topics(json({"mixed.mcap", "--from", "0.0011", "--until", "0.0013"})), ElementsAre("/proto", "/strange"));
  EXPECT_THAT(topics(json({"mixed.mcap", "--from", "2023-11-14T22:13:20.125456789Z"})), ElementsAre("/joints"));
  for (const char* late : {"5", "2023-11-15T00:00:00Z"})
    EXPECT_THAT(rehearse({"cat", "mixed.mcap", "--from", late}).err, HasSubstr("nothing was recorded in the span"))
        << late;
}

TEST_F(Cat, ReadsFromAPipe) {
  const Outcome outcome = shell("cat mixed.mcap | " + command.string() + " cat - --json --topics '/j*'");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(topics(lines_of(outcome)), ElementsAre("/joints", "/joints", "/json", "/json", "/joints"));
}

TEST_F(Cat, EndsQuietlyWhenNobodyReadsOn) {
  auto writer = std::move(*mcap::Writer::create(folder() / "long.mcap"));
  TopicWriter topic(*writer, "/a", "json");
  for (std::uint64_t i = 0; i < 100'000; ++i) topic.raw(i, bytes_of("{\"some\":\"text\"}"));
  ASSERT_TRUE(writer->close());
  const Outcome outcome = shell(command.string() + " cat long.mcap --json | head -2");
  EXPECT_EQ(lines_of(outcome).size(), 2u);
  EXPECT_EQ(outcome.err, "");
  const Outcome ignored = shell("trap '' PIPE; (" + command.string() + " cat long.mcap; echo $? >&2) | head -1");
  EXPECT_EQ(ignored.err, "141\n") << "a program that ignores the signal passes that on";
}

TEST_F(Cat, PassesNumbersOfJsonBeyondTheRangeOfADouble) {
  {
    auto writer = std::move(*mcap::Writer::create(folder() / "large.mcap"));
    TopicWriter json(*writer, "/json", "json", 0);
    json.raw(0, bytes_of("{\"a\": [1e400, -1.5E+4000], \"b\": \"1e400 x\"}"));
    json.raw(1, bytes_of("[0001e400]"));
    ASSERT_TRUE(writer->close());
  }
  const Outcome outcome = done({"cat", "large.mcap", "--json"});
  EXPECT_THAT(outcome.out, HasSubstr(R"("message":{"a":[1e400,-1.5E+4000],"b":"1e400 x"}})"));
  EXPECT_THAT(outcome.out, HasSubstr(R"("error":"the payload isn't JSON")"));
}

TEST_F(Cat, SaysThatADiskIsFull) {
  const Outcome outcome = shell(command.string() + " cat mixed.mcap > /dev/full");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("can't write to stdout: No space left on device"));
}

TEST_F(Cat, DeliversWhatIsWholeOfADamagedFileAndEndsIn2) {
  std::string bytes = read_file(folder() / "mixed.mcap");
  write("cut.mcap", bytes.substr(0, bytes.size() - 20));
  const Outcome outcome = rehearse({"cat", "cut.mcap", "--json"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(lines_of(outcome).size(), 9u);
  EXPECT_THAT(outcome.err, HasSubstr("cut.mcap: error: "));
}

TEST_F(Cat, RefusesBadUsage) {
  const auto refusal = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"cat", "mixed.mcap"});
    const Outcome outcome = rehearse(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.out, "");
    return outcome.err;
  };
  EXPECT_THAT(refusal({"--topics", "/nothing*"}), HasSubstr("no topic matches '/nothing*'"));
  EXPECT_THAT(refusal({"--from", "soon"}), HasSubstr("--from: 'soon' is no time"));
  EXPECT_THAT(refusal({"--ticks", "9..3"}), HasSubstr("--ticks: '9..3' is no span of ticks"));
  EXPECT_THAT(refusal({"--ticks", "1..3"}), HasSubstr("it has no ticks"));
  EXPECT_THAT(refusal({"--limit", "0"}), HasSubstr("--limit"));
  EXPECT_EQ(rehearse({"cat", "nowhere.mcap"}).status, 2);
  EXPECT_THAT(shell("cat mixed.mcap | " + command.string() + " cat - --ticks 1..2").err, HasSubstr("it has no ticks"));
}

}  // namespace
}  // namespace rehearse::test
