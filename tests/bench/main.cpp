// The benchmarks run pinned and supervised, as `rehearse` does, so that they measure the code that users run.

#include <benchmark/benchmark.h>
#include <rehearse/pin.h>

#include <string>

#include "core/guard/supervise.h"
#include "pinned_child.h"

int main(int argc, char** argv) {
  rehearse::pin_process(argv);
  if (argc == 3 && std::string(argv[1]) == "--work") return rehearse::run_child(argv[2]);
  rehearse::supervise_process();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  return benchmark::RunSpecifiedBenchmarks() > 0 ? 0 : 1;
}
