// rehearse diff of files of other programs: other encodings, wall-clock times, no ticks, repeated topics.
#include <gmock/gmock.h>

#include <span>
#include <vector>

#include "command.h"
#include "mixed_file.h"

namespace rehearse::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class DiffFiles : public Command {
 protected:
  /// Two channels of one topic, of joints and of bytes; the values that a test may change.
  void write_file(const std::string& name, double knee, std::string_view bytes, std::string_view second = "same",
                  bool has_extra = false) const {
    auto writer = std::move(*mcap::Writer::create(folder() / name));
    TopicWriter joints(*writer, "/joints", "cdr", add_schema<msg::JointState>(*writer));
    TopicWriter proto(*writer, "/proto", "protobuf", writer->add_schema("foo.Bar", "protobuf", "x"));
    TopicWriter first(*writer, "/twice", "");
    TopicWriter other(*writer, "/twice", "text");
    for (std::uint64_t i = 0; i < 3; ++i) {
      const std::uint64_t time = wall_clock + i * 1'000'000;
      joints.put(time, msg::JointState{{}, {"KNEE"}, {i == 1 ? knee : 0.5}, {}, {}});
      proto.raw(time, bytes_of(i == 2 ? bytes : "bytes"));
      first.raw(time, bytes_of("same"));
      other.raw(time, bytes_of(second));
    }
    if (has_extra) TopicWriter(*writer, "/extra", "").raw(wall_clock, bytes_of("x"));
    ASSERT_TRUE(writer->close());
  }
  Outcome diff(const std::string& other) const { return rehearse({"diff", "a.mcap", other}); }

  void SetUp() override { write_file("a.mcap", 0.5, "bytes"); }
};

TEST_F(DiffFiles, FindsEqualFilesEqual) {
  write_file("b.mcap", 0.5, "bytes");
  const Outcome outcome = diff("b.mcap");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("equal bit for bit: 12 values, 0 pictures\n"));
}

TEST_F(DiffFiles, NamesTheMessageOfANumberThatDiffers) {
  write_file("b.mcap", 0.75, "bytes");
  const Outcome outcome = diff("b.mcap");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out,
              StartsWith("differs at message 1 (1700000000.124457 s): /joints KNEE/q is 0.75, expected 0.5: "
                         "off by 0.25"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("stage: ")));
}

TEST_F(DiffFiles, ComparesWhatItDoesNotDecodeByItsBytes) {
  write_file("b.mcap", 0.5, "bytez");
  const Outcome outcome = diff("b.mcap");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, StartsWith("differs at message 2 ("));
  EXPECT_THAT(outcome.out, HasSubstr("/proto"));
}

TEST_F(DiffFiles, ComparesEachChannelOfATopicThatComesTwice) {
  write_file("b.mcap", 0.5, "bytes", "other");
  const Outcome outcome = diff("b.mcap");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, StartsWith("differs at message 0 ("));
  EXPECT_THAT(outcome.out, HasSubstr("/twice"));
}

TEST_F(DiffFiles, NamesAChannelThatOneOfThemLacks) {
  write_file("b.mcap", 0.5, "bytes", "same", true);
  EXPECT_THAT(diff("b.mcap").out, HasSubstr("/extra: the channel is not in the golden"));
  EXPECT_THAT(rehearse({"diff", "b.mcap", "a.mcap"}).out, HasSubstr("/extra: the channel is missing"));
}

TEST_F(DiffFiles, ListsNoTicksAsEqualThatNoFileHas) {
  write_file("b.mcap", 0.75, "bytes");
  EXPECT_THAT(diff("b.mcap").out, AllOf(HasSubstr("bit-equal: 2 channels (/proto, /twice)"), Not(HasSubstr("/tick"))));
}

