// ProcessGuard: finds changes that guarded code makes to the process, undoes them and reports them.
//
// A controller runs in the host's process and may change its state: the working directory, signal handlers, the locale,
// file descriptors. Comparing all of this around each call of control() would cost more than the call. So functions
// that change it have replacements (process_tripwires.cpp). The first of them in a guarded call stores the state of the
// process, and put_right() compares after the call. Calls that aren't made in every tick are always checked; this also
// finds changes made past those functions.
//
// Two resources of a run are protected in advance: signals that end a call, and protected file descriptors.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core/turns/scheduler.h"

namespace rehearse {

/// A change that guarded code made to the process.
struct Trespass {
  enum class Kind {
    float_mode,
    directory,
    signals,
    mask,
    timers,
    locale,
    environment,
    umask,
    limits,
    fork,
    descriptors,
    thread_exit
  };
  Kind kind;
  std::string deed;  // after the name of the function: "changed the working directory to '/'; it was set back"
};

class ProcessGuard {
 public:
  /// The only guard of the process.
  static ProcessGuard& instance();

  /// Guarded code can't close this descriptor from now on; -1: there is none. `name`: "the recording".
  void protect(int descriptor, std::string name);
  /// The owner has closed the descriptor.
  void release(int descriptor);

  /// Called before a guarded call into a library whose threads are counted by `threads`. `closely`: store the state of
  /// the process now, not at the first change.
  void begin(ThreadCount threads, bool closely);
  /// Sets the limits of the process back to those at its start. Called after a call that failed, before memory is
  /// needed.
  void restore_limits();
  /// Called after the call: returns the changes that the code made. All but the environment is restored; that one
  /// belongs to all controllers of a run (RunEnvironment).
  std::vector<Trespass> put_right();

  // Called by the functions that replace those of the C library.

  /// Guarded code will change a state of the process.
  void before_change();
  /// The program itself, or a thread, changes what happens at a signal.
  static void note_change_of_actions();
  /// Guarded code tries to close this descriptor. True: it may not.
  bool keeps(int descriptor);
  /// The descriptors from `first` to `last` that guarded code may not close, ascending.
  std::vector<unsigned int> kept_in(unsigned int first, unsigned int last);
  /// Guarded code tries to handle, ignore or block a signal that ends calls. True: it may not.
  bool keeps_signal(int signal_number);
  /// The count of the library whose code runs in this thread; null: no controller's code.
  ThreadCount threads_here() const;
  /// The count of the library that is called; null: none is.
  const ThreadCount& threads_of_call() const { return threads_; }
  /// A controller's own thread tried to end the process; the thread is suspended instead. `deed`: "called exit(0)".
  void note_thread_exit(const char* deed);
  /// Guarded code, or a controller's own thread, has created a child process.
  void note_fork();
  /// Guarded code tried to set a resource limit. It isn't set, because threads of the host may write or allocate
  /// meanwhile.
  void note_limit();

 private:
  struct State;
  ProcessGuard();
  ~ProcessGuard();
  void note(Trespass trespass);

  std::mutex mutex_;  // guards the next two
  std::vector<std::pair<int, std::string>> protected_;
  std::vector<Trespass> noted_;  // in the present call
  std::atomic<bool> has_noted_{false};
  ThreadCount threads_;            // of the called library
  std::unique_ptr<State> before_;  // null: no change was announced
  bool looking_ = false;
};

/// A descriptor that guarded code can't close during its lifetime.
class ProtectedDescriptor {
 public:
  ProtectedDescriptor(int descriptor, std::string name) : descriptor_(descriptor) {
    ProcessGuard::instance().protect(descriptor, std::move(name));
  }
  ~ProtectedDescriptor() { ProcessGuard::instance().release(descriptor_); }
  ProtectedDescriptor(const ProtectedDescriptor&) = delete;
  ProtectedDescriptor& operator=(const ProtectedDescriptor&) = delete;

 private:
  int descriptor_;
};

/// Sets the environment back to its variables at the construction, so that a later run in the process gets none from
/// this one. Of several at a time, which are of one run or of nested ones, the last that is destroyed does this.
class RunEnvironment {
 public:
  RunEnvironment();
  ~RunEnvironment();
  RunEnvironment(const RunEnvironment&) = delete;
  RunEnvironment& operator=(const RunEnvironment&) = delete;
};

/// The count of the library that started this thread. Null in threads that no controller started.
extern thread_local constinit const ThreadCount* own_threads;

}  // namespace rehearse
