#include <fmt/format.h>
#include <rehearse/pin.h>
#include <rehearse/renderer.h>
#include <rehearse/session.h>
#include <rehearse/world.h>

#include <cstring>
#include <set>
#include <string_view>
#include <utility>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

#include "base/hashing.h"
#include "core/host/loaded_libraries.h"
#include "core/host/virtualised.h"
#include "core/recording/code_hashes.h"
#include "core/recording/provenance.h"
#include "core/recording/recorder.h"
#include "core/scenario/plant_text.h"
#include "core/trace/run_facts.h"
#include "mesh/assimp_library.h"

extern char** environ;

namespace rehearse {
namespace {

std::string hash_of(const std::string& text) { return hash_text(hash_bytes(text.data(), text.size())); }

/// The facts of libraries: the hashes of their code.
Result<mcap::StringMap> facts_of(std::map<std::string, LoadedLibrary> libraries) {
  // it has no file: the kernel provides it
  std::erase_if(libraries, [](const auto& entry) { return entry.second.file == "linux-vdso.so.1"; });
  const auto hashes = REHEARSE_TRY(code_hashes_of(libraries));
  mcap::StringMap facts;
  for (const auto& [name, hash] : hashes)
    facts.emplace(name.empty() ? "the program " + own_program().filename().string() : "the library " + name, hash);
  return facts;
}

/// The facts of the libraries with which the program began. Controllers are loaded later, and no other code uses their
/// symbols. One that came later with the same name is later in the linker's list, and doesn't count.
Result<mcap::StringMap> facts_of_start() {
  auto libraries = loaded_libraries();
  std::erase_if(libraries, [](const auto& entry) { return !libraries_at_start().contains(entry.first); });
  return facts_of(std::move(libraries));
}

/// The facts of a library and of those that it needs, which are loaded here and stay loaded.
Result<mcap::StringMap> facts_of_library(const std::string& name) {
  auto libraries = load_library(name);
  return libraries ? facts_of(*std::move(libraries)) : Result<mcap::StringMap>(libraries.errors());
}

/// Adds the program and all libraries, by the hashes of their code: any of them may replace functions of others. If a
/// model has a mesh file, the libraries that read it are among them, and if a camera runs, those of the renderer. A
/// loaded file stays what it is, so each is looked at once.
Result<void> add_libraries(const Scenario& scenario, mcap::StringMap& plant) {
  static const auto& at_start = *new auto(facts_of_start());
  if (!at_start) return at_start.errors();
  plant.insert(at_start->begin(), at_start->end());
  if (has_mesh_files(scenario)) {
    static const auto& reader = *new auto(facts_of_library(assimp_library().string()));
    if (!reader) return reader.errors();
    plant.insert(reader->begin(), reader->end());
  }
  if (!scenario.runs_a_camera()) return {};
  static const auto& renderer = *new auto(facts_of_library(Renderer::library));
  if (!renderer) return renderer.errors();
  plant.insert(renderer->begin(), renderer->end());
  return {};
}

/// The vendor of the processor, and whether a program emulates it. Read by CPUID, which an emulator answers itself.
Result<std::string> read_processor() {
#if defined(__x86_64__)
  unsigned a = 0, registers[3] = {};
  char vendor[13] = {}, hypervisor[13] = {}, brand[49] = {};
  __cpuid(0, a, registers[0], registers[2], registers[1]);  // the order of the name's letters
  std::memcpy(vendor, registers, 12);
  unsigned b = 0, c = 0, d = 0;
  __cpuid(1, a, b, c, d);
  if (c & (1U << 31)) {  // there is a hypervisor
    __cpuid(0x40000000, a, registers[0], registers[1], registers[2]);
    std::memcpy(hypervisor, registers, 12);
  }
  __cpuid(0x80000000, a, b, c, d);
  for (unsigned leaf = 0; a >= 0x80000004 && leaf < 3; ++leaf) {
    unsigned words[4] = {};
    __cpuid(0x80000002 + leaf, words[0], words[1], words[2], words[3]);
    std::memcpy(brand + 16 * leaf, words, 16);
  }
  const bool emulated = std::strcmp(hypervisor, "TCGTCGTCGTCG") == 0 || std::strstr(brand, "QEMU") != nullptr ||
                        std::strstr(brand, "Virtual") != nullptr;
  return emulated ? fmt::format("{}, emulated: {} {}", vendor, brand, hypervisor) : vendor;
#else
  return error("only processors of x86-64 state their vendor and whether they are emulated");
#endif
}

/// The variables of the environment that Mesa and its compiler read.
std::string environment_of_renderer() {
  std::set<std::string> found;
  for (char** entry = environ; *entry; ++entry)
    for (const std::string_view prefix : {"MESA", "GALLIUM", "LP_", "LIBGL", "DRAW_", "ST_", "TGSI_", "NIR_", "LLVM",
                                          "OSMESA", "SOFTPIPE", "GALLIVM", "LVP_", "UTIL_"})
      if (std::string_view(*entry).starts_with(prefix)) found.insert(*entry);
  return fmt::format("{}", fmt::join(found, " "));
}

Result<void> add_scenario(const Scenario& scenario, mcap::StringMap& plant) {
  const auto text = REHEARSE_TRY(plant_text(scenario));
  plant["the scenario"] = hash_of(
      fmt::format("{}{} {} {} {}", text, scenario.duration, scenario.time_step, scenario.seed, scenario.record_frames));
  for (const SourceFile& source : sources_of(scenario))
    if (source.name != "scenario.yaml") plant[source.name] = hash_of(source.text);
  return {};
}

}  // namespace

Result<mcap::StringMap> describe_plant(const Scenario& scenario) {
  mcap::StringMap plant;
  const mcap::StringMap here = provenance(scenario, nullptr, World::engine_description(), "");
  if (!is_pinned()) return error(fmt::format("the process isn't pinned: {}", pinned_fact()));
  if (!virtualisation().empty()) return error("the controllers have simulated time and seeded random numbers");
  for (const char* fact : {facts::compiler, facts::build, facts::physics, facts::pinned_mathematics, facts::solver})
    if (const std::string value = stated(here, fact); !value.empty()) plant[fact] = value;
  static const auto& processor = *new auto(read_processor());  // a virtual machine takes 30 µs for it
  if (!processor) return processor.errors();
  plant["the processor"] = *processor;
  plant["the renderer's environment"] = environment_of_renderer();
  REHEARSE_TRY(add_libraries(scenario, plant));
  REHEARSE_TRY(add_scenario(scenario, plant));
  return plant;
}

}  // namespace rehearse
