// The table of verdicts' codes, and verdicts that are made of statements.
#include <gmock/gmock.h>
#include <rehearse/verdict.h>

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

TEST(Verdicts, HaveTheirCodesInTheOrderOfTheirStatements) {
  Verdict verdict(VerdictCode::same, "equal bit for bit");
  verdict.lead(VerdictCode::controller_inputs_changed, "the controller reads other inputs");
  verdict.add(VerdictCode::expectations_hold, "all 3 expectations hold");
  verdict.add(VerdictCode::model_changed);
  EXPECT_EQ(verdict.text(), "the controller reads other inputs; equal bit for bit; all 3 expectations hold");
  EXPECT_THAT(verdict.codes(), ::testing::ElementsAre(VerdictCode::controller_inputs_changed, VerdictCode::same,
                                                      VerdictCode::expectations_hold, VerdictCode::model_changed));
  EXPECT_EQ(verdict.code(), "controller.inputs_changed");
  EXPECT_EQ(verdict.text_without({VerdictCode::same}), "the controller reads other inputs; all 3 expectations hold");
  EXPECT_EQ(Verdict().text(), "");
  EXPECT_EQ(Verdict().code(), "");
}

}  // namespace
}  // namespace rehearse
