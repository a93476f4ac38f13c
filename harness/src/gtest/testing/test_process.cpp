#include "test_process.h"

#include <rehearse/pin.h>
#include <rehearse/renderer.h>

#include "core/guard/own_process.h"
#include "core/guard/supervise.h"

namespace rehearse::internal {

void begin_test_process(char** argv) {
  pin_process(argv);  // first, because it starts the program once more, before any computation
  supervise_process();
  begin_own_processes();
  if (has_own_processes()) Renderer::forgo_threads();  // reports and tests draw pictures here
}

}  // namespace rehearse::internal
