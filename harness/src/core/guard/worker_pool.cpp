#include "worker_pool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/futex.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <new>
#include <utility>

#include "c_library.h"
#include "child_process.h"
#include "guarded_call.h"
#include "interruption.h"
#include "process_guard.h"
#include "supervise.h"

namespace rehearse {
namespace {

constexpr int interval_ms = 200;              // of looks at limits and signals
constexpr std::size_t places_per_worker = 4;  // for the job at work, and for those that are next
constexpr useconds_t reading_pause_us = 1500;

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

/// Who has the job of a place: nobody, no worker yet, or the worker of index i (1 + i).
constexpr std::int32_t free_place = -1, waiting_job = 0;

std::int32_t owner_of(std::size_t worker) { return static_cast<std::int32_t>(worker) + 1; }

std::int64_t now_ns() { return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// The head of an answer. After it come its text, and the output and errors of the job.
struct MessageHead {
  std::uint64_t place = 0;
  std::int64_t job = 0;
  std::uint64_t text = 0, out = 0, errors = 0;  // sizes [bytes]
  std::uint64_t spoils_process = 0;

  std::uint64_t size() const { return text + out + errors; }
};

}  // namespace

/// The memory that this process and its workers share. This process writes the job of a free place, and a worker takes
/// a job by writing itself as the owner. A controller may write here: what this process relies on is in places_.
struct WorkerPool::Shared {
  struct Place {
    std::atomic<std::int32_t> owner{free_place};
    std::atomic<std::int64_t> job{0}, order{0}, since{0};  // since: when a worker took it [ns]
  };
  std::atomic<std::uint32_t> changes{0};  // a futex: idle workers wait for its change
  std::atomic<bool> ends{false};          // idle workers end
  Place* places() { return reinterpret_cast<Place*>(this + 1); }

