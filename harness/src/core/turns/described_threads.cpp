// What threads that take turns wait for, with their names and places: for messages and debuggers.
#include "raw_call.h"
#include "scheduler.h"

namespace rehearse {

std::string TurnScheduler::name_of(const TurnThread& thread) const {
  if (thread.number == 0) return "the call itself";
  if (*thread.name) return "'" + std::string(thread.name) + "'";
  const std::string function = name_of_function ? name_of_function(thread.function) : "";
  return function.empty() ? "thread " + std::to_string(thread.number) : "'" + function + "'";
}

std::string TurnScheduler::words_of(const TurnThread& thread) const {
  if (thread.is_delayed) return "its delay";
  std::string words = thread.wait.words;
  const int owner = thread.wait.owner ? *thread.wait.owner : 0;
  if (owner == 0) return words;
  if (owner == caller_.tid) return words + " that " + name_of(caller_) + " holds";
  for (const TurnThread* other : threads_)
    if (owner == other->tid) return words + " that " + name_of(*other) + " holds";
  return words + " that a thread holds which doesn't take turns";
}

/// Where a thread waits for its turn, or this thread is.
CodePlaces TurnScheduler::places_of(TurnThread& thread) const {
  if (&thread == this_turn) return find_places ? find_places() : CodePlaces{};
  thread.places = {};
  thread.has_place = 0;
  thread.go.store(TurnThread::must_state_place, std::memory_order_release);
  wake_one(thread.go);
  while (thread.has_place.load(std::memory_order_acquire) == 0) wait_while(thread.has_place, 0);
  return thread.places;
}

std::vector<TurnScheduler::Waiting> TurnScheduler::stuck() {
  std::vector<Waiting> all = {{name_of(caller_), words_of(caller_), places_of(caller_)}};
  for (TurnThread* const thread : threads_)
    if (thread->state == State::waiting)
      all.push_back({name_of(*thread), words_of(*thread), places_of(*thread)});
    else if (thread->state == State::suspended)
      all.push_back({name_of(*thread), words_of(*thread), {}});
  return all;
}

std::vector<TurnScheduler::Waiting> TurnScheduler::at_rest() {
  std::vector<Waiting> all;
  for (TurnThread* const thread : threads_) {
    if (thread->is_lost || thread->state == State::ended) continue;
    const bool can_answer = thread->state == State::waiting || thread->state == State::ready;
    all.push_back({name_of(*thread), words_of(*thread), can_answer ? places_of(*thread) : CodePlaces{}});
  }
  return all;
}

std::size_t TurnScheduler::list(std::span<Listed> list) const {
  std::size_t count = 0;
  const TurnThread* const running = running_.load();
  const auto add = [&](const TurnThread& thread) {
    if (count < list.size())
      list[count++] = {thread.tid, thread.number, &thread == running, thread.name,
                       thread.state == State::resting ? "the others" : thread.wait.words};
  };
  add(caller_);
  for (const TurnThread* const thread : threads_) add(*thread);
  return count;
}

}  // namespace rehearse
