// rehearse doctor, recover, filter, merge: on recordings of Rehearse, as a user runs them.
#include <gmock/gmock.h>

#include <cstring>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Mending : public Command {
 protected:
  Mending() {
    scenario_ = pendulum(MISBEHAVING, "nothing 0");
    done({"record", scenario_.string(), "-o", "run.mcap"});
  }

  /// A copy that ends so many bytes behind the end of the data section.
  void cut(const std::string& name, std::int64_t bytes) const {
    const std::string whole = read_file(folder() / "run.mcap");
    constexpr std::size_t from_end = 8 + 20;  // the Footer's first field, where the summary begins
    std::uint64_t summary = 0;
    std::memcpy(&summary, whole.data() + whole.size() - from_end, sizeof summary);
    constexpr std::int64_t data_end = 13;
    write(name, whole.substr(0, static_cast<std::size_t>(static_cast<std::int64_t>(summary) - data_end + bytes)));
  }

  fs::path scenario_;
};

TEST_F(Mending, DoctorFindsNothingWrongWithARecording) {
  const Outcome outcome = done({"doctor", "run.mcap"});
  EXPECT_THAT(outcome.out, HasSubstr("run.mcap: no findings; "));
  const auto json = done({"doctor", "run.mcap", "--json"}).json();
  EXPECT_EQ(json["errors"], 0);
  EXPECT_TRUE(json["findings"].empty());
}

TEST_F(Mending, DoctorFindsNothingWrongWithRunsThatFailed) {
  for (const std::string deed : {"crash 12", "throw 12", "exit 20", "refuse", "crash 0"}) {
    const Outcome recorded = rehearse({"record", pendulum(MISBEHAVING, deed).string(), "-o", "failed.mcap"});
    EXPECT_EQ(recorded.status, 3) << deed;
    const Outcome outcome = rehearse({"doctor", "failed.mcap"});
    EXPECT_EQ(outcome.status, 0) << deed << ": " << outcome.out;
  }
}

TEST_F(Mending, DoctorSaysWhatIsWrongAndEndsAccordingly) {
  cut("cut.mcap", -100);
  const Outcome cut_file = rehearse({"doctor", "cut.mcap"});
  EXPECT_EQ(cut_file.status, 1);
  EXPECT_THAT(cut_file.out, HasSubstr("error: truncated"));
  write("text.mcap", "a text");
  const Outcome both = rehearse({"doctor", "run.mcap", "text.mcap", "missing.mcap", "--json"});
  EXPECT_EQ(both.status, 2);
  const auto json = both.json();
  EXPECT_EQ(json["errors"], 2);
  EXPECT_EQ(json["files"][0]["readable"], true);
  EXPECT_EQ(json["files"][1]["readable"], false);
  EXPECT_THAT(json["findings"][0]["message"], HasSubstr("not an MCAP file"));
}

TEST_F(Mending, ARecordingThatWasCutIsRecoveredAndReplayedUpToThere) {
  cut("cut.mcap", 5);
  EXPECT_EQ(rehearse({"replay", "cut.mcap"}).status, 2);
  const Outcome recovered = rehearse({"recover", "cut.mcap", "-o", "saved.mcap"});
  ASSERT_EQ(recovered.status, 0) << recovered.err;
  EXPECT_THAT(recovered.out, HasSubstr("saved "));
  EXPECT_EQ(rehearse({"doctor", "saved.mcap"}).status, 0);
  EXPECT_EQ(rehearse({"info", "saved.mcap"}).status, 0);
  const auto json = rehearse({"recover", "cut.mcap", "-o", "again.mcap", "--json"}).json();
  EXPECT_EQ(json["whole"], false);
  EXPECT_FALSE(json["lost"].empty());
}

