#include "proof.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <utility>
#include <vector>

#include "base/hashing.h"
#include "base/names.h"
#include "base/text.h"
#include "base/user_cache.h"
#include "core/golden/golden_files.h"
#include "core/golden/state_samples.h"
#include "core/replay/plant_level.h"
#include "core/scenario/plant_text.h"
#include "core/trace/run_facts.h"
#include "core/turns/scheduler.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

std::string text_of(const mcap::StringMap& plant) {
  std::string text;
  for (const auto& [name, value] : plant) text += fmt::format("{}: {}\n", name, value);
  return text;
}

std::set<std::string> lines_of(const std::string& text) {
  std::set<std::string> lines;
  for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1)
    lines.insert(text.substr(begin, end - begin));
  return lines;
}

/// The names of the facts that only one of the plants has, or whose values differ.
std::vector<std::string> changed_facts(const std::string& before, const std::string& now) {
  const std::set<std::string> left = lines_of(before), right = lines_of(now);
  std::vector<std::string> lines;
  std::set_symmetric_difference(left.begin(), left.end(), right.begin(), right.end(), std::back_inserter(lines));
  std::vector<std::string> names;
  for (const std::string& line : lines) names.push_back(line.substr(0, line.find(": ")));
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

/// "the program hold_test", if another program simulated the golden, and nothing changed but the program and the
/// libraries that it loads; else empty. `changed`: names of facts; `now`: the present plant.
std::string other_program(const std::vector<std::string>& changed, const std::string& now) {
  std::string other;
  for (const std::string& name : changed) {
    const bool is_program = name.starts_with("the program ");
    if (!is_program && !name.starts_with("the library ")) return {};
    const bool is_present = now.starts_with(name + ": ") || now.find("\n" + name + ": ") != std::string::npos;
    if (is_program && !is_present) other = name;
  }
  return other;
}

/// The reason why the facts of the golden allow no proof; empty: they allow it.
std::string objection_to_golden(const Trace& golden) {
  const RunFacts run = RunFacts::of(golden);
  if (!run.time_step || run.provenances != 1 || run.is_of_log || run.branch)
    return "the golden is no recording of one whole simulation";
  if (!run.outcome || !run.outcome->complete || run.outcome->failure) return "the golden isn't complete";
  if (!run.stated(facts::virtualised).empty()) return "the golden's controllers had simulated time";
  return "";
}

/// Calls `visit` with each controller of the scenario and its name: "BODY/NAME".
template <class Visit>
void visit_controllers(const Scenario& scenario, const Visit& visit) {
  for (const ScenarioBody& body : scenario.bodies)
    for (const ScenarioController& controller : body.controllers) {
      visit(body.name + "/" + controller.name, controller);
      for (const ScenarioController& child : controller.children) visit(body.name + "/" + child.name, child);
    }
}

/// The reason why the threads of the controllers allow no proof; empty: they allow it.
std::string objection_to_threads(const Scenario& scenario) {
  std::string objection;
  visit_controllers(scenario, [&](const std::string& name, const ScenarioController& controller) {
    if (controller.threads.are_free && objection.empty())
      objection = fmt::format("the threads of {} are free, so its commands may differ in each run", name);
  });
  return objection;
}

/// Facts about threads on which the commands depend, a line each.
std::string turns_of(const Scenario& scenario) {
  std::string text = fmt::format("the rules of turns: {}\n", rules_of_turns);
  visit_controllers(scenario, [&](const std::string& name, const ScenarioController& controller) {
    for (const auto& [thread, delay] : controller.threads.delays)
      text += fmt::format("the delay of {} of {}: {} s\n", thread, name, delay);
  });
  return text;
}

/// The reason why the samples of the golden's state aren't enough; empty: they are, or the golden contains the state of
/// all ticks.
std::string objection_to_samples(const Scenario& scenario, const Trace& golden) {
  const auto kept = RunFacts::of(golden).state_rate;
  if (!kept) return "";
  const auto whole = Trace::load_in_pieces(golden.file(), [](const Trace&) {});
  if (!whole) return whole.errors()[0].message;
  const auto asked = state_rate_of(scenario, *whole);
  if (asked && kept->includes(*asked)) return "";
  return "the golden keeps other samples of the state than the scenario asks for";
}

}  // namespace

fs::path Certificates::file_for(const std::string& facts) const {
  return folder_ / (subject_ + "-" + hash_text(hash_bytes(facts.data(), facts.size())));
}

