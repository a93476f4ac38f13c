#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cnoid/ValueTree>

#include <functional>
#include <string>

namespace {

using cnoid::Listing;
using cnoid::ListingPtr;
using cnoid::Mapping;
using cnoid::MappingPtr;
using cnoid::ScalarNode;
using cnoid::ValueNode;
using testing::HasSubstr;

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
  EXPECT_EQ(mapping->get("gain", 0.0f), 0.1f);
  EXPECT_EQ(mapping->get("steps", 0), 3);
  EXPECT_EQ(mapping->get("loop", false), true);
  EXPECT_EQ(mapping->get<double>("gain"), 0.1);
  EXPECT_EQ((*mapping)["name"].toString(), "walker");
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

TEST(Mapping, TakesTheFirstOfSeveralNamesThatIsThere) {
  const MappingPtr mapping = new Mapping;
  mapping->write("frameRate", 500);
  EXPECT_EQ(mapping->get({"frame_rate", "frameRate"}, 0), 500);
  EXPECT_EQ(mapping->get<int>({"frame_rate", "frameRate"}), 500);
  EXPECT_FALSE(mapping->find({"rate", "fps"})->isValid());
}

TEST(Mapping, GivesAnInvalidNodeForWhatIsNotThere) {
  const MappingPtr mapping = new Mapping;
  EXPECT_FALSE(mapping->find("a")->isValid());
  EXPECT_FALSE(mapping->findMapping("a")->findListing("b")->isValid());
  mapping->write("a", 1);
  EXPECT_TRUE(mapping->find("a")->isValid());
  EXPECT_FALSE(mapping->findMapping("a")->isValid()) << "it is there, but no mapping";
}

TEST(Mapping, OpensWhatIsThereAndCreatesWhatIsNot) {
  const MappingPtr mapping = new Mapping;
  Mapping* first = mapping->openMapping("a");
  EXPECT_EQ(mapping->openMapping("a"), first);
  EXPECT_NE(mapping->createMapping("a"), first);
  mapping->openListing("b")->append(1);
  EXPECT_EQ(mapping->openListing("b")->size(), 1);
  EXPECT_EQ(mapping->createListing("b")->size(), 0);
}

TEST(Mapping, TakesFromAnotherOnlyWhatItHasNot) {
  const MappingPtr mapping = new Mapping;
  const MappingPtr other = new Mapping;
  mapping->write("a", 1);
  other->write("a", 2);
  other->write("b", 3);
  mapping->insert(other);
  EXPECT_EQ(mapping->get("a", 0), 1);
  EXPECT_EQ(mapping->get("b", 0), 3);
}

TEST(Mapping, GivesUpWhatIsRemovedOrExtracted) {
  const MappingPtr mapping = new Mapping;
  mapping->write("a", 1);
  mapping->write("b", 2);
  EXPECT_TRUE(mapping->remove("a"));
  EXPECT_FALSE(mapping->remove("a"));
  EXPECT_EQ(mapping->extract("b")->toInt(), 2);
  EXPECT_EQ(mapping->extract("b"), nullptr);
  EXPECT_TRUE(mapping->empty());
}

TEST(Mapping, SharesNodesWithACloneAndNoneWithADeepClone) {
  const MappingPtr mapping = new Mapping;
  mapping->createMapping("inner")->write("a", 1);
  mapping->createListing("list")->newMapping()->write("b", 2);
  const MappingPtr shallow = mapping->clone();
  const MappingPtr deep = mapping->deepClone();
  mapping->findMapping("inner")->write("a", 10);
  mapping->findListing("list")->at(0)->toMapping()->write("b", 20);
  EXPECT_EQ(shallow->findMapping("inner")->get("a", 0), 10);
  EXPECT_EQ(deep->findMapping("inner")->get("a", 0), 1);
  EXPECT_EQ(deep->findListing("list")->at(0)->toMapping()->get("b", 0), 2);
}

TEST(Mapping, HasItsKeysInAlphabeticalOrder) {
  const MappingPtr mapping = new Mapping;
  for (const char* key : {"b", "c", "a"}) mapping->write(key, 0);
  std::string keys;
  for (const auto& entry : *mapping) keys += entry.first;
  EXPECT_EQ(keys, "abc");
}

TEST(Listing, HasItsElementsInOrder) {
  const ListingPtr listing = new Listing;
  listing->append(1);
  listing->append(2.5);
  listing->append("three");
  EXPECT_EQ(listing->size(), 3);
  EXPECT_EQ((*listing)[0].toInt(), 1);
  EXPECT_EQ((*listing)[1].to<double>(), 2.5);
  EXPECT_EQ(listing->back()->toString(), "three");
  EXPECT_EQ(listing->front()->toInt(), 1);
}

std::string problem_of(const std::function<void()>& question) {
  try {
    question();
  } catch (const ValueNode::Exception& problem) {
    return problem.message();
  }
  return "no problem";
}

TEST(ValueNode, SaysWhereAndWhyAValueCanNotBeHad) {
  const MappingPtr mapping = new Mapping;
  mapping->setPosition(3, 5);
  mapping->write("a", "many");
  mapping->find("a")->setPosition(4, 9);
  EXPECT_EQ(problem_of([&] { (*mapping)["b"].toInt(); }), "line 3, column 5: the key \"b\" is missing");
  EXPECT_EQ(problem_of([&] { (*mapping)["a"].toInt(); }), "line 4, column 9: \"many\" is no whole number");
  EXPECT_EQ(problem_of([&] { (*mapping)["a"].toDouble(); }), "line 4, column 9: \"many\" is no number");
  EXPECT_EQ(problem_of([&] { (*mapping)["a"].toBool(); }),
            "line 4, column 9: \"many\" is no truth value (true or false)");
  EXPECT_EQ(problem_of([&] { (*mapping)["a"].toListing(); }),
            "line 4, column 9: a list is expected here, not a single value");
  EXPECT_EQ(problem_of([&] { mapping->toString(); }),
            "line 3, column 5: a single value is expected here, not a mapping");
  EXPECT_THAT(problem_of([&] { mapping->get<int>("a"); }), HasSubstr("line 4, column 9: the value of \"a\" is not"));
  const ListingPtr listing = new Listing;
  EXPECT_EQ(problem_of([&] { listing->at(0); }), "element 0 is asked for in a list of 0");
  EXPECT_THROW(listing->toMapping(), ValueNode::NotMappingException);
}

TEST(ValueNode, ReadsNumbersInOneWayWhateverTheLocale) {
  double number = 0.0;
  EXPECT_TRUE(cnoid::ValueNodePtr(new ScalarNode("-1.5e-3"))->read(number));
  EXPECT_EQ(number, -1.5e-3);
  EXPECT_FALSE(cnoid::ValueNodePtr(new ScalarNode("1,5"))->read(number));
  EXPECT_FALSE(cnoid::ValueNodePtr(new ScalarNode("1.5 m"))->read(number));
  EXPECT_FALSE(cnoid::ValueNodePtr(new ScalarNode(""))->read(number));
}

}  // namespace