  static std::size_t bytes(std::size_t places) { return sizeof(Shared) + places * sizeof(Place); }
  void tell_change(int workers) {
    ++changes;
    ::syscall(SYS_futex, &changes, FUTEX_WAKE, workers, nullptr, nullptr, 0);
  }
  /// The number of jobs that no worker has taken.
  std::size_t waiting(std::size_t count) {
    return static_cast<std::size_t>(
        std::count_if(places(), places() + count, [](const Place& place) { return place.owner == waiting_job; }));
  }
  std::optional<std::size_t> take_first(std::size_t count, std::int32_t owner);
  std::optional<std::size_t> wait_for_job(std::size_t count, std::int32_t owner);
};

/// Takes the job that was given first among those that wait.
std::optional<std::size_t> WorkerPool::Shared::take_first(std::size_t count, std::int32_t owner) {
  for (;;) {
    std::optional<std::size_t> first;
    for (std::size_t i = 0; i < count; ++i)
      if (places()[i].owner == waiting_job && (!first || places()[i].order < places()[*first].order)) first = i;
    if (!first) return std::nullopt;
    std::int32_t waiting = waiting_job;
    if (!places()[*first].owner.compare_exchange_strong(waiting, owner)) continue;
    places()[*first].since = now_ns();
    return first;
  }
}

/// None: the worker has to end, because the pool says so or a signal came, as when the pool's process is gone.
std::optional<std::size_t> WorkerPool::Shared::wait_for_job(std::size_t count, std::int32_t owner) {
  constexpr timespec longest{0, interval_ms * 1'000'000};  // a signal may come just before the wait
  for (;;) {
    const std::uint32_t before = changes;
    if (ends || interruption() != 0) return std::nullopt;
    if (const auto place = take_first(count, owner)) return place;
    ::syscall(SYS_futex, &changes, FUTEX_WAIT, before, &longest, nullptr, 0);
  }
}

WorkerPool::WorkerPool(Setup setup, Work work)
    : setup_([&] {
        if (setup.kind == Kind::bare && setup.limits.memory <= 0.0) setup.limits.memory = default_memory_limit();
        return std::move(setup);
      }()),
      work_(std::move(work)),
      workers_(setup_.size),
      places_(places_per_worker * setup_.size) {
  static_assert(std::atomic<std::int64_t>::is_always_lock_free && sizeof(std::atomic<std::uint32_t>) == 4);
  if (setup_.folder.empty()) return;
  for (std::size_t i = 0; i < places_.size(); ++i) places_[i].folder = setup_.folder / fmt::format("job-{}", i + 1);
}

WorkerPool::~WorkerPool() {
  if (setup_.kind == Kind::supervised) tell(SIGTERM);  // all at the same time
  if (shared_) shared_->ends = true;
  if (shared_) shared_->tell_change(INT_MAX);
  for (Worker& worker : workers_) stop(worker, setup_.kind == Kind::bare ? Ending::is_killed : Ending::is_asked);
  if (shared_) ::munmap(shared_, Shared::bytes(places_.size()));
}

Result<void> WorkerPool::share() {
  const std::size_t bytes = Shared::bytes(places_.size());
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return not_started(std::strerror(errno));
  shared_ = new (memory) Shared;
  for (std::size_t i = 0; i < places_.size(); ++i) new (shared_->places() + i) Shared::Place;
  return {};
}

Result<void> WorkerPool::give(std::int64_t job) {
  const auto place = std::ranges::find_if(places_, [](const Place& known) { return !known.job; });
  REHEARSE_ASSERT(place != places_.end(), "a job needs a place");
  if (!shared_) REHEARSE_TRY(share());
  std::error_code failed;
  if (!place->folder.empty()) std::filesystem::create_directories(place->folder, failed);
  if (failed) return error_in(place->folder.string(), fmt::format("it can't be made: {}", failed.message()));
  Shared::Place& shared = shared_->places()[place - places_.begin()];
  place->job = job;
  ++given_;
  shared.job = job;
  shared.order = order_++;
  shared.since = 0;
  shared.owner = waiting_job;
  shared_->tell_change(1);
  return start_missing();
}

/// Starts workers until there is one for each job without an answer, or all are there.
Result<void> WorkerPool::start_missing() {
  std::size_t missing = std::min(given_, workers_.size());
  for (Worker& worker : workers_) {
    if (missing == 0) break;
    if (worker.process == 0) REHEARSE_TRY(start(worker));
    --missing;
  }
  return {};
}

Result<void> WorkerPool::start(Worker& worker) {
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
    serve(worker, sockets[1]);
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
    on_failed_process(nullptr);  // the pool's process tells it
    supervise_process();
    end_runs_on_signals();
  }
  ProcessGuard::instance().protect(socket, "the socket of a worker");
}

void WorkerPool::serve(const Worker& worker, int socket) const noexcept {
  bool is_sound = true;
  while (is_sound) {
    const auto place = shared_->wait_for_job(places_.size(), owner_of(number_of(worker)));
    if (!place) break;
    const std::int64_t job = shared_->places()[*place].job;
    const Made made = work_(job, places_[*place].folder);
    std::fflush(nullptr);
    const std::string out = take_text(worker.out), errors = take_text(worker.errors);
    const MessageHead head{*place, job, made.text.size(), out.size(), errors.size(), made.spoils_process};
    std::string message(reinterpret_cast<const char*>(&head), sizeof head);  // in one piece: the pool wakes up once
    message.append(made.text).append(out).append(errors);
    is_sound = send_all(socket, message.data(), message.size()) && !made.spoils_process;
  }
  if (setup_.kind == Kind::supervised) std::exit(EXIT_SUCCESS);  // as the program itself: the libraries clean up
  leave_process(EXIT_SUCCESS);
}

Result<std::optional<WorkerPool::Answer>> WorkerPool::wait() {
  for (Worker& worker : workers_)
    if (auto answer = next_received(worker)) return answer;
  REHEARSE_TRY(start_missing());
  // workers that have a next job need no answer: several are read at a time, because each time interrupts a worker
  if (shared_ && shared_->waiting(places_.size()) >= workers_.size()) ::usleep(reading_pause_us);
  std::vector<pollfd> sockets;
  for (const Worker& worker : workers_) sockets.push_back({worker.socket, POLLIN, 0});  // poll() ignores -1
  const int found = ::poll(sockets.data(), sockets.size(), interval_ms);
  if (found < 0) return std::optional<Answer>();
  if (found == 0) offer_lost_places();
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    Worker& worker = workers_[i];
    if (sockets[i].revents != 0) {
      if (auto answer = receive(worker)) return answer;
      continue;
    }
    const auto place = place_of(worker);
    if (setup_.kind == Kind::supervised || worker.process == 0 || !place) continue;
    const std::int64_t since = shared_->places()[*place].since;
    if (since != 0 && 1e-9 * static_cast<double>(now_ns() - since) > setup_.limits.time)
      return end_of(worker, Answer::Limit::time);
    if (memory_of(worker.process) > setup_.limits.memory) return end_of(worker, Answer::Limit::memory);
  }
  return std::optional<Answer>();
}

/// Reads from the worker's socket. The answer that is whole then, or the end of the worker.
std::optional<WorkerPool::Answer> WorkerPool::receive(Worker& worker) {
  std::array<char, 1 << 16> block;
  const ssize_t size = ::recv(worker.socket, block.data(), block.size(), MSG_DONTWAIT);
  if (size < 0 && (errno == EINTR || errno == EAGAIN)) return std::nullopt;
  if (size <= 0) return end_of(worker, std::nullopt);
  worker.received.append(block.data(), static_cast<std::size_t>(size));
  return next_received(worker);
}

