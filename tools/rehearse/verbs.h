// The table of verbs: the lines of `rehearse --help`, and the program that contains each verb. `rehearse` itself
// contains it, and links no library of Rehearse: this header includes none.
#pragma once

#include <span>
#include <string_view>

namespace rehearse::tool {

/// The programs that contain verbs, in libexec/rehearse: rehearse-read, rehearse-simulate, rehearse-audit.
enum class Program { read, simulate, audit };

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
  bool is_built = true;        // false: this build leaves out its wing
  std::string_view wing = {};  // empty: it is of the core
};

/// All verbs, in the order of `rehearse --help`, also those that this build leaves out.
std::span<const VerbSummary> all_verbs();
/// Null if no verb has this name.
const VerbSummary* find_verb(std::string_view name);

}  // namespace rehearse::tool
