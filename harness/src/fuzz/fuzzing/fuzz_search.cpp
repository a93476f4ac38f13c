// The search of a fuzz test.
#include <fmt/format.h>
#include <rehearse/fuzz.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "base/hashing.h"
#include "core/golden/golden_files.h"
#include "core/host/controller_host.h"
#include "corpus.h"
#include "fuzz_mistake.h"
#include "fuzz_setup.h"
#include "input_workers.h"
#include "inputs_file.h"
#include "mutation.h"
#include "seeds.h"
#include "shrinking.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr std::int64_t runs_of_round = 16;  // chosen from what the rounds before it reached
constexpr std::int64_t runs_between_saves = 4096;
constexpr int most_hung = 8;  // each takes the whole limit of a call

struct Found {
  Inputs inputs;
  InputOutcome outcome;
  std::int64_t run = 0;
};

/// How many inputs aren't constantly at their start.
int moved_inputs(const Inputs& inputs, const std::vector<InputColumn>& columns) {
  std::set<std::size_t> moved;
  for (const InputChange& change : changes_of(inputs, columns)) moved.insert(change.column);
  return static_cast<int>(moved.size());
}

class Search {
 public:
  Search(const FuzzPlan& plan, const FuzzOptions& options)
      : options_(options),
        setup_(checked(set_up(plan))),
        seeds_(checked(seeds_of(setup_))),
        mutator_(setup_.columns, setup_.plan.ticks),
        workers_(checked(InputWorkers::create(setup_, static_cast<std::size_t>(std::max(1, options.jobs))))) {}

  FuzzResult go();

 private:
  std::string identity() const;
  void resume();
  void save() const;
  bool goes_on() const;
  void make_round();
  Inputs next_inputs(std::int64_t run) const;
  void take_finding(const Inputs& inputs, const InputOutcome& outcome, std::int64_t run);
  void repeat(const std::vector<Found>& kept);
  FuzzFinding finding_of(const Found& found);
  void write_files(const Found& shrunk, FuzzFinding& finding);

  const FuzzOptions& options_;
  const FuzzSetup setup_;
  const std::vector<Inputs> seeds_;
  const Mutator mutator_;
  std::unique_ptr<InputWorkers> workers_;
  Corpus corpus_;
  std::vector<Found> found_;
  std::int64_t run_ = 0, resumed_from_ = 0;
  int hung_ = 0;
  const Clock::time_point began_ = Clock::now();
};

/// What a state must have in common with a search that goes on with it.
std::string Search::identity() const {
  const ScenarioController& controller = setup_.scenario.bodies[0].controllers[0];
  const auto library =
      library_of(setup_.scenario, controller, setup_.scenario.bodies[0].name + "/" + controller.name, {});
  std::string all =
      scenario_text(setup_.plan, setup_.body(), setup_.plan.ticks) + (library ? content_hash_of(*library) : "");
  all += fmt::format(" {} {} {}", options_.seed, options_.guided, setup_.plan.seeds);
  for (const InputColumn& column : setup_.columns)
    all += fmt::format(" {} {} {} {}", column.name, column.low, column.high, column.start);
  return hash_text(hash_bytes(all.data(), all.size()));
}

/// Makes the corpus of the state again, by the runs of its inputs.
void Search::resume() {
  std::error_code ignored;
  if (options_.state.empty() || !fs::exists(options_.state, ignored)) return;
  const Json state = Json::parse(checked(read_text(options_.state)), nullptr, false);
  if (!state.is_object() || state.value("version", 0) != 1)
    throw FuzzMistake({error_in(options_.state, "this is no state of a search", "remove it")});
  if (state.value("search", "") != identity()) return;  // of another controller or test: it begins anew
  std::vector<Inputs> kept;
  std::vector<std::int64_t> runs;
  const std::size_t columns = setup_.columns.size();
  const auto inputs_in = [&](const Json& entry) {
    return Inputs{columns, entry.at("values").get<std::vector<double>>()};
  };
  for (const Json& entry : state.at("kept")) {
    kept.push_back(inputs_in(entry));
    runs.push_back(entry.at("run").get<std::int64_t>());
  }
  const auto outcomes = checked(workers_->run(kept));
  for (std::size_t i = 0; i < kept.size(); ++i) corpus_.take(kept[i], runs[i], outcomes[i]);
  std::vector<Inputs> failing;
  for (const Json& entry : state.at("found")) failing.push_back(inputs_in(entry));
  const auto failures = checked(workers_->run(failing));
  for (std::size_t i = 0; i < failing.size(); ++i) {
    InputOutcome outcome = failures[i];
    if (outcome.passed()) {  // it was found by a repetition
      outcome.end = InputEnd::not_repeated;
      outcome.sentence = outcome.reason = "other commands in a second run of the same inputs";
    }
    found_.push_back({failing[i], outcome, state.at("found")[i].at("run").get<std::int64_t>()});
  }
  hung_ = state.value("hung", 0);
  run_ = resumed_from_ = state.at("runs").get<std::int64_t>();
}

