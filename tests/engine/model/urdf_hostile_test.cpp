// For any bytes, the loader returns a model or errors, and none takes it long.
#include <rehearse/urdf.h>

#include "../../sound_input.h"
#include "support/files.h"
#include "urdf_texts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

namespace rehearse {
namespace {

using testing::HasSubstr;

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

std::string sr1_text() { return test::read_file(FIXTURES_DIR "/models/sr1.urdf"); }

/// The result of `work`, which takes at most three times as long as the slowest of these tests.
auto quickly(const auto& work) {
  int load = 0;  // a robot of another name is read again
  static const SoundInput sr1(
      [&, text = sr1_text()] { EXPECT_TRUE(parse_urdf(text, "test" + std::to_string(++load) + ".urdf").ok()); });
  return sr1.bounds(1000, work);
}

std::string quick_refusal(const std::string& text) {
  return quickly([&] { return refusal(text); });
}

TEST(HostileUrdf, AHundredThousandLevelsAreTooDeep) {
  EXPECT_THAT(quick_refusal(robot(repeated("<link>\n", 100'000) + repeated("</link>", 100'000))),
              HasSubstr("test.urdf:90: error: elements are nested deeper than 90 levels"));
}

TEST(HostileUrdf, NinetyLevelsAreNotTooDeep) {
  const std::string text =
      "<robot name='r'><link name='world'/>" + repeated("<x>", 88) + "<x>text</x>" + repeated("</x>", 88) + "</robot>";
  EXPECT_EQ(load(text).links.size(), 1u);
}

TEST(HostileUrdf, DepthInCommentsAndTextIsNone) {
  const std::string deep = repeated("<x>", 200);
  EXPECT_EQ(load(robot("<!--" + deep + "--><link name='world'/><y><![CDATA[" + deep + "]]></y>")).links.size(), 1u);
}

TEST(HostileUrdf, AMillionAttributesAreTooMany) {
  std::string text = "<robot ";
  for (int i = 0; i < 1'000'000; ++i) text += "a" + std::to_string(i) + "='<'\n";
  EXPECT_THAT(quick_refusal(text + "/>"), HasSubstr("test.urdf:1: error: a tag has more than 100 attributes"));
}

TEST(HostileUrdf, AMillionTagsAreTooMany) {
  EXPECT_THAT(quick_refusal(robot(repeated("<a/>", 1'000'000))), HasSubstr("the file has more than 250000 tags"));
}

TEST(HostileUrdf, SeventyMebibytesAreTooMany) {
  EXPECT_THAT(quick_refusal(std::string(std::size_t{70} << 20, ' ')), HasSubstr("more than 64 MiB"));
}

TEST(HostileUrdf, AsManyUnknownTagsAsAllowedAreIgnored) {
  std::string text;
  for (int i = 0; i < 200'000; ++i) text += "<t" + std::to_string(i % 50'000) + "/>";
  const Model model = quickly([&] { return load(robot("<link name='world'/>" + text)); });
  EXPECT_EQ(model.report.size(), 50'000u);
}

TEST(HostileUrdf, AChainOfAllAllowedLinksLoads) {
  std::string text = link("world", "");
  std::string last = "world";
  for (int i = 1; i < max_urdf_links; ++i) {
    const std::string name = "l" + std::to_string(max_urdf_links - i);
    text += link(name) + joint("j" + name, "continuous", last, name);
    last = name;
  }
  EXPECT_EQ(load(robot(text)).joints.size(), static_cast<std::size_t>(max_urdf_links - 1));
}

TEST(HostileUrdf, SixtyMebibytesOfOneAttributeLoad) {
  const std::string value(std::size_t{60} << 20, 'x');
  const std::string text = robot("<link name='world' remark='" + value + "'/>");
  EXPECT_EQ(quickly([&] { return load(text); }).links.size(), 1u);
}

TEST(HostileUrdf, SixtyMebibytesOfNumbersAreRefused) {
  EXPECT_THAT(quick_refusal(still("<visual><origin xyz='" + repeated("1 ", 30 << 20) + "'/></visual>")),
              HasSubstr("not three numbers"));
}

TEST(HostileUrdf, AHundredThousandMaterialsLoad) {
  std::string text = link("world", "");
  for (int i = 0; i < 100'000; ++i) text += "<material name='m" + std::to_string(i) + "'/>";
  EXPECT_EQ(quickly([&] { return load(robot(text)); }).report.size(), 100'000u);
}

TEST(HostileUrdf, AHundredThousandSensorsLoad) {
  std::string text = link("world", "") + "<gazebo reference='world'>";
  for (int i = 0; i < 100'000; ++i) text += "<sensor name='s" + std::to_string(i) + "' type='imu'/>";
  EXPECT_EQ(quickly([&] { return load(robot(text + "</gazebo>")); }).devices.size(), 100'000u);
}

TEST(HostileUrdf, AHundredThousandBlocksOfNobodyLoad) {
  const std::string text = link("world", "") + repeated("<gazebo reference='x'/>", 100'000);
  EXPECT_EQ(quickly([&] { return load(robot(text)); }).report.size(), 100'000u);
}

TEST(HostileUrdf, ContactSensorsOfTenThousandShapesLoad) {
  std::string shapes, names;
  for (int i = 0; i < 10'000; ++i) {
    const std::string name = "c" + std::to_string(i);
    shapes += "<collision name='" + name + "'><geometry><sphere radius='1'/></geometry></collision>";
    names += "<collision>" + name + "</collision>";
  }
  std::string sensors;
  for (int i = 0; i < 3; ++i)
    sensors += "<sensor name='s" + std::to_string(i) + "' type='contact'><contact>" + names + "</contact></sensor>";
  for (int i = 3; i < 50'000; ++i) sensors += "<sensor name='s" + std::to_string(i) + "' type='contact'/>";
  const std::string text = link("world", shapes) + "<gazebo reference='world'>" + sensors + "</gazebo>";
  EXPECT_EQ(quickly([&] { return load(robot(text)); }).devices.size(), 50'000u);
}

TEST(HostileUrdf, MoreLinksThanAllowedAreRefused) {
  std::string text;
  for (int i = 0; i <= max_urdf_links; ++i) text += link("l" + std::to_string(i), "");
  EXPECT_THAT(quick_refusal(robot(text)), HasSubstr("the robot has 5001 links, more than 5000"));
}

TEST(HostileUrdf, ManyErrorsAreFoundQuickly) {
  EXPECT_THAT(quick_refusal(robot(repeated("<joint><origin xyz='x'/></joint>", 50'000))), HasSubstr("more errors"));
}

TEST(HostileUrdf, RandomBytesAreRefused) {
  std::mt19937 generator(1);
  std::uniform_int_distribution<int> byte(0, 255);
  for (int length = 1; length < 2000; length += 13) {
    std::string text;
    for (int i = 0; i < length; ++i) text += static_cast<char>(byte(generator));
    quick_refusal(text);
    quick_refusal("<robot name='" + text + "'>");
  }
}

TEST(HostileUrdf, ATruncatedFileIsRefusedWhereverItEnds) {
  const std::string text = sr1_text();
  const std::size_t end_of_content = text.find_last_of('>');
  for (std::size_t length = 0; length < end_of_content; length += 997) quick_refusal(text.substr(0, length));
}

TEST(HostileUrdf, AFlippedByteNeverCrashes) {
  const std::string sound = sr1_text();
  std::mt19937 generator(2);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    std::string text = sound;
    text[generator() % text.size()] = static_cast<char>(generator() % 256);
    refused += parse_urdf(text, "test.urdf").ok() ? 0 : 1;
  }
  EXPECT_GT(refused, 30);  // comments and colours may change unnoticed, most else may not
}

}  // namespace
}  // namespace rehearse
