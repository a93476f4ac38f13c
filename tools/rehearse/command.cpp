#include "command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/pin.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/names.h"
#include "core/guard/child_process.h"
#include "core/guard/interruption.h"
#include "core/guard/result_stream.h"
#include "core/guard/supervise.h"
#include "debugger.h"
#include "mesh/slow_mesh.h"
#include "output.h"
#include "progress.h"
#include "wings.h"

namespace rehearse::tool {
namespace {

Exit usage_error(const std::string& verb, const std::string& what) {
  return refuse(error(fmt::format("rehearse {}: {}", verb, what), fmt::format("see rehearse {} --help", verb)));
}

/// The error for the first word that is neither an option nor a part (`golden accept`) of the verb.
std::optional<Diagnostic> unknown_word(const CLI::App& options, const std::string& verb) {
  std::vector<std::string> long_options, parts;
  for (const CLI::Option* option : options.get_options())
    for (const std::string& name : option->get_lnames()) long_options.push_back("--" + name);
  for (const CLI::App* part : options.get_subcommands(nullptr)) parts.push_back(part->get_name());
  for (const CLI::App* part : options.get_subcommands()) {
    if (auto unknown = unknown_word(*part, verb + " " + part->get_name())) return unknown;
  }
  for (const std::string& word : options.remaining()) {
    const std::string see = fmt::format("see rehearse {} --help", verb);
    if (is_option(word)) {
      const std::string name = word.substr(0, word.find('='));
      return error(fmt::format("rehearse {}: there is no option {}", verb, plain_text(name)),
                   spelling_hint(name, long_options) + see);
    }
    const std::string hint = spelling_hint(word, parts);
    if (!hint.empty()) return error(fmt::format("rehearse {}: there is no {}", verb, plain_text(word)), hint + see);
  }
  return std::nullopt;
}

/// Those with which this program was started.
char** own_arguments = nullptr;

/// True if the verb was called with --json: then an error is also printed as an object on stdout.
bool errors_as_json = false;

/// The message on one line, without a full stop at its end.
std::string one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
  return text;
}

/// CLI11's help, in lines of at most 100 columns.
class WrappedHelp : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    const std::string names = make_option_name(option, is_positional) + make_option_opts(option);
    return entry(names, make_option_desc(option));
  }
  /// CLI11 lists the options that an option needs or excludes in the order of their addresses.
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    for (const char* word : {" Needs:", " Excludes:"}) text = text.substr(0, text.find(word));
    return text + list(" Needs:", option->get_needs()) + list(" Excludes:", option->get_excludes());
  }
  std::string make_subcommand(const CLI::App* verb) const override {
    return entry(verb->get_name(), verb->get_description());
  }

 private:
  static constexpr std::size_t text_column = 26;
  static constexpr std::size_t last_column = 100;

  /// The names of the options by name; empty if there are none.
  static std::string list(const char* word, const auto& options) {
    std::vector<std::string> names;
    for (const CLI::Option* option : options) names.push_back(option->get_name());
    std::ranges::sort(names);
    return names.empty() ? "" : fmt::format("{} {}", word, fmt::join(names, " "));
  }

  static std::string entry(const std::string& names, const std::string& text) {
    std::string lines = "  " + names;
    lines += lines.size() + 1 < text_column ? std::string(text_column - lines.size(), ' ')
                                            : '\n' + std::string(text_column, ' ');
    return lines + wrapped(text, last_column, text_column) + '\n';
  }
};

}  // namespace

Exit worse(Exit a, Exit b) {
  constexpr Exit order[] = {Exit::done, Exit::odd, Exit::differs, Exit::bad_input, Exit::controller_failed};
  const auto rank = [&](Exit exit) { return std::ranges::find(order, exit) - std::begin(order); };
  return rank(a) < rank(b) ? b : a;
}

bool is_option(std::string_view word) {
  return word.size() > 1 && word[0] == '-' && word != "--" && (word[1] < '0' || word[1] > '9');
}

std::string spelling_hint(std::string_view word, const std::vector<std::string>& names) {
  const auto near = near_names(word, names);
  return near.empty() ? "" : fmt::format("did you mean {}? ", fmt::join(near, " or "));
}

Diagnostic left_out(std::string_view asked, std::string_view wing) {
  return error(fmt::format("this build leaves out {}", asked),
               fmt::format("it is in a build whose REHEARSE_WINGS has {}", wing));
}

std::filesystem::path program_tree() { return own_program().parent_path().parent_path().parent_path(); }

Result<std::filesystem::path> program_of_wing(std::string_view wing, std::string_view asked) {
  const std::string name = fmt::format("rehearse-{}", wing);
  std::filesystem::path program = own_program().parent_path() / name;
  if (!is_in_this_build(wing)) return left_out(asked, wing);
  if (::access(program.c_str(), X_OK) == 0) return program;
  return error(fmt::format("{} is in {}, which can't be started: {}", asked, program.string(), std::strerror(errno)),
               fmt::format("tools/build release {} builds it", name));
}

Exit continue_in_wing(std::string_view wing, std::string_view asked) {
  const auto program = program_of_wing(wing, asked);
  if (!program) return refuse(program.errors());
  replace_process(*program, own_arguments, {});
  return refuse(error(fmt::format("can't start {}: {}", program->string(), std::strerror(errno))));
}

