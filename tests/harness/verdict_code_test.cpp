// The table of verdicts' codes.
#include <gmock/gmock.h>
#include <rehearse/verdict_code.h>

#include <set>
#include <string>

namespace rehearse {
namespace {

TEST(VerdictCodes, HaveNamesOfTheirOwnAndMeanings) {
  std::set<std::string> names;
  for (const VerdictRow& row : verdict_rows()) {
    EXPECT_TRUE(names.insert(std::string(row.name)).second) << row.name;
    EXPECT_THAT(std::string(row.name), ::testing::MatchesRegex("[a-z_]+(\\.[a-z_]+)?"));
    EXPECT_FALSE(row.meaning.empty() || row.meaning.ends_with('.')) << row.name;
  }
}

TEST(VerdictCodes, AreFoundByTheirNames) {
  for (const VerdictRow& row : verdict_rows()) {
    EXPECT_EQ(verdict_code_of(row.name), row.code);
    EXPECT_EQ(to_string(row.code), row.name);
  }
  EXPECT_EQ(verdict_code_of("controller"), std::nullopt);
  EXPECT_EQ(verdict_code_of(""), std::nullopt);
}

}  // namespace
}  // namespace rehearse
