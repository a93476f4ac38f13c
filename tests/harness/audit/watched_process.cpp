// watched_process LIBRARY FUNCTION TICKS: calls a function of a library at each tick in the same way as a controller,
// and prints the returned values with all bits.
#include <dlfcn.h>
#include <fcntl.h>

#include <cstdio>
#include <ctime>
#include <string>

#include "core/host/interposer.h"

int main(int, char** arguments) {
  using namespace rehearse;
  const std::string controller = "Rig/Watched";
  const std::filesystem::path library = arguments[1];
  open("/dev/null", O_RDONLY);  // a descriptor of the host's
  InterposerWatch watch(std::nullopt);
  double (*function)(int) = nullptr;
  {
    const Watched watched(&watch, {controller, library, "load"});
    void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle) function = reinterpret_cast<double (*)(int)>(dlsym(handle, arguments[2]));
    time(nullptr);  // the host's own calls are not recorded
  }
  if (!function) return std::printf("%s\n", dlerror()), 1;
  const int ticks = std::stoi(arguments[3]);
  for (int tick = 0; tick < ticks; ++tick) {
    double value = 0.0;
    {
      const Watched watched(&watch, {controller, library, "control", tick, 0.001 * tick});
      value = function(tick);
    }
    std::printf("%a\n", value);
    std::fflush(stdout);
  }
  return 0;
}
