// A quadruped that trots with ideal drives, and falls with those of its hardware.
#include <rehearse/scenario.h>
#include <rehearse/session.h>
#include <rehearse/trace.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace rehearse {
namespace {

/// The lowest place of the trunk after it has stood up [m], with values of fixtures/campaigns/trot_hardware.yaml: the
/// delay of commands [ms], and the share of its effort that is left to the right hind knee.
double lowest(const std::string& delay, const std::string& strength) {
  setenv("REHEARSE_CONTROLLER_PATH", SAMPLE_CONTROLLERS, 1);
  const std::string path = std::string(FIXTURES_DIR) + "/campaigns/trot_hardware.yaml";
  const auto scenario = Scenario::load(path);
  if (!scenario.ok()) throw std::runtime_error(to_string(scenario.errors()));
  const auto text = scenario->varied_text({delay, "RR_KNEE", strength, "0"});
  const auto varied = Scenario::load_text(*text, path);
  if (!varied.ok()) throw std::runtime_error(to_string(varied.errors()));
  const test::TemporaryFolder folder;
  const auto summary = record(*varied, folder / "trot.mcap");
  if (!summary.ok()) throw std::runtime_error(to_string(summary.errors()));
  const auto trace = Trace::load(folder / "trot.mcap");
  const std::vector<double> height = trace->values("Quadruped/TRUNK/position/z");
  return *std::min_element(height.begin() + 800, height.end());
}

TEST(TrotOnHardware, FallsWithLateCommandsAndAWeakKneeTogether) {
  EXPECT_GT(lowest("0", "1"), 0.33) << "ideal drives";
  EXPECT_GT(lowest("14", "1"), 0.25) << "late commands alone";
  EXPECT_GT(lowest("0", "0.3"), 0.25) << "a weak knee alone";
  EXPECT_LT(lowest("14", "0.3"), 0.2) << "both";
}

}  // namespace
}  // namespace rehearse
