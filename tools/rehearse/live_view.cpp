#include "live_view.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>

#include "command.h"
#include "core/guard/child_process.h"
#include "wings.h"

namespace rehearse::tool {
namespace {

constexpr std::chrono::milliseconds pause{10};

std::string text_of(int file) {
  std::string text(4096, '\0');
  const ssize_t size = ::pread(file, text.data(), text.size(), 0);
  text.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return text;
}

/// False also for a process that has ended, and whose parent hasn't asked for its status.
bool is_running(pid_t process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t name_end = text.rfind(") ");
  return name_end != std::string::npos && text[name_end + 2] != 'Z';
}

}  // namespace

Result<std::unique_ptr<LiveView>> LiveView::start(const std::filesystem::path& recording, std::uint16_t port) {
  if (!has_viewing) return left_out("the option --live", "viewing");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> printed(std::tmpfile(), std::fclose);
  if (!printed) return error("there is no room for temporary files");
  ChildProcess server;
  server.words = {(program_tree() / "libexec/rehearse/rehearse-read").string(),
                  "serve",
                  recording.string(),
                  "--follow",
                  "--ends-with-parent",
                  fmt::format("--port={}", port)};
  server.environment = environment_with({});
  server.output = fmt::format("/proc/self/fd/{}", fileno(printed.get()));  // the child's own copy of it
  server.errors = ChildProcess::Errors::shown;
  const pid_t process = REHEARSE_TRY(rehearse::start(server));
  while (text_of(fileno(printed.get())).find("Ctrl-C") == std::string::npos) {
    int status = 0;
    if (::waitpid(process, &status, WNOHANG) != 0)
      return error("the run isn't served", "without --live it is recorded alone");
    std::this_thread::sleep_for(pause);
  }
  fmt::print(stderr, "{}", text_of(fileno(printed.get())));
  return std::unique_ptr<LiveView>(new LiveView(process));
}

LiveView::~LiveView() {
  for (int i = 0; i < 200 && is_running(process_); ++i) std::this_thread::sleep_for(pause);
  ::kill(process_, SIGTERM);
}

}  // namespace rehearse::tool
