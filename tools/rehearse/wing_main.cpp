// rehearse-logs, rehearse-campaigns, rehearse-audit, rehearse-choreonoid, rehearse-fuzz, rehearse-fitting: the verbs of a
// wing. Only `rehearse` starts them.
#include <rehearse/pin.h>

#include <string_view>

#include "command.h"
#include "log_library.h"

int main(int argc, char** argv) {
  using namespace rehearse::tool;
  const VerbSummary* verb = argc < 2 ? nullptr : find_verb(argv[1]);
  if (verb && verb->rounding == Rounding::matters) rehearse::pin_process(argv);
  open_logs_when_needed();
  return static_cast<int>(run_own_verb(argc, argv));
}
