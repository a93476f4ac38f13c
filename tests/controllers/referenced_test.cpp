#include <gtest/gtest.h>
#include <cnoid/Referenced>

#include <memory>
#include <sstream>

namespace {

using cnoid::ref_ptr;
using cnoid::weak_ref_ptr;

struct Counted : cnoid::Referenced {
  explicit Counted(int& alive_count) : alive(alive_count) { ++alive; }
  ~Counted() override { --alive; }
  int& alive;
};

struct Special : Counted {
  using Counted::Counted;
};

TEST(RefPtr, DeletesTheObjectWithItsLastOwner) {
  int alive = 0;
  ref_ptr<Counted> first = new Counted(alive);
  ref_ptr<Counted> second = first;
  first.reset();
  EXPECT_EQ(alive, 1);
  second = nullptr;
  EXPECT_EQ(alive, 0);
}

TEST(RefPtr, ConvertsToARawPointerInBothDirections) {
  int alive = 0;
  Counted* raw = new Counted(alive);
  ref_ptr<Counted> owner = raw;
  Counted* borrowed = owner;
  EXPECT_EQ(borrowed, raw);
  EXPECT_TRUE(owner == raw);
  EXPECT_TRUE(raw == owner);
  EXPECT_TRUE(owner != nullptr);
  EXPECT_TRUE(owner ? true : false);
}

TEST(RefPtr, KeepsTheObjectThroughSelfAssignmentAndMoves) {
  int alive = 0;
  ref_ptr<Counted> owner = new Counted(alive);
  const ref_ptr<Counted>& same = owner;
  owner = same;
  EXPECT_EQ(alive, 1);
  ref_ptr<Counted> moved = std::move(owner);
  EXPECT_EQ(alive, 1);
  EXPECT_EQ(owner.get(), nullptr);
  EXPECT_NE(moved.get(), nullptr);
}

TEST(RefPtr, OwnsADerivedObjectByItsBase) {
  int alive = 0;
  {
    ref_ptr<Counted> base = ref_ptr<Special>(new Special(alive));
    EXPECT_EQ(alive, 1);
  }
  EXPECT_EQ(alive, 0);
}

TEST(RefPtr, CastsOnlyToWhatTheObjectIs) {
  int alive = 0;
  const ref_ptr<Counted> plain = new Counted(alive);
  const ref_ptr<Counted> special = new Special(alive);
  EXPECT_EQ(cnoid::dynamic_pointer_cast<Special>(plain), nullptr);
  EXPECT_EQ(dynamic_pointer_cast<Special>(special).get(), special.get());  // found without cnoid::, as sources write it
  EXPECT_EQ(static_pointer_cast<Special>(special).get(), special.get());
}

TEST(RefPtr, GivesAnObjectUpWithoutDeletingIt) {
  int alive = 0;
  ref_ptr<Counted> owner = new Counted(alive);
  const std::unique_ptr<Counted> released(owner.retn());
  EXPECT_EQ(alive, 1);
  EXPECT_EQ(owner.get(), nullptr);
}

TEST(RefPtr, PrintsAsItsAddress) {
  std::ostringstream text;
  std::ostringstream expected;
  int alive = 0;
  const ref_ptr<Counted> owner = new Counted(alive);
  text << owner;
  expected << owner.get();
  EXPECT_EQ(text.str(), expected.str());
}

TEST(WeakRefPtr, LocksWhileTheObjectLivesAndNotAfter) {
  int alive = 0;
  ref_ptr<Counted> owner = new Counted(alive);
  const weak_ref_ptr<Counted> weak = owner;
  EXPECT_EQ(weak.lock().get(), owner.get());
  EXPECT_FALSE(weak.expired());
  owner.reset();
  EXPECT_EQ(alive, 0);
  EXPECT_EQ(weak.lock().get(), nullptr);
  EXPECT_TRUE(weak.expired());
}

TEST(WeakRefPtr, OfNothingHasNotExpired) {
  const weak_ref_ptr<Counted> weak;
  EXPECT_FALSE(weak.expired());
  EXPECT_EQ(weak.lock().get(), nullptr);
}

}  // namespace
