// What a tap costs from begin to end: tap_bench [TICKS]. 12 joints and an IMU; ticks with a tap and bare ticks
// alternate, so that both meet the same disturbances. The numbers are those of this machine.
#include <unistd.h>
#include <rehearse/tap.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

std::uint64_t quantile(const std::vector<std::uint64_t>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t ticks = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1'000'000;
  rehearse_tap_options options{};
  options.replace = 1;
  rehearse::Tap tap("bench", options);
  if (!tap.is_open()) return std::fprintf(stderr, "%s\n", rehearse::Tap::error()), 2;
  std::vector<std::string> names;
  for (int i = 0; i < 12; ++i) names.push_back("J" + std::to_string(i));
  const int q = tap.joints("Walker", names, REHEARSE_TAP_Q | REHEARSE_TAP_DQ);
  const int imu = tap.imu("Walker", "Imu");
  const int u = tap.commands("Walker", names, REHEARSE_TAP_U);
  std::vector<double> q_dq(24, 0.1), measured(6, 0.2), tau(12, 0.3);
  std::vector<std::uint64_t> with(ticks), bare(ticks);
  const auto measure = [&](rehearse_tap* used) {
    const Clock::time_point begin = Clock::now();
    rehearse_tap_begin(used, begin.time_since_epoch().count());
    rehearse_tap_write(used, q, q_dq.data(), q_dq.size());
    rehearse_tap_write(used, imu, measured.data(), measured.size());
    rehearse_tap_write(used, u, tau.data(), tau.size());
    rehearse_tap_end(used);
    return static_cast<std::uint64_t>((Clock::now() - begin).count());
  };
  for (std::size_t i = 0; i < ticks; ++i) {
    bare[i] = measure(nullptr);  // a null tap does nothing
    with[i] = measure(tap.get());
  }
  std::ranges::sort(with);
  std::ranges::sort(bare);
  for (const double share : {0.5, 0.99, 0.9999, 1.0})
    std::printf("%8g %%  bare %6llu ns  with a tap %6llu ns\n", 100 * share,
                static_cast<unsigned long long>(quantile(bare, share)),
                static_cast<unsigned long long>(quantile(with, share)));
  std::remove(("/dev/shm/rehearse-tap-" + std::to_string(geteuid()) + "-bench").c_str());  // nobody reads it
}
