// Records a scenario of the fixtures, in a process of its own: probe SCENARIO SECONDS TRACE.

#include <rehearse/pin.h>
#include <rehearse/session.h>

#include <charconv>
#include <cstdio>
#include <cstring>

int main(int argc, char** argv) {
  using namespace rehearse;
  pin_process(argv);
  if (argc != 4) return std::fputs("usage: probe SCENARIO SECONDS TRACE\n", stderr), 2;
  auto scenario = Scenario::load(argv[1]);
  if (!scenario) return std::fputs(to_string(scenario.errors()).c_str(), stderr), 2;
  std::from_chars(argv[2], argv[2] + std::strlen(argv[2]), scenario->duration);
  const auto summary = record(*scenario, argv[3]);
  if (!summary) return std::fputs(to_string(summary.errors()).c_str(), stderr), 1;
  return summary->failure ? 1 : 0;
}
