#include "worker_pool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "c_library.h"
#include "child_process.h"
#include "guarded_call.h"
#include "interruption.h"
#include "process_guard.h"
#include "supervise.h"

namespace rehearse {
namespace {

constexpr int interval_ms = 200;  // of looks at limits and signals

/// The sockets and locks of this process must end with it.
void close_all_but(int socket) {
  const auto kept = static_cast<unsigned>(socket);
  if (kept > 3) ::close_range(3, kept - 1, 0);
  ::close_range(kept + 1, ~0U, 0);
  const int nothing = ::open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
  if (nothing > STDERR_FILENO) ::close(nothing);
}

bool send_all(int socket, const void* data, std::size_t size) {
  for (const char* next = static_cast<const char*>(data); size > 0;) {
    const ssize_t sent = ::send(socket, next, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    next += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

/// The next job; none: the pool has closed its socket.
std::optional<std::int64_t> receive_job(int socket) {
  std::int64_t job = 0;
  for (;;) {
    const ssize_t size = ::recv(socket, &job, sizeof job, MSG_WAITALL);
    if (size == static_cast<ssize_t>(sizeof job)) return job;
    if (size >= 0 || errno != EINTR) return std::nullopt;
  }
}

/// A file in memory for the output of a worker.
FileDescriptor output_file() { return FileDescriptor(::memfd_create("output of a worker", MFD_CLOEXEC)); }

/// Takes the text out of a file that another process may append to. That process's stream has the same place in it.
std::string take_text(int file) {
  struct stat status {};
  if (file < 0 || ::fstat(file, &status) != 0 || status.st_size == 0) return {};
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  const ssize_t size = ::pread(file, text.data(), text.size(), 0);
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  if (::ftruncate(file, 0) == 0) ::lseek(file, 0, SEEK_SET);
  return text;
}

Diagnostic not_started(const char* why) { return error(fmt::format("a worker can't be started: {}", why)); }

}  // namespace

WorkerPool::WorkerPool(Setup setup, Work work)
    : setup_([&] {
        if (setup.kind == Kind::bare && setup.limits.memory <= 0.0) setup.limits.memory = default_memory_limit();
        return std::move(setup);
      }()),
      work_(std::move(work)),
      workers_(setup_.size) {
  if (setup_.folder.empty()) return;
  for (std::size_t i = 0; i < workers_.size(); ++i)
    workers_[i].folder = setup_.folder / fmt::format("worker-{}", i + 1);
}

WorkerPool::~WorkerPool() {
  if (setup_.kind == Kind::supervised) tell(SIGTERM);  // all at the same time
  for (Worker& worker : workers_) stop(worker, setup_.kind == Kind::bare ? Ending::is_killed : Ending::is_asked);
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
  static_cast<void>(send_all(free->socket, &job, sizeof job));
  return {};
}

Result<void> WorkerPool::start(Worker& worker) {
  std::error_code failed;
  if (!worker.folder.empty()) std::filesystem::create_directories(worker.folder, failed);
  if (failed) return error_in(worker.folder.string(), fmt::format("it can't be made: {}", failed.message()));
  if (setup_.kind == Kind::supervised)
    for (FileDescriptor* file : {&worker.out, &worker.errors})
      if (*file = output_file(); *file < 0) return not_started(std::strerror(errno));
  std::array<int, 2> sockets{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0)
    return not_started(std::strerror(errno));
  std::fflush(nullptr);
  std::signal(SIGCHLD, SIG_DFL);
  worker.socket = sockets[0];
  const pid_t here = ::getpid(), process = ::fork();
  if (process == 0) {
    ::prctl(PR_SET_PDEATHSIG, setup_.kind == Kind::bare ? SIGKILL : SIGTERM);
    if (::getppid() != here) leave_process(EXIT_FAILURE);
    prepare(worker, sockets[1]);
    serve(sockets[1], worker.folder);
  }
  const int reason = errno;
  ::close(sockets[1]);
  if (process < 0) {
    ::close(std::exchange(worker.socket, -1));
    return not_started(std::strerror(reason));
  }
  worker.process = process;
  worker.received.clear();
  ++started_;
  return {};
}

/// Makes this process, a fork, a worker.
void WorkerPool::prepare(const Worker& worker, int socket) const {
  watch_calls_after_fork();
  if (setup_.kind == Kind::bare) {
    close_all_but(socket);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, SIG_IGN);  // the pool ends its workers
  } else {
    for (const Worker& other : workers_)
      if (other.socket >= 0) ::close(other.socket);
    ::dup2(worker.out, STDOUT_FILENO);
    ::dup2(worker.errors, STDERR_FILENO);
    supervise_process();
    end_runs_on_signals();
  }
  ProcessGuard::instance().protect(socket, "the socket of a worker");
}

void WorkerPool::serve(int socket, const std::filesystem::path& folder) const noexcept {
  while (const auto job = receive_job(socket)) {
    const std::string answer = work_(*job, folder);
    std::fflush(nullptr);
    const std::uint64_t size = answer.size();
    std::string message(reinterpret_cast<const char*>(&size), sizeof size);  // in one piece: the pool wakes up once
    message += answer;
    if (!send_all(socket, message.data(), message.size())) break;
  }
  if (setup_.kind == Kind::supervised) std::exit(EXIT_SUCCESS);  // as the program itself: the libraries clean up
  leave_process(EXIT_SUCCESS);
}

std::optional<WorkerPool::Answer> WorkerPool::wait() {
  std::vector<pollfd> sockets;
  for (const Worker& worker : workers_)
    sockets.push_back({worker.job ? worker.socket : -1, POLLIN, 0});  // poll() ignores -1
  if (::poll(sockets.data(), sockets.size(), interval_ms) < 0) return std::nullopt;
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    Worker& worker = workers_[i];
    if (!worker.job) continue;
    if (sockets[i].revents != 0) {
      std::array<char, 1 << 16> block;
      const ssize_t size = ::recv(worker.socket, block.data(), block.size(), MSG_DONTWAIT);
      if (size < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (size <= 0) return end_of(worker, std::nullopt);
      worker.received.append(block.data(), static_cast<std::size_t>(size));
      std::uint64_t whole = 0;
      if (worker.received.size() < sizeof whole) continue;
      std::memcpy(&whole, worker.received.data(), sizeof whole);
      if (worker.received.size() - sizeof whole < whole) continue;
      Answer answer = answer_of(worker);
      answer.text = std::exchange(worker.received, {}).substr(sizeof whole);
      return answer;
    }
    if (setup_.kind == Kind::supervised) continue;
    if (std::chrono::duration<double>(Clock::now() - worker.since).count() > setup_.limits.time)
      return end_of(worker, Answer::Limit::time);
    if (memory_of(worker.process) > setup_.limits.memory) return end_of(worker, Answer::Limit::memory);
  }
  return std::nullopt;
}

/// Takes the worker's job from it.
WorkerPool::Answer WorkerPool::answer_of(Worker& worker) const {
  Answer answer;
  answer.job = std::exchange(worker.job, std::nullopt).value_or(0);
  answer.worker = static_cast<std::size_t>(&worker - workers_.data());
  answer.folder = worker.folder;
  answer.out = take_text(worker.out);
  answer.errors = take_text(worker.errors);
  return answer;
}

WorkerPool::Answer WorkerPool::end_of(Worker& worker, std::optional<Answer::Limit> exceeded) {
  Answer answer = stop(worker, exceeded ? Ending::is_killed : Ending::has_closed);
  answer.exceeded = exceeded;
  return answer;
}

/// Ends a worker, and returns how it ended.
WorkerPool::Answer WorkerPool::stop(Worker& worker, Ending ending) const {
  if (worker.process == 0) return answer_of(worker);
  if (ending == Ending::is_asked) ask_to_end(worker);
  constexpr int patience_ms = 1000;
  int ended = 0;
  pid_t found = 0;
  if (setup_.kind == Kind::supervised && ending != Ending::is_killed) {
    // its supervisor ends with it
    while ((found = ::waitpid(worker.process, &ended, 0)) < 0 && errno == EINTR) continue;
  }
  for (int i = 0; ending != Ending::is_killed && found == 0 && i < patience_ms; ++i) {
    found = ::waitpid(worker.process, &ended, WNOHANG);
    if (found == 0) ::usleep(1000);
  }
  if (found == 0) {
    ::kill(worker.process, SIGKILL);
    while (::waitpid(worker.process, &ended, 0) < 0 && errno == EINTR) continue;
  }
  if (worker.socket >= 0) ::close(std::exchange(worker.socket, -1));
  worker.process = 0;
  worker.received.clear();
  Answer answer = answer_of(worker);
  answer.status = WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended);
  answer.end = WIFEXITED(ended) ? fmt::format("with exit status {}", WEXITSTATUS(ended))
                                : fmt::format("by SIG{}", sigabbrev_np(WTERMSIG(ended)));
  return answer;
}

void WorkerPool::ask_to_end(Worker& worker) {
  if (worker.socket >= 0) ::close(std::exchange(worker.socket, -1));
}

WorkerPool::Answer WorkerPool::renew(std::size_t worker) {
  REHEARSE_ASSERT(!workers_.at(worker).job, "the worker has no job");
  take_text(workers_[worker].out);
  take_text(workers_[worker].errors);
  return stop(workers_[worker], setup_.kind == Kind::bare ? Ending::is_killed : Ending::is_asked);
}

std::vector<WorkerPool::Answer> WorkerPool::renew_all() {
  REHEARSE_ASSERT(is_idle(), "no worker has a job");
  std::vector<Answer> ends;
  if (setup_.kind == Kind::supervised)
    for (Worker& worker : workers_) ask_to_end(worker);  // they end at the same time
  for (std::size_t i = 0; i < workers_.size(); ++i) ends.push_back(renew(i));
  return ends;
}

void WorkerPool::tell(int signal) const {
  for (const Worker& worker : workers_)
    if (worker.process > 0) ::kill(worker.process, signal);
}

}  // namespace rehearse
