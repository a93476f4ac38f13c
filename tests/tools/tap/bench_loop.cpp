// A robot's loop whose controller is a library alone: bench_loop NAME MODEL TICKS JOINTS LIBRARY. Prints the median
// time of a tick of the library, with the host around it [us].
#include <rehearse/controller_bench.h>
#include <rehearse/tap.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  if (argc < 6) return 2;
  rehearse_tap_options options{};
  options.model = argv[2];
  options.controller = "Walk";
  rehearse::Tap tap(argv[1], options);
  if (!tap.is_open()) return std::fprintf(stderr, "%s\n", rehearse::Tap::error()), 1;
  rehearse::ControllerBench bench(argv[5], argv[2]);
  const int joints = std::atoi(argv[4]);
  std::vector<std::string> names;
  for (int i = 0; i < joints; ++i) names.push_back("J" + std::to_string(i));
  const int of_joints = tap.joints("Walker", names, REHEARSE_TAP_Q | REHEARSE_TAP_DQ);
  const int of_imu = tap.imu("Walker", "Imu");
  const int of_efforts = tap.commands("Walker", names, REHEARSE_TAP_U);
  std::vector<double> q_dq(2 * names.size()), imu(6), u(names.size()), times;
  for (long tick = 0; tick < std::atol(argv[3]); ++tick) {
    for (std::size_t i = 0; i < q_dq.size(); ++i)
      q_dq[i] = 0.2 * std::sin(2e-3 * static_cast<double>(tick) + static_cast<double>(i));
    for (std::size_t i = 0; i < 6; ++i) imu[i] = 0.01 * std::cos(1e-3 * static_cast<double>(tick) + i);
    rehearse::Tap::Tick recorded = tap.tick(tick * 1'000'000);
    recorded.write(of_joints, q_dq);
    recorded.write(of_imu, imu);
    const Clock::time_point begin = Clock::now();
    for (std::size_t i = 0; i < names.size(); ++i) {
      bench.joint(names[i]).q = q_dq[i];
      bench.joint(names[i]).dq = q_dq[names.size() + i];
    }
    bench.device("Imu").values = imu;
    bench.tick();
    for (std::size_t i = 0; i < names.size(); ++i) u[i] = bench.joint(names[i]).u;
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
    recorded.write(of_efforts, u);
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  std::printf("%.1f\n", times[times.size() / 2]);
  return tap.dropped() == 0 ? 0 : 1;
}
