// The settings of the interposer in the variable REHEARSE_INTERPOSER, in the form of harness/src/host/interposer.cpp.
#pragma once

#include <stdint.h>

namespace rehearse::interposer {

enum class Threads { as_they_come, late, early };

struct Substitution {
  int layer = 0;  // 0: everywhere; 1: at one place
  bool has_clock = false;
  int64_t date = 0;          // [ns] since 1970 at time 0
  int64_t uptime = 0;        // [ns]
  int64_t rate = 1'000'000;  // [ppm] of simulated time
  int64_t read_step = 1;     // [ns]
  bool has_seed = false;
  uint64_t seed = 0;
  int machine = 0;  // number of the imaginary machine; 0: the real one
  Threads threads = Threads::as_they_come;
  int slow = 0;  // [us]
};

struct Settings {
  char log[4096] = "";
  char files[4096] = "";  // folder of the process's copies of files; empty: none
  Substitution everywhere;
  bool has_only = false;
  char only_module[4096] = "";
  uint64_t only_offset = 0;
  Substitution there;
};

/// Reads the variable's value. An invalid value is reported on stderr and ends the process: a program of Rehearse wrote
/// it, so it is a bug.
void read_settings(const char* text, Settings& settings);

}  // namespace rehearse::interposer