std::string overview() {
  std::string text =
      "Rehearse records robot controllers in a deterministic simulation, and replays and judges the recordings.\n"
      "\n"
      "Usage: rehearse [--no-pin] VERB [ARGUMENTS...]\n"
      "       rehearse VERB --help | rehearse help VERB\n"
      "       rehearse --version\n";
  std::string_view group;
  for (const VerbSummary& verb : all_verbs()) {
    if (!verb.wing_adds && !is_in_this_build(verb.wing)) continue;
    if (verb.group != group) text += fmt::format("\n{}:\n", group = verb.group);
    text += fmt::format("  {:<11}{}\n", verb.name, verb.summary);
  }
  const auto paragraph = [&](std::string_view sentences) { text += "\n" + wrapped(sentences, 100, 0) + "\n"; };
  paragraph(
      "--no-pin, or REHEARSE_PIN=off in the environment: mathematics and pictures use the best instructions of "
      "this processor, so that their last bits are not those of other machines. Recordings state this.");
  paragraph(
      "Exit status: 0 the same, or done; 1 differs; 2 bad usage or bad input, nothing written; 3 a controller failed; "
      "4 done, with warnings (doctor, import). A signal ends a verb with 128 and its number, as 141 (SIGPIPE) if the "
      "reader of its output is gone.");
  return text;
}

Exit after_output(Exit exit) {
  std::FILE* const results = result_stream();
  if (results != stdout) std::fflush(stdout);
  errno = 0;
  const bool is_lost = std::fflush(results) != 0 || std::ferror(results) != 0;
  int cause = errno;
  if (is_lost && cause == 0 && ::write(fileno(results), "", 0) < 0) cause = errno;  // an earlier flush failed
  end_if_reader_is_gone();
  if (!is_lost || static_cast<int>(exit) >= 128) return exit;
  std::clearerr(results);
  errors_as_json = false;  // the object would be lost, too
  return refuse(error(fmt::format("can't write to stdout{}{}", cause ? ": " : "", cause ? std::strerror(cause) : "")));
}

Exit run_own_verb(int argc, char** argv) {
  own_arguments = argv;
  const std::string_view word = argc < 2 ? "" : argv[1];
  for (const Verb* verb : own_verbs())
    if (verb->name == word) return after_output(run_verb(*verb, argc, argv));
  return refuse(error(
      fmt::format("{} is a part of rehearse and not meant to be started by hand", own_program().filename().string()),
      "rehearse --help lists all verbs"));
}

Exit run_verb(const Verb& verb, int argc, char** argv) {
  std::signal(SIGPIPE, SIG_DFL);  // a program that ignores it starts this one with that setting
  on_slow_mesh([](const std::string& sentence) { fmt::print(stderr, "{}\n", plain_text(sentence)); });
  const std::string name(verb.name);
  CLI::App options(std::string(find_verb(verb.name)->summary), "rehearse " + name);
  const auto formatter = std::make_shared<WrappedHelp>();
  formatter->label("REQUIRED", "");
  options.formatter(formatter);
  options.footer("Example:\n" + std::string(verb.example));
  try {
    const std::function<Exit()> run = verb.declare(options);
    std::vector<std::string> arguments(argv + 2, argv + argc);
    const bool json = std::ranges::find(arguments, "--json") != arguments.end();
    errors_as_json = json && name != "cat";  // cat prints lines, and an error comes behind some of them
    if (errors_as_json)
      on_failed_process([](const std::string& sentence) {
        print_errors_as_json({error(sentence)});
        std::fflush(result_stream());
      });
    spell_out_gdb_arguments(arguments);
    std::ranges::reverse(arguments);  // CLI11 expects the arguments in this order
    options.parse(arguments);
    if (json) keep_stdout_for_results();
    const Exit exit = run();
    end_if_reader_is_gone();
    return interruption() == 0 ? exit : static_cast<Exit>(128 + interruption());
  } catch (const Interrupted&) {
    end_if_reader_is_gone();
    fmt::print(stderr, "rehearse {}: interrupted by SIG{}; incomplete results are removed\n", name,
               sigabbrev_np(interruption()));
    return static_cast<Exit>(128 + interruption());
  } catch (const CLI::CallForHelp&) {
    std::fputs(options.help().c_str(), stdout);  // fmt would throw out of the handler on a full disk
    return Exit::done;
  } catch (const CLI::ParseError& problem) {
    if (auto unknown = unknown_word(options, name)) return refuse(std::move(*unknown));
    return usage_error(name, one_line(problem.what()));
  } catch (const std::exception& problem) {
    if (std::ferror(result_stream()))
      return Exit::bad_input;  // fmt throws if it can't write; after_output() reports it
    return refuse(error(fmt::format("internal error: {}", problem.what())));
  }
}

void print_errors_as_json(const Diagnostics& diagnostics) {
  if (errors_as_json && !has_printed_results()) print(Json{{"errors", json_of(diagnostics)}});
}

Exit refuse(const Diagnostics& diagnostics) {
  print_errors_as_json(diagnostics);
  std::fputs(to_string(diagnostics).c_str(), stderr);  // a failure to write, as on a full disk, must not throw
  return Exit::bad_input;
}

Exit refuse(Diagnostic diagnostic) { return refuse(Diagnostics{std::move(diagnostic)}); }

}  // namespace rehearse::tool