void Search::save() const {
  if (options_.state.empty()) return;
  Json state{{"version", 1}, {"search", identity()}, {"runs", run_}, {"hung", hung_}};
  state["kept"] = state["found"] = Json::array();
  for (std::size_t i = 0; i < corpus_.size(); ++i)
    state["kept"].push_back({{"run", corpus_.run_of(i)}, {"values", corpus_.inputs(i).values}});
  for (const Found& one : found_) state["found"].push_back({{"run", one.run}, {"values", one.inputs.values}});
  std::error_code ignored;
  fs::create_directories(fs::path(options_.state).parent_path(), ignored);
  checked(replace_text(options_.state, state.dump()));
}

bool Search::goes_on() const {
  if (static_cast<int>(found_.size()) >= options_.most_findings || hung_ >= most_hung) return false;
  if (options_.seconds > 0.0) return std::chrono::duration<double>(Clock::now() - began_).count() < options_.seconds;
  return run_ < options_.runs;
}

Inputs Search::next_inputs(std::int64_t run) const {
  if (run == 0) return inputs_at_start(setup_.columns, setup_.plan.ticks);
  if (static_cast<std::size_t>(run) <= seeds_.size()) return seeds_[static_cast<std::size_t>(run) - 1];
  Dice dice(options_.seed, run);
  if (!options_.guided || corpus_.empty() || dice.happens(0.1)) return mutator_.fresh(dice);
  const Corpus::Choice choice = corpus_.choose(dice);
  const Inputs& other = corpus_.inputs(dice.below(corpus_.size()));
  return mutator_.mutated(corpus_.inputs(choice.entry), other, choice.hints, choice.is_aimed, choice.columns, dice);
}

void Search::take_finding(const Inputs& inputs, const InputOutcome& outcome, std::int64_t run) {
  if (outcome.end == InputEnd::hung) ++hung_;
  const auto is_known = [&](const Found& known) { return known.outcome.is_like(outcome); };
  if (std::ranges::any_of(found_, is_known) || static_cast<int>(found_.size()) >= options_.most_findings) return;
  found_.push_back({inputs, outcome, run});
}

/// Runs the inputs that were kept a second time, with other contents of fresh memory.
void Search::repeat(const std::vector<Found>& kept) {
  std::vector<Inputs> again;
  for (const Found& one : kept) again.push_back(one.inputs);
  const auto outcomes = checked(workers_->run(again, MemoryFill::zeros));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (outcomes[i].passed() && outcomes[i].hash == kept[i].outcome.hash) continue;
    InputOutcome other = outcomes[i];
    other.end = InputEnd::not_repeated;
    other.sentence = "other commands in a second run of the same inputs, with zeros in fresh memory";
    other.reason = "other commands in a second run of the same inputs";
    other.tick = std::max<std::int64_t>(0, other.tick);
    take_finding(kept[i].inputs, other, kept[i].run);
  }
}

void Search::make_round() {
  std::vector<Inputs> round;
  for (std::int64_t i = 0; i < runs_of_round; ++i) round.push_back(next_inputs(run_ + i));
  const auto outcomes = checked(workers_->run(round));
  std::vector<Found> kept;
  for (std::size_t i = 0; i < round.size(); ++i) {
    const std::int64_t run = run_ + static_cast<std::int64_t>(i);
    if (outcomes[i].end == InputEnd::unable) throw FuzzMistake({error(outcomes[i].sentence)});
    if (!outcomes[i].passed())
      take_finding(round[i], outcomes[i], run);
    else if (corpus_.take(round[i], run, outcomes[i]))
      kept.push_back({round[i], outcomes[i], run});
  }
  run_ += runs_of_round;
  repeat(kept);
}

