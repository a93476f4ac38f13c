// Child processes: other programs that this process starts with changed conditions, and waits for. Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <sys/types.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// The path of the program that a shell would execute for that name; empty: none.
std::filesystem::path find_program(const std::string& name);

/// Variables with their new values; none: removed.
using EnvironmentChanges = std::map<std::string, std::optional<std::string>>;

/// The variables of this process with changes, as "NAME=VALUE".
std::vector<std::string> environment_with(const EnvironmentChanges& changes);

/// Pointers to the words, and a null pointer, for functions of the C library, which don't change the words. Valid as
/// long as `words`.
std::vector<char*> pointers_to(const std::vector<std::string>& words);

/// Makes this process the program `program` with changed variables. `words`: its arguments, from its name to a null
/// pointer. Returns only if that fails, and sets errno.
void replace_process(const std::filesystem::path& program, char* const words[], const EnvironmentChanges& changes);

/// How a process ended, of what waitpid() returned: "with exit status 5", "by SIGKILL".
std::string end_text(int ended);

/// Memory of a process [bytes]; 0 if it isn't known.
double memory_of(pid_t process);

/// Four fifths of the memory that is available now [bytes]; infinite if that isn't known.
double default_memory_limit();

/// A program to start. Its stdin is empty.
struct ChildProcess {
  std::vector<std::string> words;        // the program's path, and its arguments
  std::vector<std::string> environment;  // all its variables, as "NAME=VALUE"
  std::filesystem::path output = {};     // the file for its stdout; empty: discarded
  enum class Errors {
    with_output,
    discarded,
    shown,
    apart
  } errors = Errors::with_output;          // its stderr; shown: this process's; apart: of a RunningProgram alone
  std::filesystem::path errors_file = {};  // of stderr, if it is kept apart; a RunningProgram sets it
  std::filesystem::path folder = {};       // working folder; empty: that of this process
  bool fixed_addresses = false;            // without random addresses
};

/// The process's number. Fails if the program can't be started.
Result<pid_t> start(const ChildProcess& process);

/// Starts a program and waits for its end. Returns its exit status, 128 + n if signal n ended it. Fails if it can't be
/// started, or if `should_stop` (may be null) returned true and the program was killed.
Result<int> run_to_end(const ChildProcess& process, const std::function<bool()>& should_stop = nullptr);

/// A program that runs beside this process, with its output. It is killed when this object is destroyed.
class RunningProgram {
 public:
  /// The member `output` is not used. Fails if the program can't be started.
  static Result<RunningProgram> start(ChildProcess process);
  ~RunningProgram();
  RunningProgram(RunningProgram&& other) noexcept;
  RunningProgram& operator=(RunningProgram&& other) noexcept;

  /// Its exit status, as of run_to_end(). None: it runs. Fails if the process was lost.
  Result<std::optional<int>> ended();
  /// Sends it a signal, unless it has ended.
  void signal(int number) const;
  /// Its stdout so far, and its stderr if the process asks for it there.
  std::string output() const { return text_of(output_.get()); }
  /// Its stderr so far; empty unless it is kept apart.
  std::string errors() const { return errors_ ? text_of(errors_.get()) : std::string(); }

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  RunningProgram(pid_t process, File output, File errors);
  static Result<File> temporary_file();
  static std::string text_of(std::FILE* file);

  pid_t process_;              // 0: it was moved from
  std::optional<int> status_;  // none: it runs
  File output_, errors_;
};

struct ProgramOutput {
  std::optional<int> status;  // as of run_to_end; none: it was stopped
  std::string text;           // its stdout, and its stderr if the process asks for it there
};

/// As run_to_end, with the output; the member `output` is not used. The program is stopped when its time is over, and
/// when this process is interrupted. Fails if it can't be started. `limit`: of wall time [s].
Result<ProgramOutput> output_of(ChildProcess process, double limit = std::numeric_limits<double>::infinity());

/// True if a process can be started at addresses that aren't random.
bool can_fix_addresses();

}  // namespace rehearse
