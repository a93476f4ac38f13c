#include <gtest/gtest.h>
#include <cnoid/FireDevice>
#include <cnoid/FountainDevice>
#include <cnoid/GeneralSliderView>

#include <stdexcept>
#include <vector>

namespace {

using cnoid::FireDevice;
using cnoid::FireDevicePtr;
using cnoid::FountainDevice;
using cnoid::FountainDevicePtr;
using cnoid::Vector3f;

TEST(FireDevice, HasChoreonoidsDefaults) {
  const FireDevicePtr fire = new FireDevice;
  EXPECT_TRUE(fire->on());
  EXPECT_EQ(fire->particleSystem().lifeTime(), 5.0f);
  EXPECT_EQ(fire->particleSystem().numParticles(), 200);
  EXPECT_EQ(fire->particleSystem().particleSize(), 0.25f);
  EXPECT_EQ(fire->particleSystem().acceleration(), Vector3f(0.0f, 0.0f, 0.05f));
}

TEST(FountainDevice, HasChoreonoidsDefaults) {
  const FountainDevicePtr water = new FountainDevice;
  EXPECT_EQ(water->particleSystem().lifeTime(), 3.0f);
  EXPECT_EQ(water->particleSystem().numParticles(), 1000);
  EXPECT_EQ(water->particleSystem().initialSpeedAverage(), 0.1f);
}

TEST(FireDevice, ReadsTheStateThatItWrote) {
  const FireDevicePtr fire = new FireDevice;
  fire->on(false);
  fire->particleSystem().setNumParticles(7);
  fire->particleSystem().setTintColor(Vector3f(0.25f, 0.5f, 0.75f));
  std::vector<double> state(14);
  ASSERT_EQ(fire->stateSize(), 14);
  EXPECT_EQ(fire->writeState(state.data()), state.data() + 14);
  const FireDevicePtr other = new FireDevice;
  EXPECT_EQ(other->readState(state.data(), 13), state.data()) << "one number is missing";
  EXPECT_EQ(other->readState(state.data(), 14), state.data() + 14);
  EXPECT_FALSE(other->on());
  EXPECT_EQ(other->particleSystem().numParticles(), 7);
  EXPECT_EQ(other->particleSystem().tintColor(), Vector3f(0.25f, 0.5f, 0.75f));
}

TEST(FireDevice, TakesTheStateOfItsOwnTypeOnly) {
  const FireDevicePtr fire = new FireDevice;
  const FountainDevicePtr water = new FountainDevice;
  EXPECT_THROW(fire->copyStateFrom(*water), std::invalid_argument);
}

TEST(GeneralSliderView, HasSlidersThatKeepTheirValues) {
  const auto slider = cnoid::GeneralSliderView::instance()->getOrCreateSlider("size", 0.1, 1.0, 1);
  slider->setValue(0.5);
  EXPECT_EQ(slider->value(), 0.5);
  EXPECT_EQ(slider->name(), "size");
}

}  // namespace
