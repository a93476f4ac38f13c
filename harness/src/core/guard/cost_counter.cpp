// The replacements of functions that are only counted. Each jumps to the next function of its name with all registers
// unchanged, so one form serves all signatures, also those with variable arguments.
#undef _FORTIFY_SOURCE  // see next_functions.h
#include "cost_counter.h"

#include <dlfcn.h>
#include <stdlib.h>

#include "counted_function.h"
#include "next_functions.h"

using rehearse::Cost;
using rehearse::CountedFunction;

extern "C" {
// The allocator of the C library. It is called before dlsym() can be.
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
void __libc_free(void*);

/// The allocator of AddressSanitizer replaces this one, and calls these hooks. Null without it.
__attribute__((weak)) int __sanitizer_install_malloc_and_free_hooks(void (*allocated)(const volatile void*, size_t),
                                                                    void (*released)(const volatile void*));

/// The counts of the present call; null: this thread counts nothing. A thread-local variable of the static model,
/// because any other one allocates memory at its first use.
__attribute__((visibility("hidden"),
               tls_model("initial-exec"))) __thread rehearse::msg::ControlCost* rehearse_counting = nullptr;
}

namespace rehearse {
namespace {

CostObserver observer = nullptr;

/// The registers of the first arguments, as the replacement stored them. No std::array: its functions may be those of a
/// file that is compiled with AddressSanitizer.
using Arguments = std::uint64_t[3];

void add(const CountedFunction& function, const Arguments& arguments, msg::ControlCost& costs) {
  const auto allocate = [&](std::uint64_t bytes) {
    ++costs.allocations;
    costs.allocated_bytes += bytes;
  };
  switch (function.count) {
    case CountedFunction::Count::none: break;
    case CountedFunction::Count::allocate_0: return allocate(arguments[0]);
    case CountedFunction::Count::allocate_1: return allocate(arguments[1]);
    case CountedFunction::Count::allocate_2: return allocate(arguments[2]);
    case CountedFunction::Count::allocate_product: return allocate(arguments[0] * arguments[1]);
    case CountedFunction::Count::reallocate:
      if (arguments[0] != 0) ++costs.releases;
      return allocate(arguments[1]);
    case CountedFunction::Count::release:
      if (arguments[0] != 0) ++costs.releases;
      break;
    case CountedFunction::Count::lock: ++costs.locks; break;
    case CountedFunction::Count::system: ++costs.system_calls; break;
    case CountedFunction::Count::exception: ++costs.exceptions; break;
  }
}

Cost cost_of(CountedFunction::Count count) {
  using Count = CountedFunction::Count;
  switch (count) {
    case Count::none: return Cost::none;
    case Count::release: return Cost::release;
    case Count::lock: return Cost::lock;
    case Count::system: return Cost::system_call;
    case Count::exception: return Cost::exception;
    default: return Cost::allocation;
  }
}

void count(const CountedFunction& function, const Arguments& arguments) {
  msg::ControlCost* const costs = rehearse_counting;
  if (!costs) return;
  add(function, arguments, *costs);
  const Cost cost = cost_of(function.count);
  if (!observer || cost == Cost::none || (cost == Cost::release && arguments[0] == 0)) return;
  const HostCode own;
  observer(cost, function.name);
}

void note_new(const volatile void*, size_t size) {
  static const CountedFunction function{nullptr, "malloc", CountedFunction::Count::allocate_0};
  count(function, {size});
}

void note_freed(const volatile void* block) {
  static const CountedFunction function{nullptr, "free", CountedFunction::Count::release};
  count(function, {reinterpret_cast<std::uint64_t>(block)});
}

void* next_of(CountedFunction& function) {
  if (!function.next) function.next = next_function(function.name);
  if (!function.next) abort();  // it exists, because the caller is linked to it
  return function.next;
}

}  // namespace

std::string_view to_string(Cost cost) {
  constexpr std::string_view names[] = {"", "allocation", "release", "lock", "system call", "exception"};
  return names[static_cast<std::size_t>(cost)];
}

CountedCall::CountedCall(msg::ControlCost* costs) { rehearse_counting = costs; }
void CountedCall::stop() { rehearse_counting = nullptr; }

HostCode::HostCode() : outer_(rehearse_counting) { rehearse_counting = nullptr; }
HostCode::~HostCode() { rehearse_counting = outer_; }

void count_message_bytes(std::uint64_t bytes) {
  if (rehearse_counting) rehearse_counting->message_bytes += bytes;
}

void observe_costs(CostObserver other) { observer = other; }

void count_guarded(const CountedFunction& function) { count(function, {}); }

bool can_count_costs() {
  static const bool can = [] {
    if (__sanitizer_install_malloc_and_free_hooks) __sanitizer_install_malloc_and_free_hooks(note_new, note_freed);
    msg::ControlCost costs;
    const CountedCall counted(&costs);
    void* (*volatile const allocate)(size_t) = malloc;  // volatile: the compiler may not leave out the pair
    free(allocate(1));
    return costs.allocations == 1 && costs.releases == 1;
  }();
  return can;
}

}  // namespace rehearse

/// Called by a replacement that counts, or whose next function isn't known yet. Returns the next function.
extern "C" __attribute__((visibility("hidden"), used)) void* rehearse_count_call(rehearse::CountedFunction* function,
                                                                                 const rehearse::Arguments* arguments) {
  rehearse::count(*function, *arguments);
  return rehearse::next_of(*function);
}

