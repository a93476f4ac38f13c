#include "instruction_check.h"

#include <fmt/format.h>
#include <rehearse/golden.h>

#include <cstdio>
#include <filesystem>
#include <optional>

#include "audit/audit/instruction_golden.h"
#include "core/guard/interruption.h"
#include "output.h"
#include "progress.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

/// The result of one golden.
struct Checked {
  std::string verdict;
  Exit exit = Exit::done;
  std::string kept;  // the written file; empty: none
  std::optional<AuditReport> report;
  InstructionJudgement judgement;
};

Checked failed(const Diagnostics& problems) { return {to_string(problems.front()), Exit::bad_input, "", {}, {}}; }

Checked check_golden(const fs::path& golden, bool keeps, AuditOptions& options) {
  auto report = [&] {
    Progress progress("counting " + golden.stem().string());
    options.progress = [&](const std::string&, int done, int all) { progress.show(done, all); };
    return audit(golden, options);
  }();
  if (interruption() != 0) throw Interrupted();
  if (!report) return failed(report.errors());
  Checked checked{report->verdict, Exit::done, "", *std::move(report), {}};
  if (checked.report->failure || checked.report->controller_refused) {
    checked.exit = Exit::controller_failed;
  } else if (keeps) {
    if (const auto kept = keep_instructions(*checked.report, golden); !kept) return failed(kept.errors());
    checked.kept = instructions_file_of(golden).string();
    checked.verdict = "kept in " + checked.kept + ": " + checked.verdict;
  } else {
    auto judgement = judge_instructions(*checked.report, golden);
    if (!judgement) return failed(judgement.errors());
    checked.judgement = *std::move(judgement);
    checked.verdict = checked.judgement.verdict;
    if (checked.judgement.has_grown) checked.exit = Exit::differs;
  }
  return checked;
}

Json object_of(const std::optional<ComparedCall>& call) {
  if (!call) return nullptr;
  return {{"tick", call->tick}, {"instructions", call->instructions}, {"expected", call->expected}};
}

Json object_of(const std::string& golden, const Checked& checked) {
  Json controllers = Json::array();
  for (const ComparedInstructions& compared : checked.judgement.controllers)
    controllers.push_back(
        {{"controller", compared.controller},
         {"not_compared", compared.not_compared.empty() ? Json(nullptr) : Json(compared.not_compared)},
         {"ticks", compared.ticks},
         {"grown", compared.grown},
         {"share", compared.share},
         {"first", object_of(compared.first)},
         {"worst", object_of(compared.worst)}});
  return {{"recording", golden},
          {"verdict", checked.verdict},
          {"within", checked.exit == Exit::done},
          {"kept", checked.kept.empty() ? Json(nullptr) : Json(checked.kept)},
          {"controllers", controllers},
          {"remarks", json_of(checked.report ? checked.report->remarks : Diagnostics())}};
}

}  // namespace

Exit check_instructions(const std::vector<std::string>& goldens, AuditOptions options, bool json) {
  const auto mode = golden_mode();
  if (!mode) return refuse(mode.errors());
  options.instructions = true;
  Exit exit = Exit::done;
  bool was_anything_done = false;
  std::string verdict;
  Json entries = Json::array();
  for (const std::string& golden : goldens) {
    std::error_code ignored;
    const bool has_counts = fs::exists(instructions_file_of(golden), ignored);
    if (!has_counts && *mode == GoldenMode::check) continue;
    const bool keeps = *mode == GoldenMode::accept || !has_counts;
    const Checked checked = check_golden(golden, keeps, options);
    was_anything_done = was_anything_done || keeps || checked.judgement.was_compared || checked.exit != Exit::done;
    exit = std::max(exit, checked.exit);
    if (verdict.empty() || checked.exit != Exit::done) verdict = checked.verdict;
    entries.push_back(object_of(golden, checked));
    if (json) continue;
    fmt::print("{}: {}\n", fs::path(golden).stem().string(), checked.verdict);
    std::fflush(stdout);  // before related output on stderr
    if (checked.report) tell_remarks(checked.report->remarks, checked.report->failure);
  }
  if (entries.empty())
    return refuse(error("no counts of instructions are kept beside the goldens",
                        "REHEARSE_GOLDEN=new rehearse check --instructions keeps them"));
  if (json) print({{"verdict", verdict}, {"within", exit == Exit::done && was_anything_done}, {"recordings", entries}});
  return was_anything_done ? exit : Exit::bad_input;
}

}  // namespace rehearse::tool
