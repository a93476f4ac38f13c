#include "child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <string.h>
#include <sys/personality.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <string_view>
#include <thread>
#include <utility>

#include "interruption.h"
#include "result_stream.h"

namespace rehearse {
namespace {

constexpr std::chrono::milliseconds look_interval{1};

/// Switches off random addresses for processes that this thread starts during its lifetime.
class FixedAddresses {
 public:
  explicit FixedAddresses(bool wanted) : before_(::personality(0xffffffff)) {
    if (wanted && before_ != -1) ::personality(static_cast<unsigned long>(before_) | ADDR_NO_RANDOMIZE);
  }
  ~FixedAddresses() {
    if (before_ != -1) ::personality(static_cast<unsigned long>(before_));
  }
  FixedAddresses(const FixedAddresses&) = delete;
  FixedAddresses& operator=(const FixedAddresses&) = delete;

 private:
  int before_;
};

}  // namespace

std::filesystem::path find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const auto file = std::filesystem::path(folder.empty() ? "." : folder) / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

std::vector<std::string> environment_with(const EnvironmentChanges& changes) {
  std::vector<std::string> variables;
  for (char** entry = environ; *entry; ++entry) {
    const std::string_view text = *entry;
    if (changes.count(std::string(text.substr(0, text.find('=')))) == 0) variables.emplace_back(text);
  }
  for (const auto& [name, value] : changes)
    if (value) variables.push_back(name + "=" + *value);
  return variables;
}

std::vector<char*> pointers_to(const std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

void replace_process(const std::filesystem::path& program, char* const words[], const EnvironmentChanges& changes) {
  give_stdout_back();
  execve(program.c_str(), words, pointers_to(environment_with(changes)).data());
}

Result<pid_t> start(const ChildProcess& process) {
  using Errors = ChildProcess::Errors;
  const char* const output = process.output.empty() ? "/dev/null" : process.output.c_str();
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (process.errors == Errors::with_output) posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  if (process.errors == Errors::apart)
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, process.errors_file.c_str(), O_WRONLY, 0);
  if (process.errors == Errors::discarded)
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  if (!process.folder.empty()) posix_spawn_file_actions_addchdir_np(&files, process.folder.c_str());
  pid_t child = 0;
  const FixedAddresses fixed(process.fixed_addresses);
  const int failed = posix_spawn(&child, process.words[0].c_str(), &files, nullptr, pointers_to(process.words).data(),
                                 pointers_to(process.environment).data());
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) return error(fmt::format("{} can't be started: {}", process.words[0], strerror(failed)));
  return child;
}

/// The exit status of an ended process: 128 + n if signal n ended it. None: it runs. Fails if it was lost.
static Result<std::optional<int>> status_of(pid_t process) {
  int status = 0;
  const pid_t ended = waitpid(process, &status, WNOHANG);
  if (ended < 0 && errno != EINTR) return error(fmt::format("process {} was lost: {}", process, strerror(errno)));
  if (ended <= 0) return std::optional<int>();
  return std::optional(WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
}

Result<int> run_to_end(const ChildProcess& process, const std::function<bool()>& should_stop) {
  const auto child = REHEARSE_TRY(start(process));
  for (;; std::this_thread::sleep_for(look_interval)) {
    if (const auto status = REHEARSE_TRY(status_of(child))) return *status;
    if (!should_stop || !should_stop()) continue;
    ::kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    return error(fmt::format("{} was stopped", process.words[0]));
  }
}

RunningProgram::RunningProgram(pid_t process, File output, File errors)
    : process_(process), output_(std::move(output)), errors_(std::move(errors)) {}

RunningProgram::RunningProgram(RunningProgram&& other) noexcept
    : process_(std::exchange(other.process_, 0)),
      status_(other.status_),
      output_(std::move(other.output_)),
      errors_(std::move(other.errors_)) {}

RunningProgram& RunningProgram::operator=(RunningProgram&& other) noexcept {
  std::swap(process_, other.process_);
  std::swap(status_, other.status_);
  std::swap(output_, other.output_);
  std::swap(errors_, other.errors_);
  return *this;
}

RunningProgram::~RunningProgram() {
  if (process_ == 0 || status_) return;
  ::kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

Result<RunningProgram::File> RunningProgram::temporary_file() {
  File file(std::tmpfile(), std::fclose);
  if (!file) return error(fmt::format("there is no room for temporary files: {}", strerror(errno)));
  return file;
}

std::string RunningProgram::text_of(std::FILE* file) {
  std::string text;
  char piece[4096];
  for (ssize_t size; (size = ::pread(fileno(file), piece, sizeof piece, static_cast<off_t>(text.size()))) > 0;)
    text.append(piece, static_cast<std::size_t>(size));
  return text;
}

Result<RunningProgram> RunningProgram::start(ChildProcess process) {
  File output = REHEARSE_TRY(temporary_file());
  File errors(nullptr, std::fclose);
  process.output = fmt::format("/proc/self/fd/{}", fileno(output.get()));  // the child's own copy of it
  if (process.errors == ChildProcess::Errors::apart) {
    errors = REHEARSE_TRY(temporary_file());
    process.errors_file = fmt::format("/proc/self/fd/{}", fileno(errors.get()));
  }
  const pid_t child = REHEARSE_TRY(rehearse::start(process));
  return RunningProgram(child, std::move(output), std::move(errors));
}

Result<std::optional<int>> RunningProgram::ended() {
  if (!status_) status_ = REHEARSE_TRY(status_of(process_));
  return status_;
}

void RunningProgram::signal(int number) const {
  if (!status_) ::kill(process_, number);
}

Result<ProgramOutput> output_of(ChildProcess process, double limit) {
  using Clock = std::chrono::steady_clock;
  auto program = REHEARSE_TRY(RunningProgram::start(std::move(process)));
  const auto is_late = [begin = Clock::now(), limit] {
    const std::chrono::duration<double> passed = Clock::now() - begin;
    return passed.count() > limit || interruption() != 0;
  };
  ProgramOutput output;
  do {
    output.status = REHEARSE_TRY(program.ended());
    if (!output.status) std::this_thread::sleep_for(look_interval);
  } while (!output.status && !is_late());
  output.text = program.output();
  return output;
}

bool can_fix_addresses() {
  const int before = ::personality(0xffffffff);
  if (before == -1) return false;
  const FixedAddresses fixed(true);
  return (::personality(0xffffffff) & ADDR_NO_RANDOMIZE) != 0;
}

std::string end_text(int ended) {
  return WIFEXITED(ended) ? fmt::format("with exit status {}", WEXITSTATUS(ended))
                          : fmt::format("by SIG{}", sigabbrev_np(WTERMSIG(ended)));
}

double memory_of(pid_t process) {
  std::ifstream facts(fmt::format("/proc/{}/statm", process));
  double size = 0.0, resident = 0.0;  // [pages]
  facts >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double default_memory_limit() {
  std::ifstream facts("/proc/meminfo");
  for (std::string word; facts >> word;)
    if (double kilobytes = 0.0; word == "MemAvailable:" && facts >> kilobytes) return 0.8 * 1024.0 * kilobytes;
  return std::numeric_limits<double>::infinity();
}

}  // namespace rehearse
