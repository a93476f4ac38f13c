// Functions that each make one call that the interposer must record. watched_process.cpp calls them as `double NAME(int
// tick)`, instead of a controller's control().
#include <signal.h>
#include <sys/random.h>
#include <sys/time.h>
#include <unistd.h>

#include <dlfcn.h>
#include <chrono>
#include <clocale>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <locale>
#include <mutex>
#include <random>
#include <string>
#include <thread>

double brought_along();

namespace {

using namespace std::chrono;

class Filter {
 public:
  [[gnu::noinline]] double update() {
    return duration<double>(steady_clock::now().time_since_epoch()).count();  // the line that is asked for
  }
};

inline long inlined_draw() { return rand(); }

}  // namespace

extern "C" {

double nothing(int tick) { return 0.5 * tick; }

double read_steady_clock(int) {
  Filter filter;
  return filter.update();
}

double read_system_clock(int) { return duration<double>(system_clock::now().time_since_epoch()).count(); }
double read_time(int) { return static_cast<double>(time(nullptr)); }
double read_gettimeofday(int) {
  timeval now{};
  gettimeofday(&now, nullptr);
  return static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_usec);
}
double read_processor_time(int) { return static_cast<double>(clock()); }
double read_twice(int) {
  timespec first{}, second{};
  clock_gettime(CLOCK_MONOTONIC, &first);
  clock_gettime(CLOCK_MONOTONIC, &second);
  return 1e-9 * static_cast<double>(second.tv_nsec - first.tv_nsec);
}
double sleep_an_hour(int) {
  const auto before = steady_clock::now();
  std::this_thread::sleep_for(hours(1));
  return duration<double>(steady_clock::now() - before).count();
}
double wait_in_vain(int) {
  std::mutex mutex;
  std::condition_variable never;
  std::unique_lock lock(mutex);
  const auto before = steady_clock::now();
  never.wait_for(lock, milliseconds(20), [] { return false; });
  return duration<double>(steady_clock::now() - before).count();
}
double spin_for_a_millisecond(int) {
  const auto end = steady_clock::now() + microseconds(100);
  double rounds = 0.0;
  while (steady_clock::now() < end) ++rounds;
  return rounds;
}

double draw_rand(int) { return rand(); }
double draw_inlined(int) { return static_cast<double>(inlined_draw()); }
double draw_seeded_rand(int tick) {
  if (tick == 0) srand(42);
  return rand();
}
double draw_seeded_drand48(int tick) {
  unsigned short seed[] = {1, 2, 3};
  if (tick == 0) seed48(seed);
  return drand48();
}
double draw_drand48(int) { return drand48(); }
double draw_random_device(int) {
  std::random_device device;
  return device();
}
double draw_getrandom(int) {
  unsigned number = 0;
  return getrandom(&number, sizeof number, 0) == sizeof number ? number : -1.0;
}
double draw_urandom(int) {
  unsigned number = 0;
  std::ifstream device("/dev/urandom", std::ios::binary);
  device.read(reinterpret_cast<char*>(&number), sizeof number);
  return device ? number : -1.0;
}
double draw_at_two_places(int) {
  const double first = rand();
  const double second = rand();
  return first + 1e-12 * second;
}

double start_a_thread(int) {
  double seen = 0.0;
  std::thread([&] { seen = static_cast<double>(time(nullptr)); }).join();
  return seen;
}

double read_a_file(int) {
  double gain = 0.0;
  std::ifstream("gains.txt") >> gain;
  return gain;
}
double count_in_a_file(int) {
  double count = 0.0;
  std::ifstream("count.txt") >> count;
  std::ofstream("count.txt") << ++count << '\n';
  return count;
}
double list_what_it_made(int) {
  namespace fs = std::filesystem;
  std::ofstream("made.txt") << "made\n";
  fs::remove("gains.txt");
  double found = 0.0;
  for (const auto& entry : fs::directory_iterator(".")) {
    if (entry.path().filename() == "made.txt") found += 1.0;
    if (entry.path().filename() == "gains.txt") found += 10.0;
    if (entry.path().filename() == "kept.txt") found += 100.0;
  }
  return found;
}
double draw_past_the_c_library(int) {
  unsigned char number = 0;
  long result = 318;  // getrandom
  asm volatile("syscall" : "+a"(result) : "D"(&number), "S"(1L), "d"(0L) : "rcx", "r11", "memory");
  return result == 1 ? number : -1.0;
}
double block_all_signals_and_draw(int tick) {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);
  return draw_past_the_c_library(tick);
}
double ask_for_processors(int) { return std::thread::hardware_concurrency(); }
double write_a_file(int tick) {
  if (FILE* file = fopen("written.txt", "w")) {
    fprintf(file, "%d\n", tick);
    fclose(file);
  }
  return 0.0;
}
double open_many_files(int tick) {
  std::ifstream(("frame" + std::to_string(tick) + ".txt").c_str());
  return 0.0;
}

double ask_for_home(int) { return getenv("HOME") ? 1.0 : 0.0; }
double ask_whether_watched(int) { return getenv("LD_PRELOAD") || getenv("REHEARSE_INTERPOSER") ? 1.0 : 0.0; }
double ask_for_the_hour(int) {
  const std::time_t fixed = 0;
  return localtime(&fixed)->tm_hour;
}
double ask_for_process(int) { return getpid(); }
double take_users_locale(int) {
  const std::locale users("");
  return users == std::locale::classic() ? 1.0 : 0.0;
}
double set_the_locale(int) { return setlocale(LC_ALL, "C") && setlocale(LC_NUMERIC, nullptr) ? 1.0 : 0.0; }
double run_a_program(int) { return system("exit 3") / 256; }
double close_the_hosts_files(int) {
  for (int file = 3; file < 100; ++file) close(file);
  return 0.0;
}
double close_an_own_file(int) {
  const int ends = dup(1);
  return close(ends);
}
double crash(int tick) {
  if (tick == 3) abort();
  return draw_rand(tick);
}
double load_a_plugin(int) { return dlopen("libwatched_plugin.so", RTLD_NOW) ? 1.0 : 0.0; }
double call_what_it_brought(int) { return brought_along(); }
}
