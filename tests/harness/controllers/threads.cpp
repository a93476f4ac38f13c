// Controllers with threads of their own. Each commands a number that depends on the order in which its threads ran.
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <threads.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <future>
#include <latch>
#include <mutex>
#include <semaphore>
#include <shared_mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "behaviours.h"

namespace behaviours {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// A number that depends on the order of the numbers that were added.
class Order {
 public:
  void add(std::uint64_t number) {
    const std::scoped_lock lock(mutex_);
    value_ = value_ * 31 + number + 1;
  }
  double value() const { return static_cast<double>(value_ % 1000) * 1e-3; }

 private:
  std::mutex mutex_;
  std::uint64_t value_ = 7;
};

class Threaded : public Pusher {
 public:
  explicit Threaded(const Words&) : Pusher(0.0) {}
  bool control() override {
    effort_ = term();
    return Pusher::control();
  }

 protected:
  virtual double term() = 0;
  Order order_;
};

/// Two workers that meet control() at barriers.
class Pool : public Threaded {
 public:
  explicit Pool(const Words& words) : Threaded(words) {
    pthread_barrier_init(&begin_, nullptr, 3);
    pthread_barrier_init(&end_, nullptr, 3);
  }
  bool start() override {
    for (int i = 0; i < 2; ++i)
      workers_.emplace_back([this, i] {
        for (;;) {
          pthread_barrier_wait(&begin_);
          if (over_) return;
          order_.add(static_cast<std::uint64_t>(i + tick_));
          pthread_barrier_wait(&end_);
        }
      });
    return true;
  }
  double term() override {
    pthread_barrier_wait(&begin_);
    pthread_barrier_wait(&end_);
    return order_.value();
  }
  void stop() override {
    over_ = true;
    pthread_barrier_wait(&begin_);
    for (std::thread& worker : workers_) worker.join();
  }

 private:
  pthread_barrier_t begin_{}, end_{};
  bool over_ = false;
  std::vector<std::thread> workers_;
};
const Add<Pool> pool("pool");

/// A planner that is woken by a condition. Commands the tick of the newest plan.
class Planner : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    thread_ = std::thread([this] {
      pthread_setname_np(pthread_self(), "planner");
      std::unique_lock lock(mutex_);
      for (;;) {
        woken_.wait(lock, [this] { return over_ || goal_ > plan_; });
        if (over_) return;
        plan_ = goal_;
      }
    });
    return true;
  }
  double term() override {
    const std::scoped_lock lock(mutex_);
    const double command = plan_;
    goal_ = tick_ + 1;
    woken_.notify_one();
    return command;
  }
  void stop() override {
    {
      const std::scoped_lock lock(mutex_);
      over_ = true;
    }
    woken_.notify_one();
    thread_.join();
  }

 private:
  std::mutex mutex_;
  std::condition_variable woken_;
  bool over_ = false;
  int goal_ = 0, plan_ = 0;
  std::thread thread_;
};
const Add<Planner> planner("planner");

/// A thread that fills the other one of two buffers each millisecond.
class DoubleBuffer : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    thread_ = std::thread([this] {
      for (int count = 1; !over_; ++count) {
        const int next = 1 - now_;
        buffer_[next] = count;
        now_ = next;
        std::this_thread::sleep_for(milliseconds(1));
      }
    });
    return true;
  }
  double term() override { return buffer_[now_]; }
  void stop() override {
    over_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> over_{false};
  std::atomic<int> now_{0};
  int buffer_[2] = {0, 0};
  std::thread thread_;
};
const Add<DoubleBuffer> double_buffer("double_buffer");

/// Counts every fifth millisecond. Its first time is from before the thread was started.
class Timer : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    thread_ = std::thread([this] {
      for (steady_clock::time_point next = begin_; !over_; ++count_) {
        next += milliseconds(5);
        std::this_thread::sleep_until(next);
      }
    });
    return true;
  }
  double term() override { return count_ + 1e-3 * std::chrono::duration<double>(steady_clock::now() - begin_).count(); }
  void stop() override {
    over_ = true;
    thread_.join();
  }

 private:
  steady_clock::time_point begin_ = steady_clock::now();
  std::atomic<bool> over_{false};
  std::atomic<int> count_{0};
  std::thread thread_;
};
const Add<Timer> timer("timer");

class Async : public Threaded {
 public:
  using Threaded::Threaded;
  double term() override {
    auto first = std::async(std::launch::async, [this] { return order_.add(1), tick_; });
    auto second = std::async(std::launch::async, [this] { return order_.add(2), tick_; });
    return order_.value() + second.get() + first.get();
  }
};
const Add<Async> async("async");

