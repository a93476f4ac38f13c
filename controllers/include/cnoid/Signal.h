// Signal: a list of functions to be called when something happens.
//
// Slots are called in the order in which they were connected. A slot that is connected while the signal is being
// emitted is first called by the next emission; one that is disconnected meanwhile is not called any more. An emission
// from within a slot of the same signal waits until the running one is over. One thread only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace cnoid {

namespace signal_private {

/// What a Connection and its signal both know of a slot.
struct SlotState {
  bool connected = true;
  int blocks = 0;
};

}  // namespace signal_private

/// One slot's place in a signal. Letting go of it does not disconnect the slot: ScopedConnection does.
class Connection {
 public:
  Connection() = default;
  explicit Connection(std::shared_ptr<signal_private::SlotState> state) : state_(std::move(state)) {}

  void disconnect() {
    if (state_) state_->connected = false;
    state_.reset();
  }
  bool connected() const { return state_ && state_->connected; }

  /// A blocked slot stays connected and is passed over. Blocks count: unblock as often.
  void block() {
    if (state_) ++state_->blocks;
  }
  void unblock() {
    if (state_ && state_->blocks > 0) --state_->blocks;
  }
  bool isBlocked() const { return state_ && state_->blocks > 0; }

  /// Blocks as long as it lives.
  class ScopedBlock {
   public:
    explicit ScopedBlock(Connection& connection) : connection_(connection) { connection_.block(); }
    ~ScopedBlock() { connection_.unblock(); }
    ScopedBlock(const ScopedBlock&) = delete;
    ScopedBlock& operator=(const ScopedBlock&) = delete;

   private:
    Connection& connection_;
  };
  ScopedBlock scopedBlock() { return ScopedBlock(*this); }

 private:
  std::shared_ptr<signal_private::SlotState> state_;
};

/// A connection that ends with its owner.
class ScopedConnection {
 public:
  ScopedConnection() = default;
  ScopedConnection(const Connection& connection) : connection_(connection) {}
  ScopedConnection(const ScopedConnection&) = delete;
  ScopedConnection(ScopedConnection&& other) noexcept : connection_(std::exchange(other.connection_, Connection())) {}
  ~ScopedConnection() { connection_.disconnect(); }

  ScopedConnection& operator=(const ScopedConnection&) = delete;
  ScopedConnection& operator=(const Connection& connection) {
    reset(connection);
    return *this;
  }

  void reset() { connection_.disconnect(); }
  void reset(const Connection& connection) {
    connection_.disconnect();
    connection_ = connection;
  }
  void disconnect() { connection_.disconnect(); }
  bool connected() const { return connection_.connected(); }
  void block() { connection_.block(); }
  void unblock() { connection_.unblock(); }
  bool isBlocked() const { return connection_.isBlocked(); }

 private:
  Connection connection_;
};

/// Many of them under one roof.
class ScopedConnectionSet {
 public:
  void add(const Connection& connection) { connections_.emplace_back(connection); }
  void disconnect() { connections_.clear(); }
  bool empty() const { return connections_.empty(); }

 private:
  std::vector<ScopedConnection> connections_;
};

template <typename Signature>
class Signal;

/// Only slots that return nothing exist here: Choreonoid's combiners of return values are not part of this API.
template <typename... Args>
class Signal<void(Args...)> {
 public:
  using Function = std::function<void(Args...)>;

  Signal() = default;
  Signal(const Signal&) = delete;
  Signal& operator=(const Signal&) = delete;
  ~Signal() {
    for (const auto& slot : slots_) slot->state->connected = false;
  }

  Connection connect(Function function) {
    forget_disconnected();
    slots_.push_back(std::make_shared<Slot>(Slot{std::move(function), std::make_shared<signal_private::SlotState>()}));
    return Connection(slots_.back()->state);
  }

  bool hasConnections() const {
    return std::any_of(slots_.begin(), slots_.end(), [](const auto& slot) { return slot->state->connected; });
  }

  /// Calls every connected, unblocked slot.
  void operator()(Args... args) {
    if (slots_.empty()) return;
    if (emitting_) {
      waiting_.push_back([this, args...]() { call_slots(args...); });
      return;
    }
    const EmissionScope scope(*this);
    call_slots(args...);
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      const std::function<void()> emission = waiting_[i];  // a copy: the vector may grow while it runs
      emission();
    }
  }

 private:
  struct Slot {
    Function function;
    std::shared_ptr<signal_private::SlotState> state;
  };

  /// Also when a slot throws the signal must be usable again.
  struct EmissionScope {
    explicit EmissionScope(Signal& owner) : signal(owner) { signal.emitting_ = true; }
    ~EmissionScope() {
      signal.emitting_ = false;
      signal.waiting_.clear();
      signal.forget_disconnected();
    }
    EmissionScope(const EmissionScope&) = delete;
    EmissionScope& operator=(const EmissionScope&) = delete;
    Signal& signal;
  };

  void call_slots(const Args&... args) {
    const std::size_t count = slots_.size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::shared_ptr<Slot> slot = slots_[i];
      if (slot->state->connected && slot->state->blocks == 0) slot->function(args...);
    }
  }

  void forget_disconnected() {
    if (emitting_) return;
    slots_.erase(std::remove_if(slots_.begin(), slots_.end(), [](const auto& slot) { return !slot->state->connected; }),
                 slots_.end());
  }

  std::vector<std::shared_ptr<Slot>> slots_;
  std::vector<std::function<void()>> waiting_;
  bool emitting_ = false;
};

/// Lets others connect to a signal without letting them emit it. Borrowed: don't keep it longer than the signal's
/// owner.
template <typename Signature>
class SignalProxy {
 public:
  /// A proxy of nothing: connecting is accepted, and nothing will ever be called.
  SignalProxy() = default;
  SignalProxy(Signal<Signature>& signal) : signal_(&signal) {}

  Connection connect(typename Signal<Signature>::Function function) {
    return signal_ ? signal_->connect(std::move(function)) : Connection();
  }
  bool hasConnections() const { return signal_ && signal_->hasConnections(); }

 private:
  Signal<Signature>* signal_ = nullptr;
};

}  // namespace cnoid
