#include <gtest/gtest.h>
#include <cnoid/SharedJoystick>

#include <memory>

#include "bodies.h"
#include "scripted_joystick.h"
#include "test_io.h"

namespace {

using cnoid::ExtJoystick;
using cnoid::Joystick;
using cnoid::SharedJoystick;
using cnoid::SharedJoystickPtr;
using rehearse::test::ScriptedJoystick;

TEST(Joystick, WithoutADeviceReadsZeroAndIsNoError) {
  Joystick joystick;
  EXPECT_FALSE(joystick.makeReady());
  EXPECT_FALSE(joystick.isReady());
  EXPECT_STREQ(joystick.errorMessage(), "");
  EXPECT_EQ(joystick.numAxes(), 0);
  EXPECT_EQ(joystick.numButtons(), 0);
  EXPECT_FALSE(joystick.readCurrentState());
  EXPECT_EQ(joystick.getPosition(Joystick::L_STICK_V_AXIS), 0.0);
  EXPECT_FALSE(joystick.getButtonState(Joystick::A_BUTTON));
  EXPECT_FALSE(joystick.isActive());
  EXPECT_FALSE(joystick.sigAxis().connect([](int, double) {}).connected());
  EXPECT_FALSE(joystick.sigButton().connect([](int, bool) {}).connected());
}

TEST(Joystick, HasChoreonoidsNumbersOfAxesAndButtons) {
  EXPECT_EQ(Joystick::R_STICK_V_AXIS, 3);
  EXPECT_EQ(Joystick::R_TRIGGER_AXIS, 7);
  EXPECT_EQ(Joystick::START_BUTTON, 7);
  EXPECT_EQ(Joystick::LOGO_BUTTON, 10);
}

TEST(Joystick, UsesTheOneThatTheHostHasRegistered) {
  ScriptedJoystick scripted;
  ExtJoystick::registerJoystick("script", &scripted);
  Joystick joystick;
  ASSERT_TRUE(joystick.isReady());
  EXPECT_EQ(joystick.numAxes(), 4);
  EXPECT_EQ(joystick.numButtons(), 11);
  scripted.axes[Joystick::L_STICK_V_AXIS] = -0.5;
  scripted.buttons[Joystick::B_BUTTON] = true;
  EXPECT_TRUE(joystick.readCurrentState());
  EXPECT_EQ(scripted.reads, 1);
  EXPECT_EQ(joystick.getPosition(Joystick::L_STICK_V_AXIS), -0.5);
  EXPECT_TRUE(joystick.getButtonState(Joystick::B_BUTTON));
  EXPECT_TRUE(joystick.isActive());
  EXPECT_TRUE(joystick.sigAxis().connect([](int, double) {}).connected());
}

TEST(Joystick, ReadsZeroOnAxesAndButtonsThatTheDeviceHasNot) {
  ScriptedJoystick scripted;
  ExtJoystick::registerJoystick("script", &scripted);
  const Joystick joystick;
  EXPECT_EQ(joystick.getPosition(4), 0.0);
  EXPECT_EQ(joystick.getPosition(-1), 0.0);
  EXPECT_FALSE(joystick.getButtonState(11));
  EXPECT_FALSE(joystick.getButtonState(-1));
}

TEST(Joystick, FindsADeviceThatComesLaterWhenItIsMadeReady) {
  Joystick joystick;
  ScriptedJoystick scripted;
  ExtJoystick::registerJoystick("script", &scripted);
  EXPECT_FALSE(joystick.isReady());
  EXPECT_TRUE(joystick.makeReady());
  EXPECT_EQ(joystick.numAxes(), 4);
}

TEST(Joystick, LetsGoOfADeviceThatIsGone) {
  auto scripted = std::make_unique<ScriptedJoystick>();
  ExtJoystick::registerJoystick("script", scripted.get());
  const Joystick joystick;
  ASSERT_TRUE(joystick.isReady());
  scripted.reset();
  EXPECT_FALSE(joystick.isReady());
  EXPECT_EQ(joystick.getPosition(0), 0.0);
  EXPECT_EQ(ExtJoystick::findJoystick("script"), nullptr);
}

TEST(Joystick, KeepsADeviceThatIsTakenOutOfTheRegisterWhichNobodyElseFinds) {
  ScriptedJoystick scripted;
  ExtJoystick::registerJoystick("script", &scripted);
  const Joystick early;
  ExtJoystick::registerJoystick("script", nullptr);
  EXPECT_TRUE(early.isReady());
  EXPECT_FALSE(Joystick().isReady());
  EXPECT_EQ(ExtJoystick::findJoystick("script"), nullptr);
  EXPECT_EQ(ExtJoystick::findJoystick("*"), nullptr);
}

TEST(Joystick, PrefersTheDeviceOfItsNameAndElseTakesTheFirst) {
  ScriptedJoystick left, right;
  ExtJoystick::registerJoystick("right", &right);
  ExtJoystick::registerJoystick("left", &left);
  left.axes[0] = -1.0;
  right.axes[0] = 1.0;
  EXPECT_EQ(Joystick("right").getPosition(0), 1.0);
  EXPECT_EQ(Joystick().getPosition(0), -1.0);
  EXPECT_EQ(Joystick("/dev/input/js0").getPosition(0), -1.0);
}

TEST(Joystick, KeepsItsDeviceWhenAnotherTakesItsName) {
  ScriptedJoystick first, second;
  ExtJoystick::registerJoystick("script", &first);
  Joystick joystick;
  ExtJoystick::registerJoystick("script", &second);
  second.axes[0] = 1.0;
  EXPECT_TRUE(joystick.makeReady());
  EXPECT_EQ(joystick.getPosition(0), 0.0);
  EXPECT_EQ(Joystick().getPosition(0), 1.0);
}

class SharedJoystickOfTwo : public testing::Test {
 protected:
  SharedJoystickOfTwo() {
    ExtJoystick::registerJoystick("script", &scripted_);
    joystick_ = new SharedJoystick;
    parent_ = joystick_->addMode();
    child_ = joystick_->addMode();
  }
  void step(bool button) {
    scripted_.buttons[Joystick::SELECT_BUTTON] = button;
    joystick_->updateState(parent_);
    joystick_->updateState(child_);
  }

