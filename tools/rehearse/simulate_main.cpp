// rehearse-simulate: the verbs that need physics or a renderer. Only `rehearse` starts it.
#include <rehearse/pin.h>

#include <string_view>

#include "command.h"

namespace rehearse::tool {
namespace {

constexpr const Verb* simulating_verbs[] = {&record_verb, &check_verb, &golden_verb, &render_verb, &sweep_verb};

Exit run(int argc, char** argv) {
  pin_process(argv);
  const std::string_view word = argc < 2 ? "" : argv[1];
  for (const Verb* verb : simulating_verbs)
    if (verb->name == word) return run_verb(*verb, argc, argv);
  return refuse(error("rehearse-simulate is a part of rehearse and not meant to be started by hand",
                      "rehearse --help lists all verbs"));
}

}  // namespace
}  // namespace rehearse::tool

int main(int argc, char** argv) { return static_cast<int>(rehearse::tool::run(argc, argv)); }
