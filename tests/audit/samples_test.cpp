// Audits each sample controller in its scenarios: all are deterministic.
#include "audited.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace rehearse::test {
namespace {

std::vector<std::string> scenarios_with_controllers() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fixtures / "scenarios"))
    if (entry.path().extension() == ".yaml" && read_file(entry.path()).find("controllers:") != std::string::npos)
      names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

class Samples : public Audited, public ::testing::WithParamInterface<std::string> {};

TEST_P(Samples, AreFunctionsOfTheirInputs) {
  const fs::path scenario = fixtures / "scenarios" / (GetParam() + ".yaml");
  const Outcome outcome = rehearse({"audit", scenario.string(), "--until", "0.4"});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out,
              ::testing::ContainsRegex("(of (its|their) inputs(, its [0-9]+ threads take turns)?: |gave the same .* in )[0-9]+ replays of [0-9.]+ s"));
}

INSTANTIATE_TEST_SUITE_P(Of, Samples, ::testing::ValuesIn(scenarios_with_controllers()),
                         [](const auto& of) { return of.param; });

}  // namespace
}  // namespace rehearse::test