TEST_F(DiffFiles, CountsMessagesWhereNoFileHasTicks) {
  write_file("b.mcap", 0.75, "bytes");
  write("tolerances.yaml", "tolerances:\n  - {channel: KNEE/q, atol: 0.1}\n");
  EXPECT_THAT(
      rehearse({"diff", "a.mcap", "b.mcap", "--tolerances", "tolerances.yaml"}).out,
      AllOf(StartsWith("differs: KNEE/q is beyond ±0.1 from message 1 (1700000000.124457 s) on, worst 0.25 (2.5 "
                       "times) at message 1\n"),
            Not(HasSubstr("tick "))));
}

TEST_F(DiffFiles, ComparesAStampAsOneTime) {
  const auto write_stamp = [&](const std::string& name, std::uint64_t stamp) {
    auto writer = std::move(*mcap::Writer::create(folder() / name));
    TopicWriter(*writer, "/joints", "cdr", add_schema<msg::JointState>(*writer))
        .put(wall_clock, msg::JointState{{msg::Time::from_ns(stamp), "base"}, {"KNEE"}, {0.5}, {}, {}});
    ASSERT_TRUE(writer->close());
  };
  write_stamp("c.mcap", 1'999'999'999);
  write_stamp("d.mcap", 2'000'000'001);
  EXPECT_THAT(rehearse({"diff", "c.mcap", "d.mcap"}).out,
              StartsWith("differs at message 0 (1700000000.123457 s): /joints header/stamp is 2.000000001 s, expected "
                         "1.999999999 s: off by 2e-09 s\n"));
  const auto json = rehearse({"diff", "c.mcap", "d.mcap", "--json"}).json();
  EXPECT_EQ(json["differing"], 1);
  EXPECT_EQ(json["first"]["unit"], "s");
  EXPECT_DOUBLE_EQ(json["first"]["difference"], 2e-9);
  write("tolerances.yaml", "tolerances:\n  - {channel: header/stamp, atol: 1e-6}\n");
  const Outcome within = rehearse({"diff", "c.mcap", "d.mcap", "--tolerances", "tolerances.yaml"});
  EXPECT_EQ(within.status, 0) << within.out;
  EXPECT_THAT(within.out, AllOf(StartsWith("within tolerance: 1 of 2 values differ"), Not(HasSubstr("warning"))));
  write_stamp("e.mcap", wall_clock);
  write_stamp("f.mcap", wall_clock + 2);
  write_stamp("g.mcap", wall_clock + 5);
  EXPECT_THAT(rehearse({"diff", "f.mcap", "g.mcap"}).out,
              HasSubstr("header/stamp: is 1700000000.123456794 s, expected 1700000000.123456791 s: off by 3e-09 s\n"));
  EXPECT_THAT(rehearse({"diff", "e.mcap", "g.mcap", "--json"}).json()["differing"], 1);
}

TEST_F(DiffFiles, ComparesATimeInAColumnAsOneTime) {
  const auto write_time = [&](const std::string& name, std::int32_t seconds, std::uint32_t nanoseconds) {
    auto writer = std::move(*mcap::Writer::create(folder() / name));
    CdrWriter cdr;
    msg::encode(msg::Time{seconds, nanoseconds}, cdr);
    TopicWriter(*writer, "/goal", "cdr",
                writer->add_schema("a/msg/Goal", "ros2msg", "builtin_interfaces/Duration time_from_start\n"))
        .raw(wall_clock, cdr.bytes());
    ASSERT_TRUE(writer->close());
  };
  write_time("c.mcap", -1, 999'999'999);
  write_time("d.mcap", 0, 500'000'000);
  const auto json = rehearse({"diff", "c.mcap", "d.mcap", "--json"}).json();
  EXPECT_EQ(json["differing"], 1);
  EXPECT_EQ(json["values"], 1);
  EXPECT_EQ(json["first"]["element"], "time_from_start");
  EXPECT_DOUBLE_EQ(json["first"]["difference"], 0.500000001);
  write("tolerances.yaml", "tolerances:\n  - {channel: time_from_start, atol: 1}\n");
  EXPECT_EQ(rehearse({"diff", "c.mcap", "d.mcap", "--tolerances", "tolerances.yaml"}).status, 0);
}

TEST_F(DiffFiles, ComparesAMessageThatCannotBeDecodedByItsBytesAndTheOthersByFields) {
  /// `invalid`: the bytes of message 2.
  const auto write_cut = [&](const std::string& name, std::string_view invalid, double knee) {
    auto writer = std::move(*mcap::Writer::create(folder() / name));
    TopicWriter joints(*writer, "/joints", "cdr", add_schema<msg::JointState>(*writer));
    TopicWriter own(*writer, "/own", "cdr", writer->add_schema("a/msg/Own", "ros2msg", "int32 count\nfloat64[] x\n"));
    for (std::uint64_t i = 0; i < 5; ++i) {
      const std::uint64_t time = wall_clock + i * 1'000'000;
      CdrWriter cdr;
      const std::vector<double> values{i == 4 ? knee : 0.5};
      cdr.put(static_cast<std::int32_t>(i));
      cdr.put_sequence(std::span(values));
      if (i == 2) {
        joints.raw(time, bytes_of(invalid));
        own.raw(time, bytes_of(invalid));
      } else {
        joints.put(time, msg::JointState{{{}, "base"}, {"KNEE"}, {i == 4 ? knee : 0.5}, {}, {}});
        own.raw(time, cdr.bytes());
      }
    }
    ASSERT_TRUE(writer->close());
  };
  const std::string_view some("\0\1\0\0\7\0\0\0\2\0\0\0", 12), other("\0\1\0\0\7\0\0\0\3\0\0\0", 12);
  write_cut("c.mcap", some, 0.5);
  write_cut("d.mcap", some, 0.5);
  write_cut("e.mcap", other, 0.75);
  const Outcome equal = rehearse({"diff", "c.mcap", "d.mcap"});
  EXPECT_EQ(equal.status, 0) << equal.out << equal.err;
  EXPECT_THAT(equal.out,
              AllOf(StartsWith("equal bit for bit: "),
                    HasSubstr("  note: /own: 1 message of the golden can't be decoded, at 1700000000.125457 s "
                              "(ends at byte 12, within x); it is compared by its bytes\n")));
  const Outcome differs = rehearse({"diff", "c.mcap", "e.mcap"});
  EXPECT_EQ(differs.status, 1) << differs.err;
  EXPECT_THAT(differs.out,
              StartsWith("differs at message 2 (1700000000.125457 s): /joints: its bytes differ; it can't be "
                         "decoded: ends at byte 12, within header/frame_id\n"));
  const auto json = rehearse({"diff", "c.mcap", "e.mcap", "--json"}).json();
  EXPECT_EQ(json["differing"], 4);
  for (const auto& channel : json["channels"]) {
    EXPECT_EQ(channel["differing"], 2) << channel;
    EXPECT_EQ(channel["worst"]["tick"], 2) << channel;
  }
  write_cut("f.mcap", some, 0.75);
  EXPECT_THAT(
      rehearse({"diff", "c.mcap", "f.mcap"}).out,
      StartsWith("differs at message 4 (1700000000.127457 s): /joints KNEE/q is 0.75, expected 0.5: off by 0.25"));
}

TEST_F(DiffFiles, ComparesMessagesOfASchemaThatIsNoneByTheirBytes) {
  const auto write = [&](const std::string& name, std::string_view payload) {
    auto writer = std::move(*mcap::Writer::create(folder() / name));
    TopicWriter(*writer, "/wide", "cdr", writer->add_schema("a/msg/B", "ros2msg", "wstring text\n"))
        .raw(wall_clock, bytes_of(payload));
    ASSERT_TRUE(writer->close());
  };
  write("c.mcap", "one");
  write("d.mcap", "one");
  write("e.mcap", "two");
  EXPECT_EQ(rehearse({"diff", "c.mcap", "d.mcap"}).status, 0);
  EXPECT_EQ(rehearse({"diff", "c.mcap", "e.mcap"}).status, 1);
}

}  // namespace
}  // namespace rehearse::test