/// Writes NAME.inputs and NAME.mcap.
void Search::write_files(const Found& shrunk, FuzzFinding& finding) {
  const std::string inputs = text_of_inputs(setup_, shrunk.inputs, {});
  const std::string key = hash_text(hash_bytes(inputs.data(), inputs.size())).substr(0, 8);
  const std::string name = fmt::format("{}-{}", setup_.plan.name, key);
  std::vector<std::string> comments{
      fmt::format("{}: {}", finding.kind, finding.sentence.substr(0, finding.sentence.find('\n')))};
  const fs::path file = fs::path(options_.folder) / (name + ".inputs"),
                 recording = fs::path(file).replace_extension(".mcap");
  if (!options_.folder.empty())
    comments.push_back(fmt::format("tick by tick: rehearse step {}",
                                   (fs::path(options_.folder).filename() / recording.filename()).string()));
  finding.text = text_of_inputs(setup_, shrunk.inputs, comments);
  if (options_.folder.empty()) return;
  std::error_code failed;
  fs::create_directories(options_.folder, failed);
  checked(replace_text(file, finding.text));
  finding.file = file.string();
  const InputOutcome recorded = checked(workers_->record(shrunk.inputs, recording));
  finding.repeats = finding.repeats && recorded.hash == shrunk.outcome.hash;
  if (recorded.end != InputEnd::took_memory && fs::exists(recording, failed)) finding.recording = recording.string();
}

FuzzFinding Search::finding_of(const Found& found) {
  FuzzFinding finding;
  finding.run = found.run;
  finding.ticks_before = found.inputs.ticks();
  finding.inputs_before = moved_inputs(found.inputs, setup_.columns);
  finding.changes_before = static_cast<int>(changes_of(found.inputs, setup_.columns).size());
  Found shrunk = found;
  // a hung run takes its limit, and what differs from run to run has no smallest form
  const InputEnd end = found.outcome.end;
  if (options_.shrinks && end != InputEnd::hung && end != InputEnd::not_repeated && end != InputEnd::took_memory) {
    ShrunkInputs made = checked(shrink_inputs(*workers_, setup_, found.inputs, found.outcome));
    shrunk.inputs = std::move(made.inputs);
    shrunk.outcome = std::move(made.outcome);
  }
  finding.kind = to_string(end);
  finding.sentence = shrunk.outcome.sentence;
  finding.tick = shrunk.outcome.tick;
  finding.ticks = shrunk.inputs.ticks();
  finding.inputs = moved_inputs(shrunk.inputs, setup_.columns);
  finding.changes = static_cast<int>(changes_of(shrunk.inputs, setup_.columns).size());
  const auto again = checked(workers_->run({shrunk.inputs}));
  finding.repeats = again[0].is_like(shrunk.outcome) && again[0].hash == shrunk.outcome.hash;
  if (options_.shrinks) write_files(shrunk, finding);
  return finding;
}

FuzzResult Search::go() {
  resume();
  while (goes_on()) {
    make_round();
    if (run_ % runs_between_saves == 0) save();
  }
  save();
  FuzzResult result;
  result.runs = run_;
  result.resumed_from = resumed_from_;
  result.kept = static_cast<std::int64_t>(corpus_.size());
  result.points = corpus_.points();
  for (const Found& found : found_) result.findings.push_back(finding_of(found));
  result.seconds = std::chrono::duration<double>(Clock::now() - began_).count();
  return result;
}

}  // namespace

FuzzResult search_inputs(const FuzzPlan& plan, const FuzzOptions& options) { return Search(plan, options).go(); }

std::vector<KeptInputs> run_kept_inputs(const FuzzPlan& plan, const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed))
    if (entry.path().extension() == ".inputs" && entry.path().filename().string().starts_with(plan.name + "-"))
      files.push_back(entry.path());
  if (files.empty()) return {};
  std::ranges::sort(files);
  const FuzzSetup setup = checked(set_up(plan));
  std::vector<Inputs> all;
  for (const fs::path& file : files) all.push_back(checked(inputs_of_text(setup, checked(read_text(file)), file)));
  const auto workers = checked(InputWorkers::create(setup, 1));
  const auto outcomes = checked(workers->run(all));
  const auto again = checked(workers->run(all, MemoryFill::zeros));
  std::vector<KeptInputs> kept;
  for (std::size_t i = 0; i < files.size(); ++i) {
    std::string why = outcomes[i].sentence;
    if (outcomes[i].passed() && (!again[i].passed() || again[i].hash != outcomes[i].hash))
      why = "other commands in a second run of the same inputs";
    kept.push_back({files[i].string(), std::move(why)});
  }
  return kept;
}

}  // namespace rehearse
