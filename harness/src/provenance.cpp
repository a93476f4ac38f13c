#include "provenance.h"

#include <fmt/format.h>
#include <gnu/libc-version.h>

#include <cstdlib>
#include <fstream>

#include "trace_version.h"

namespace rehearse {
namespace {

std::string processor() {
  std::ifstream cpus("/proc/cpuinfo");
  for (std::string line; std::getline(cpus, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    return colon == std::string::npos ? std::string() : line.substr(colon + 2);
  }
  return "unknown";
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "gcc " __VERSION__;
#endif
}

std::string environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value ? value : "";
}

}  // namespace

mcap::StringMap provenance(const Scenario& scenario, const ControllerHost* host, const std::string& physics,
                           const std::string& renderer) {
  const SolverSettings& solver = scenario.solver;
  mcap::StringMap facts{
      {"trace_version", std::to_string(trace_version)},
      {"trace_revision", std::to_string(trace_revision)},
      {"rehearse", REHEARSE_VERSION},
      {"scenario", scenario.name},
      {"seed", std::to_string(scenario.seed)},
      {"time_step", fmt::format("{}", scenario.time_step)},
      {"duration", fmt::format("{}", scenario.duration)},
      {"solver", fmt::format("{}, {} iterations, over-relaxation {}, erp {}, cfm {}",
                             solver.method == SolverSettings::Method::quick ? "quick" : "exact", solver.iterations,
                             solver.over_relaxation, solver.erp, solver.cfm)},
      {"physics", physics},
      {"libc", std::string("glibc ") + gnu_get_libc_version()},
      {"compiler", compiler()},
      {"processor", processor()},
      {"pinned.GLIBC_TUNABLES", environment("GLIBC_TUNABLES")},
      {"pinned.GALLIUM_OVERRIDE_CPU_CAPS", environment("GALLIUM_OVERRIDE_CPU_CAPS")},
  };
  if (!renderer.empty()) facts["renderer"] = renderer;
  if (host) facts.merge(controller_facts(*host));
  return facts;
}

mcap::StringMap controller_facts(const ControllerHost& host) {
  mcap::StringMap facts;
  for (const HostedController& hosted : host.controllers())
    facts["controller." + hosted.label] =
        hosted.library->file().filename().string() + " " + hosted.library->content_hash();
  return facts;
}

}  // namespace rehearse
