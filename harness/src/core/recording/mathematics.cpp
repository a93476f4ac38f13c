#include "mathematics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/utsname.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "core/host/loaded_libraries.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

std::string architecture_here() {
  utsname machine{};
  return ::uname(&machine) == 0 ? machine.machine : "";
}

/// In hexadecimal digits; empty: there is none.
std::string build_id_of_libm() {
  std::string digits;
  for (const auto& [name, id] : build_ids())
    if (name.starts_with("libm.") || name.starts_with("libm-"))
      for (const char byte : id) digits += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  return digits;
}

}  // namespace

std::string mathematics_of_processor() {
  std::ifstream lines("/proc/cpuinfo");
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("flags") && !line.starts_with("Features")) continue;
    std::istringstream words(line.substr(std::min(line.find(':') + 1, line.size())));
    std::set<std::string> kept;
    for (std::string word; words >> word;)
      if (word == "fma" || word == "fma4" || word == "avx" || word == "avx2" || word == "asimd") kept.insert(word);
    return fmt::format("{}", fmt::join(kept, " "));
  }
  return {};
}

std::string other_mathematics(const mcap::StringMap& flight) {
  const auto named = [](const std::string& value) { return value.empty() ? std::string("none") : value; };
  const char* const tunables = std::getenv("GLIBC_TUNABLES");
  const struct {
    const char *fact, *what;
    std::string here;
  } facts[] = {{flight_facts::architecture, "the loop's machine was", architecture_here()},
               {flight_facts::mathematics, "the loop's processor has", mathematics_of_processor()},
               {flight_facts::tunables, "the loop's GLIBC_TUNABLES were", tunables ? tunables : ""}};
  for (const auto& [fact, what, here] : facts)
    if (const std::string then = stated(flight, fact); then != here)
      return fmt::format("{} {}, and here {}", what, named(then), named(here));
  // A loop without the shared libm has its functions in itself.
  if (const std::string then = stated(flight, flight_facts::libm); then != build_id_of_libm())
    return fmt::format("the loop's libm has the build id {}, and the one here {}", named(then),
                       named(build_id_of_libm()));
  return {};
}

}  // namespace rehearse
