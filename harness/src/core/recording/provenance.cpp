#include "provenance.h"

#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <rehearse/pin.h>

#include <algorithm>
#include <cfloat>
#include <cstdlib>
#include <fstream>
#include <set>
#include <string_view>

#include "base/hashing.h"
#include "core/host/loaded_libraries.h"
#include "core/host/virtualised.h"
#include "core/scenario/plant_text.h"
#include "core/trace/run_facts.h"

// The build checks this with the compiler, too; here the check covers the final compilation of this file.
static_assert(FLT_EVAL_METHOD == 0 || *REHEARSE_OTHER_FLAGS, "intermediate results are rounded to their type");
#if defined(__FAST_MATH__) || defined(__FMA__) || defined(__AVX__)
static_assert(*REHEARSE_OTHER_FLAGS, "built with flags that change the bits of recordings");
#endif

namespace rehearse {
namespace {

std::string read_processor() {
  std::ifstream cpus("/proc/cpuinfo");
  for (std::string line; std::getline(cpus, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    return colon == std::string::npos ? std::string() : line.substr(colon + 2);
  }
  return "unknown";
}

const std::string& processor() {
  static const auto& known = *new std::string(read_processor());
  return known;
}

/// Empty: x86-64, which recordings don't state.
constexpr const char* other_architecture() {
#if defined(__x86_64__)
  return "";
#elif defined(__aarch64__)
  return "arm64";
#else
  return "unknown";
#endif
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "gcc " __VERSION__;
#endif
}

/// A hash over the loaded libraries whose code influences bits: Rehearse's libraries, and the libraries that they
/// compute with. OSMesa is included only if it draws, and the reader of mesh files only if there is one, because an
/// earlier run may have loaded them. Empty if a library has no build identifier.
std::string programs(bool draws, bool has_mesh_files) {
  constexpr std::string_view deciding[] = {"librehearse_harness.",
                                           "librehearse_simulation.",
                                           "librehearse_cnoid.",
                                           "librehearse_assimp.",
                                           "libode.",
                                           "libOSMesa.",
                                           "libm.",
                                           "libc.",
                                           "libstdc++."};
  std::string all;
  for (const auto& [name, id] : build_ids()) {
    const auto names_it = [&name = name](std::string_view prefix) { return name.starts_with(prefix); };
    if (std::ranges::none_of(deciding, names_it)) continue;
    if (!draws && name.starts_with("libOSMesa.")) continue;
    if (!has_mesh_files && name.starts_with("librehearse_assimp.")) continue;
    if (id.empty()) return {};
    all += name + '\0' + id + '\0';
  }
  return all.empty() ? all : hash_text(hash_bytes(all.data(), all.size()));
}

std::string environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value ? value : "";
}

/// The tunables of the processor. The user's other tunables influence no bit and aren't recorded.
std::string tunables_of_the_processor() {
  std::string all = environment("GLIBC_TUNABLES"), kept;
  for (std::size_t begin = 0; begin < all.size();) {
    const std::size_t end = std::min(all.find(':', begin), all.size());
    const std::string one = all.substr(begin, end - begin);
    if (one.starts_with("glibc.cpu.")) kept += (kept.empty() ? "" : ":") + one;
    begin = end + 1;
  }
  return kept;
}

std::string solver_fact(const SolverSettings& solver) {
  std::string fact = fmt::format("{}, {} iterations, over-relaxation {}, erp {}, cfm {}",
                                 SolverSettings::method_names[static_cast<std::size_t>(solver.method)],
                                 solver.iterations, solver.over_relaxation, solver.erp, solver.cfm);
  if (solver.sleep_after > 0.0)
    fact += fmt::format(", sleep after {} s below {} m/s", solver.sleep_after, solver.sleep_speed);
  return fact;
}

}  // namespace

mcap::StringMap provenance(const Scenario& scenario, const ControllerHost* host, const std::string& physics,
                           const std::string& renderer) {
  mcap::StringMap stated{
      {facts::trace_version, std::to_string(trace_version)},
      {facts::trace_revision, std::to_string(trace_revision)},
      {facts::rehearse, REHEARSE_VERSION},
      {facts::scenario, scenario.name},
      {facts::seed, std::to_string(scenario.seed)},
      {facts::time_step, fmt::format("{}", scenario.time_step)},
      {facts::duration, fmt::format("{}", scenario.duration)},
      {facts::solver, solver_fact(scenario.solver)},
      {facts::physics, physics},
      {facts::libc, std::string("glibc ") + gnu_get_libc_version()},
      {facts::compiler, compiler()},
      {facts::processor, processor()},
      {facts::pinned, pinned_fact()},
      {facts::pinned_mathematics, tunables_of_the_processor()},
      {facts::pinned_renderer, environment("GALLIUM_OVERRIDE_CPU_CAPS")},
  };
  if (*other_architecture()) stated[facts::architecture] = other_architecture();
  if (!renderer.empty()) stated[facts::renderer] = renderer;
  if (const std::string mark = programs(!renderer.empty(), has_mesh_files(scenario)); !mark.empty())
    stated[facts::programs] = mark;
  if (const std::string given = virtualisation(); !given.empty()) stated[facts::virtualised] = given;
  if (*REHEARSE_OTHER_FLAGS) stated[facts::build] = "other flags: " REHEARSE_OTHER_FLAGS;
  if (host) stated.merge(controller_facts(*host));
  return stated;
}

std::string other_arithmetic(const mcap::StringMap& recorded, const mcap::StringMap& here) {
  const bool unpinned = stated(here, facts::pinned_mathematics).empty();
  std::string text;
  if (const std::string then = architecture_of(recorded), now = architecture_of(here); then != now)
    text = fmt::format("{} was \"{}\" and is \"{}\"", facts::architecture, then, now);
  for (const std::string fact :
       {facts::libc, facts::compiler, facts::build, facts::pinned_mathematics, facts::processor}) {
    const std::string then = stated(recorded, fact), now = stated(here, fact);
    if (then == now || (fact == facts::processor && !unpinned)) continue;
    const bool is_pin = fact == facts::pinned_mathematics;
    const std::string before = is_pin && recorded.count(facts::pinned) ? stated(recorded, facts::pinned) : then;
    const std::string after = is_pin ? stated(here, facts::pinned) : now;
    text += fmt::format("{}{} was \"{}\" and is \"{}\"", text.empty() ? "" : ", ", is_pin ? facts::pinned : fact,
                        before, after);
  }
  return text;
}

mcap::StringMap controller_facts(const ControllerHost& host) {
  mcap::StringMap libraries;
  for (const HostedController& hosted : host.controllers())
    libraries[facts::controller_prefix + hosted.label] =
        hosted.library->file().filename().string() + " " + hosted.library->content_hash();
  return libraries;
}

std::string mesh_digests(const Model& model) {
  std::string text;
  std::set<std::string> listed;
  const auto add = [&](const std::string& digest, const std::string& file) {
    if (listed.insert(file).second) text += fmt::format("{}  {}\n", digest, file);
  };
  const auto list = [&](const std::vector<Shape>& shapes) {
    for (const Shape& shape : shapes) {
      const auto* mesh = std::get_if<Mesh>(&shape.geometry);
      if (mesh != nullptr && !mesh->heightmap && !mesh->file.empty()) add(mesh->data->digest, mesh->file);
      if (shape.texture && !shape.texture->digest.empty()) add(shape.texture->digest, shape.texture->file);
    }
  };
  for (const Link& link : model.links) {
    list(link.visuals);
    list(link.collisions);
  }
  return text;
}

}  // namespace rehearse
