// A program with a main() of its own that uses only the bench, as a notebook or a tool would.
#include <rehearse/controller_bench.h>

#include <cstdio>
#include <exception>

int main(int count, char** words) {
  if (count != 3) return 2;
  try {
    for (int i = 0; i < 2; ++i) {
      rehearse::ControllerBench bench(words[1], words[2]);
      bench.joint("HINGE").q = 0.2;  // [rad]
      bench.tick();
      std::printf("u is %.3f N·m\n", bench.joint("HINGE").u);
    }
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s\n", problem.what());
    return 1;
  }
}
