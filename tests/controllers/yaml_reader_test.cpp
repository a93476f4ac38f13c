#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cnoid/YAMLReader>

#include <filesystem>
#include <fstream>
#include <string>

namespace {

using cnoid::Mapping;
using cnoid::ValueNode;
using cnoid::YAMLReader;
using testing::HasSubstr;
using testing::StartsWith;

TEST(YAMLReader, BuildsATreeThatKnowsItsPlaces) {
  YAMLReader reader;
  ASSERT_TRUE(reader.parse("a: 1\nb:\n  - x\n  - { c: 2.5 }\n")) << reader.errorMessage();
  ASSERT_EQ(reader.numDocuments(), 1);
  const Mapping& top = *reader.document()->toMapping();
  EXPECT_EQ(top["a"].toInt(), 1);
  const cnoid::Listing& list = *top["b"].toListing();
  EXPECT_EQ(list[0].toString(), "x");
  EXPECT_EQ(list[1].toMapping()->get("c", 0.0), 2.5);
  EXPECT_EQ(list[1].line(), 4);
  EXPECT_EQ(list[1].column(), 5);
}

TEST(YAMLReader, ReadsSeveralDocumentsAndNone) {
  YAMLReader reader;
  ASSERT_TRUE(reader.parse("--- 1\n--- 2\n"));
  EXPECT_EQ(reader.numDocuments(), 2);
  EXPECT_EQ(reader.document(1)->toInt(), 2);
  EXPECT_EQ(reader.document(2), nullptr);
  ASSERT_TRUE(reader.parse("# nothing\n"));
  EXPECT_EQ(reader.numDocuments(), 0);
}

TEST(YAMLReader, SharesTheNodeOfAnAlias) {
  YAMLReader reader;
  ASSERT_TRUE(reader.parse("a: &x [1, 2]\nb: *x\n"));
  const Mapping& top = *reader.document()->toMapping();
  EXPECT_EQ(top.find("a"), top.find("b"));
}

TEST(YAMLReader, RefusesAnAliasWithinItself) {
  YAMLReader reader;
  EXPECT_FALSE(reader.parse("a: &x [1, *x]\n"));
  EXPECT_EQ(reader.errorMessage(), "line 1, column 11: an alias stands within what it is an alias of");
  EXPECT_EQ(reader.numDocuments(), 0);
}

TEST(YAMLReader, RefusesAKeyThatIsGivenTwice) {
  YAMLReader reader;
  EXPECT_FALSE(reader.parse("a: 1\na: 2\n"));
  EXPECT_EQ(reader.errorMessage(), "line 2, column 1: the key \"a\" is given twice");
}

TEST(YAMLReader, RefusesAKeyThatIsAList) {
  YAMLReader reader;
  EXPECT_FALSE(reader.parse("? [1, 2]\n: 3\n"));
  EXPECT_THAT(reader.errorMessage(), HasSubstr("a key must be a single value"));
}

TEST(YAMLReader, SaysWhereATextIsNoYaml) {
  YAMLReader reader;
  EXPECT_FALSE(reader.parse("a: [1, 2\nb: 3\n"));
  EXPECT_THAT(reader.errorMessage(), StartsWith("line 2, column"));
  EXPECT_TRUE(reader.parse("a: 1"));
  EXPECT_EQ(reader.errorMessage(), "") << "the old message must go";
}

TEST(YAMLReader, SaysWhichFileCanNotBeRead) {
  YAMLReader reader;
  EXPECT_FALSE(reader.load("/no/such/file.yaml"));
  EXPECT_EQ(reader.errorMessage(), "/no/such/file.yaml: the file can't be read");
  EXPECT_FALSE(reader.load(testing::TempDir())) << "a folder";
  EXPECT_THROW(reader.loadDocument("/no/such/file.yaml"), ValueNode::FileException);
}

TEST(YAMLReader, LoadsAFile) {
  const std::string path = testing::TempDir() + "yaml_reader_test.yaml";
  std::ofstream(path) << "a: 1\n";
  YAMLReader reader;
  EXPECT_EQ(reader.loadDocument(path)->toMapping()->get("a", 0), 1);
  std::ofstream(path, std::ios::trunc) << "";
  EXPECT_TRUE(reader.load(path)) << reader.errorMessage();
  EXPECT_THROW(reader.loadDocument(path), ValueNode::FileException);
  std::filesystem::remove(path);
}

TEST(YAMLReader, ComesToAnEndOnAStrayComma) {
  YAMLReader reader;
  EXPECT_FALSE(reader.parse("# a motion\n, 2.5 type: CompositeSeq\n"));
  EXPECT_EQ(reader.errorMessage(), "line 2, column 1: this can't stand here");
}

TEST(YAMLReader, RefusesNestingWithoutEnd) {
  YAMLReader reader;
  EXPECT_FALSE(reader.parse(std::string(100000, '[')));
  EXPECT_NE(reader.errorMessage(), "");
}

}  // namespace
