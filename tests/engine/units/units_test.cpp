// The registry of units, and the page that states it.
#include <rehearse/units.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string_view> texts_of(std::span<const Spelling> spellings) {
  std::vector<std::string_view> texts;
  for (const Spelling& spelling : spellings) texts.push_back(spelling.text);
  return texts;
}

/// A number in tables: 1e-9, 0.0005.
std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string tolerance_text(const UnitTolerance& tolerance) {
  std::string text;
  const auto add = [&](double value, const std::string& what) {
    if (value != 0.0) text += (text.empty() ? "" : ", ") + what + " " + number(value);
  };
  add(tolerance.atol, "`atol`");
  add(tolerance.rtol, "`rtol`");
  add(tolerance.pixel_share, "`pixel_share`");
  add(tolerance.pixel_delta, "`pixel_delta`");
  return text.empty() ? "bit for bit" : text;
}

/// The row of a unit in the page.
std::string row_of(const Unit& unit) {
  std::string everywhere, in_noise;
  for (const Spelling& spelling : unit.all_spellings()) {
    std::string& list = spelling.where == SpeltIn::noise ? in_noise : everywhere;
    list += (list.empty() ? "" : ", ") + std::string(spelling.text);
  }
  const std::string name = unit.name.empty() ? "none" : std::string(unit.name);
  return "| " + name + " | " + everywhere + (everywhere.empty() ? "" : " ") + "| " + in_noise +
         (in_noise.empty() ? "" : " ") + "| " + tolerance_text(unit.tolerance) + " |";
}

TEST(Units, HaveEachNameAndEachSpellingOfExpressionsOnce) {
  std::set<std::string_view> names, spellings;
  for (const Unit& unit : units::rows) {
    EXPECT_TRUE(names.insert(unit.name).second) << unit.name;
    for (const Spelling& spelling : unit.all_spellings())
      if (spelling.where == SpeltIn::all_files) {
        EXPECT_TRUE(spellings.insert(spelling.text).second) << spelling.text;
      }
  }
}

TEST(Units, OfAMagneticFieldAreKnownToExpressions) {
  const auto written = leading_unit("uT and more");
  ASSERT_TRUE(written);
  EXPECT_EQ(written->unit, "T");
  EXPECT_EQ(written->scale, 1e-6);
  EXPECT_THAT(known_units(), HasSubstr("T, mT, uT, nT"));
  EXPECT_EQ(leading_unit("mrad")->unit, "rad");
}

TEST(Units, TakeTheLongestSpellingThatEndsWithTheWord) {
  EXPECT_EQ(leading_unit("m/s^2")->unit, "m/s²");
  EXPECT_EQ(leading_unit("m/s")->unit, "m/s");
  EXPECT_FALSE(leading_unit("meters"));
  EXPECT_EQ(leading_unit("g")->unit, "kg") << "the g of an acceleration belongs to noise";
}

TEST(Units, HaveADensityForEachSpelling) {
  EXPECT_THAT(texts_of(density_spellings("T", DensityPer::root_hertz)),
              ElementsAre("T/sqrt(Hz)", "mT/sqrt(Hz)", "uT/sqrt(Hz)", "nT/sqrt(Hz)"));
  EXPECT_THAT(texts_of(density_spellings("N·m", DensityPer::root_second)),
              ElementsAre("N·m/sqrt(s)", "Nm/sqrt(s)", "N*m/sqrt(s)"));
  EXPECT_TRUE(density_spellings("", DensityPer::root_hertz).empty());
  EXPECT_EQ(factor_of_spelling("mg/sqrt(Hz)"), 1e-3 * units::gravity);
  EXPECT_EQ(factor_of_spelling("furlong"), std::nullopt);
}

TEST(Units, ShowDistancesAsMeters) {
  EXPECT_EQ(shown_unit("float32 distance"), "m");
  EXPECT_EQ(shown_unit("N·m"), "N·m");
  EXPECT_EQ(shown_unit("lx"), "lx") << "a controller's variable may have any unit";
}

TEST(Units, StandInThePageAsInTheRegistry) {
  const std::string page = std::string(FIXTURES_DIR) + "/../tools/site/pages/reference/units.md";
  std::ifstream stream(page);
  std::vector<std::string> stated, expected;
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("| ") && !line.starts_with("| unit |") && !line.starts_with("| ---")) stated.push_back(line);
  for (const Unit& unit : units::rows) expected.push_back(row_of(unit));
  std::string rows;
  for (const std::string& row : expected) rows += row + "\n";
  EXPECT_EQ(stated, expected) << page << " has to have these rows:\n" << rows;
}

}  // namespace
}  // namespace rehearse
