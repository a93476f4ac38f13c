// The random numbers of a seed.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "watching.h"

namespace rehearse::interposer {

enum Stream {
  stream_rand,
  stream_drand48,
  stream_lrand48,
  stream_mrand48,
  stream_arc4random,
  stream_getrandom,
  stream_random_device,
  stream_device_file,
  stream_count
};

/// The next number of a stream.
uint64_t draw(uint64_t seed, Stream stream);

/// All streams begin again, and the seeds of generators are reset.
void restart_streams();

void fill(uint64_t seed, Stream stream, void* bytes, size_t count);

/// Opens the replacement of /dev/urandom: a file of a mebibyte of numbers. Returns the descriptor, or -1 and errno.
int open_random_file(uint64_t seed);

}  // namespace rehearse::interposer
