#include <gtest/gtest.h>
#include <cnoid/AttachmentDevice>
#include <cnoid/HolderDevice>

#include "bodies.h"

namespace {

using cnoid::AttachmentDevice;
using cnoid::AttachmentDevicePtr;
using cnoid::HolderDevice;
using cnoid::HolderDevicePtr;

TEST(HolderDevice, IsOffUntilItIsSwitchedOn) {
  const HolderDevicePtr holder = new HolderDevice;
  EXPECT_FALSE(holder->on());
  holder->on(true);
  EXPECT_TRUE(holder->on());
  EXPECT_EQ(holder->maxHoldDistance(), 0.1);
  EXPECT_EQ(holder->holdCondition(), HolderDevice::Distance);
}

TEST(HolderDevice, HoldsAnAttachmentOnceAndTakesItFromAnother) {
  const HolderDevicePtr left = new HolderDevice;
  const HolderDevicePtr right = new HolderDevice;
  const AttachmentDevicePtr attachment = new AttachmentDevice;
  EXPECT_TRUE(left->addAttachment(attachment));
  EXPECT_FALSE(left->addAttachment(attachment));
  EXPECT_EQ(attachment->holder(), left);
  EXPECT_TRUE(right->addAttachment(attachment));
  EXPECT_EQ(left->numAttachments(), 0);
  EXPECT_EQ(right->attachment(0), attachment);
  EXPECT_EQ(right->attachment(1), nullptr);
}

TEST(HolderDevice, LetsGo) {
  const HolderDevicePtr holder = new HolderDevice;
  const AttachmentDevicePtr attachment = new AttachmentDevice;
  holder->addAttachment(attachment);
  attachment->detach();
  EXPECT_FALSE(attachment->isAttaching());
  EXPECT_FALSE(holder->removeAttachment(attachment));
  holder->addAttachment(attachment);
  holder->removeAttachment(0);
  EXPECT_FALSE(attachment->isAttaching());
  holder->removeAttachment(0);
  EXPECT_EQ(holder->numAttachments(), 0);
}

TEST(HolderDevice, LetsGoWhenItGoes) {
  HolderDevicePtr holder = new HolderDevice;
  const AttachmentDevicePtr attachment = new AttachmentDevice;
  holder->addAttachment(attachment);
  holder.reset();
  EXPECT_FALSE(attachment->isAttaching());
}

TEST(HolderDevice, HasACopyThatHoldsNothing) {
  const HolderDevicePtr holder = new HolderDevice;
  const AttachmentDevicePtr attachment = new AttachmentDevice;
  holder->addCategory("cup");
  holder->setHoldTargetName("CUP");
  holder->addAttachment(attachment);
  const cnoid::DevicePtr copy = holder->clone();
  const auto* same = dynamic_cast<HolderDevice*>(copy.get());
  EXPECT_EQ(same->numAttachments(), 0);
  EXPECT_TRUE(same->hasCategory("cup"));
  EXPECT_EQ(same->holdTargetName(), "CUP");
}

TEST(AttachmentDevice, FitsAHolderOfAnotherBodyThatTakesItsCategory) {
  const cnoid::BodyPtr robot = rehearse::test::make_arm();
  const cnoid::BodyPtr object = rehearse::test::make_arm();
  auto* holder = new HolderDevice;
  auto* attachment = new AttachmentDevice;
  robot->addDevice(holder, robot->rootLink());
  object->addDevice(attachment, object->rootLink());
  EXPECT_TRUE(attachment->isAttachableTo(holder)) << "a holder without categories takes all";
  holder->addCategory("cup");
  holder->addCategory("");
  EXPECT_EQ(holder->categories().size(), 1u);
  EXPECT_FALSE(attachment->isAttachableTo(holder));
  attachment->setCategory("cup");
  EXPECT_TRUE(attachment->isAttachableTo(holder));

  auto* own = new AttachmentDevice;
  own->setCategory("cup");
  robot->addDevice(own, robot->rootLink());
  EXPECT_FALSE(own->isAttachableTo(holder)) << "of the same body";
}

}  // namespace
