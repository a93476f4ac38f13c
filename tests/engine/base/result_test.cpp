#include <rehearse/diagnostic.h>

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace rehearse {
namespace {

Result<int> number_or(bool fails) { return fails ? Result<int>(error("no number", "state one")) : Result<int>(7); }
Result<void> done_or(bool fails) { return fails ? Result<void>(error("not done")) : Result<void>(); }

Result<std::string> text_of(bool fails) {
  const int number = REHEARSE_TRY(number_or(fails));
  return std::to_string(number);
}

Result<void> both(bool first_fails, bool second_fails, bool& has_ended) {
  REHEARSE_TRY(done_or(first_fails));
  REHEARSE_TRY(number_or(second_fails));
  has_ended = true;
  return {};
}

TEST(Try, IsTheValue) { EXPECT_EQ(*text_of(false), "7"); }

TEST(Try, ReturnsTheDiagnosticsOfAnotherType) {
  const auto failed = text_of(true);
  ASSERT_FALSE(failed);
  ASSERT_EQ(failed.errors().size(), 1u);
  EXPECT_EQ(failed.errors()[0].message, "no number");
  EXPECT_EQ(failed.errors()[0].hint, "state one");
}

TEST(Try, EndsTheFunctionAtTheFirstFailure) {
  bool has_ended = false;
  EXPECT_FALSE(both(true, false, has_ended));
  EXPECT_FALSE(both(false, true, has_ended));
  EXPECT_FALSE(has_ended);
  EXPECT_TRUE(both(false, false, has_ended));
  EXPECT_TRUE(has_ended);
}

TEST(Try, MovesAValueThatCantBeCopied) {
  const auto make = []() -> Result<std::unique_ptr<int>> { return std::make_unique<int>(3); };
  const auto add = [&]() -> Result<int> {
    const std::unique_ptr<int> owned = REHEARSE_TRY(make());
    return *owned + 1;
  };
  EXPECT_EQ(*add(), 4);
}

TEST(Try, LeavesANamedResultItsValue) {
  const auto twice = [](Result<std::string>& named) -> Result<std::string> {
    const std::string text = REHEARSE_TRY(named);
    return text + *named;
  };
  Result<std::string> named(std::string("a text that is longer than a string's own buffer"));
  EXPECT_EQ(twice(named)->size(), 2 * named->size());
}

TEST(Try, PassesCommasOn) {
  const auto first = []() -> Result<int> {
    const std::pair<int, int> both = REHEARSE_TRY(Result<std::pair<int, int>>({1, 2}));
    return both.second;
  };
  EXPECT_EQ(*first(), 2);
}

}  // namespace
}  // namespace rehearse
