// Random numbers. With a seed each function draws from a separate stream, so that draws of one function don't change
// another's numbers. A controller that seeds its generator itself gets the numbers of its own seed.
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "next.h"
#include "random_stream.h"

namespace rehearse::interposer {
namespace {

enum Generator { generator_rand, generator_drand48, generator_count };

struct OwnSeed {
  bool given = false;
  uint64_t seed = 0;
};
OwnSeed own_seed[generator_count];

uint64_t draws[stream_count];  // number of draws from each stream, by any caller

/// A mixing function for 64 bits (SplitMix64's).
uint64_t mixed(uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

void set_seed(Generator generator, uint64_t seed, Stream first, Stream last) {
  own_seed[generator] = {true, seed};
  for (int stream = first; stream <= last; ++stream) __atomic_store_n(&draws[stream], 0, __ATOMIC_RELAXED);
}

uint64_t words_as_seed(const unsigned short* words, int count) {
  uint64_t seed = 0;
  for (int i = 0; i < count; ++i) seed = mixed(seed ^ words[i]);
  return seed;
}

uint64_t draw(const Substitution& substitution, Stream stream, Generator generator) {
  const OwnSeed& own = own_seed[generator];
  return draw(own.given ? own.seed : substitution.seed, stream);
}

}  // namespace

uint64_t draw(uint64_t seed, Stream stream) {
  const uint64_t number = __atomic_fetch_add(&draws[stream], 1, __ATOMIC_RELAXED);
  return mixed(mixed(mixed(seed) ^ (stream + 1)) ^ number);
}

void restart_streams() {
  for (OwnSeed& own : own_seed) own = {};
  for (uint64_t& number : draws) __atomic_store_n(&number, 0, __ATOMIC_RELAXED);
}

void fill(uint64_t seed, Stream stream, void* bytes, size_t count) {
  auto* to = static_cast<unsigned char*>(bytes);
  for (; count > 0;) {
    const uint64_t number = draw(seed, stream);
    const size_t part = count < sizeof number ? count : sizeof number;
    memcpy(to, &number, part);
    to += part;
    count -= part;
  }
}

int open_random_file(uint64_t seed) {
  constexpr size_t size = 1 << 20;
  const Busy busy;
  const int file = memfd_create("random", 0);
  if (file < 0 || ftruncate(file, size) != 0) return file;
  void* bytes = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (bytes == MAP_FAILED) return file;
  fill(seed, stream_device_file, bytes, size);
  munmap(bytes, size);
  return file;
}

// NOLINTBEGIN(bugprone-macro-parentheses): a list of arguments has its own

// A function that draws a number: it is logged, and uses a stream if there is a seed.
#define REHEARSE_DRAWN(result, name, stream, generator, value)    \
  REHEARSE_ANSWERED(has_seed, result, name, (), (), "", {         \
    const uint64_t drawn = draw(substitution, stream, generator); \
    return value;                                                 \
  })
REHEARSE_DRAWN(int, rand, stream_rand, generator_rand, static_cast<int>(drawn >> 33))
REHEARSE_DRAWN(long, random, stream_rand, generator_rand, static_cast<long>(drawn >> 33))
REHEARSE_DRAWN(double, drand48, stream_drand48, generator_drand48, static_cast<double>(drawn >> 16) * 0x1p-48)
REHEARSE_DRAWN(long, lrand48, stream_lrand48, generator_drand48, static_cast<long>(drawn >> 33))
REHEARSE_DRAWN(long, mrand48, stream_mrand48, generator_drand48, static_cast<int32_t>(drawn >> 32))
#undef REHEARSE_DRAWN

REHEARSE_ANSWERED(has_seed, uint32_t, arc4random, (), (), "",
                  return static_cast<uint32_t>(draw(substitution.seed, stream_arc4random) >> 32);)
REHEARSE_ANSWERED(has_seed, uint32_t, arc4random_uniform, (uint32_t bound), (bound), "",
                  return static_cast<uint32_t>((draw(substitution.seed, stream_arc4random) >> 32) * bound >> 32);)
REHEARSE_ANSWERED(has_seed, void, arc4random_buf, (void* to, size_t count), (to, count), "",
                  fill(substitution.seed, stream_arc4random, to, count);)
REHEARSE_ANSWERED(has_seed, ssize_t, getrandom, (void* to, size_t count, unsigned flags), (to, count, flags), "", {
  fill(substitution.seed, stream_getrandom, to, count);
  return static_cast<ssize_t>(count);
})
REHEARSE_ANSWERED(has_seed, int, getentropy, (void* to, size_t count), (to, count), "", {
  fill(substitution.seed, stream_getrandom, to, count);
  return 0;
})

// A function that seeds a generator: it is logged, and a controller's seed is kept. The last arguments are those of
// set_seed().
#define REHEARSE_SEEDED(result, name, parameters, arguments, text, ...)                              \
  REHEARSE_INTERPOSED(result, name, parameters) {                                                    \
    if (watching() && note(source_of::name, #name, text, __builtin_return_address(0)).is_controller) \
      set_seed(__VA_ARGS__);                                                                         \
    return next_##name.get() arguments;                                                              \
  }
REHEARSE_SEEDED(void, srand, (unsigned seed), (seed), Digits(seed), generator_rand, seed, stream_rand, stream_rand)
REHEARSE_SEEDED(void, srandom, (unsigned seed), (seed), Digits(seed), generator_rand, seed, stream_rand, stream_rand)
REHEARSE_SEEDED(char*, initstate, (unsigned seed, char* state, size_t size), (seed, state, size), Digits(seed),
                generator_rand, seed, stream_rand, stream_rand)
REHEARSE_SEEDED(void, srand48, (long seed), (seed), Digits(seed), generator_drand48, static_cast<uint64_t>(seed),
                stream_drand48, stream_mrand48)
REHEARSE_SEEDED(unsigned short*, seed48, (unsigned short* seed), (seed), "", generator_drand48, words_as_seed(seed, 3),
                stream_drand48, stream_mrand48)
REHEARSE_SEEDED(void, lcong48, (unsigned short* parameters), (parameters), "", generator_drand48,
                words_as_seed(parameters, 7), stream_drand48, stream_mrand48)
#undef REHEARSE_SEEDED
// NOLINTEND(bugprone-macro-parentheses)

// std::random_device. It reads its source (the processor, by default) inside of libstdc++, so its own functions are
// replaced: the constructor with its token, and the drawing of a number.
namespace {

/// libstdc++'s std::string: it begins with a pointer to its text, which ends with a zero.
struct StringHead {
  const char* text;
};

}  // namespace

#define REHEARSE_MEMBER(result, name, mangled, parameters)                                                \
  static Next<result parameters> next_##name{mangled};                                                    \
  extern "C" __attribute__((visibility("default"))) result interposed_##name parameters __asm__(mangled); \
  extern "C" result interposed_##name parameters

REHEARSE_MEMBER(void, random_device_init,
                "_ZNSt13random_device7_M_initERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE",
                (void* self, const StringHead* token)) {
  if (watching()) note(Source::random, "std::random_device", token->text, __builtin_return_address(0));
  const Busy busy;  // it may open a file, but its use was logged already
  next_random_device_init.get()(self, token);
}

REHEARSE_MEMBER(unsigned, random_device_getval, "_ZNSt13random_device9_M_getvalEv", (void* self)) {
  if (!watching()) return next_random_device_getval.get()(self);
  const Caller caller = note(Source::random, "std::random_device::operator()", "", __builtin_return_address(0));
  const Substitution& substitution = substitution_for(caller);
  if (substitution.has_seed) return static_cast<unsigned>(draw(substitution.seed, stream_random_device) >> 32);
  const Busy busy;
  return next_random_device_getval.get()(self);
}

}  // namespace rehearse::interposer
