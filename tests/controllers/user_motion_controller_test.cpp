// user_motion_controller.cpp, compiled outside the build with only include paths, in the process of the harness.
#include <gtest/gtest.h>
#include <cnoid/HolderDevice>
#include <cnoid/Joystick>

#include <filesystem>
#include <memory>
#include <string>

#include "bodies.h"
#include "controller_library.h"
#include "scripted_joystick.h"
#include "share_variable.h"
#include "test_io.h"

namespace {

using rehearse::test::ControllerLibrary;
using rehearse::test::ScriptedJoystick;
using rehearse::test::ShareVariable;
using rehearse::test::TestIO;

class UserMotionController : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const std::string path = USER_CONTROLLER_DIR "/user_motion_controller_" + GetParam() + ".so";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "there is no compiler for " << GetParam() << " on this machine";
    if (GetParam() == "avx2" && !__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
    holder_ = new cnoid::HolderDevice;
    body_->addDevice(holder_, body_->link("HAND"));
    cnoid::ExtJoystick::registerJoystick("script", &joystick_);
    library_ = std::make_unique<ControllerLibrary>(path);
    ASSERT_NE(library_->controller(), nullptr);
  }

  cnoid::SimpleController& controller() { return *library_->controller(); }

  ScriptedJoystick joystick_;
  // Before the body, so that it is closed after it: the body holds a joystick whose code is in the library.
  std::unique_ptr<ControllerLibrary> library_;
  cnoid::BodyPtr body_ = rehearse::test::make_arm();
  cnoid::HolderDevice* holder_ = nullptr;
  TestIO io_{body_};
};

TEST_P(UserMotionController, FollowsItsMotion) {
  const ShareVariable share(FIXTURES_DIR "/motions");
  ASSERT_TRUE(controller().initialize(&io_)) << io_.messages.str();
  EXPECT_TRUE(controller().control());
  EXPECT_EQ(body_->joint(1)->q_target(), -0.036);
  EXPECT_EQ(body_->rootLink()->dq_target(), 0.1);
  joystick_.axes[1] = 1.0;
  EXPECT_TRUE(controller().control());
  EXPECT_EQ(body_->joint(1)->q_target(), 2 * -0.035);
  EXPECT_FALSE(controller().control()) << "three frames, three steps";
  EXPECT_EQ(body_->joint(0)->q_target(), 2 * 0.5);
}

TEST_P(UserMotionController, TellsOfItsDevice) {
  const ShareVariable share(FIXTURES_DIR "/motions");
  ASSERT_TRUE(controller().initialize(&io_)) << io_.messages.str();
  int states = 0;
  int infos = 0;
  holder_->sigStateChanged().connect([&] { ++states; });
  holder_->sigInfoChanged().connect([&] { ++infos; });
  joystick_.buttons[cnoid::Joystick::A_BUTTON] = true;
  controller().control();
  controller().control();
  EXPECT_TRUE(holder_->on());
  EXPECT_EQ(holder_->info()->get("grip", 0.0), 0.5);
  EXPECT_EQ(states, 2);
  EXPECT_EQ(infos, 2);
}

TEST_P(UserMotionController, SaysWhichMotionIsMissing) {
  const ShareVariable share("/no/such/folder");
  EXPECT_FALSE(controller().initialize(&io_));
  EXPECT_EQ(io_.messages.str(), "/no/such/folder/version2.seq: error: the file can't be read\n\n");
}

INSTANTIATE_TEST_SUITE_P(CompiledBy, UserMotionController, testing::Values("gcc", "O0", "avx2", "clang"),
                         [](const auto& test) { return test.param; });

}  // namespace
