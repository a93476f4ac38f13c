// Signal: a list of functions that are called at an event.
//
// Slots are called in the order of connection. A slot that is connected during an emission is first called by the next
// emission; a slot that is disconnected during an emission is no longer called. An emission inside a slot of the same
// signal waits until the running emission is complete. One thread only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace cnoid {

namespace signal_private {

/// The data of a slot that a Connection and its signal share.
struct SlotState {
  bool connected = true;
  int blocks = 0;
};

}  // namespace signal_private

/// A slot's connection to a signal. Its destruction does not disconnect the slot; that of a ScopedConnection does.
class Connection {
 public:
  Connection() = default;
  explicit Connection(std::shared_ptr<signal_private::SlotState> state) : state_(std::move(state)) {}

  void disconnect() {
    if (state_) state_->connected = false;
    state_.reset();
  }
  bool connected() const { return state_ && state_->connected; }

  /// A blocked slot stays connected but is not called. Blocks are counted: unblock as often.
  void block() {
    if (state_) ++state_->blocks;
  }
  void unblock() {
    if (state_ && state_->blocks > 0) --state_->blocks;
  }
  bool isBlocked() const { return state_ && state_->blocks > 0; }

  /// Blocks a connection during its lifetime.
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

/// A connection that its destructor disconnects.
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

/// A set of scoped connections.
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

/// Only slots without a return value are supported: Choreonoid's combiners of return values are not part of this API.
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

  /// Keeps the signal usable if a slot throws.
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

/// Allows connecting to a signal, but not emitting it. Borrowed: it must not outlive the signal's owner.
template <typename Signature>
class SignalProxy {
 public:
  /// A proxy without a signal: connecting is accepted, and no slot will ever be called.
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
