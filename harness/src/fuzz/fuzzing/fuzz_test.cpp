// Fuzz tests in GoogleTest, and the answer to `rehearse fuzz`, which runs their programs.
#include <fmt/format.h>
#include <rehearse/fuzz.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "base/text.h"
#include "core/golden/golden_files.h"
#include "fuzz_mistake.h"

namespace rehearse::internal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const char* from_environment(const char* name) {
  const char* const value = std::getenv(name);
  return value && *value ? value : nullptr;
}

/// What `rehearse fuzz` asks for, as JSON; null: ctest runs the test.
Json asked() {
  const char* const text = from_environment("REHEARSE_FUZZ");
  return text ? Json::parse(text, nullptr, false) : Json();
}

std::string failures_folder() {
  fs::path golden = fs::path(test_folders().golden);
  if (!golden.has_filename()) golden = golden.parent_path();
  return (golden.parent_path() / "failures").lexically_normal().string();
}

Json json_of(const FuzzFinding& finding) {
  return {{"kind", finding.kind},
          {"sentence", finding.sentence},
          {"run", finding.run},
          {"tick", finding.tick},
          {"ticks", finding.ticks},
          {"ticks_before", finding.ticks_before},
          {"inputs", finding.inputs},
          {"inputs_before", finding.inputs_before},
          {"changes", finding.changes},
          {"changes_before", finding.changes_before},
          {"repeats", finding.repeats},
          {"file", finding.file},
          {"recording", finding.recording}};
}

Json json_of(const FuzzResult& result, const std::vector<KeptInputs>& kept, const FuzzOptions& options) {
  Json object{{"runs", result.runs},       {"resumed_from", result.resumed_from},
              {"seed", options.seed},      {"kept", result.kept},
              {"points", result.points},   {"seconds", result.seconds},
              {"findings", Json::array()}, {"kept_findings", Json::array()}};
  for (const FuzzFinding& finding : result.findings) object["findings"].push_back(json_of(finding));
  for (const KeptInputs& one : kept)
    object["kept_findings"].push_back({{"file", one.file}, {"sentence", one.sentence}});
  return object;
}

/// As the verb reads them.
Json json_of(const Diagnostics& mistakes) {
  Json list = Json::array();
  for (const Diagnostic& one : mistakes)
    list.push_back(
        {{"file", one.file}, {"line", one.line}, {"column", one.column}, {"message", one.message}, {"hint", one.hint}});
  return list;
}

std::string text_of(const FuzzFinding& finding) {
  std::string text =
      fmt::format("\n{}: {}\n  found in run {}, shrunk from {} and {} to {} and {}", finding.kind, finding.sentence,
                  finding.run, count_text(finding.ticks_before, "tick"), count_text(finding.changes_before, "change"),
                  count_text(finding.ticks, "tick"), count_text(finding.changes, "change"));
  if (!finding.repeats) text += "\n  it doesn't repeat its bits";
  if (!finding.file.empty()) text += "\n  its inputs: " + finding.file;
  if (!finding.recording.empty()) text += "\n  tick by tick: rehearse step " + finding.recording;
  return text;
}

TestVerdict judge(const FuzzPlan& plan, const Json& wanted) {
  FuzzOptions options;
  options.runs = plan.runs;
  options.seed = plan.seed;
  options.folder = failures_folder();
  if (wanted.is_object()) {
    options.runs = wanted.value("runs", plan.runs);
    options.seconds = wanted.value("seconds", 0.0);
    options.seed = wanted.value("seed", plan.seed);
    options.jobs = wanted.value("jobs", static_cast<int>(std::max(1L, ::sysconf(_SC_NPROCESSORS_ONLN))));
    options.state = (fs::path(test_folders().output) / "fuzz" / (plan.name + ".json")).string();
    if (wanted.value("anew", false)) fs::remove(options.state);
  }
  const std::vector<KeptInputs> kept = run_kept_inputs(plan, options.folder);
  const FuzzResult result = search_inputs(plan, options);
  if (wanted.is_object() && wanted.contains("result"))
    if (const auto written = replace_text(wanted["result"].get<std::string>(), json_of(result, kept, options).dump());
        !written)
      return {false, to_string(written.errors())};
  TestVerdict verdict{true, ""};
  for (const KeptInputs& one : kept) {
    if (one.sentence.empty()) continue;
    verdict.passed = false;
    verdict.message += fmt::format("\na kept finding fails again: {}: {}", one.file, one.sentence);
  }
  for (const FuzzFinding& finding : result.findings) {
    const auto is_it = [&](const KeptInputs& one) { return !one.sentence.empty() && one.file == finding.file; };
    if (std::ranges::any_of(kept, is_it)) continue;
    verdict.passed = false;
    verdict.message += text_of(finding);
  }
  if (!verdict.passed)
    verdict.message = fmt::format("inputs break the controller {}{}\n{} of the search, seed {}", plan.library,
                                  verdict.message, count_text(result.runs, "run"), options.seed);
  return verdict;
}

}  // namespace

TestVerdict run_fuzz_test(const FuzzPlan& plan) {
  const Json wanted = asked();
  try {
    return judge(plan, wanted);
  } catch (const FuzzMistake& mistake) {
    if (wanted.is_object() && wanted.contains("result"))
      static_cast<void>(replace_text(wanted["result"].get<std::string>(),
                                     Json{{"errors", json_of(mistake.diagnostics)}}.dump()));  // the text below remains
    return {false, mistake.what()};
  }
}

}  // namespace rehearse::internal
