// rehearse-simulate: the verbs that need physics or a renderer. Only `rehearse` starts it.
#include <rehearse/logs.h>
#include <rehearse/pin.h>

#include "command.h"
#include "core/guard/supervise.h"
#include "wings.h"

int main(int argc, char** argv) {
  rehearse::pin_process(argv);
  rehearse::keep_freed_memory();
  if constexpr (rehearse::tool::has_logs) rehearse::read_rosbag2_logs();
  return static_cast<int>(rehearse::tool::run_own_verb("rehearse-simulate", argc, argv));
}
