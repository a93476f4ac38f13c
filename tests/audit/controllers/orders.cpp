// Controllers with threads whose commands depend on the order of these, and others that look like them and don't. The
// option is the name of one.
#include <pthread.h>
#include <semaphore.h>

#include <atomic>
#include <condition_variable>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <thread>
#include <vector>

#include "zoo.h"

namespace {

using Lock = std::scoped_lock<std::mutex>;

/// What a controller does: `tick` returns the command.
struct Guest {
  virtual ~Guest() = default;
  virtual void start() {}
  virtual double tick(int number) = 0;
  virtual void stop() {}
};

/// A thread that works once for each ask().
struct Asked : Guest {
  std::mutex mutex;
  std::condition_variable woken;
  int asked = 0;
  bool over = false;
  std::thread worker;

  virtual void work(int number) = 0;
  void start() override {
    worker = std::thread([this] {
      pthread_setname_np(pthread_self(), "worker");
      for (int done = 0;;) {
        {
          std::unique_lock lock(mutex);
          woken.wait(lock, [&] { return over || asked > done; });
          if (over) return;
          done = asked;
        }
        work(done);
      }
    });
  }
  void ask() {
    {
      const Lock lock(mutex);
      ++asked;
    }
    woken.notify_one();
  }
  void stop() override {
    {
      const Lock lock(mutex);
      over = true;
    }
    woken.notify_one();
    if (worker.joinable()) worker.join();
  }
};

// Eight that depend on the order.

/// Asks for a plan, and uses the newest one at once: it may be that of this tick.
struct StalePlan : Asked {
  std::atomic<int> plan{0};
  void work(int number) override { plan = number; }
  double tick(int) override {
    ask();
    return plan;
  }
};

/// Adds in two steps, with a lock around each.
struct LostUpdate : Asked {
  std::mutex guard;
  int value = 0;
  int read() {
    const Lock lock(guard);
    return value;
  }
  void write(int next) {
    const Lock lock(guard);
    value = next;
  }
  void add() { write(read() + 1); }
  void work(int) override { add(); }
  double tick(int) override {
    const int before = read();
    ask();
    add();
    return before;
  }
};

/// Looks for work, and waits for it later: what comes between isn't done.
struct MissedWakeUp : Guest {
  std::mutex mutex;
  std::condition_variable woken;
  std::atomic<int> asked{0}, done{0};
  std::atomic<bool> over{false};
  std::thread worker;
  void start() override {
    worker = std::thread([this] {
      while (!over) {
        if (asked > done) {
          done = asked.load();
          continue;
        }
        std::unique_lock lock(mutex);
        woken.wait(lock);
      }
    });
  }
  void ask() {
    ++asked;
    woken.notify_one();
  }
  double tick(int) override {
    const double late = asked - done;
    ask();
    ask();
    return late;
  }
  void stop() override {
    over = true;
    for (int i = 0; i < 3; ++i) {
      const Lock lock(mutex);
      woken.notify_all();
    }
    worker.join();
  }
};

/// Says that a result is there before it is.
struct PublishBeforeWrite : Asked {
  std::condition_variable published;
  int newest = 0;
  std::atomic<int> result{0};
  void work(int number) override {
    {
      const Lock lock(mutex);
      newest = number;
    }
    published.notify_one();
    result = number;
  }
  double tick(int) override {
    ask();
    std::unique_lock lock(mutex);
    published.wait(lock, [this] { return newest == asked; });
    return result;
  }
};

/// Two locks, in two orders.
struct LockOrder : Asked {
  std::mutex first, second;
  int count = 0;
  void work(int) override {
    const Lock one(second);
    const Lock other(first);
    ++count;
  }
  double tick(int) override {
    ask();
    const Lock one(first);
    const Lock other(second);
    return 0.0 * count;
  }
};

/// Takes away a table before it says so.
struct UseAfterStop : Asked {
  std::unique_ptr<std::vector<int>> table = std::make_unique<std::vector<int>>(8, 1);
  std::mutex guard;
  void work(int number) override {
    const Lock lock(guard);
    volatile const int* place = table ? table->data() : nullptr;
    static_cast<void>(place[number % 8]);
  }
  double tick(int) override { return 1.0; }
  void stop() override {
    ask();
    {
      const Lock lock(guard);
      table.reset();
    }
    Asked::stop();
  }
};

/// Two numbers that belong together, with a line of a log between.
struct TornPair : Asked {
  std::atomic<int> first{0}, second{0};
  std::mutex log;
  int lines = 0;
  void line() {
    const Lock lock(log);
    ++lines;
  }
  void work(int number) override {
    first = number;
    line();
    second = number;
  }
  double tick(int) override {
    ask();
    line();
    return first - second;
  }
};

/// Two threads register: the first has the first place.
struct FirstCome : Guest {
  std::mutex mutex;
  std::vector<int> registered;
  std::vector<std::thread> workers;
  void start() override {
    for (int i = 0; i < 2; ++i)
      workers.emplace_back([this, i] {
        const Lock lock(mutex);
        registered.push_back(i);
      });
  }
  double tick(int) override {
    const Lock lock(mutex);
    return registered.empty() ? -1.0 : registered[0];
  }
  void stop() override {
    for (std::thread& worker : workers) worker.join();
  }
};

// Twelve that don't.

/// Uses the plan that was asked for in the tick before.
struct LastPlan : Asked {
  std::mutex guard;
  int plan = 0;
  void work(int number) override {
    const Lock lock(guard);
    plan = number;
  }
  double tick(int) override {
    double command;
    {
      const Lock lock(guard);
      command = plan;
    }
    ask();
    return command;
  }
};

/// Waits for the plan of this tick.
struct AwaitedPlan : Asked {
  std::condition_variable there;
  int plan = 0;
  void work(int number) override {
    {
      const Lock lock(mutex);
      plan = number;
    }
    there.notify_one();
  }
  double tick(int) override {
    ask();
    std::unique_lock lock(mutex);
    there.wait(lock, [this] { return plan == asked; });
    return plan;
  }
};

/// Adds with one lock around both steps; the sum is read when it can't change.
struct KeptUpdate : Asked {
  std::mutex guard;
  int value = 0;
  void add() {
    const Lock lock(guard);
    ++value;
  }
  void work(int) override { add(); }
  double tick(int) override {
    double command;
    {
      const Lock lock(guard);
      command = value % 7;
    }
    ask();
    add();
    return command;
  }
};

struct OneLockOrder : Asked {
  std::mutex first, second;
  int count = 0;
  void work(int) override {
    const Lock one(first);
    const Lock other(second);
    ++count;
  }
  double tick(int) override {
    double command;
    {
      const Lock one(first);
      const Lock other(second);
      command = count % 5;
    }
    ask();
    return command;
  }
};

/// Two numbers under one lock.
struct WholePair : Asked {
  std::mutex guard;
  int first = 0, second = 0;
  void work(int number) override {
    const Lock lock(guard);
    first = number;
    second = number;
  }
  double tick(int) override {
    ask();
    const Lock lock(guard);
    return first - second;
  }
};

/// Each worker has its own place.
struct OwnPlaces : Guest {
  pthread_barrier_t begin, end;
  std::atomic<bool> over{false};
  int number = 0, places[3] = {};
  std::vector<std::thread> workers;
  OwnPlaces() {
    pthread_barrier_init(&begin, nullptr, 4);
    pthread_barrier_init(&end, nullptr, 4);
  }
  void start() override {
    for (int i = 0; i < 3; ++i)
      workers.emplace_back([this, i] {
        for (;;) {
          pthread_barrier_wait(&begin);
          if (over) return;
          places[i] = number * (i + 1);
          pthread_barrier_wait(&end);
        }
      });
  }
  double tick(int now) override {
    number = now;
    pthread_barrier_wait(&begin);
    pthread_barrier_wait(&end);
    return places[0] + 0.5 * places[1] - places[2];
  }
  void stop() override {
    over = true;
    pthread_barrier_wait(&begin);
    for (std::thread& worker : workers) worker.join();
  }
};

/// A sum doesn't depend on the order of its terms.
struct Sum : Guest {
  double tick(int number) override {
    std::mutex mutex;
    int sum = 0;
    std::vector<std::thread> workers;
    for (int i = 0; i < 3; ++i)
      workers.emplace_back([&, i] {
        const Lock lock(mutex);
        sum += i * number;
      });
    for (std::thread& worker : workers) worker.join();
    return sum;
  }
};

struct Futures : Guest {
  double tick(int number) override {
    auto one = std::async(std::launch::async, [=] { return 2 * number; });
    auto other = std::async(std::launch::async, [=] { return 3 * number; });
    return other.get() - one.get();
  }
};

/// Hands a number to and fro.
struct PingPong : Guest {
  sem_t ping, pong;
  int number = 0;
  std::atomic<bool> over{false};
  std::thread worker;
  void start() override {
    sem_init(&ping, 0, 0);
    sem_init(&pong, 0, 0);
    worker = std::thread([this] {
      for (;;) {
        sem_wait(&ping);
        if (over) return;
        number *= 2;
        sem_post(&pong);
      }
    });
  }
  double tick(int now) override {
    number = now;
    sem_post(&ping);
    sem_wait(&pong);
    return number;
  }
  void stop() override {
    over = true;
    sem_post(&ping);
    worker.join();
  }
};

/// One of two threads makes a table, whichever it is.
struct Once : Guest {
  std::once_flag flag;
  int table = 0;
  double tick(int number) override {
    std::vector<std::thread> workers;
    for (int i = 0; i < 2; ++i) workers.emplace_back([this] { std::call_once(flag, [this] { table = 3; }); });
    for (std::thread& worker : workers) worker.join();
    return table * number;
  }
};

/// Counts lines that nobody reads.
struct Log : Asked {
  int lines = 0;
  void work(int) override { ++lines; }
  double tick(int number) override {
    ask();
    return number % 3;
  }
};

/// Several read what one wrote before.
struct Readers : Guest {
  std::shared_mutex guard;
  int table = 0;
  double tick(int number) override {
    {
      const std::unique_lock lock(guard);
      table = number;
    }
    int seen[2] = {};
    std::vector<std::thread> readers;
    for (int i = 0; i < 2; ++i)
      readers.emplace_back([&, i] {
        const std::shared_lock lock(guard);
        seen[i] = table;
      });
    for (std::thread& reader : readers) reader.join();
    return seen[0] + seen[1];
  }
};

template <class Kind>
std::unique_ptr<Guest> make() {
  return std::make_unique<Kind>();
}

const std::map<std::string, std::unique_ptr<Guest> (*)()> kinds = {{"stale_plan", make<StalePlan>},
                                                                   {"lost_update", make<LostUpdate>},
                                                                   {"missed_wake_up", make<MissedWakeUp>},
                                                                   {"publish_before_write", make<PublishBeforeWrite>},
                                                                   {"lock_order", make<LockOrder>},
                                                                   {"use_after_stop", make<UseAfterStop>},
                                                                   {"torn_pair", make<TornPair>},
                                                                   {"first_come", make<FirstCome>},
                                                                   {"last_plan", make<LastPlan>},
                                                                   {"awaited_plan", make<AwaitedPlan>},
                                                                   {"kept_update", make<KeptUpdate>},
                                                                   {"one_lock_order", make<OneLockOrder>},
                                                                   {"whole_pair", make<WholePair>},
                                                                   {"own_places", make<OwnPlaces>},
                                                                   {"sum", make<Sum>},
                                                                   {"futures", make<Futures>},
                                                                   {"ping_pong", make<PingPong>},
                                                                   {"once", make<Once>},
                                                                   {"log", make<Log>},
                                                                   {"readers", make<Readers>}};

class Orders : public ZooController {
  bool begin() override {
    const auto kind = kinds.find(options());
    if (kind == kinds.end()) return false;
    guest_ = kind->second();
    return true;
  }
  bool start() override {
    guest_->start();
    return true;
  }
  double term() override { return 0.01 * guest_->tick(++number_); }
  void stop() override { guest_->stop(); }

  std::unique_ptr<Guest> guest_;
  int number_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Orders)
