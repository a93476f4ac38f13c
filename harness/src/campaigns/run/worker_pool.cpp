#include "worker_pool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

#include "core/guard/c_library.h"
#include "core/guard/child_process.h"
#include "core/guard/guarded_call.h"
#include "core/guard/process_guard.h"

namespace rehearse {
namespace {

constexpr int interval_ms = 200;          // of looks at limits and signals
constexpr std::size_t longest = 1 << 20;  // of an answer [bytes]

/// The sockets and locks of this process must end with it.
void close_all_but(int socket) {
  const auto kept = static_cast<unsigned>(socket);
  if (kept > 3) ::close_range(3, kept - 1, 0);
  ::close_range(kept + 1, ~0U, 0);
  const int nothing = ::open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
  if (nothing > STDERR_FILENO) ::close(nothing);
}

}  // namespace

WorkerPool::WorkerPool(std::size_t size, const Limits& limits, std::filesystem::path folder, Work work)
    : limits_{limits.time, limits.memory > 0.0 ? limits.memory : default_memory_limit()},
      work_(std::move(work)),
      workers_(size) {
  for (std::size_t i = 0; i < size; ++i) workers_[i].folder = folder / fmt::format("worker-{}", i + 1);
}

WorkerPool::~WorkerPool() {
  for (Worker& worker : workers_) stop(worker, false);
}

bool WorkerPool::is_idle() const {
  return std::none_of(workers_.begin(), workers_.end(), [](const Worker& worker) { return worker.job.has_value(); });
}

bool WorkerPool::has_room() const {
  return std::any_of(workers_.begin(), workers_.end(), [](const Worker& worker) { return !worker.job; });
}

Result<void> WorkerPool::give(std::int64_t job) {
  const auto free = std::find_if(workers_.begin(), workers_.end(), [](const Worker& worker) { return !worker.job; });
  REHEARSE_ASSERT(free != workers_.end(), "a job needs a worker without a job");
  if (free->process == 0)
    if (auto started = start(*free); !started) return started;
  free->job = job;
  free->since = Clock::now();
  // a worker that has ended meanwhile is noticed by wait()
  static_cast<void>(::send(free->socket, &job, sizeof job, MSG_NOSIGNAL));
  return {};
}

Result<void> WorkerPool::start(Worker& worker) {
  std::error_code failed;
  std::filesystem::create_directories(worker.folder, failed);
  if (failed) return error_in(worker.folder.string(), fmt::format("it can't be made: {}", failed.message()));
  std::array<int, 2> sockets{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets.data()) != 0)
    return error(fmt::format("a worker can't be started: {}", std::strerror(errno)));
  std::fflush(nullptr);
  std::signal(SIGCHLD, SIG_DFL);
  const pid_t here = ::getpid(), process = ::fork();
  if (process == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != here) leave_process(EXIT_FAILURE);
    close_all_but(sockets[1]);
    serve(sockets[1], worker.folder);
  }
  ::close(sockets[1]);
  if (process < 0) {
    ::close(sockets[0]);
    return error(fmt::format("a worker can't be started: {}", std::strerror(errno)));
  }
  worker.process = process;
  worker.socket = sockets[0];
  return {};
}

void WorkerPool::serve(int socket, const std::filesystem::path& folder) const {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, SIG_IGN);  // the pool ends its workers
  watch_calls_after_fork();
  ProcessGuard::instance().protect(socket, "the socket of the campaign");
  std::int64_t job = 0;
  while (::recv(socket, &job, sizeof job, 0) == static_cast<ssize_t>(sizeof job)) {
    const std::string answer = work_(job, folder);
    if (::send(socket, answer.data(), answer.size(), MSG_NOSIGNAL) < 0) break;
  }
  leave_process(EXIT_SUCCESS);
}

std::optional<WorkerPool::Answer> WorkerPool::wait() {
  std::vector<pollfd> sockets;
  for (const Worker& worker : workers_)
    sockets.push_back({worker.job ? worker.socket : -1, POLLIN, 0});  // poll() ignores -1
  ::poll(sockets.data(), sockets.size(), interval_ms);
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    Worker& worker = workers_[i];
    if (!worker.job) continue;
    if (sockets[i].revents != 0) {
      std::string text(longest, '\0');
      const ssize_t size = ::recv(worker.socket, text.data(), text.size(), 0);
      if (size <= 0) return end_of(worker, std::nullopt);
      text.resize(static_cast<std::size_t>(size));
      return Answer{*std::exchange(worker.job, std::nullopt), worker.folder, std::move(text), {}, {}};
    }
    if (std::chrono::duration<double>(Clock::now() - worker.since).count() > limits_.time)
      return end_of(worker, Answer::Limit::time);
    if (memory_of(worker.process) > limits_.memory) return end_of(worker, Answer::Limit::memory);
  }
  return std::nullopt;
}

WorkerPool::Answer WorkerPool::end_of(Worker& worker, std::optional<Answer::Limit> exceeded) {
  Answer answer{*std::exchange(worker.job, std::nullopt), worker.folder, std::nullopt, exceeded, {}};
  answer.end = stop(worker, !exceeded);
  return answer;
}

/// Ends a worker, and returns how it ended. `is_ending`: it has closed its socket.
std::string WorkerPool::stop(Worker& worker, bool is_ending) {
  if (worker.process == 0) return {};
  constexpr int patience_ms = 1000;
  int ended = 0;
  pid_t found = 0;
  for (int i = 0; is_ending && found == 0 && i < patience_ms; ++i) {
    found = ::waitpid(worker.process, &ended, WNOHANG);
    if (found == 0) ::usleep(1000);
  }
  if (found == 0) {
    ::kill(worker.process, SIGKILL);
    while (::waitpid(worker.process, &ended, 0) < 0 && errno == EINTR) continue;
  }
  ::close(worker.socket);
  worker.process = 0;
  worker.socket = -1;
  return WIFEXITED(ended) ? fmt::format("with exit status {}", WEXITSTATUS(ended))
                          : fmt::format("by SIG{}", sigabbrev_np(WTERMSIG(ended)));
}

void WorkerPool::renew(const std::filesystem::path& folder) {
  for (Worker& worker : workers_)
    if (worker.folder == folder) stop(worker, false);
}

void WorkerPool::renew_all() {
  REHEARSE_ASSERT(is_idle(), "no worker has a job");
  for (Worker& worker : workers_) stop(worker, false);
}

}  // namespace rehearse