class Stoppable : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    thread_ = std::jthread([this](const std::stop_token& token) {
      std::unique_lock lock(mutex_);
      while (woken_.wait(lock, token, [this] { return given_; })) {
        given_ = false;
        order_.add(static_cast<std::uint64_t>(tick_));
      }
      order_.add(99);
    });
    return true;
  }
  double term() override {
    const std::scoped_lock lock(mutex_);
    given_ = true;
    woken_.notify_all();
    return order_.value();
  }

 private:
  std::mutex mutex_;
  std::condition_variable_any woken_;
  bool given_ = false;
  std::jthread thread_;
};
const Add<Stoppable> stoppable("jthread");

/// A ball goes to and fro, by semaphores of C++ and of POSIX.
class Semaphores : public Threaded {
 public:
  explicit Semaphores(const Words& words) : Threaded(words) { sem_init(&back_, 0, 0); }
  bool start() override {
    thread_ = std::thread([this] {
      for (;;) {
        there_.acquire();
        if (over_) return;
        order_.add(5);
        sem_post(&back_);
      }
    });
    return true;
  }
  double term() override {
    for (int i = 0; i < 3; ++i) {
      there_.release();
      order_.add(3);
      sem_wait(&back_);
    }
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    now.tv_sec += 1;
    return order_.value() + (sem_timedwait(&back_, &now) == 0 ? 100.0 : 0.0);  // a second of simulated time passes
  }
  void stop() override {
    over_ = true;
    there_.release();
    thread_.join();
  }

 private:
  std::counting_semaphore<> there_{0};
  sem_t back_{};
  bool over_ = false;
  std::thread thread_;
};
const Add<Semaphores> semaphores("semaphores");

class Latch : public Threaded {
 public:
  using Threaded::Threaded;
  double term() override {
    std::latch done(2);
    std::thread first([&] { order_.add(1), done.count_down(); }), second([&] { order_.add(2), done.count_down(); });
    done.wait();
    order_.add(3);
    first.join();
    second.join();
    return order_.value();
  }
};
const Add<Latch> latch("latch");

/// Three threads want to be the first; the chosen one waits in its call.
class Once : public Threaded {
 public:
  using Threaded::Threaded;
  double term() override {
    std::once_flag flag;
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i)
      threads.emplace_back([&, i] {
        std::call_once(flag, [&] {
          std::this_thread::sleep_for(milliseconds(1));
          order_.add(static_cast<std::uint64_t>(10 + i));
        });
        order_.add(static_cast<std::uint64_t>(i));
      });
    for (std::thread& thread : threads) thread.join();
    return order_.value();
  }
};
const Add<Once> once("once");

/// Destructors of thread-local objects, which wait.
class Locals : public Threaded {
 public:
  using Threaded::Threaded;
  double term() override {
    struct Local {
      Order* order = nullptr;
      std::uint64_t number = 0;
      ~Local() {
        std::this_thread::yield();
        if (order) order->add(number);
        std::this_thread::sleep_for(milliseconds(1));
        if (order) order->add(number + 10);
      }
    };
    std::vector<std::thread> threads;
    for (std::uint64_t i = 0; i < 3; ++i)
      threads.emplace_back([this, i] {
        static thread_local Local local;
        local.order = &order_;
        local.number = i;
      });
    for (std::thread& thread : threads) thread.join();
    return order_.value();
  }
};
const Add<Locals> locals("locals");

/// A logger that is never joined.
class Logger : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    std::thread([this] {
      std::unique_lock lock(mutex_);
      for (;;) {
        woken_.wait(lock, [this] { return over_ || !lines_.empty(); });
        if (over_) break;
        order_.add(static_cast<std::uint64_t>(lines_.front()));
        lines_.pop_front();
      }
      ended_ = true;
      woken_.notify_all();
    }).detach();
    return true;
  }
  double term() override {
    const std::scoped_lock lock(mutex_);
    for (int i = 0; i < 3; ++i) lines_.push_back(tick_ + i);
    woken_.notify_all();
    return order_.value();
  }
  void stop() override {
    std::unique_lock lock(mutex_);
    over_ = true;
    woken_.notify_all();
    woken_.wait(lock, [this] { return ended_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable woken_;
  std::deque<int> lines_;
  bool over_ = false, ended_ = false;
};
const Add<Logger> logger("logger");

class Shared : public Threaded {
 public:
  using Threaded::Threaded;
  double term() override {
    std::vector<std::thread> threads;
    for (std::uint64_t i = 0; i < 4; ++i)
      threads.emplace_back([this, i] {
        if (i % 2 == 0) {
          const std::unique_lock lock(mutex_);
          std::this_thread::sleep_for(milliseconds(1));
          order_.add(i);
        } else {
          const std::shared_lock lock(mutex_);
          order_.add(i);
        }
      });
    for (std::thread& thread : threads) thread.join();
    return order_.value();
  }

 private:
  std::shared_mutex mutex_;
};
const Add<Shared> shared("rwlock");

class AtomicWait : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    thread_ = std::thread([this] {
      for (int seen = 0;;) {
        goal_.wait(seen);
        seen = goal_;
        if (seen < 0) return;
        plan_ = seen;
        plan_.notify_all();
      }
    });
    return true;
  }
  double term() override {
    const int before = plan_;
    goal_ = before + 1;
    goal_.notify_all();
    if (tick_ % 2 == 0) plan_.wait(before);
    return plan_;
  }
  void stop() override {
    goal_ = -1;
    goal_.notify_all();
    thread_.join();
  }

 private:
  std::atomic<int> goal_{0}, plan_{0};
  std::thread thread_;
};
const Add<AtomicWait> atomic_wait("atomic_wait");

