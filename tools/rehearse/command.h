// A verb of the command: its options, its work, and its exit status.
//
// Each verb is one file, VERB_command.cpp, with one Verb object. Several programs contain them, and `rehearse` executes
// one of these (verbs.h). `rehearse-read` links neither physics nor renderer, `rehearse-simulate` links both, and the
// verbs of a wing are in the program of its name, as `rehearse-audit`.
#pragma once

#include <rehearse/diagnostic.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "verbs.h"

namespace rehearse::tool {

/// The exit status of a program. Other programs depend on the numbers.
enum class Exit {
  done = 0,               // success; with a comparison: no difference
  differs = 1,            // two runs differ
  bad_input = 2,          // bad usage or bad input; nothing was written
  controller_failed = 3,  // the controller refused, threw, crashed or hung; the trace is kept up to there
  odd = 4,                // doctor, import: warnings, and no errors; check, replay of a log, sweep: undecided
  // 128 and the signal's number: the verb was ended by SIGINT, SIGTERM or SIGHUP
};

/// The worse of two results: what is undecided is better than a difference.
Exit worse(Exit a, Exit b);

struct Verb {
  std::string_view name;
  std::string_view example;  // one or more command lines, printed below --help
  /// Declares the options and returns the function that runs the verb after they are read.
  std::function<Exit()> (*declare)(CLI::App& options);
};

/// The verbs of this program. The build lists them; NAME_command.cpp defines NAME_verb.
std::span<const Verb* const> own_verbs();
/// Runs the verb that the first argument names. For a program that only `rehearse` starts.
Exit run_own_verb(int argc, char** argv);

/// True for words as -o and --json, false for numbers and --.
bool is_option(std::string_view word);
/// "did you mean --seed? ", for a word that is none of the names; empty if none is similar.
std::string spelling_hint(std::string_view word, const std::vector<std::string>& names);
/// The error for a verb or an option of a wing that this build leaves out. `asked`: "the verb map".
Diagnostic left_out(std::string_view asked, std::string_view wing);

/// The folder with bin/, libexec/ and share/: of the build, or of the installation.
std::filesystem::path program_tree();
/// The program of a wing, beside this one; an error if the build leaves out the wing, or hasn't built the program.
/// `asked`: "the option --coverage".
Result<std::filesystem::path> program_of_wing(std::string_view wing, std::string_view asked);
/// Executes the program of a wing with the arguments of this one. Returns only if it can't.
Exit continue_in_wing(std::string_view wing, std::string_view asked);

/// The text of `rehearse --help`.
std::string overview();

/// Reads the verb's arguments (argv[2] and on) and runs it. Usage errors and, as a last resort, exceptions are reported
/// on stderr and result in Exit::bad_input.
Exit run_verb(const Verb& verb, int argc, char** argv);

/// Writes what is left of stdout, and returns `exit`. Output that can't be written, as on a full disk or with a closed
/// stdout, is reported on stderr and results in Exit::bad_input.
Exit after_output(Exit exit);

/// Prints the diagnostics as an object on stdout if the verb was called with --json and has printed none, else nothing.
void print_errors_as_json(const Diagnostics& diagnostics);

/// Prints the diagnostics to stderr, one per line, and as an object with --json; returns Exit::bad_input.
Exit refuse(const Diagnostics& diagnostics);
Exit refuse(Diagnostic diagnostic);

}  // namespace rehearse::tool
