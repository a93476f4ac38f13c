// System calls by number: those through syscall(), and those by the instruction itself, which a filter of the kernel
// (seccomp) turns into a signal. The interposed function of the same name handles them. So they are logged under its
// name, and get the same answers.
#include "system_calls.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <signal.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/sysinfo.h>
#include <sys/time.h>
#include <sys/times.h>
#include <sys/utsname.h>
#include <time.h>
#include <ucontext.h>
#include <unistd.h>

#include "next.h"
#include "watching.h"

namespace rehearse::interposer {
namespace {

struct SystemCall {
  long number;
  long a, b, c, d, e, f;
};

/// The result in the kernel's form: -errno after a failure.
long make(const SystemCall& call) {
  long result = call.number;
  register long d __asm__("r10") = call.d;
  register long e __asm__("r8") = call.e;
  register long f __asm__("r9") = call.f;
  __asm__ volatile("syscall"
                   : "+a"(result)
                   : "D"(call.a), "S"(call.b), "d"(call.c), "r"(d), "r"(e), "r"(f)
                   : "rcx", "r11", "memory");
  return result;
}

template <class T>
T* to(long address) {
  return reinterpret_cast<T*>(address);
}

long kernels(long result) { return result == -1 ? -errno : result; }

/// With SIGSYS blocked the next system call would end the process.
long set_mask(SystemCall call) {
  uint64_t mask = 0;
  if (call.b && call.a != SIG_UNBLOCK) {
    mask = *to<uint64_t>(call.b) & ~(uint64_t{1} << (SIGSYS - 1));
    call.b = reinterpret_cast<long>(&mask);
  }
  return make(call);
}

/// True if there is an interposed function for the call. `result` in the kernel's form.
bool answer(const SystemCall& call, long& result) {
  const auto [number, a, b, c, d, e, f] = call;
  switch (number) {
    case SYS_getrandom:
      return result = kernels(getrandom(to<void>(a), static_cast<size_t>(b), static_cast<unsigned>(c))), true;
    case SYS_time: return result = time(to<time_t>(a)), true;
    case SYS_gettimeofday: return result = kernels(gettimeofday(to<timeval>(a), to<struct timezone>(b))), true;
    case SYS_clock_gettime: return result = kernels(clock_gettime(static_cast<clockid_t>(a), to<timespec>(b))), true;
    case SYS_nanosleep: return result = kernels(nanosleep(to<timespec>(a), to<timespec>(b))), true;
    case SYS_clock_nanosleep:
      return result =
                 -clock_nanosleep(static_cast<clockid_t>(a), static_cast<int>(b), to<timespec>(c), to<timespec>(d)),
             true;
    case SYS_times: return result = kernels(times(to<tms>(a))), true;
    case SYS_getrusage: return result = kernels(getrusage(static_cast<__rusage_who>(a), to<struct rusage>(b))), true;
    case SYS_getpid: return result = getpid(), true;
    case SYS_gettid: return result = gettid(), true;
    case SYS_getppid: return result = getppid(), true;
    case SYS_getuid: return result = getuid(), true;
    case SYS_geteuid: return result = geteuid(), true;
    case SYS_getgid: return result = getgid(), true;
    case SYS_getegid: return result = getegid(), true;
    case SYS_uname: return result = kernels(uname(to<utsname>(a))), true;
    case SYS_sysinfo: return result = kernels(sysinfo(to<struct sysinfo>(a))), true;
    case SYS_getcpu: return result = kernels(getcpu(to<unsigned>(a), to<unsigned>(b))), true;
    case SYS_sched_getaffinity: {  // the kernel returns the number of written bytes
      const long size = b < 128 ? b : 128;
      result = kernels(sched_getaffinity(static_cast<pid_t>(a), static_cast<size_t>(size), to<cpu_set_t>(c)));
      if (result == 0) result = size;
      return true;
    }
    case SYS_ioctl: return result = kernels(ioctl(static_cast<int>(a), static_cast<unsigned long>(b), c)), true;
    case SYS_open: return result = kernels(open(to<char>(a), static_cast<int>(b), static_cast<mode_t>(c))), true;
    case SYS_openat:
      return result = kernels(openat(static_cast<int>(a), to<char>(b), static_cast<int>(c), static_cast<mode_t>(d))),
             true;
    case SYS_creat: return result = kernels(creat(to<char>(a), static_cast<mode_t>(b))), true;
    case SYS_unlink: return result = kernels(unlink(to<char>(a))), true;
    case SYS_mkdir: return result = kernels(mkdir(to<char>(a), static_cast<mode_t>(b))), true;
    case SYS_access: return result = kernels(access(to<char>(a), static_cast<int>(b))), true;
    case SYS_stat: return result = kernels(stat(to<char>(a), to<struct stat>(b))), true;
    case SYS_newfstatat:
      return result = kernels(fstatat(static_cast<int>(a), to<char>(b), to<struct stat>(c), static_cast<int>(d))), true;
    default: return false;
  }
}

/// System calls that only have an effect, or return only data that the controller wrote itself.
bool is_quiet(long number) {
  static constexpr long numbers[] = {SYS_write,       SYS_writev,         SYS_close,   SYS_lseek, SYS_mmap,
                                     SYS_munmap,      SYS_mprotect,       SYS_madvise, SYS_brk,   SYS_futex,
                                     SYS_sched_yield, SYS_rt_sigprocmask, SYS_read,    SYS_readv};
  for (const long quiet : numbers)
    if (number == quiet) return true;
  return false;
}

void on_system_call(int, siginfo_t* info, void* context) {
  greg_t* const registers = static_cast<ucontext_t*>(context)->uc_mcontext.gregs;
  const SystemCall call{info->si_syscall,   registers[REG_RDI], registers[REG_RSI], registers[REG_RDX],
                        registers[REG_R10], registers[REG_R8],  registers[REG_R9]};
  const int errno_before = errno;
  long result = 0;
  if (call.number == SYS_rt_sigprocmask) {
    result = set_mask(call);
  } else if (!watching()) {
    result = make(call);
  } else if (!answer(call, result)) {
    if (!is_quiet(call.number)) note(source_of::syscall, "syscall", Digits(call.number), info->si_call_addr);
    result = make(call);
  }
  errno = errno_before;
  registers[REG_RAX] = result;
}

bool holds_system_calls(const unsigned char* begin, const unsigned char* end) {
  for (const unsigned char* at = begin; at + 1 < end; ++at) {
    at = static_cast<const unsigned char*>(memchr(at, 0x0f, static_cast<size_t>(end - at - 1)));
    if (!at) return false;
    if (at[1] == 0x05) return true;
  }
  return false;
}

}  // namespace

REHEARSE_INTERPOSED(long, syscall, (long number, long a, long b, long c, long d, long e, long f)) {
  if (!watching()) return next_syscall.get()(number, a, b, c, d, e, f);
  long result = 0;
  if (answer({number, a, b, c, d, e, f}, result)) {
    if (result >= 0 || result < -4095) return result;
    errno = static_cast<int>(-result);
    return -1;
  }
  if (!is_quiet(number)) note(source_of::syscall, "syscall", Digits(number), __builtin_return_address(0));
  return next_syscall.get()(number, a, b, c, d, e, f);
}

void sleep_really(const timespec& duration) {
  static_cast<void>(make({SYS_nanosleep, reinterpret_cast<long>(&duration), 0, 0, 0, 0, 0}));
}

void prepare_for_system_calls() {
  struct sigaction action {};
  action.sa_sigaction = on_system_call;
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  sigaction(SIGSYS, &action, nullptr);
}

bool watch_system_calls(uint64_t begin, uint64_t end) {
  if (!holds_system_calls(reinterpret_cast<unsigned char*>(begin), reinterpret_cast<unsigned char*>(end))) return true;
  const auto low = [](uint64_t address) { return static_cast<uint32_t>(address); };
  const auto high = [](uint64_t address) { return static_cast<uint32_t>(address >> 32); };
  if (high(begin) != high(end)) return false;  // the filter only compares halves of addresses
  // Calls that begin a thread on its own stack, or return from a signal, can't be made by the handler.
  sock_filter code[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, arch)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_X86_64, 0, 11),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 9, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 8, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_vfork, 7, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_rt_sigreturn, 6, 0),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, instruction_pointer) + 4),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, high(begin), 0, 4),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, instruction_pointer)),
      BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, low(begin), 0, 2),
      BPF_JUMP(BPF_JMP | BPF_JGT | BPF_K, low(end), 1, 0),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const sock_fprog program{sizeof code / sizeof code[0], code};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  return syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) == 0;
}

}  // namespace rehearse::interposer
