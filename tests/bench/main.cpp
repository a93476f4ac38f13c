// Pinned as `rehearse` is, so that the same code is measured that users run.

#include <benchmark/benchmark.h>
#include <rehearse/pin.h>

int main(int argc, char** argv) {
  rehearse::pin_process(argv);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  return benchmark::RunSpecifiedBenchmarks() > 0 ? 0 : 1;
}
