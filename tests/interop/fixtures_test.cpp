// The beginning of every fixture's trace, cameras included: @mcap/core reads it with its CRC checks on, and every value
// and every byte of every picture equals the output of `rehearse cat --json`.
#include <gmock/gmock.h>

#include <algorithm>
#include <vector>

#include "node.h"

namespace rehearse::test {
namespace {

std::vector<std::string> scenarios() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(FIXTURES_DIR) / "scenarios"))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

class InteropFixtures : public NodeTest, public testing::WithParamInterface<std::string> {};

TEST_P(InteropFixtures, OthersFindWhatOurCatPrints) {
  const fs::path scenario = fs::path(FIXTURES_DIR) / "scenarios" / (GetParam() + ".yaml");
  const Output recorded =
      run(quoted(REHEARSE_COMMAND) + " record " + quoted(scenario) + " --duration 0.2 -o " + quoted(file_));
  ASSERT_EQ(recorded.status, 0) << recorded.text;
  const Output compared = compare_with_cat();
  EXPECT_EQ(compared.status, 0) << compared.text;
  EXPECT_THAT(compared.text, testing::HasSubstr(" messages, "));
  const Output schemas = node("compare_schemas.mjs");
  EXPECT_EQ(schemas.status, 0) << schemas.text;
}

INSTANTIATE_TEST_SUITE_P(Scenarios, InteropFixtures, testing::ValuesIn(scenarios()),
                         [](const auto& scenario) { return scenario.param; });

}  // namespace
}  // namespace rehearse::test
