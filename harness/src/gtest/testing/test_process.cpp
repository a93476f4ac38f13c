#include "test_process.h"

#include <rehearse/pin.h>
#include <rehearse/renderer.h>

#include <chrono>

#include "core/guard/own_process.h"
#include "core/guard/supervise.h"

namespace rehearse::internal {

static std::optional<std::chrono::steady_clock::time_point> test_began;

void begin_test() { test_began = std::chrono::steady_clock::now(); }

std::optional<double> seconds_of_test() {
  if (!test_began) return std::nullopt;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - *test_began).count();
}

void begin_test_process(char** argv) {
  pin_process(argv);  // first, because it starts the program once more, before any computation
  supervise_process();
  begin_own_processes();
  if (has_own_processes()) Renderer::forgo_threads();  // reports and tests draw pictures here
}

}  // namespace rehearse::internal