class Pipe : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    if (pipe(there_) != 0 || pipe(back_) != 0) return false;
    thread_ = std::thread([this] {
      for (int number = 0; read(there_[0], &number, sizeof number) == sizeof number && number >= 0;) {
        number *= 2;
        if (write(back_[1], &number, sizeof number) != sizeof number) return;
      }
    });
    return true;
  }
  double term() override {
    int answer = -1;
    if (write(there_[1], &tick_, sizeof tick_) != sizeof tick_) return -2;
    pollfd file{back_[0], POLLIN, 0};
    if (tick_ % 2 == 0 && poll(&file, 1, 1000) != 1) return -3;  // waits; else the answer of the tick before is there
    if (tick_ % 2 == 1 && read(back_[0], &answer, sizeof answer) != sizeof answer) return -4;
    return answer;
  }
  void stop() override {
    const int end = -1;
    if (write(there_[1], &end, sizeof end) == sizeof end) thread_.join();
  }

 private:
  int there_[2] = {}, back_[2] = {};
  std::thread thread_;
};
const Add<Pipe> pipes("pipe");

/// A timer of 3 ms in a descriptor, and an event by which the thread ends.
class TimerDescriptor : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    timer_ = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC);
    end_ = eventfd(0, EFD_CLOEXEC);
    const itimerspec each{{0, 3'000'000}, {0, 3'000'000}};
    timerfd_settime(timer_, 0, &each, nullptr);
    thread_ = std::thread([this] {
      for (;;) {
        pollfd files[] = {{timer_, POLLIN, 0}, {end_, POLLIN, 0}};
        poll(files, 2, -1);
        if (files[1].revents != 0) return;
        std::uint64_t times = 0;
        if (read(timer_, &times, sizeof times) == sizeof times) count_ += static_cast<int>(times);
      }
    });
    return true;
  }
  double term() override { return count_; }
  void stop() override {
    eventfd_write(end_, 1);
    thread_.join();
    close(timer_);
    close(end_);
  }

 private:
  int timer_ = -1, end_ = -1;
  std::atomic<int> count_{0};
  std::thread thread_;
};
const Add<TimerDescriptor> timer_descriptor("timerfd");

/// Threads of C11.
class ThreadsOfC : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    mtx_init(&mutex_, mtx_plain);
    cnd_init(&woken_);
    return thrd_create(&thread_, work, this) == thrd_success;
  }
  double term() override {
    mtx_lock(&mutex_);
    ++goal_;
    cnd_signal(&woken_);
    while (tick_ % 3 == 0 && plan_ < goal_) cnd_wait(&woken_, &mutex_);
    const double command = plan_;
    mtx_unlock(&mutex_);
    return command;
  }
  void stop() override {
    mtx_lock(&mutex_);
    over_ = true;
    cnd_signal(&woken_);
    mtx_unlock(&mutex_);
    int result = 0;
    if (thrd_join(thread_, &result) != thrd_success || result != 17) std::abort();
  }

 private:
  static int work(void* given) {
    ThreadsOfC& my = *static_cast<ThreadsOfC*>(given);
    mtx_lock(&my.mutex_);
    for (;;) {
      while (!my.over_ && my.plan_ == my.goal_) cnd_wait(&my.woken_, &my.mutex_);
      if (my.over_) break;
      my.plan_ = my.goal_;
      cnd_signal(&my.woken_);
    }
    mtx_unlock(&my.mutex_);
    return 17;
  }
  mtx_t mutex_{};
  cnd_t woken_{};
  thrd_t thread_{};
  bool over_ = false;
  int goal_ = 0, plan_ = 0;
};
const Add<ThreadsOfC> threads_of_c("c11");

