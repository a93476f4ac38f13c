#include "virtualised.h"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

#include "core/guard/child_process.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

constexpr const char* variable = "REHEARSE_VIRTUALISED";
constexpr std::string_view words_before_seed = "clock, random; seed ";

/// The arguments that this process was started with.
std::vector<std::string> own_arguments() {
  std::ifstream stream("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> arguments;
  for (std::string argument; std::getline(stream, argument, '\0');) arguments.push_back(argument);
  return arguments;
}

}  // namespace

Substitution virtualised(std::uint64_t seed) {
  Substitution substitution;
  substitution.clock = SimulatedClock{};
  substitution.seed = seed;
  return substitution;
}

std::map<std::string, std::optional<std::string>> virtualised_environment(std::uint64_t seed) {
  return {{variable, fmt::format("{}{}", words_before_seed, seed)}};
}

std::string virtualisation() {
  const char* given = std::getenv(variable);
  return given && is_interposed() ? given : "";
}

std::optional<std::uint64_t> virtualised_seed(const mcap::Reader& trace) {
  const std::string fact = RunFacts::of(trace).stated(facts::virtualised);
  if (!fact.starts_with(words_before_seed)) return std::nullopt;
  std::uint64_t seed = 0;
  const std::string_view text = std::string_view(fact).substr(words_before_seed.size());
  const bool is_number = std::from_chars(text.data(), text.data() + text.size(), seed).ec == std::errc();
  return is_number ? std::optional(seed) : std::nullopt;
}

Result<void> virtualise_process_like(const std::filesystem::path& trace) {
  const auto reader = mcap::Reader::open(trace);
  if (!reader) return {};  // the reader of the trace reports it
  const auto seed = virtualised_seed(**reader);
  if (!seed || !virtualisation().empty()) return {};
  const auto interposed = REHEARSE_TRY(interposer_environment({{}, {}, virtualised(*seed), {}, {}}));
  EnvironmentChanges changes = virtualised_environment(*seed);
  changes.insert(interposed.begin(), interposed.end());
  replace_process("/proc/self/exe", pointers_to(own_arguments()).data(), changes);
  return error(
      fmt::format("{} was recorded with simulated time and seeded random numbers, and this process can't start "
                  "itself again with them: {}",
                  trace.string(), std::strerror(errno)));
}

}  // namespace rehearse
