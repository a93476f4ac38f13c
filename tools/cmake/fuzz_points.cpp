// The callbacks of a controller that is built for fuzz tests (rehearse_add_simple_controller(NAME ... FUZZ)). They
// count the edges between blocks of its code, and keep the nearest operands of each comparison. The library contains
// them, so that it runs in every program; only fuzz tests read what they keep.
//
// gcc calls them by the address of a block (trace-pc) and reports comparisons of floating-point numbers, too; clang
// numbers the edges (trace-pc-guard) and reports comparisons of integers.
#include <cmath>
#include <cstdint>

namespace {

constexpr std::uint32_t edge_count = 1u << 12, site_count = 1u << 8;

/// A comparison of the code.
struct Site {
  std::uint32_t place;    // its address in the library, or 0: this entry is free
  std::uint32_t seen;     // bits: 1 a < b, 2 a == b, 4 a > b
  double a, b, distance;  // the nearest operands that aren't equal
};

}  // namespace

namespace {

// Zeros at first, so that they are in no page of the file: a page that is copied when it is written costs more.
std::uint8_t counts[edge_count];
Site comparisons[site_count];

}  // namespace

/// Read by fuzz tests, by its name.
struct RehearseFuzzPoints {
  std::uint32_t version, edges, sites;
  const std::uint8_t* counts;
  const void* comparisons;
};
extern "C" __attribute__((visibility("default")))
const RehearseFuzzPoints rehearse_fuzz_points = {1, edge_count, site_count, counts, comparisons};

namespace {

std::uint32_t guards = 0;
std::uint32_t before = 0;

std::uint32_t place_of(const void* address) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(address) -
                                    reinterpret_cast<std::uintptr_t>(&rehearse_fuzz_points));
}

std::uint32_t mixed(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

void count(std::uint32_t edge) {
  std::uint8_t& counter = counts[edge % edge_count];
  if (counter < 255) ++counter;
}

void compare(const void* address, double a, double b) {
  std::uint32_t place = place_of(address);
  if (place == 0) place = 1;
  for (std::uint32_t i = 0, at = mixed(place); i < 8; ++i, ++at) {
    Site& site = comparisons[at % site_count];
    if (site.place == 0) {
      site.place = place;
      site.distance = HUGE_VAL;
    }
    if (site.place != place) continue;
    if (a == b) {
      site.seen |= 2;
    } else if (a < b || a > b) {
      site.seen |= a < b ? 1 : 4;
      const double distance = a < b ? b - a : a - b;
      if (distance < site.distance) {
        site.a = a;
        site.b = b;
        site.distance = distance;
      }
    }
    return;
  }
}

}  // namespace

extern "C" {

void __sanitizer_cov_trace_pc() {
  const std::uint32_t here = mixed(place_of(__builtin_return_address(0)));
  count(here ^ before);
  before = here >> 1;
}
void __sanitizer_cov_trace_pc_guard_init(std::uint32_t* start, std::uint32_t* stop) {
  if (start == stop || *start != 0) return;
  for (std::uint32_t* guard = start; guard < stop; ++guard) *guard = ++guards;
}
void __sanitizer_cov_trace_pc_guard(std::uint32_t* guard) {
  const std::uint32_t here = mixed(*guard);
  count(here ^ before);
  before = here >> 1;
}

#define REHEARSE_COMPARISON(name, type)                                                   \
  void __sanitizer_cov_trace_##name(type a, type b) {                                     \
    compare(__builtin_return_address(0), static_cast<double>(a), static_cast<double>(b)); \
  }
REHEARSE_COMPARISON(cmp1, std::int8_t)
REHEARSE_COMPARISON(cmp2, std::int16_t)
REHEARSE_COMPARISON(cmp4, std::int32_t)
REHEARSE_COMPARISON(cmp8, std::int64_t)
REHEARSE_COMPARISON(const_cmp1, std::int8_t)
REHEARSE_COMPARISON(const_cmp2, std::int16_t)
REHEARSE_COMPARISON(const_cmp4, std::int32_t)
REHEARSE_COMPARISON(const_cmp8, std::int64_t)
REHEARSE_COMPARISON(cmpf, float)
REHEARSE_COMPARISON(cmpd, double)
#undef REHEARSE_COMPARISON
void __sanitizer_cov_trace_switch(std::uint64_t value, const std::uint64_t* cases) {
  for (std::uint64_t i = 0; i < cases[0]; ++i)
    compare(reinterpret_cast<const char*>(__builtin_return_address(0)) + i, static_cast<double>(value),
            static_cast<double>(cases[2 + i]));
}
void __sanitizer_cov_trace_pc_indir(const void*) {}
void __sanitizer_cov_trace_div4(std::uint32_t) {}
void __sanitizer_cov_trace_div8(std::uint64_t) {}
void __sanitizer_cov_trace_gep(std::uintptr_t) {}

}  // extern "C"
