// rehearse-audit: the verb audit, which needs a disassembler and a reader of debug information. Only `rehearse` starts
// it.
#include <rehearse/pin.h>

#include <string_view>

#include "command.h"

namespace rehearse::tool {
namespace {

Exit run(int argc, char** argv) {
  pin_process(argv);
  if (argc > 1 && argv[1] == audit_verb.name) return run_verb(audit_verb, argc, argv);
  return refuse(error("rehearse-audit is a part of rehearse and not meant to be started by hand",
                      "rehearse --help lists all verbs"));
}

}  // namespace
}  // namespace rehearse::tool

int main(int argc, char** argv) { return static_cast<int>(rehearse::tool::run(argc, argv)); }
