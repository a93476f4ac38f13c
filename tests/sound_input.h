// Bounds of the time that hostile input may take, as multiples of the time that a sound input takes in the same
// process. They are the same on each machine, with any other load, with and without sanitizers.
#pragma once

#include <gtest/gtest.h>

#include <ctime>

namespace rehearse {

class SoundInput {
 public:
  /// `load` loads a sound input once.
  explicit SoundInput(const auto& load) {
    constexpr int times = 20;
    const std::clock_t begin = std::clock();
    for (int i = 0; i < times; ++i) load();
    time_ = static_cast<double>(std::clock() - begin) / times;
  }

  /// The result of `work`, which must take less processor time than `most` sound inputs.
  auto bounds(double most, const auto& work) const {
    const std::clock_t begin = std::clock();
    auto result = work();
    EXPECT_LT(static_cast<double>(std::clock() - begin) / time_, most) << "times the sound input";
    return result;
  }

 private:
  double time_ = 0.0;  // processor time [clocks]
};

}  // namespace rehearse
