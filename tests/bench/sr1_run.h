// SR1 under its minimum controller, recorded once for all benchmarks, and the same run without recording.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/world.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <vector>

namespace rehearse {

/// The recording of ten simulated seconds that the benchmarks use, in a temporary folder; removed when the process
/// ends.
class Sr1Run {
 public:
  static const Sr1Run& instance();
  ~Sr1Run();

  const Scenario& scenario() const { return scenario_; }  // no camera runs
  const std::filesystem::path& folder() const { return folder_; }
  const std::filesystem::path& trace() const { return trace_; }
  std::int64_t ticks() const { return scenario_.ticks(); }
  /// The commands to the world in each tick.
  const std::vector<Command>& commands() const { return commands_; }

  /// The scenario's bodies: a floor and SR1.
  std::vector<WorldBody> bodies() const;
  /// A new world of these bodies, with the scenario's solver.
  std::unique_ptr<World> make_world() const { return make_world(scenario_.solver, bodies()); }
  std::unique_ptr<World> make_world(const SolverSettings& solver, std::vector<WorldBody> bodies) const;

 private:
  Sr1Run();
  std::filesystem::path folder_, trace_;
  Scenario scenario_;
  std::vector<Command> commands_;
};

/// Ends the process with the diagnostics if there are any.
template <class T>
T must(Result<T> result) {
  if (result) return std::move(result).value();
  std::fputs(to_string(result.errors()).c_str(), stderr);
  std::exit(1);
}

}  // namespace rehearse
