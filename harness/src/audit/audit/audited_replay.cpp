// The work of one process of an audit: feeds recorded inputs to the controllers, and writes their outputs into a file.
#include <fmt/format.h>
#include <rehearse/audit.h>
#include <rehearse/replay.h>
#include <stdlib.h>
#include <valgrind/callgrind.h>
#include <valgrind/memcheck.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "code_breakpoints.h"
#include "core/compare/place_json.h"
#include "core/guard/guarded_call.h"
#include "core/host/interposer.h"
#include "core/host/turn_order_file.h"
#include "core/turns/scheduler.h"
#include "executed_code_json.h"
#include "instruction_profile.h"
#include "outputs_file.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Notes each call in the outputs file, so that the file names the call that ended the process.
class AuditWatch : public ControllerWatch {
 public:
  AuditWatch(OutputsWriter& outputs, const AuditedReplay& work)
      : outputs_(outputs),
        inner_(work.stack_fill ? std::optional(StackFill(static_cast<unsigned char>(*work.stack_fill))) : std::nullopt),
        counts_instructions_(work.instructions),
        finds_coverage_(work.coverage) {}
  void enter(const ControllerCall& call) override {
    outputs_.enter(call.controller.c_str(), call.function, call.tick);
    inner_.enter(call);
    if (finds_coverage_) find_coverage(call);
    if (!counts_instructions_ || std::string_view(call.function) != "control") return;
    if (call.tick == 0) CALLGRIND_START_INSTRUMENTATION;
    counted_ = profile_title(call.controller, call.tick);
  }
  void begin_control() override {
    if (counts_instructions_) CALLGRIND_TOGGLE_COLLECT;
  }
  void end_control() override {
    if (counts_instructions_) CALLGRIND_TOGGLE_COLLECT;
  }
  void leave() override {
    if (!counted_.empty()) CALLGRIND_DUMP_STATS_AT(counted_.c_str());
    counted_.clear();
    inner_.leave();
    outputs_.leave();
  }

 private:
  void find_coverage(const ControllerCall& call) {
    const std::string_view function = call.function;
    // A library that can't be watched is reported by the parent process.
    if (function == "load") static_cast<void>(watch_library(call.library));
    runs_ = runs_ || function == "control";
    set_watched_tick(runs_ ? call.tick : -1);
  }

  OutputsWriter& outputs_;
  InterposerWatch inner_;
  bool counts_instructions_, finds_coverage_;
  bool runs_ = false;    // the first control() has begun
  std::string counted_;  // the title of the profile of the present call
};

/// Allocates memory in odd sizes, some large and many small, and keeps about every second block. Later allocations are
/// in the holes between, at different addresses and in a different order.
void pad_memory(std::uint32_t seed) {
  constexpr int pieces = 20000, every = 200;
  static std::vector<void*>& kept = *new std::vector<void*>;
  std::vector<void*> given_back;
  std::mt19937 random(seed);
  for (int i = 0; i < pieces; ++i) {
    const std::size_t size = random() % (i % every == 0 ? 100000u : 1000u) + 1;
    (random() % 2 == 0 ? kept : given_back).push_back(malloc(size));
  }
  std::shuffle(given_back.begin(), given_back.end(), random);
  for (void* piece : given_back) free(piece);
}

/// Under valgrind: the first output of a row that the controller never set, as "LLEG_KNEE/u of
/// /SR1/Stand/output/joints at tick 3". Empty: there is none, or valgrind doesn't run this process.
std::string undefined_in(const std::vector<OutputField>& fields, std::int64_t tick,
                         const std::vector<std::uint64_t>& row) {
  for (std::size_t i = 0; i < row.size(); ++i)
    if (VALGRIND_CHECK_MEM_IS_DEFINED(&row[i], sizeof row[i]) != 0)
      return fmt::format("{} of {} at tick {}", fields[i].element, fields[i].channel, tick);
  return {};
}

Json json_of_texts(const Diagnostics& diagnostics) {
  Json texts = Json::array();
  for (const Diagnostic& diagnostic : diagnostics)
    texts.push_back({{"warning", diagnostic.severity != Severity::error}, {"text", diagnostic.message}});
  return texts;
}

Json pass(const AuditedReplay& work, OutputsWriter& outputs) {
  AuditWatch watch(outputs, work);
  std::vector<OutputField> known;
  std::string undefined;
  ReplayOptions options;
  static_cast<HostOptions&>(options) = work.host;
  options.keep_libraries = work.passes > 1;
  options.watch = &watch;
  options.counts_costs = work.costs;
  options.until = work.until;
  options.on_started = [&](const std::vector<OutputField>& fields) {
    outputs.begin(fields);
    known = fields;
  };
  options.on_outputs = [&](std::int64_t tick, const std::vector<std::uint64_t>& row) {
    if (undefined.empty()) undefined = undefined_in(known, tick, row);
    outputs.add(tick, row);
  };
  const auto report = replay(work.trace, options);
  Json result{{"problem", nullptr},
              {"failure", nullptr},
              {"refused", false},
              {"differs_from_recording", nullptr},
              {"beyond", nullptr},
              {"counted_costs", false},
              {"undefined", nullptr},
              {"remarks", Json::array()},
              {"page_faults", Json::object()}};
  if (!report) {
    result["problem"] = report.errors()[0];
    return result;
  }
  if (report->failure) result["failure"] = report->failure->message;
  if (!undefined.empty()) result["undefined"] = undefined;
  result["refused"] = report->controller_refused;
  result["counted_costs"] =
      std::ranges::any_of(report->control_times, [](const ControlTimes& times) { return times.costs.has_value(); });
  for (const ControlTimes& times : report->control_times)
    if (times.costs) {
      const ControlCosts::Count& faults = times.costs->page_faults;
      result["page_faults"][times.controller] = {faults.total, faults.ticks, faults.first_tick};
    }
  result["differs_from_recording"] = json_of_place(report->first);
  result["beyond"] = json_of_place(report->beyond);
  result["remarks"] = json_of_texts(report->remarks);
  if (const TurnScheduler& turns = TurnScheduler::instance(); turns.order()) {
    result["order"] = json_of_order(made_exchanges());
    result["order"]["places"] = turns.order()->places();
    result["order"]["threads"] = turns.thread_count();
  }
  if (work.coverage) result["executed"] = json_of_executed_code(executed_code());
  return result;
}

}  // namespace

Result<void> make_audited_replay(const AuditedReplay& work) {
  end_process_at_library_crashes();
  if (work.costs) log_costs();
  if (!work.order.empty()) REHEARSE_TRY(take_turn_order(work.order));
  if (work.padding != 0) pad_memory(work.padding);
  const fs::path folder = fs::absolute(work.folder);  // a controller may change the working folder
  AuditedReplay here = work;
  here.trace = fs::absolute(work.trace);
  for (int number = 1; number <= work.passes; ++number) {
    auto outputs = REHEARSE_TRY(OutputsWriter::create(folder / fmt::format("{}.outputs", number)));
    Json result = pass(here, outputs);
    if (!outputs.complete()) return error("the commands of the controllers can't be stored: the disk is full");
    const fs::path file = folder / fmt::format("{}.json", number);
    std::ofstream stream(file);
    stream << result.dump(1, ' ', false, Json::error_handler_t::replace);
    stream.close();
    if (!stream) return error(fmt::format("can't write {}", file.string()));
  }
  return {};
}

}  // namespace rehearse
