#include "trace_scenario.h"

#include <fmt/format.h>
#include <rehearse/urdf.h>

#include <charconv>

#include "branch_origin.h"
#include "recording/trace_version.h"

namespace rehearse {
namespace {

Diagnostic in_trace(const mcap::Reader& trace, std::string message, std::string hint = {}) {
  Diagnostic diagnostic = error(std::move(message), std::move(hint));
  diagnostic.file = trace.name();
  return diagnostic;
}

const mcap::Attachment* find_attachment(const mcap::Reader& trace, const std::string& name) {
  for (const mcap::Attachment& attachment : trace.attachments())
    if (attachment.name == name) return &attachment;
  return nullptr;
}

std::string text_of(const mcap::Attachment& attachment) {
  return {reinterpret_cast<const char*>(attachment.data.data()), attachment.data.size()};
}

template <class T>
bool read_number(const mcap::StringMap& facts, const char* key, T& value) {
  const auto fact = facts.find(key);
  if (fact == facts.end()) return false;
  const char* end = fact->second.data() + fact->second.size();
  return std::from_chars(fact->second.data(), end, value).ptr == end;
}

}  // namespace

Result<Scenario> scenario_of(const mcap::Reader& trace) {
  const mcap::StringMap* facts = nullptr;
  for (const mcap::Metadata& metadata : trace.metadata()) {
    if (metadata.name != "rehearse") continue;
    if (facts) return in_trace(trace, "it holds several recordings, merged into one", "take them one by one");
    facts = &metadata.values;
  }
  const mcap::Attachment* source = find_attachment(trace, "scenario.yaml");
  if (!facts || !source)
    return in_trace(trace, "it is an MCAP file, but not a recording of Rehearse: it has no provenance or no scenario");
  int version = 0;
  if (!read_number(*facts, "trace_version", version) || version != trace_version)
    return in_trace(trace,
                    fmt::format("it is of trace version {}, and this program reads version {}", version, trace_version),
                    "read it with the version of Rehearse that wrote it");
  const Scenario::ModelSource models = [&trace](const std::string& file, const UrdfOptions& options) -> Result<Model> {
    const mcap::Attachment* model = find_attachment(trace, file);
    if (!model) return error(fmt::format("the trace has no attachment '{}'", file));
    UrdfOptions without_meshes = options;  // a trace has none
    without_meshes.meshes = UrdfOptions::Meshes::skip;
    return parse_urdf(text_of(*model), file, without_meshes);
  };
  Result<Scenario> scenario = Scenario::parse(text_of(*source), trace.name() + "/scenario.yaml", models);
  if (!scenario) return scenario;
  read_number(*facts, "seed", scenario->seed);
  read_number(*facts, "duration", scenario->duration);
  if (const auto origin = BranchOrigin::of(trace)) {
    for (const std::string& text : origin->push) {
      const auto push = parse_push(text, *scenario);
      if (!push) return push.errors();
      scenario->pushes.push_back(*push);
    }
  }
  return scenario;
}

Result<Scenario> recorded_scenario(const Trace& trace) {
  const auto reader = mcap::Reader::open(trace.file());
  if (!reader) return reader.errors();
  return scenario_of(**reader);
}

}  // namespace rehearse
