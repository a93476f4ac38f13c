// The table of verbs: the lines of `rehearse --help`, and the program that contains each verb. `rehearse` itself
// contains it, and links no library of Rehearse: this header includes none.
#pragma once

#include <span>
#include <string_view>

namespace rehearse::tool {

/// The programs that contain verbs of the core, in libexec/rehearse: rehearse-read and rehearse-simulate. Verbs of a
/// wing are in rehearse-WING, but for those of `viewing`, which are few and in rehearse-read.
enum class Program { read, simulate, of_the_wing };

/// Whether the results of a verb depend on rounding, so that it must compute with pinned arithmetic (pin.h). The
/// environment that pins it is that of the programs it starts, too, as a browser.
enum class Rounding { matters, is_none };

/// The entry of a verb in the list of all verbs.
struct VerbSummary {
  std::string_view name;
  std::string_view group;  // its title in the list; the verbs of a group follow each other
  std::string_view summary;
  Program program;
  Rounding rounding = Rounding::matters;
  std::string_view wing = {};  // empty: it is of the core
  bool wing_adds = false;      // a verb of the core that does more in the program of the wing, if there is one
};

/// All verbs, in the order of `rehearse --help`, also those that this build leaves out.
std::span<const VerbSummary> all_verbs();
/// Null if no verb has this name.
const VerbSummary* find_verb(std::string_view name);
/// False: REHEARSE_WINGS leaves it out. The core, named by the empty string, is in each build.
bool is_in_this_build(std::string_view wing);

}  // namespace rehearse::tool