/// Creates threads in each tick and joins them.
class Executor : public Threaded {
 public:
  using Threaded::Threaded;
  double term() override {
    std::vector<std::thread> threads;
    for (std::uint64_t i = 0; i < 3; ++i)
      threads.emplace_back([this, i] {
        order_.add(i);
        std::this_thread::yield();
        order_.add(i + 10);
      });
    for (std::thread& thread : threads) thread.join();
    return order_.value();
  }
};
const Add<Executor> executor("executor");

/// A thread that waits by reading the clock, and one that waits by yielding.
class Readers : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    reader_ = std::thread([this] {
      for (steady_clock::time_point next = steady_clock::now(); !over_; ++reads_) {
        next += milliseconds(2);
        while (steady_clock::now() < next) continue;
      }
    });
    yielder_ = std::thread([this] {
      for (int seen = 0; !over_; seen = reads_, ++yields_)
        while (reads_ == seen && !over_) std::this_thread::yield();
    });
    return true;
  }
  double term() override { return reads_ + 1e-3 * yields_; }
  void stop() override {
    over_ = true;
    reader_.join();
    yielder_.join();
  }

 private:
  std::atomic<bool> over_{false};
  std::atomic<int> reads_{0}, yields_{0};
  std::thread reader_, yielder_;
};
const Add<Readers> readers("readers");

/// Two threads for one lock, which is held while its owner sleeps: first come, first served.
class Contended : public Threaded {
 public:
  using Threaded::Threaded;
  bool start() override {
    for (std::uint64_t i = 0; i < 2; ++i)
      threads_.emplace_back([this, i] {
        while (!over_) {
          const std::scoped_lock lock(mutex_);
          std::this_thread::sleep_for(milliseconds(1));
          order_.add(i);
        }
      });
    return true;
  }
  double term() override { return order_.value(); }
  void stop() override {
    over_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::mutex mutex_;
  std::atomic<bool> over_{false};
  std::vector<std::thread> threads_;
};
const Add<Contended> contended("contended");

/// A date that increases with each read, and a cancelled thread.
class Cancelled : public Threaded {
 public:
  using Threaded::Threaded;
  double term() override {
    pthread_t thread{};
    pthread_create(&thread, nullptr, wait_for_ever, &order_);
    std::this_thread::sleep_for(milliseconds(1));
    pthread_cancel(thread);
    void* result = nullptr;
    pthread_join(thread, &result);
    const auto first = std::chrono::system_clock::now(), second = std::chrono::system_clock::now();
    return order_.value() + (result == PTHREAD_CANCELED ? 1.0 : 0.0) + (second > first ? 2.0 : 0.0);
  }

 private:
  static void* wait_for_ever(void* order) {
    struct End {
      Order* order;
      ~End() { order->add(4); }
    } const end{static_cast<Order*>(order)};
    for (;;) sleep(1000);
  }
};
const Add<Cancelled> cancelled("cancelled");

// Controllers that fail.

std::mutex first_lock, second_lock;

/// deadlock TICK: control() and a worker take two locks in different orders.
class Deadlock : public Threaded {
 public:
  explicit Deadlock(const Words& words) : Threaded(words), when_(std::stoi(words.at(0))) {}
  bool start() override {
    worker_ = std::thread([this] {
      pthread_setname_np(pthread_self(), "worker");
      begins_.acquire();
      const std::scoped_lock second(second_lock);
      has_lock_.release();
      const std::scoped_lock first(first_lock);
    });
    return true;
  }
  double term() override {
    if (tick_ != when_) return 0.0;
    const std::scoped_lock first(first_lock);
    begins_.release();
    has_lock_.acquire();
    const std::scoped_lock second(second_lock);
    return 1.0;
  }

 private:
  int when_;
  std::binary_semaphore begins_{0}, has_lock_{0};
  std::thread worker_;
};
const Add<Deadlock> deadlock("deadlock");

volatile int spun = 0;

/// spin TICK: a thread spins from that tick on, without reading anything.
class Spinner : public Threaded {
 public:
  explicit Spinner(const Words& words) : Threaded(words), when_(std::stoi(words.at(0))) {}
  double term() override {
    if (tick_ == when_) std::thread(spin).detach();
    return 0.0;
  }

 private:
  static void spin() {
    for (;;) spun = spun + 1;
  }
  int when_;
};
const Add<Spinner> spinner("spin");

/// Waits in each tick for a thread that it has started in each tick, and lets a last one sleep beyond stop().
class Outliver : public Threaded {
 public:
  using Threaded::Threaded;
  double term() override {
    std::thread([] {}).detach();
    return 0.0;
  }
  void stop() override {
    std::thread([] { sleep(1000); }).detach();
  }
};
const Add<Outliver> outliver("outliver");

}  // namespace
}  // namespace behaviours
