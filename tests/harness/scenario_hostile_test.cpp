// Hostile files: each is refused, without a crash, and none takes it long.
#include "../sound_input.h"
#include "scenario_files.h"

#include <gmock/gmock.h>

namespace rehearse {
namespace {

using ::testing::HasSubstr;

/// At most three times as long as the slowest of these tests takes.
std::string refusal(const std::string& text) {
  static const SoundInput sr1([] { EXPECT_TRUE(Scenario::load(fixtures / "scenarios/sr1_minimum.yaml").ok()); });
  const std::string message = sr1.bounds(1500, [&] { return mistakes(load_text(text)); });
  EXPECT_NE(message, "");
  return message;
}

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

TEST(HostileScenario, NestedTooDeep) {
  EXPECT_THAT(refusal(repeated("[", 100'000)), HasSubstr("nests too deep"));
  EXPECT_THAT(refusal(repeated("a: {", 100'000)), HasSubstr("error: "));
  EXPECT_THAT(refusal(repeated("- ", 100'000)), HasSubstr("nests too deep"));
}

TEST(HostileScenario, AliasesThatUnfoldToBillions) {
  std::string text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string below = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + repeated(below + ", ", 9) + below + "]\n";
  }
  EXPECT_THAT(refusal(text), HasSubstr("more than a million nodes"));
}

TEST(HostileScenario, LargerThanAnyScenario) {
  EXPECT_THAT(refusal(std::string((1 << 20) + 1, '#')), HasSubstr("larger than 1 MiB"));
}

TEST(HostileScenario, AMebibyteOfUnknownKeys) {
  std::string text = "rehearse: 1\n";
  for (int i = 0; text.size() < 1'000'000; ++i) text += "bodie" + std::to_string(i) + ": 1\n";
  EXPECT_THAT(refusal(text), HasSubstr("more errors not shown"));
}

TEST(HostileScenario, ThousandsOfBodies) {
  EXPECT_THAT(refusal("rehearse: 1\nduration: 1\nbodies: [" + repeated("{}, ", 200'000) + "]\n"),
              HasSubstr("bodies has 200000 elements"));
}

TEST(HostileScenario, BytesThatAreNoText) {
  std::string bytes;
  unsigned state = 1;
  for (int i = 0; i < 100'000; ++i) {
    state = state * 1664525u + 1013904223u;
    bytes += static_cast<char>(state >> 24);
  }
  refusal(bytes);
  refusal(std::string(1000, '\0'));
}

TEST(HostileScenario, CutAnywhere) {
  const std::string whole = read_file(fixtures / "scenarios/drop_box.yaml");
  ASSERT_GT(whole.size(), 300u);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto result = load_text(whole.substr(0, size));
    if (result.ok()) continue;
    EXPECT_GT(result.errors()[0].line, 0) << mistakes(result);
  }
}

}  // namespace
}  // namespace rehearse
