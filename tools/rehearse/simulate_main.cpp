// rehearse-simulate: the verbs that need physics or a renderer. Only `rehearse` starts it.
#include <rehearse/pin.h>

#include "command.h"
#include "core/guard/supervise.h"
#include "log_library.h"

int main(int argc, char** argv) {
  rehearse::pin_process(argv);
  rehearse::keep_freed_memory();
  rehearse::tool::open_logs_when_needed();
  return static_cast<int>(rehearse::tool::run_own_verb(argc, argv));
}