/// The first answer in the received bytes, if it is whole. A worker that its job spoiled has ended then.
std::optional<WorkerPool::Answer> WorkerPool::next_received(Worker& worker) {
  MessageHead head;
  if (worker.received.size() < sizeof head) return std::nullopt;
  std::memcpy(&head, worker.received.data(), sizeof head);
  const std::string& bytes = worker.received;
  if (bytes.size() - sizeof head < head.size()) return std::nullopt;
  std::size_t at = sizeof head;
  const auto part = [&](std::uint64_t size) { return bytes.substr(std::exchange(at, at + size), size); };
  std::string text = part(head.text), out = part(head.out), errors = part(head.errors);
  worker.received.erase(0, at);
  // of another job: something wrote into the shared memory, and offer_lost_places() has the right one made
  const bool is_known = head.place < places_.size() && places_[head.place].job == head.job;
  if (!is_known && head.place < places_.size()) shared_->places()[head.place].owner = free_place;
  std::optional<Answer> answer;
  if (is_known) {
    answer = take(head.place);
    answer->text = std::move(text);
    answer->out = std::move(out);
    answer->errors = std::move(errors);
  }
  if (head.spoils_process == 0) return answer;
  const Answer end = stop(worker, setup_.kind == Kind::bare ? Ending::is_killed : Ending::has_closed);
  if (!answer || setup_.kind == Kind::bare) return answer;
  answer->out += end.out;
  answer->errors += end.errors;
  answer->status = end.status;
  if (end.status != EXIT_SUCCESS) answer->text.reset();  // a part whose worker doesn't end well has failed
  return answer;
}

/// The place whose job the worker has.
std::optional<std::size_t> WorkerPool::place_of(const Worker& worker) const {
  for (std::size_t i = 0; i < places_.size(); ++i)
    if (places_[i].job && shared_->places()[i].owner == owner_of(number_of(worker))) return i;
  return std::nullopt;
}

/// Lets workers take the jobs of places whose owner is none of them: something wrote into the shared memory.
void WorkerPool::offer_lost_places() {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const std::int32_t owner = shared_->places()[i].owner;
    const bool is_worker = owner > 0 && static_cast<std::size_t>(owner) <= workers_.size() &&
                           workers_[static_cast<std::size_t>(owner) - 1].process != 0;
    if (!places_[i].job || owner == waiting_job || is_worker) continue;
    shared_->places()[i].job = *places_[i].job;
    shared_->places()[i].owner = waiting_job;
    shared_->tell_change(INT_MAX);
  }
}

/// Takes the job from its place.
WorkerPool::Answer WorkerPool::take(std::size_t place) {
  Answer answer;
  answer.job = *std::exchange(places_[place].job, std::nullopt);
  answer.folder = places_[place].folder;
  shared_->places()[place].owner = free_place;
  --given_;
  return answer;
}

/// Ends a worker whose answers are all received. The end of its job; none: it had none.
std::optional<WorkerPool::Answer> WorkerPool::end_of(Worker& worker, std::optional<Answer::Limit> exceeded) {
  const auto place = place_of(worker);
  Answer end = stop(worker, exceeded ? Ending::is_killed : Ending::has_closed);
  if (!place) {
    ended_.push_back(std::move(end));
    return std::nullopt;
  }
  const Answer taken = take(*place);
  end.job = taken.job;
  end.folder = taken.folder;
  end.exceeded = exceeded;
  return end;
}

/// Ends a worker, and returns how it ended.
WorkerPool::Answer WorkerPool::stop(Worker& worker, Ending ending) {
  Answer answer;
  if (worker.process == 0) return answer;
  if (ending == Ending::is_asked) ::close(std::exchange(worker.socket, -1));  // it sends nothing more
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
  answer.out = take_text(worker.out);
  answer.errors = take_text(worker.errors);
  answer.status = WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended);
  answer.end = end_text(ended);
  return answer;
}

std::vector<WorkerPool::Answer> WorkerPool::renew_all() {
  REHEARSE_ASSERT(is_idle(), "no job is without an answer");
  std::vector<Answer> ends = std::exchange(ended_, {});
  if (!shared_) return ends;
  shared_->ends = true;  // they end at the same time
  shared_->tell_change(INT_MAX);
  for (Worker& worker : workers_)
    if (worker.process != 0)
      ends.push_back(stop(worker, setup_.kind == Kind::bare ? Ending::is_killed : Ending::is_asked));
  shared_->ends = false;
  return ends;
}

void WorkerPool::tell(int signal) const {
  for (const Worker& worker : workers_)
    if (worker.process > 0) ::kill(worker.process, signal);
}

}  // namespace rehearse
