#include "side_by_side.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/guard/interruption.h"
#include "core/guard/supervise.h"
#include "output.h"

namespace rehearse::tool {
namespace {

struct CloseScratchFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using ScratchFile = std::unique_ptr<std::FILE, CloseScratchFile>;

/// A nameless temporary file.
ScratchFile scratch_file() {
  ScratchFile file(std::tmpfile());
  if (!file) throw std::runtime_error("a temporary file can't be made");
  return file;
}

std::string text_of_file(std::FILE* file) {
  std::rewind(file);
  std::string text;
  char block[1 << 14];
  while (const std::size_t size = std::fread(block, 1, sizeof block, file)) text.append(block, size);
  return text;
}

struct ForkedPart {
  pid_t process = 0;
  ScratchFile out = scratch_file(), errors = scratch_file(), result = scratch_file();
  std::optional<int> ended;  // the status that waitpid() reported
};

[[noreturn]] void be_part(const ForkedPart& part, std::size_t number,
                          const std::function<Result<std::string>(std::size_t)>& work) {
  dup2(fileno(part.out.get()), STDOUT_FILENO);
  dup2(fileno(part.errors.get()), STDERR_FILENO);
  supervise_process();
  end_runs_on_signals();
  auto made = work(number);
  int status = EXIT_SUCCESS;
  if (made)
    std::fwrite(made->data(), 1, made->size(), part.result.get());
  else
    status = static_cast<int>(refuse(made.errors()));
  std::fflush(nullptr);
  std::exit(interruption() == 0 ? status : 128 + interruption());
}

ForkedPart begin_part(std::size_t number, const std::function<Result<std::string>(std::size_t)>& work) {
  ForkedPart part;
  const pid_t here = getpid();
  part.process = fork();
  if (part.process < 0) throw std::runtime_error("a process can't be started");
  if (part.process > 0) return part;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != here) _exit(EXIT_FAILURE);
  be_part(part, number, work);
}

int status_of_part(int ended) { return WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended); }

/// Waits until one of the processes ends, and passes signals of this process on to them.
void wait_for_part(std::vector<ForkedPart>& parts) {
  int told = 0;
  for (;;) {
    for (ForkedPart& part : parts) {
      int status = 0;
      if (part.process == 0 || part.ended || waitpid(part.process, &status, WNOHANG) != part.process) continue;
      part.ended = status;
      return;
    }
    if (interruption() != 0 && told == 0) {
      told = interruption();
      for (const ForkedPart& part : parts)
        if (part.process > 0 && !part.ended) kill(part.process, told);
    }
    usleep(1000);
  }
}

void stop_parts(std::vector<ForkedPart>& parts) {
  for (ForkedPart& part : parts) {
    if (part.process == 0 || part.ended) continue;
    kill(part.process, SIGTERM);
    int status = 0;
    waitpid(part.process, &status, 0);
  }
}

}  // namespace

std::size_t processors() { return std::max(1U, std::thread::hardware_concurrency()); }

Exit work_side_by_side(std::size_t count, std::size_t jobs, const std::function<Result<std::string>(std::size_t)>& work,
                       const std::function<void(const std::string&)>& take) {
  std::fflush(nullptr);
  keep_terminal();
  signal(SIGCHLD, SIG_DFL);
  end_runs_on_signals();
  std::vector<ForkedPart> parts;
  std::size_t running = 0;
  for (std::size_t next = 0; next < count;) {
    while (parts.size() < count && running < jobs && interruption() == 0) {
      parts.push_back(begin_part(parts.size(), work));
      ++running;
    }
    if (next == parts.size()) return Exit::done;  // a signal came before it began
    if (!parts[next].ended) {
      wait_for_part(parts);
      --running;
      continue;
    }
    ForkedPart& part = parts[next++];
    std::fputs(text_of_file(part.out.get()).c_str(), stdout);
    std::fflush(stdout);
    std::fputs(text_of_file(part.errors.get()).c_str(), stderr);
    const std::string result = text_of_file(part.result.get());
    if (const int status = status_of_part(*part.ended); status != EXIT_SUCCESS) {
      stop_parts(parts);
      return static_cast<Exit>(status);
    }
    take(result);
  }
  return Exit::done;
}

}  // namespace rehearse::tool
