#include <gtest/gtest.h>
#include <cnoid/ValueTree>

namespace {

using cnoid::Mapping;
using cnoid::MappingPtr;

TEST(Mapping, ReadsWhatWasWritten) {
  const MappingPtr mapping = new Mapping;
  EXPECT_TRUE(mapping->empty());
  mapping->write("name", "walker");
  mapping->write("gain", 0.1);
  mapping->write("steps", 3);
  mapping->write("loop", true);
  EXPECT_EQ(mapping->size(), 4);
  EXPECT_EQ(mapping->get("name", "none"), "walker");
  EXPECT_EQ(mapping->get("gain", 0.0), 0.1);
  EXPECT_EQ(mapping->get("steps", 0), 3);
  EXPECT_EQ(mapping->get("loop", false), true);
}

TEST(Mapping, FallsBackOnTheDefaultForWhatIsMissingOrOfAnotherType) {
  const MappingPtr mapping = new Mapping;
  mapping->write("steps", "many");
  EXPECT_EQ(mapping->get("steps", 7), 7);
  EXPECT_EQ(mapping->get("gain", 0.5), 0.5);
  int steps = 1;
  EXPECT_FALSE(mapping->read("steps", steps));
  EXPECT_EQ(steps, 1);
  EXPECT_TRUE(mapping->contains("steps"));
  EXPECT_FALSE(mapping->contains("gain"));
}

}  // namespace
