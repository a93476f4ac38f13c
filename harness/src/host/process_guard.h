// ProcessGuard: the process is not the controller's. What guarded code does to it is found, put right and told.
//
// A controller runs in our process and may change what belongs to all of it: the working directory, signal handlers,
// the locale, file descriptors. To compare all of that around each call of control() would cost more than the call. So
// the functions that change it lead through ours (process_tripwires.cpp): the first of them in a guarded call remembers
// the process as it is, and put_right() compares after the call. Calls that aren't made in every tick are looked at in
// any case, which finds also what went past those functions.
//
// What a run stands on is not given away in the first place: signals that end a call, and protected file descriptors.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// How many threads that a library started are still running.
using ThreadCount = std::shared_ptr<std::atomic<int>>;

/// Something that guarded code did to the process.
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
  /// A process has one.
  static ProcessGuard& instance();

  /// Guarded code can't close this descriptor from now on. `name`: "the recording".
  void protect(int descriptor, std::string name);
  /// It is closed by its owner.
  void release(int descriptor);

  /// Before a guarded call into a library whose threads are counted by `threads`. `closely`: remember the process now
  /// and not when it is first changed.
  void begin(ThreadCount threads, bool closely);
  /// After the call: what the code did. All but the environment is as it was before.
  std::vector<Trespass> put_right();

  // What the functions in the place of the C library's ask and tell.

  /// Guarded code is about to change something of the process.
  void before_change();
  /// Guarded code wants to close this. True: it may not.
  bool keeps(int descriptor);
  /// The same for all from `first` to `last`: those that it may not close, ascending.
  std::vector<unsigned int> kept_in(unsigned int first, unsigned int last);
  /// Guarded code wants to handle, ignore or block a signal that ends calls. True: it may not.
  bool keeps_signal(int signal_number);
  /// Of the code that runs in this thread; null: none of a controller's.
  ThreadCount threads_here() const;
  /// A thread of a controller's own wanted to end the process; it stands still instead. `deed`: "called exit(0)".
  void note_thread_exit(const char* deed);
  /// Guarded code, or a thread of a controller's own, has made a child process.
  void note_fork();
  /// It wants another resource limit: that isn't set, since threads of ours may write or allocate meanwhile.
  void note_limit();

 private:
  struct State;
  ProcessGuard();
  ~ProcessGuard();
  void note(Trespass trespass);

  std::mutex mutex_;  // of the next two
  std::vector<std::pair<int, std::string>> protected_;
  std::vector<Trespass> noted_;  // in this call
  std::atomic<bool> has_noted_{false};
  ThreadCount threads_;            // of the library that is called
  std::unique_ptr<State> before_;  // null: nothing was about to change
  bool looking_ = false;
};

/// A descriptor that guarded code can't close as long as this lives.
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

/// In a thread that a controller started: its library's count. Null in all others.
extern thread_local constinit const ThreadCount* own_threads;

}  // namespace rehearse
