// user_controller.cpp, compiled outside the build with only include paths, in the process of the harness.
#include <gtest/gtest.h>
#include <cnoid/BasicSensors>
#include <cnoid/RangeCamera>
#include <cnoid/SpotLight>

#include <filesystem>

#include "bodies.h"
#include "controller_library.h"
#include "test_io.h"

namespace {

using cnoid::Body;
using cnoid::BodyPtr;
using cnoid::Device;
using cnoid::Link;
using cnoid::Vector3;
using rehearse::test::ControllerLibrary;
using rehearse::test::TestIO;

template <class DeviceType>
DeviceType* add(Body& body, const std::string& link, const std::string& name) {
  auto* device = new DeviceType;
  device->setName(name);
  EXPECT_TRUE(body.addDevice(device, body.link(link)));
  return device;
}

class UserController : public testing::TestWithParam<const char*> {
 protected:
  UserController() : io_(body_) {
    force_ = add<cnoid::ForceSensor>(*body_, "HAND", "wrist");
    camera_ = add<cnoid::RangeCamera>(*body_, "BASE", "eye");
    accelerometer_ = add<cnoid::AccelerationSensor>(*body_, "BASE", "accel");
    light_ = add<cnoid::SpotLight>(*body_, "BASE", "lamp");
  }

  void SetUp() override {
    const std::string path = std::string(USER_CONTROLLER_DIR "/") + GetParam() + ".so";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "there is no compiler for " << GetParam() << " on this machine";
    if (std::string(GetParam()) == "user_controller_avx2" && !__builtin_cpu_supports("avx2")) {
      GTEST_SKIP() << "this processor has no AVX2";
    }
    library_ = std::make_unique<ControllerLibrary>(path);
    ASSERT_NE(library_->controller(), nullptr);
  }

  cnoid::SimpleController& controller() { return *library_->controller(); }

  // First, so that it is closed last: the body may hold objects whose code is in the library.
  std::unique_ptr<ControllerLibrary> library_;
  BodyPtr body_ = rehearse::test::make_arm();
  cnoid::ForceSensor* force_;
  cnoid::RangeCamera* camera_;
  cnoid::AccelerationSensor* accelerometer_;
  cnoid::SpotLight* light_;
  TestIO io_;
};

TEST_P(UserController, IsConfiguredAndInitialized) {
  io_.options_text = "fast \"two words\"";
  cnoid::SimpleControllerConfig config(&io_);
  EXPECT_TRUE(controller().configure(&config));
  EXPECT_TRUE(controller().initialize(&io_));
  EXPECT_EQ(io_.messages.str(), "configured arm\noption fast\noption two words\n");
  EXPECT_EQ(io_.outputs, (std::set<std::string>{"ARM", "HAND"}));
  EXPECT_EQ(io_.inputs["BASE"], Link::LinkPosition | Link::LinkTwist | Link::LinkAcceleration);
  EXPECT_EQ(io_.device_inputs, (std::set<std::string>{"accel", "wrist"}));
  EXPECT_EQ(body_->joint(0)->actuationMode(), Link::JointEffort);
}

TEST_P(UserController, ReadsInputsAndWritesCommands) {
  ASSERT_TRUE(controller().initialize(&io_));
  body_->joint(0)->q() = 0.001;
  body_->rootLink()->setTranslation(Vector3(0, 0, 0.5));
  accelerometer_->dv() = Vector3(0, 0, 9.5);
  force_->F()[2] = 20.0;
  EXPECT_TRUE(controller().control());
  EXPECT_DOUBLE_EQ(body_->joint(0)->u(), -0.001 * 100.0 - 0.001 / 0.001 * 10.0);
  EXPECT_DOUBLE_EQ(body_->joint(0)->q_target(), 0.5 + 9.5 + 20.0);
}

TEST_P(UserController, NotifiesADeviceOfItsNewState) {
  ASSERT_TRUE(controller().initialize(&io_));
  int notified = 0;
  light_->sigStateChanged().connect([&] { ++notified; });
  controller().control();
  EXPECT_EQ(notified, 1);
  EXPECT_TRUE(light_->on());
  EXPECT_EQ(light_->beamWidth(), 1.570796f - 0.5f);
  camera_->newImage().setSize(1, 1, 3);
  controller().control();
  EXPECT_FALSE(light_->on());
}

TEST_P(UserController, MayLeaveASharedObjectBehind) {
  ASSERT_TRUE(controller().initialize(&io_));
  controller().control();
  EXPECT_NE(body_->findCache<cnoid::Referenced>("counter"), nullptr);
}

INSTANTIATE_TEST_SUITE_P(CompiledBy, UserController,
                         testing::Values("user_controller_gcc", "user_controller_O0", "user_controller_avx2",
                                         "user_controller_clang"),
                         [](const auto& test) { return std::string(test.param).substr(sizeof "user_controller"); });

}  // namespace
