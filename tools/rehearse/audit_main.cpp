// rehearse-audit: the verb audit, which needs a disassembler and a reader of debug information. Only `rehearse` starts
// it.
#include <rehearse/pin.h>

#include "command.h"

int main(int argc, char** argv) {
  rehearse::pin_process(argv);
  return static_cast<int>(rehearse::tool::run_own_verb("rehearse-audit", argc, argv));
}
