// rehearse: the command. It executes the program that contains the verb (verbs.h), and links no other library than that
// of C, because each library that it links would be loaded twice. rehearse-read answers all that names no verb.
#include <rehearse/pin.h>
#include <sys/auxv.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "verbs.h"

namespace rehearse::tool {
namespace {

constexpr int bad_input = 2;  // Exit::bad_input

const char* name_of(Program program) {
  constexpr const char* names[] = {"rehearse-read", "rehearse-simulate", "rehearse-audit"};
  return names[static_cast<std::size_t>(program)];
}

/// The file of this program; without /proc, the name by which it was started.
std::string own_file() {
  std::array<char, PATH_MAX> file{};
  const ssize_t size = readlink("/proc/self/exe", file.data(), file.size());
  if (size > 0) return {file.data(), static_cast<std::size_t>(size)};
  const auto* started_as = reinterpret_cast<const char*>(getauxval(AT_EXECFN));
  return started_as && realpath(started_as, file.data()) ? file.data() : "";
}

/// The file of a program that contains verbs. It has no ".." in it: ps and debuggers show it.
std::string file_of(Program program) {
  const std::string own = own_file();
  const std::size_t name = own.rfind('/'), folder = name == std::string::npos ? name : own.rfind('/', name - 1);
  return (folder == std::string::npos ? "" : own.substr(0, folder)) + "/" PROGRAMS_IN_TREE "/" + name_of(program);
}

/// Removes --no-pin from the arguments, at any position: it applies to the process, not to a verb.
int take_no_pin(int argc, char** argv) {
  char** const end = std::remove_if(argv + std::min(argc, 1), argv + argc,
                                    [](const char* word) { return std::string_view(word) == "--no-pin"; });
  if (end == argv + argc) return argc;
  setenv("REHEARSE_PIN", "off", 1);
  *end = nullptr;
  return static_cast<int>(end - argv);
}

/// Returns only if the program can't be executed.
int run(int argc, char** argv) {
  argc = take_no_pin(argc, argv);
  std::string help = "--help";
  char* help_of_verb[] = {argv[0], argc > 2 ? argv[2] : nullptr, help.data(), nullptr};
  if (argc == 3 && std::string_view(argv[1]) == "help") argv = help_of_verb;  // rehearse help VERB
  const VerbSummary* verb = argc < 2 ? nullptr : find_verb(argv[1]);
  const bool runs = verb && verb->is_built;
  if (runs && verb->rounding == Rounding::matters && !is_pinning_off()) set_pinned_environment();
  const std::string file = file_of(runs ? verb->program : Program::read);
  execv(file.c_str(), argv);
  std::fprintf(stderr, "error: can't start %s: %s (it is built and installed together with rehearse)\n", file.c_str(),
               std::strerror(errno));
  return bad_input;
}

}  // namespace
}  // namespace rehearse::tool

int main(int argc, char** argv) { return rehearse::tool::run(argc, argv); }
