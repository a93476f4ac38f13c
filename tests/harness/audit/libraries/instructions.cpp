// Instructions that a scan of a library must find, each in a separate function.
#include <cpuid.h>
#include <immintrin.h>
#include <x86intrin.h>

#include <cmath>

namespace remarkable {

unsigned long long time_stamp() { return __rdtsc(); }

__attribute__((target("rdrnd"))) unsigned drawn() {
  unsigned number = 0;
  _rdrand32_step(&number);
  return number;
}

__attribute__((target("rdseed"))) unsigned seeded() {
  unsigned number = 0;
  _rdseed32_step(&number);
  return number;
}

unsigned long long time_stamp_of_core() {
  unsigned core = 0;
  return __rdtscp(&core) + core;
}

unsigned processor() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  __get_cpuid(1, &a, &b, &c, &d);
  return a;
}

__attribute__((target("rdpid"))) unsigned core() { return _rdpid_u32(); }

long kernel_call() {
  long result = 39;  // getpid
  asm volatile("syscall" : "+a"(result) : : "rcx", "r11", "memory");
  return result;
}

__attribute__((target("fma"))) double fused(double a, double b, double c) {
  return _mm_cvtsd_f64(_mm_fmadd_sd(_mm_set_sd(a), _mm_set_sd(b), _mm_set_sd(c)));
}

float approximate(float x) { return _mm_cvtss_f32(_mm_rsqrt_ss(_mm_set_ss(x))); }

void flush_to_zero() { _mm_setcsr(_mm_getcsr() | 0x8040); }

}  // namespace remarkable