  ScriptedJoystick scripted_;
  SharedJoystickPtr joystick_;
  int parent_;
  int child_;
};

TEST_F(SharedJoystickOfTwo, IsPolledByTheFirstOnly) {
  step(false);
  EXPECT_EQ(scripted_.reads, 1);
}

TEST_F(SharedJoystickOfTwo, StepsItsModeWhenTheButtonGoesDown) {
  EXPECT_TRUE(joystick_->isMode(parent_));
  step(true);
  EXPECT_TRUE(joystick_->isMode(child_));
  step(true);
  EXPECT_TRUE(joystick_->isMode(child_)) << "a button that is held counts once";
  step(false);
  step(true);
  EXPECT_TRUE(joystick_->isMode(parent_)) << "after the last mode comes the first";
}

TEST_F(SharedJoystickOfTwo, GivesZeroToWhoseTurnItIsNot) {
  scripted_.axes[1] = 0.5;
  scripted_.buttons[Joystick::A_BUTTON] = true;
  EXPECT_EQ(joystick_->getPosition(parent_, 1, 0.1), 0.5);
  EXPECT_EQ(joystick_->getPosition(child_, 1, 0.1), 0.0);
  EXPECT_TRUE(joystick_->getButtonState(parent_, Joystick::A_BUTTON));
  EXPECT_FALSE(joystick_->getButtonState(child_, Joystick::A_BUTTON));
  joystick_->setMode(child_);
  EXPECT_EQ(joystick_->getPosition(child_, 1), 0.5);
}

TEST_F(SharedJoystickOfTwo, TellsAModeFromAThresholdByItsType) {
  scripted_.axes[1] = 0.5;
  EXPECT_EQ(joystick_->getPosition(1, 0.6), 0.0) << "axis 1 with a threshold";
  EXPECT_EQ(joystick_->getPosition(1, 0.5), 0.5) << "the threshold itself is enough";
  EXPECT_EQ(joystick_->getPosition(0, 1), 0.5) << "mode 0, axis 1";
}

TEST_F(SharedJoystickOfTwo, MayUseAnotherDevice) {
  struct Other : cnoid::JoystickInterface {
    int numAxes() const override { return 1; }
    int numButtons() const override { return 0; }
    bool readCurrentState() override { return true; }
    double getPosition(int) const override { return 0.25; }
    bool getButtonState(int) const override { return false; }
  } other;
  joystick_->setJoystick(&other);
  EXPECT_EQ(joystick_->getPosition(0), 0.25);
}

TEST(SharedJoystick, IsOneForAllWhoShareABody) {
  rehearse::test::TestIO parent(rehearse::test::make_arm());
  rehearse::test::TestIO child(parent.body());
  auto* joystick = parent.getOrCreateSharedObject<SharedJoystick>("joystick");
  EXPECT_EQ(joystick->addMode(), 0);
  EXPECT_EQ(child.getOrCreateSharedObject<SharedJoystick>("joystick"), joystick);
  EXPECT_EQ(joystick->addMode(), 1);
}

}  // namespace
