#include "trace_scenario.h"

#include <fmt/format.h>
#include <rehearse/body.h>

#include "branch_origin.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

const mcap::Attachment* find_attachment(const mcap::Reader& trace, const std::string& name) {
  for (const mcap::Attachment& attachment : trace.attachments())
    if (attachment.name == name) return &attachment;
  return nullptr;
}

}  // namespace

Result<Scenario> scenario_of(const mcap::Reader& trace) {
  const RunFacts run = RunFacts::of(trace);
  if (run.provenances > 1)
    return error_in(trace.name(), "it contains several recordings, merged into one file", "use them one by one");
  const mcap::Attachment* source = find_attachment(trace, "scenario.yaml");
  if (!run.provenance || !source)
    return error_in(trace.name(),
                    "it is an MCAP file, but not a recording of Rehearse: it has no provenance or no scenario");
  const int version = run.trace_version.value_or(0);
  if (version != trace_version)
    return error_in(trace.name(),
                    fmt::format("it is of trace version {}, and this program reads version {}", version, trace_version),
                    "read it with the version of Rehearse that wrote it");
  const Scenario::ModelSource models = [&trace](const std::string& file, const UrdfOptions& options) -> Result<Model> {
    const mcap::Attachment* model = find_attachment(trace, file);
    if (!model) return error(fmt::format("the trace has no attachment '{}'", file));
    UrdfOptions recorded = options;
    recorded.meshes = UrdfOptions::Meshes::skip;  // a trace contains no meshes
    recorded.compare = false;
    return parse_model(std::string(model->text()), file, recorded);
  };
  const Scenario::FileSource files = [&trace](const std::string& file) -> Result<std::string> {
    const mcap::Attachment* found = find_attachment(trace, file);
    if (!found) return error(fmt::format("the trace has no attachment '{}'", file));
    return std::string(found->text());
  };
  Result<Scenario> scenario =
      Scenario::parse(std::string(source->text()), trace.name() + "/scenario.yaml", models, files);
  if (!scenario) return scenario;
  scenario->seed = run.seed.value_or(scenario->seed);
  scenario->duration = run.duration.value_or(scenario->duration);
  if (run.branch) {
    for (const std::string& text : run.branch->push) {
      const auto push = REHEARSE_TRY(parse_push(text, *scenario));
      scenario->pushes.push_back(push);
    }
  }
  return scenario;
}

std::filesystem::path folder_of(const Scenario& scenario) {
  const std::filesystem::path within = std::filesystem::path(scenario.file).parent_path();
  std::error_code ignored;
  return std::filesystem::is_regular_file(within, ignored) ? within.parent_path() : within;
}

Result<Scenario> recorded_scenario(const Trace& trace) {
  const auto reader = REHEARSE_TRY(mcap::Reader::open(trace.file()));
  return scenario_of(*reader);
}

}  // namespace rehearse
