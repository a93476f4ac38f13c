// rehearse: the command. It executes the program that contains the verb (verbs.h), and links no other library than that
// of C, because each library that it links would be loaded twice. rehearse-read answers all that names no verb.
#include <fcntl.h>
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

/// The file of this program; without /proc, the name by which it was started.
std::string own_file() {
  std::array<char, PATH_MAX> file{};
  const ssize_t size = readlink("/proc/self/exe", file.data(), file.size());
  if (size > 0) return {file.data(), static_cast<std::size_t>(size)};
  const auto* started_as = reinterpret_cast<const char*>(getauxval(AT_EXECFN));
  return started_as && realpath(started_as, file.data()) ? file.data() : "";
}

/// The file of a program that contains verbs, as "rehearse-read". It has no ".." in it: ps and debuggers show it.
std::string file_of(const std::string& program) {
  const std::string own = own_file();
  const std::size_t name = own.rfind('/'), folder = name == std::string::npos ? name : own.rfind('/', name - 1);
  return (folder == std::string::npos ? "" : own.substr(0, folder)) + "/" PROGRAMS_IN_TREE "/" + program;
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

/// Opens what the caller has closed of stdin, stdout and stderr, so that no file takes its number. Writing to it fails.
void open_standard_streams() {
  for (int stream = 0; stream <= STDERR_FILENO; ++stream)
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

/// Returns only if the program can't be executed.
int run(int argc, char** argv) {
  open_standard_streams();
  argc = take_no_pin(argc, argv);
  std::string help = "--help";
  char* help_of_verb[] = {argv[0], argc > 2 ? argv[2] : nullptr, help.data(), nullptr};
  if (argc == 3 && std::string_view(argv[1]) == "help") argv = help_of_verb;  // rehearse help VERB
  const VerbSummary* verb = argc < 2 ? nullptr : find_verb(argv[1]);
  std::string program = "rehearse-read";
  if (verb && (verb->wing_adds || is_in_this_build(verb->wing))) {
    if (verb->rounding == Rounding::matters && !is_pinning_off()) set_pinned_environment();
    const std::string of_the_wing = "rehearse-" + std::string(verb->wing);
    if (verb->program == Program::simulate) program = "rehearse-simulate";
    if (verb->program == Program::of_the_wing || (verb->wing_adds && access(file_of(of_the_wing).c_str(), X_OK) == 0))
      program = of_the_wing;
  }
  const std::string file = file_of(program);
  execv(file.c_str(), argv);
  std::fprintf(stderr, "error: can't start %s: %s (in a checkout, tools/build release %s builds it)\n", file.c_str(),
               std::strerror(errno), program.c_str());
  return bad_input;
}

}  // namespace
}  // namespace rehearse::tool

int main(int argc, char** argv) { return rehearse::tool::run(argc, argv); }
