// record() in a test whose golden is proved.
#include <gmock/gmock.h>
#include <rehearse/check.h>
#include <rehearse/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "base/hashing.h"
#include "core/trace/filter.h"
#include "gtest/testing/test_recordings.h"
#include "small_traces.h"
#include "support/files.h"
#include "swinging_arm.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A swinging pendulum with a controller, its golden, and the certificate of a first test run; in folders of the test's
/// own.
class ProvedRecording : public ::testing::Test {
 protected:
  ProvedRecording() {
    for (const char* variable : {"REHEARSE_GOLDEN", "REHEARSE_PENDING", "REHEARSE_PROOF", "CI"}) unsetenv(variable);
    set_test_folders({folder_.path().string(), (folder_ / "golden").string(), folder_.path().string(), ""});
    setenv("REHEARSE_CONTROLLER_PATH", TEST_CONTROLLERS, 1);
    fs::create_directories(folder_ / "golden");
    write("HingePd");
    setenv("REHEARSE_GOLDEN", "new", 1);
    EXPECT_TRUE(match(swing()).passed);
    unsetenv("REHEARSE_GOLDEN");
    const Trace simulated = swing();
    EXPECT_FALSE(internal::is_proved(simulated));
    EXPECT_TRUE(match(simulated).passed);
  }
  ~ProvedRecording() override {
    unsetenv("REHEARSE_PROOF");
    set_test_folders({FIXTURES_DIR, "golden", ".", ""});
  }

  void write(const std::string& controller, const std::string& lines = "") {
    testing::write_swinging_arm(folder_.path(), controller, lines);
  }
  Trace swing() { return record("swing.yaml"); }
  static std::string test() { return internal::current_test(); }
  internal::TestVerdict match(const Trace& trace) { return internal::match_golden(trace, test()); }
  fs::path golden() const { return folder_ / "golden" / (test() + ".mcap"); }

  testing::TemporaryFolder folder_;
};

TEST_F(ProvedRecording, IsACopyOfTheGolden) {
  const Trace proved = swing();
  EXPECT_TRUE(internal::is_proved(proved));
  EXPECT_EQ(test::read_file(proved.file()), test::read_file(golden()));
  const internal::TestVerdict verdict = match(proved);
  EXPECT_TRUE(verdict.passed) << verdict.message;
}

TEST_F(ProvedRecording, IsSimulatedIfTheWorldIsAnother) {
  write("HingePd", "gravity: [0, 0, -9.7]\n");
  const Trace simulated = swing();
  EXPECT_FALSE(internal::is_proved(simulated));
  EXPECT_NE(simulated.values("Arm/SHOULDER/q"), Trace::load(golden())->values("Arm/SHOULDER/q"));
}

TEST_F(ProvedRecording, IsSimulatedFromACheckpointBeforeTheFirstOtherCommand) {
  write("HingePdChanged");  // from tick 70 on
  const Trace in_part = swing();
  setenv("REHEARSE_PROOF", "off", 1);
  const Trace whole = swing();
  EXPECT_FALSE(internal::is_proved(in_part));
  const auto compared = compare(fs::path(whole.file()), fs::path(in_part.file()), {}, {});
  ASSERT_TRUE(compared);
  EXPECT_TRUE(compared->equal) << table(*compared);
  unsetenv("REHEARSE_PROOF");
  const internal::TestVerdict verdict = match(in_part);
  EXPECT_FALSE(verdict.passed);
}

TEST_F(ProvedRecording, IsSimulatedIfTheUserSaysSo) {
  setenv("REHEARSE_PROOF", "off", 1);
  EXPECT_FALSE(internal::is_proved(swing()));
  setenv("REHEARSE_PROOF", "sample:100", 1);
  const Trace sampled = swing();
  EXPECT_FALSE(internal::is_proved(sampled));
  EXPECT_TRUE(match(sampled).passed);
  setenv("REHEARSE_PROOF", "perhaps", 1);
  EXPECT_THROW(swing(), std::runtime_error);
}

/// A test may read the state of any tick.
TEST_F(ProvedRecording, IsSimulatedIfTheGoldenKeepsSamplesOfTheState) {
  mcap::FilterOptions samples;
  samples.samples = StateRate{100.0, 0.001, {}};
  ASSERT_TRUE(mcap::filter(golden(), folder_ / "samples.mcap", samples));
  fs::rename(folder_ / "samples.mcap", golden());
  const Trace simulated = swing();
  EXPECT_FALSE(internal::is_proved(simulated));
  EXPECT_GT(simulated.values("Arm/SHOULDER/q").size(), 9 * Trace::load(golden())->values("Arm/SHOULDER/q").size());
  EXPECT_TRUE(compare(golden(), fs::path(simulated.file()), {}, {})->equal);
}

TEST_F(ProvedRecording, IsSimulatedToBecomeAGolden) {
  setenv("REHEARSE_GOLDEN", "accept", 1);
  EXPECT_FALSE(internal::is_proved(swing()));
  unsetenv("REHEARSE_GOLDEN");
}

/// The certificate of the golden is forged: it is one of a run with other gravity.
TEST_F(ProvedRecording, ThatWasWrongFailsLoudlyIfTheTestIsInTheSample) {
  const fs::path proofs = folder_ / "goldens/pending/proofs";
  const std::string certificate = fs::directory_iterator(proofs)->path().filename().string();
  write("HingePd", "gravity: [0, 0, -9.7]\n");
  fs::copy_file(swing().file(), golden(), fs::copy_options::overwrite_existing);
  write("HingePd");
  const auto hash = hash_of_file(golden());
  ASSERT_TRUE(hash);
  fs::copy_file(proofs / certificate, proofs / (hash_text(*hash) + certificate.substr(certificate.find('-'))));
  EXPECT_TRUE(internal::is_proved(swing()));
  setenv("REHEARSE_PROOF", "sample:100", 1);
  try {
    swing();
    FAIL() << "the proof wasn't tested";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("the proof was wrong: it found no change since "));
  }
}

}  // namespace
}  // namespace rehearse