TEST_F(Mending, RecoverWithNothingToSaveWritesNothing) {
  write("text.mcap", "a text");
  const Outcome outcome = rehearse({"recover", "text.mcap", "-o", "saved.mcap"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("nothing can be saved"));
  EXPECT_FALSE(exists("saved.mcap"));
}

TEST_F(Mending, ARecoveredKillReplaysWithoutADifference) {
  cut("killed.mcap", 0);
  ASSERT_EQ(rehearse({"recover", "killed.mcap", "-o", "saved.mcap"}).status, 0);
  const Outcome replayed = rehearse({"replay", "saved.mcap", "--json"});
  ASSERT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_EQ(replayed.json()["equal"], true);
}

TEST_F(Mending, FilterKeepsWhatIsChosen) {
  const auto json = done({"filter", "run.mcap", "-o", "part.mcap", "--topics", "/tick", "/Pendulum/joints", "--ticks",
                          "10..19", "--json"})
                        .json();
  EXPECT_EQ(json["messages"], 20);
  EXPECT_EQ(rehearse({"doctor", "part.mcap"}).status, 0);
  EXPECT_THAT(done({"info", "part.mcap"}).out, HasSubstr("rehearse.filter"));
}

TEST_F(Mending, FilterKeepsTheAttachmentsThatAreChosen) {
  const auto all = done({"filter", "run.mcap", "-o", "all.mcap", "--json"}).json();
  ASSERT_GT(all["attachments"], 1);
  const auto json = done({"filter", "run.mcap", "-o", "models.mcap", "--attachments", "*.urdf", "--json"}).json();
  EXPECT_EQ(json["attachments"], 1);
  EXPECT_EQ(done({"filter", "run.mcap", "-o", "none.mcap", "--no-attachments", "--json"}).json()["attachments"], 0);
  const Outcome refused = rehearse({"filter", "run.mcap", "-o", "x.mcap", "--attachments", "*.stl"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("no attachment matches '*.stl'"));
}

TEST_F(Mending, ACutRecordingSaysWhyItIsNotReplayed) {
  done({"filter", "run.mcap", "-o", "late.mcap", "--ticks", "10.."});
  const Outcome outcome = rehearse({"replay", "late.mcap"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("its first tick is 10: the ticks before are missing"));
  done({"filter", "run.mcap", "-o", "early.mcap", "--ticks", "..20"});
  EXPECT_EQ(rehearse({"replay", "early.mcap"}).status, 0);
}

TEST_F(Mending, MergeOfPartsIsTheWholeAgain) {
  done({"filter", "run.mcap", "-o", "a.mcap", "--ticks", "..19"});
  done({"filter", "run.mcap", "-o", "b.mcap", "--ticks", "20..", "--no-attachments", "--no-metadata"});
  done({"merge", "a.mcap", "b.mcap", "-o", "whole.mcap"});
  EXPECT_EQ(rehearse({"doctor", "whole.mcap"}).status, 0);
  const Outcome replayed = rehearse({"replay", "whole.mcap", "--json"});
  ASSERT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_EQ(replayed.json()["equal"], true);
  done({"merge", "run.mcap", "whole.mcap", "-o", "twice.mcap"});
  EXPECT_THAT(rehearse({"replay", "twice.mcap"}).err, HasSubstr("it contains several recordings"));
}

TEST_F(Mending, NeitherReplacesItsInputNorAnotherKindOfFile) {
  const std::string before = read_file(folder() / "run.mcap");
  write("notes.txt", "of mine");
  for (const std::string verb : {"filter", "merge", "recover"}) {
    EXPECT_EQ(rehearse({verb, "run.mcap", "-o", "run.mcap"}).status, 2) << verb;
    EXPECT_EQ(rehearse({verb, "run.mcap", "-o", "notes.txt"}).status, 2) << verb;
    EXPECT_EQ(rehearse({verb, "run.mcap", "-o", "."}).status, 2) << verb;
    EXPECT_EQ(rehearse({verb, "run.mcap"}).status, 2) << verb;
    EXPECT_THAT(rehearse({verb, "--help"}).out, HasSubstr("Example:")) << verb;
  }
  EXPECT_TRUE(read_file(folder() / "run.mcap") == before);
  EXPECT_EQ(read_file(folder() / "notes.txt"), "of mine");
}

}  // namespace
}  // namespace rehearse::test
