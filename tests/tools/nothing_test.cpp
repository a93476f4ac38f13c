// A comparison of nothing is not a success.
#include <gmock/gmock.h>
#include <rehearse/mcap.h>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

class NothingCompared : public Command {
 protected:
  /// A recording with one message, or none, on a channel.
  void file(const std::string& name, const std::string& topic, int messages) const {
    auto writer = *mcap::Writer::create(folder() / name);
    const std::uint16_t schema = writer->add_schema("std_msgs/msg/Float64", "ros2msg", "float64 data\n");
    const std::uint16_t channel = writer->add_channel(schema, topic, "cdr");
    std::vector<std::byte> payload(12);
    payload[1] = std::byte{1};
    for (int i = 0; i < messages; ++i) ASSERT_TRUE(writer->write(channel, 5, 5, payload));
    ASSERT_TRUE(writer->close());
  }
  void box(const std::string& rest) const {
    write("box.yaml",
          "rehearse: 1\nname: box\nduration: 0.02\n" + rest +
              "bodies:\n  - name: Box\n    box: {size: [0.2, 0.2, 0.2]}\n    mass: 1\n    position: [0, 0, 0.5]\n");
  }
};

TEST_F(NothingCompared, IsNoSuccessOfDiff) {
  file("a.mcap", "/a", 0);
  file("b.mcap", "/a", 0);
  const Outcome empty = rehearse({"diff", "a.mcap", "b.mcap"});
  EXPECT_EQ(empty.status, 2);
  EXPECT_THAT(empty.err, HasSubstr("nothing was compared"));
  file("a.mcap", "/a", 1);
  file("b.mcap", "/b", 1);
  EXPECT_NE(rehearse({"diff", "a.mcap", "b.mcap"}).status, 0) << "no channel in common";
  EXPECT_EQ(rehearse({"diff", "a.mcap", "a.mcap"}).status, 0);
}

TEST_F(NothingCompared, IsNoSuccessOfReplay) {
  sr1_without_cameras();
  ASSERT_EQ(rehearse({"record", "sr1.yaml", "-o", "a.mcap"}).status, 0);
  EXPECT_EQ(rehearse({"replay", "a.mcap"}).status, 0);
  const Outcome late = rehearse({"replay", "a.mcap", "--from", "100"});
  EXPECT_EQ(late.status, 2);
  EXPECT_THAT(late.err, HasSubstr("nothing was recorded in the span that is asked for"));
}

TEST_F(NothingCompared, IsNoSuccessOfCheck) {
  fs::create_directories(folder() / "golden");
  box("golden: Box.Falls\n");
  ASSERT_EQ(rehearse({"check", "box.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  EXPECT_EQ(rehearse({"check", "box.yaml"}).status, 0);
  const Outcome alone = rehearse({"check", "box.yaml", "--level", "controller"});
  EXPECT_EQ(alone.status, 2) << alone.out;
  EXPECT_THAT(alone.out, HasSubstr("nothing was compared"));
  EXPECT_EQ(rehearse({"check", "box.yaml", "--level", "controller", "--json"}).json()["within"], false);
}

TEST_F(NothingCompared, WithAGoldenOfANewerTraceVersionIsBadInput) {
  fs::create_directories(folder() / "golden");
  box("golden: Box.Falls\n");
  auto writer = *mcap::Writer::create(folder() / "golden/Box.Falls.mcap");
  ASSERT_TRUE(writer->add_metadata("rehearse", {{"trace_version", "2"}, {"rehearse", "9.9.0"}}));
  ASSERT_TRUE(writer->close());
  const Outcome outcome = rehearse({"check", "box.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("it is of trace version 2, and this program reads version 1"));
  EXPECT_THAT(outcome.err, HasSubstr("install the version of Rehearse that wrote it: 9.9.0"));
  EXPECT_EQ((outcome.out + outcome.err).find("golden accept"), std::string::npos);
  EXPECT_FALSE(exists("rehearse-pending"));
}

}  // namespace
}  // namespace rehearse::test
