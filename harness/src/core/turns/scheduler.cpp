#include "scheduler.h"

#include <rehearse/diagnostic.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "raw_call.h"

namespace rehearse {

thread_local constinit TurnThread* this_turn = nullptr;

namespace {

[[noreturn]] void suspend() {
  std::atomic<std::uint32_t> never{0};
  for (;;) wait_while(never, 0);
}

}  // namespace

TurnScheduler& TurnScheduler::instance() {
  static auto& scheduler = *new TurnScheduler;  // threads of controllers may outlive all static objects
  return scheduler;
}

void TurnScheduler::begin_run() {
  base_ = now_;
  if (!threads_.empty()) return;
  now_ = base_ = 0;
  started_ = 0;
  timers_.clear();
}

void TurnScheduler::set_time(std::int64_t nanoseconds) { now_ = std::max(now_, base_ + nanoseconds); }

int TurnScheduler::count_of(const GuestThreads& guest) const {
  return static_cast<int>(std::ranges::count_if(threads_, [&](const TurnThread* thread) {
    return thread->guest.get() == &guest && thread->state != State::ended;
  }));
}

void TurnScheduler::begin_call(const ThreadCount& guest) {
  place_ = {place_.call + 1, 0};
  if (!guest || guest->are_free || (!guest->from_start && guest->in_turns == 0)) return;
  join_in(guest);
}

void TurnScheduler::begin_end_of_process() {
  if (!threads_.empty()) join_in(std::make_shared<GuestThreads>());
}

void TurnScheduler::join_in(const ThreadCount& guest) {
  if (caller_.tid == 0) caller_.tid = raw_call(SYS_gettid);
  caller_.guest = guest;
  caller_.idle = 0;
  caller_.state = State::running;
  caller_.is_alone = threads_.empty();
  this_turn = &caller_;
}

void TurnScheduler::end_call(bool failed) {
  if (!caller_.guest) return;
  this_turn = nullptr;
  TurnThread* const running = running_;
  if (running != &caller_) lose(*running);
  remove(ready_, caller_);
  remove(waiting_, caller_);
  caller_.state = State::running;
  caller_.go = 0;
  running_ = &caller_;
  is_stuck_ = false;
  const ThreadCount guest = std::exchange(caller_.guest, nullptr);
  if (!failed) return;
  for (TurnThread* const thread : std::vector(threads_))
    if (thread->guest == guest) lose(*thread);
}

void TurnScheduler::remove(std::vector<TurnThread*>& from, const TurnThread& thread) { std::erase(from, &thread); }

/// Its record stays, because the thread may look at it.
void TurnScheduler::lose(TurnThread& thread) {
  if (thread.state == State::outside) --outside_;
  thread.is_lost = true;
  thread.state = State::suspended;
  remove(ready_, thread);
  remove(waiting_, thread);
  remove(threads_, thread);
}

const TurnThread* TurnScheduler::other_at_turn() const {
  const TurnThread* const running = running_;
  return running == &caller_ ? nullptr : running;
}

void TurnScheduler::let_others_run(std::int64_t until) {
  if (threads_.empty() || !this_turn) return;
  take_arrivals();
  caller_.state = State::resting;
  until_ = until;
  pass(caller_);
}

TurnThread* TurnScheduler::add(const ThreadCount& guest, const void* function) {
  auto* const thread = new TurnThread;
  thread->guest = guest;
  thread->function = function;
  thread->number = ++started_;
  ++guest->in_turns;
  return thread;
}

void TurnScheduler::started(TurnThread& thread, pthread_t handle, bool is_detached) {
  thread.handle = handle;
  thread.is_detached = is_detached;
  threads_.push_back(&thread);
  caller_.is_alone = false;
  make_ready(thread, false);
}

void TurnScheduler::forget(TurnThread& thread) {
  --thread.guest->in_turns;
  delete &thread;
}

void TurnScheduler::begin_thread(TurnThread& thread) {
  this_turn = &thread;
  take(thread);
  thread.state = State::running;
  thread.tid = raw_call(SYS_gettid);
}

void TurnScheduler::end_thread() {
  TurnThread& me = *this_turn;
  this_turn = nullptr;
  if (me.is_lost) return;
  const long tid = me.tid;
  me.state = State::ended;
  wake(&me, 1 << 30);
  if (me.is_detached) erase(me);
  TurnThread& next = *choose();
  next.after = tid;
  running_ = &next;
  give(next);
}

void TurnScheduler::erase(TurnThread& thread) {
  remove(threads_, thread);
  caller_.is_alone = threads_.empty();
  delete &thread;
}

void TurnScheduler::detach(TurnThread& thread) {
  thread.is_detached = true;
  if (thread.state == State::ended) erase(thread);
}

TurnThread* TurnScheduler::find(pthread_t handle) {
  const auto found = std::ranges::find_if(
      threads_, [&](const TurnThread* thread) { return pthread_equal(thread->handle, handle) != 0; });
  return found == threads_.end() ? nullptr : *found;
}

void TurnScheduler::give(TurnThread& next) {
  next.go.store(TurnThread::may_run, std::memory_order_release);
  wake_one(next.go);
}

/// Returns when this thread may run.
void TurnScheduler::take(TurnThread& me) {
  for (;;) {
    const std::uint32_t go = me.go.exchange(0, std::memory_order_acq_rel);
    if (me.is_lost) suspend();
    if (go == TurnThread::may_run) break;
    if (go == TurnThread::must_state_place) {
      me.places = find_places ? find_places() : CodePlaces{};
      me.has_place.store(1, std::memory_order_release);
      wake_one(me.has_place);
    }
    wait_while(me.go, 0);
  }
  // What the C library does at the end of a thread, as with the memory of its stack, comes before this thread goes on.
  if (me.after != 0) {
    const long process = raw_call(SYS_getpid);
    while (raw_call(SYS_tgkill, process, me.after, 0) == 0) raw_call(SYS_sched_yield);
    me.after = 0;
  }
}

void TurnScheduler::pass(TurnThread& me) {
  TurnThread& next = *choose();
  if (&next != &me) {
    running_ = &next;
    give(next);
    take(me);
  }
  me.state = State::running;
  if (&me == &caller_ && std::exchange(is_stuck_, false) && on_deadlock) on_deadlock();
}

/// The next thread to run.
TurnThread* TurnScheduler::choose() {
  for (;;) {
    release_due();
    if (!ready_.empty()) {
      const auto first = ready_.begin() + static_cast<std::ptrdiff_t>(first_of_ready());
      TurnThread& thread = **first;
      ready_.erase(first);
      const std::int64_t goes_on = thread.woken_at + (thread.was_delayed ? 0 : delay_of(thread));
      if (goes_on <= now_) return &thread;
      thread.state = State::waiting;
      thread.is_delayed = true;
      thread.deadline = goes_on;
      waiting_.push_back(&thread);
      continue;
    }
    if (caller_.state == State::resting) {
      const std::int64_t next = earliest();
      if (next > until_) return &caller_;
      now_ = next;
      continue;
    }
    if (pass_time()) continue;
    is_stuck_ = true;
    remove(waiting_, caller_);
    return &caller_;
  }
}

void TurnScheduler::try_order(TurnOrder order) {
  order_ = std::move(order);
  made_.clear();
  place_ = {};
}

/// The index in ready_ of the thread that comes first.
std::size_t TurnScheduler::first_of_ready() {
  if (!order_ || ready_.size() < 2) return 0;
  std::vector<int> numbers;
  for (const TurnThread* thread : ready_) numbers.push_back(thread->number);
  const OrderPlace place{place_.call, place_.number++};
  const std::size_t first = order_->choose(place, numbers);
  if (first == 0) return 0;
  MadeExchange& made = made_.emplace_back();
  made.exchange = {place, static_cast<int>(first)};
  if (order_->is_drawn()) return first;
  made.runs = name_of(*ready_[first]);
  made.runs_at = places_of(*ready_[first]);
  made.before = name_of(*ready_[0]);
  made.before_at = places_of(*ready_[0]);
  return first;
}

void TurnScheduler::consider() {
  if (!order_ || ready_.empty()) return;
  TurnThread& me = *this_turn;
  me.wait = {"its turn", nullptr, nullptr, 0, true};
  make_ready(me, false);
  std::rotate(ready_.begin(), ready_.end() - 1, ready_.end());  // it comes first, unless the order says otherwise
  pass(me);
}

/// All threads wait, the caller, too: time passes until the first goes on. False: none can.
bool TurnScheduler::pass_time() {
  const std::int64_t next = earliest();
  while (outside_ > 0) {
    const std::uint32_t arrived = arrived_;
    if (take_arrivals()) return true;
    const std::int64_t left = next == never ? 0 : next - now_;
    const timespec duration{left / 1'000'000'000, left % 1'000'000'000};
    wait_while(arrived_, arrived, next == never ? nullptr : &duration);
    if (take_arrivals()) return true;
    if (next != never) break;
  }
  if (next == never) return false;
  now_ = next;
  return true;
}

std::int64_t TurnScheduler::earliest() const {
  std::int64_t first = earliest_timer();
  for (const TurnThread* thread : waiting_) first = std::min(first, thread->deadline);
  return first;
}

void TurnScheduler::make_ready(TurnThread& thread, bool timed_out) {
  thread.was_delayed = thread.is_delayed || thread.wait.is_short || &thread == &caller_;
  if (!thread.is_delayed) {
    thread.timed_out = timed_out;
    thread.woken_at = now_;
  }
  thread.is_delayed = false;
  thread.state = State::ready;
  thread.deadline = never;
  ready_.push_back(&thread);
}

/// Threads whose time has come, in the order of their times.
void TurnScheduler::release_due() {
  fire_timers();
  for (;;) {
    const auto first =
        std::ranges::min_element(waiting_, {}, [](const TurnThread* thread) { return thread->deadline; });
    if (first == waiting_.end() || (*first)->deadline > now_) return;
    TurnThread& thread = **first;
    waiting_.erase(first);
    make_ready(thread, true);
  }
}

std::int64_t TurnScheduler::delay_of(const TurnThread& thread) const {
  if (!thread.guest || thread.guest->delays.empty()) return 0;
  GuestThreads& guest = *thread.guest;
  const std::string function = name_of_function ? name_of_function(thread.function) : "";
  for (const std::string& name : {std::string(thread.name), function}) {
    if (name.empty()) continue;
    guest.met.insert(name);
    if (const auto found = guest.delays.find(name); found != guest.delays.end()) return found->second;
  }
  return 0;
}

std::int64_t TurnScheduler::read_time() {
  TurnThread& me = *this_turn;
  if (++me.idle > most_reads) sleep_until(now_ + idle_wait);
  return now_;
}

bool TurnScheduler::wait(const TurnWait& wait, std::int64_t deadline) {
  TurnThread& me = *this_turn;
  me.idle = 0;
  me.wait = wait;
  me.timed_out = false;
  if (deadline <= now_) {
    yield();
    return false;
  }
  if (me.is_alone && deadline != never) {
    const std::int64_t left = deadline - now_;
    const timespec duration{left / 1'000'000'000, left % 1'000'000'000};
    raw_call(SYS_nanosleep, reinterpret_cast<long>(&duration));
    now_ = deadline;
    return false;
  }
  me.deadline = deadline;
  me.state = State::waiting;
  waiting_.push_back(&me);
  pass(me);
  return !me.timed_out;
}

int TurnScheduler::wake(const void* object, int count, std::uint32_t mask) {
  int woken = 0;
  for (std::size_t i = 0; i < waiting_.size() && woken < count;) {
    TurnThread& thread = *waiting_[i];
    if (thread.is_delayed || thread.wait.object != object || !object || (thread.wait.mask & mask) == 0) {
      ++i;
      continue;
    }
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
    make_ready(thread, false);
    ++woken;
  }
  return woken;
}

int TurnScheduler::requeue(const void* from, const void* to, int count) {
  int moved = 0;
  for (TurnThread* const thread : waiting_)
    if (moved < count && !thread->is_delayed && thread->wait.object == from) {
      thread->wait.object = to;
      ++moved;
    }
  return moved;
}

bool TurnScheduler::is_promised(const void* object) const {
  return std::ranges::any_of(ready_, [&](const TurnThread* thread) {
    return thread->wait.object == object && thread->wait.is_short && !thread->timed_out;
  });
}

void TurnScheduler::yield() {
  TurnThread& me = *this_turn;
  if ((me.idle += reads_of_a_yield) > most_reads) return sleep_until(now_ + idle_wait);
  release_due();
  if (ready_.empty()) return;
  me.wait = {"its turn", nullptr, nullptr, 0, true};
  make_ready(me, false);
  pass(me);
}

void TurnScheduler::sleep_until(std::int64_t deadline) { wait({"the time", nullptr}, deadline); }

void TurnScheduler::interrupt(TurnThread& thread) {
  thread.is_cancelled = true;
  if (thread.state != State::waiting) return;
  remove(waiting_, thread);
  make_ready(thread, false);
}

void TurnScheduler::stop_for_good(const char* why) {
  TurnThread& me = *this_turn;
  me.wait = {why, nullptr};
  me.state = State::suspended;
  pass(me);
  suspend();
}

void TurnScheduler::stop_if_lost() {
  if (this_turn && this_turn->is_lost) suspend();
}

void TurnScheduler::leave_for_outside(const char* words) {
  TurnThread& me = *this_turn;
  note_outside(words);
  if (&me == &caller_) return;
  me.idle = 0;
  me.wait = {words, nullptr};
  me.state = State::outside;
  ++outside_;
  TurnThread& next = *choose();
  running_ = &next;
  give(next);
}

void TurnScheduler::note_outside(const char* words) {
  constexpr std::size_t most = 8;
  auto& known = this_turn->guest->outside;
  if (known.size() >= most) return;
  const std::pair<const char*, CodePlaces> found(words, find_places ? find_places() : CodePlaces{});
  if (std::ranges::find(known, found) == known.end()) known.push_back(found);
}

void TurnScheduler::come_back() {
  TurnThread& me = *this_turn;
  if (&me == &caller_) return;
  me.next_arrived = arrivals_.load();
  while (!arrivals_.compare_exchange_weak(me.next_arrived, &me)) continue;
  ++arrived_;
  wake_one(arrived_);
  take(me);
  me.state = State::running;
}

/// True if there are some. They become ready in the order of their start.
bool TurnScheduler::take_arrivals() {
  std::vector<TurnThread*> all;
  for (TurnThread* thread = arrivals_.exchange(nullptr); thread; thread = thread->next_arrived)
    if (!thread->is_lost) all.push_back(thread);
  std::ranges::stable_sort(all, {}, &TurnThread::number);
  for (TurnThread* const thread : all) {
    --outside_;
    make_ready(*thread, false);
  }
  return !all.empty();
}

}  // namespace rehearse