// A CountedFunction for each row, and a replacement for each that is only counted.
#define REHEARSE_COUNTED(function, next_, count_)                                                         \
  extern "C" __attribute__((visibility("hidden"))) rehearse::CountedFunction rehearse_counted_##function; \
  rehearse::CountedFunction rehearse_counted_##function{next_, #function, rehearse::CountedFunction::Count::count_};
#define REHEARSE_REPLACED(function, next, count) \
  REHEARSE_COUNTED(function, next, count)        \
  REHEARSE_REPLACEMENT(function)

#if defined(__x86_64__)
// The common part keeps all registers of arguments: rdi, rsi, rdx, rcx, r8, r9, of variable arguments rax, of nested
// functions r10, and xmm0 to xmm7. r11 belongs to nobody between a call and the called function.
__asm__(R"(
  .text
  .type rehearse_count_and_jump, @function
rehearse_count_and_jump:
  .cfi_startproc
  subq $200, %rsp
  .cfi_adjust_cfa_offset 200
  movq %rdi, 0(%rsp)
  movq %rsi, 8(%rsp)
  movq %rdx, 16(%rsp)
  movq %rcx, 24(%rsp)
  movq %r8, 32(%rsp)
  movq %r9, 40(%rsp)
  movq %rax, 48(%rsp)
  movq %r10, 56(%rsp)
  movaps %xmm0, 64(%rsp)
  movaps %xmm1, 80(%rsp)
  movaps %xmm2, 96(%rsp)
  movaps %xmm3, 112(%rsp)
  movaps %xmm4, 128(%rsp)
  movaps %xmm5, 144(%rsp)
  movaps %xmm6, 160(%rsp)
  movaps %xmm7, 176(%rsp)
  movq %r11, %rdi
  movq %rsp, %rsi
  call rehearse_count_call
  movq %rax, %r11
  movq 0(%rsp), %rdi
  movq 8(%rsp), %rsi
  movq 16(%rsp), %rdx
  movq 24(%rsp), %rcx
  movq 32(%rsp), %r8
  movq 40(%rsp), %r9
  movq 48(%rsp), %rax
  movq 56(%rsp), %r10
  movaps 64(%rsp), %xmm0
  movaps 80(%rsp), %xmm1
  movaps 96(%rsp), %xmm2
  movaps 112(%rsp), %xmm3
  movaps 128(%rsp), %xmm4
  movaps 144(%rsp), %xmm5
  movaps 160(%rsp), %xmm6
  movaps 176(%rsp), %xmm7
  addq $200, %rsp
  .cfi_adjust_cfa_offset -200
  jmp *%r11
  .cfi_endproc
  .size rehearse_count_and_jump, . - rehearse_count_and_jump
)");

#define REHEARSE_REPLACEMENT(function)                  \
  __asm__(                                              \
      ".text\n"                                         \
      ".globl " #function                               \
      "\n"                                              \
      ".type " #function ", @function\n" #function      \
      ":\n"                                             \
      "  .cfi_startproc\n"                              \
      "  endbr64\n"                                     \
      "  movq rehearse_counting@gottpoff(%rip), %r11\n" \
      "  cmpq $0, %fs:(%r11)\n"                         \
      "  leaq rehearse_counted_" #function              \
      "(%rip), %r11\n"                                  \
      "  jne rehearse_count_and_jump\n"                 \
      "  cmpq $0, (%r11)\n"                             \
      "  je rehearse_count_and_jump\n"                  \
      "  jmp *(%r11)\n"                                 \
      "  .cfi_endproc\n"                                \
      ".size " #function ", . - " #function "\n");
#else
#define REHEARSE_REPLACEMENT(function)
#endif

#define REHEARSE_ROW_guarded(function, count) REHEARSE_COUNTED(function, nullptr, count)
#define REHEARSE_ROW_turns(function, count) REHEARSE_COUNTED(function, nullptr, count)
#define REHEARSE_ROW_derived(function, count)
#define REHEARSE_ROW_free(function, count)
#define REHEARSE_ROW_counted(function, count) REHEARSE_REPLACED(function, nullptr, count)
#define REHEARSE_ROW_allocator(function, count) \
  REHEARSE_REPLACED(function, reinterpret_cast<void*>(&__libc_##function), count)
#define REHEARSE_ROW(function, source, guard, count) REHEARSE_ROW_##guard(function, count)
REHEARSE_C_FUNCTIONS(REHEARSE_ROW)

namespace {

/// As for NextFunctions: a look-up takes the lock of the dynamic linker.
[[maybe_unused]] const bool looked_up_at_loading = [] {
#define REHEARSE_LOOK_UP_guarded(function)
#define REHEARSE_LOOK_UP_turns(function)
#define REHEARSE_LOOK_UP_derived(function)
#define REHEARSE_LOOK_UP_free(function)
#define REHEARSE_LOOK_UP_allocator(function)
#define REHEARSE_LOOK_UP_counted(function) \
  if (!rehearse_counted_##function.next) rehearse_counted_##function.next = rehearse::next_function(#function);
#define REHEARSE_LOOK_UP(function, source, guard, count) REHEARSE_LOOK_UP_##guard(function)
  REHEARSE_C_FUNCTIONS(REHEARSE_LOOK_UP)
  return true;
}();

}  // namespace
