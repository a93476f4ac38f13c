// The recorder that the verb tap runs: its black box, its files, and what it refuses.
#include <rehearse/tap_ring.h>
#include <sys/stat.h>

#include <cstring>

#include "tap/tap_verb.h"

namespace rehearse::test {
namespace {

using testing::HasSubstr;

TEST_F(TapVerb, WritesABlackBoxWhenItIsAskedFor) {
  const std::vector<std::string> options{"--black-box", "--last", "0.2"};
  EXPECT_EQ(record("quiet.mcap", 400, 3, {"paced"}, options), 0) << said();
  EXPECT_THAT(said(), HasSubstr("nothing asked for the black box"));
  EXPECT_FALSE(exists("quiet.mcap"));

  EXPECT_EQ(record("mark.mcap", 800, 3, {"paced", "mark=500"}, options), 0) << said();
  EXPECT_THAT(said(), HasSubstr("the loop set a mark"));
  EXPECT_EQ(ticks_in("mark.mcap").size(), 200u);
  EXPECT_THAT(rehearse({"cat", "mark.mcap", "--topics", "/events"}).out, HasSubstr("mark: a touch"));

  EXPECT_EQ(record("beyond.mcap", 800, 3, {"paced", "beyond=500"}, options), 0) << said();
  EXPECT_THAT(said(), HasSubstr("the effort 1e+06 of joint J0 is beyond the model's 1000"));
  EXPECT_EQ(*ticks_in("beyond.mcap").rbegin(), 500);

  Beside recorder(folder(), command, {"tap", tap(), "-o", "dead.mcap", "--black-box", "--last", "0.2"}, "recorder");
  EXPECT_EQ(run(LOOP, loop_words(5000, 3, {"paced", "crash=600"})).status, 128 + SIGKILL);
  EXPECT_EQ(recorder.wait(), 3) << said();
  const std::set<std::int64_t> ticks = ticks_in("dead.mcap");
  EXPECT_EQ(ticks.size(), 200u);
  EXPECT_EQ(*ticks.rbegin(), 599);
}

TEST_F(TapVerb, NeverReplacesAFileAndEndsWholeWhenTheDiskIsFull) {
  write("flight.mcap", "a file of the user");
  EXPECT_EQ(record("flight.mcap", 10, 3), 0);
  EXPECT_EQ(read_file(folder() / "flight.mcap"), "a file of the user");
  EXPECT_EQ(ticks_in("flight-2.mcap").size(), 10u);

  Beside recorder(folder(), command, {"tap", tap(), "-o", "full.mcap", "--keep-free", "900000000"}, "recorder");
  Beside loop(folder(), LOOP, loop_words(3000, 3, {"paced"}), "loop");
  EXPECT_EQ(recorder.wait(), 2) << said();
  EXPECT_THAT(said(), HasSubstr("the disk is nearly full"));
  EXPECT_EQ(rehearse({"doctor", "full.mcap"}).status, 0) << rehearse({"doctor", "full.mcap"}).out;
  EXPECT_EQ(loop.wait(), 0);
}

TEST_F(TapVerb, RefusesASecondRecorderForeignRingsAndOtherVersions) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "one.mcap"}, "recorder");
  Beside loop(folder(), LOOP, loop_words(100'000, 3, {"paced"}), "loop");
  for (int i = 0; i < 500 && !exists("one.mcap"); ++i) rest(10);
  const Outcome second = rehearse({"tap", tap(), "-o", "two.mcap"});
  EXPECT_EQ(second.status, 2);
  EXPECT_THAT(second.err, HasSubstr("records this tap already"));
  recorder.kill(SIGTERM);
  EXPECT_EQ(recorder.wait(), 0) << said();
  EXPECT_THAT(said(), HasSubstr("the recording was stopped"));
  EXPECT_TRUE(fs::exists(ring()));  // its loop goes on
  loop.kill(SIGKILL);
  loop.wait();

  std::string bytes = read_file(ring());
  const auto refused = [&](std::size_t at, char byte) {
    std::string other = bytes;
    other[at] = byte;
    write("ring", other);
    chmod((folder() / "ring").c_str(), 0600);
    return rehearse({"tap", "./ring", "--recover", "-o", "ring.mcap"}).err;
  };
  EXPECT_THAT(refused(0, 'x'), HasSubstr("it is no ring of a tap"));
  EXPECT_THAT(refused(offsetof(tap_ring_head, version), 2), HasSubstr("the ring is of version 2"));
  EXPECT_THAT(refused(offsetof(tap_ring_head, time_step) + 3, 7), HasSubstr("the head of the ring is damaged"));
  EXPECT_THAT(refused(tap_definitions_place + 1, 'x'), HasSubstr("the series of the ring are damaged"));
  bytes.resize(100);
  EXPECT_THAT(refused(50, 'x'), HasSubstr("it is no ring of a tap"));
}

TEST_F(TapVerb, RecordsALoopWithoutAModelAsALog) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "bare.mcap"}, "recorder");
  EXPECT_EQ(run(LOOP, {tap(), "", "100", "3"}).status, 0);
  EXPECT_EQ(recorder.wait(), 0) << said();
  EXPECT_EQ(ticks_in("bare.mcap").size(), 100u);
  const Outcome replayed = replay("bare.mcap", GUEST);
  EXPECT_EQ(replayed.status, 2);
}

}  // namespace
}  // namespace rehearse::test
