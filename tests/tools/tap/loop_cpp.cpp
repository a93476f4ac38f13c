// A robot's loop with the tap's class: loop_cpp NAME MODEL TICKS JOINTS. C++17, and C++20 with a span.
#include <rehearse/tap.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "step.h"

#if __cplusplus >= 202002L
#include <span>
#endif

int main(int argc, char** argv) {
  if (argc < 5) return 2;
  rehearse_tap_options options{};
  options.model = argv[2];
  options.controller = "Walk";
  rehearse::Tap tap(argv[1], options);
  if (!tap.is_open()) return std::fprintf(stderr, "%s\n", rehearse::Tap::error()), 1;
  const int joints = std::atoi(argv[4]);
  std::vector<std::string> names;
  for (int i = 0; i < joints; ++i) names.push_back("J" + std::to_string(i));
  const int of_joints = tap.joints("Walker", names, REHEARSE_TAP_Q | REHEARSE_TAP_DQ);
  const int of_imu = tap.imu("Walker", "Imu");
  const int of_efforts = tap.commands("Walker", names, REHEARSE_TAP_U);
  std::vector<double> q_dq(2 * names.size()), u(names.size());
  double imu[6] = {};
  Step self{};
  for (long tick = 0; tick < std::atol(argv[3]); ++tick) {
    for (std::size_t i = 0; i < q_dq.size(); ++i)
      q_dq[i] = 0.2 * std::sin(2e-3 * static_cast<double>(tick) + static_cast<double>(i));
    for (int i = 0; i < 6; ++i) imu[i] = 0.01 * std::cos(1e-3 * static_cast<double>(tick) + i);
    rehearse::Tap::Tick recorded = tap.tick(tick * 1'000'000);
    recorded.write(of_joints, q_dq);
    recorded.write(of_imu, imu);
    step(&self, joints, q_dq.data(), q_dq.data() + joints, imu, u.data());
#if __cplusplus >= 202002L
    recorded.write(of_efforts, std::span<const double>(u));
#else
    recorded.write(of_efforts, u);
#endif
  }
  return tap.dropped() == 0 ? 0 : 1;
}