bool Certificates::has(const std::string& facts) const {
  const auto text = read_from_cache(file_for(facts));
  return text && *text == facts;
}

Result<void> Certificates::add(const std::string& facts) const {
  const fs::path file = file_for(facts);
  REHEARSE_TRY(make_folder_of(file));
  const fs::path whole = fs::path(file).concat(fmt::format(".{}", getpid()));
  std::ofstream stream(whole, std::ios::binary);
  stream << facts;
  stream.close();
  std::error_code failed;
  fs::rename(whole, file, failed);
  if (stream && !failed) return {};
  fs::remove(whole, failed);
  if (fs::is_directory(file, failed)) return {};  // it was named when it was read
  return error(fmt::format("{} can't be written", file.string()));
}

std::vector<std::string> Certificates::all() const {
  std::vector<std::string> facts;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, failed))
    if (entry.path().filename().string().starts_with(subject_ + "-"))
      if (auto text = read_from_cache(entry.path())) facts.push_back(*std::move(text));
  return facts;
}

Proof::Proof(const Scenario& scenario, const Trace& golden, const CheckOptions& options, const Simulation& simulation) {
  const bool is_wanted = options.certificates && simulation.describe_plant && !options.run.nudge;
  if (!is_wanted || (!options.plant && !options.closed)) return;
  objection_ = objection_to(scenario, golden, options, simulation);
  holds_ = objection_.empty();
}

std::string Proof::objection_to(const Scenario& scenario, const Trace& golden, const CheckOptions& options,
                                const Simulation& simulation) {
  if (std::string objection = objection_to_golden(golden); !objection.empty()) return objection;
  if (always_simulates(scenario)) return "the scenario asks for it";
  if (scenario.counts_costs || options.run.counts_costs) return "the costs of control() are counted";
  if (std::string objection = objection_to_samples(scenario, golden); !objection.empty()) return objection;
  if (options.run.watch) return "the controllers are watched";
  if (std::string objection = objection_to_threads(scenario); !objection.empty()) return objection;
  const auto plant = simulation.describe_plant(scenario);
  if (!plant) return plant.errors()[0].message;
  const auto hash = hash_of_file(golden_file_ = golden.file());
  if (!hash) return hash.errors()[0].message;
  golden_ = *hash;
  certificates_.emplace(*options.certificates, hash_text(golden_));
  plant_ = text_of(*plant) + turns_of(scenario);
  return certificates_->has(plant_) ? "" : changes();
}

/// The changes since a check simulated the golden, as a sentence. Of several certified plants, the one with the fewest
/// changes counts.
std::string Proof::changes() const {
  std::optional<std::vector<std::string>> fewest;
  for (const std::string& certified : certificates_->all()) {
    std::vector<std::string> names = changed_facts(certified, plant_);
    if (!fewest || names.size() < fewest->size() || (names.size() == fewest->size() && names < *fewest))
      fewest = std::move(names);
  }
  if (!fewest) return "no check has simulated this golden here before";
  constexpr std::size_t most = 4;
  if (const std::string other = other_program(*fewest, plant_); !other.empty())
    return other + " simulated its golden, and this program has not";
  return listed(*fewest, most) + " changed since its golden was simulated";
}

Result<void> Proof::certify() const {
  if (plant_.empty() || holds_) return {};
  const auto hash = hash_of_file(golden_file_);
  if (!hash || *hash != golden_) return {};  // a new golden was accepted during the simulation
  return certificates_->add(plant_);
}

Result<ProofMode> proof_mode() {
  const char* set = std::getenv("REHEARSE_PROOF");
  const std::string_view word = set ? set : "";
  ProofMode mode;
  if (word.empty() || word == "on") return mode;
  if (word == "off") return mode.on = false, mode;
  constexpr std::string_view sample = "sample:";
  if (word.starts_with(sample)) {
    const auto percent = number_in<int>(word.substr(sample.size()));
    if (percent && *percent >= 0 && *percent <= 100) return mode.sampled = *percent, mode;
  }
  return error(fmt::format("REHEARSE_PROOF is '{}'", word),
               "expected on, off, or sample:20, which simulates 20 % of the checks although they are proved");
}

Result<bool> is_sampled(const std::string& name, int percent) {
  const auto day = REHEARSE_TRY(date_of_today());
  const std::string text = day + " " + name;
  return static_cast<int>(hash_bytes(text.data(), text.size()) % 100) < percent;
}

}  // namespace rehearse
