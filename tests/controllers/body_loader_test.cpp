#include <gtest/gtest.h>
#include <cnoid/BodyLoader>

#include <memory>
#include <sstream>
#include <string>

#include "bodies.h"

namespace {

using cnoid::BodyLoader;
using cnoid::BodyPtr;

class FixedLoader : public cnoid::AbstractBodyLoader {
 public:
  void setMessageSink(std::ostream& os) override { os_ = &os; }
  void setVerbose(bool on) override { is_verbose_ = on; }
  bool load(cnoid::Body* body, const std::string& filename) override {
    if (filename == "bad.robot") {
      *os_ << "bad.robot can't be read\n";
      return false;
    }
    if (is_verbose_) *os_ << "loaded\n";
    body->copyFrom(rehearse::test::make_biped());
    return true;
  }

 private:
  std::ostream* os_ = nullptr;
  bool is_verbose_ = false;
};

class BodyLoaderTest : public testing::Test {
 protected:
  BodyLoaderTest() {
    BodyLoader::registerLoader({"robot"}, [] { return std::make_shared<FixedLoader>(); });
    loader_.setMessageSink(os_);
  }

  BodyLoader loader_;
  std::ostringstream os_;
};

TEST_F(BodyLoaderTest, LoadsByTheEndingOfTheFile) {
  EXPECT_EQ(loader_.lastActualBodyLoader(), nullptr);
  const BodyPtr body = loader_.load("some/where.ROBOT");
  ASSERT_TRUE(body);
  EXPECT_EQ(body->numJoints(), 14);
  EXPECT_NE(loader_.lastActualBodyLoader(), nullptr);
  EXPECT_EQ(os_.str(), "");
  loader_.setVerbose(true);
  const BodyPtr into = rehearse::test::make_arm();
  EXPECT_TRUE(loader_.load(into, "a.robot"));
  EXPECT_EQ(into->name(), "biped");
  EXPECT_EQ(os_.str(), "loaded\n");
}

TEST_F(BodyLoaderTest, ReportsAFileThatItCantLoad) {
  const BodyPtr body = rehearse::test::make_arm();
  EXPECT_FALSE(loader_.load(body, "bad.robot"));
  EXPECT_EQ(body->name(), "arm");
  EXPECT_EQ(loader_.load("bad.robot"), nullptr);
  EXPECT_EQ(os_.str(), "bad.robot can't be read\nbad.robot can't be read\n");
}

TEST_F(BodyLoaderTest, ReportsAFormatWithoutALoader) {
  EXPECT_EQ(loader_.load("a.sdf"), nullptr);
  EXPECT_EQ(os_.str(), "a.sdf: error: no loader is registered for this file name extension\n");
}

}  // namespace
