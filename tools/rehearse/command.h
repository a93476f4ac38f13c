// A verb of the command: its options, what it does, and how it ends.
//
// Each verb is one file, VERB_command.cpp, with one Verb object. Three programs share them: `rehearse`, which simulates
// nothing and links neither physics nor renderer; behind it `rehearse-simulate`, which does, and `rehearse-audit`,
// which reads machine code and debug information.
#pragma once

#include <rehearse/diagnostic.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace rehearse::tool {

/// What a program ends with. Outside programs rely on the numbers.
enum class Exit {
  done = 0,               // the same, or done
  differs = 1,            // two runs differ
  bad_input = 2,          // bad usage or bad input; nothing was written
  controller_failed = 3,  // it refused, threw, crashed or hung; the trace is kept up to there
  // 128 and the signal's number: somebody ended the process by SIGINT or SIGTERM
};

struct Verb {
  std::string_view name;
  std::string_view example;  // a command line or more, shown below --help
  /// Declares the options and returns what to do once they are read.
  std::function<Exit()> (*declare)(CLI::App& options);
};

// Defined in NAME_command.cpp.
extern const Verb audit_verb;
extern const Verb cat_verb;
extern const Verb check_verb;
extern const Verb diff_verb;
extern const Verb doc_verb;
extern const Verb doctor_verb;
extern const Verb export_verb;
extern const Verb filter_verb;
extern const Verb golden_verb;
extern const Verb info_verb;
extern const Verb inspect_verb;
extern const Verb merge_verb;
extern const Verb new_verb;
extern const Verb record_verb;
extern const Verb recover_verb;
extern const Verb render_verb;
extern const Verb replay_verb;
extern const Verb report_verb;
extern const Verb step_verb;

/// The programs that verbs live in.
enum class Program { rehearse, simulate, audit };

/// Whether a verb has to compute as every other processor does (pin.h). To pin a process is to start it twice: 20 ms.
enum class Rounding { matters, is_none };

/// A verb as the list of all of them shows it.
struct VerbSummary {
  std::string_view name;
  std::string_view summary;
  Program program;
  Rounding rounding = Rounding::matters;
};

/// All verbs, in the order in which one meets them.
std::span<const VerbSummary> all_verbs();
/// Null if there is no such verb.
const VerbSummary* find_verb(std::string_view name);

/// `rehearse --help`.
std::string overview();

/// Reads the verb's arguments (argv[2] and on) and runs it. Usage errors and, as a last resort, exceptions are told on
/// stderr and end in Exit::bad_input.
Exit run_verb(const Verb& verb, int argc, char** argv);

/// Prints to stderr, one a line; returns Exit::bad_input.
Exit refuse(const Diagnostics& diagnostics);
Exit refuse(Diagnostic diagnostic);

}  // namespace rehearse::tool
