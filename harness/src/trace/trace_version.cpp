#include "trace_version.h"

#include <fmt/format.h>

#include "run_facts.h"

namespace rehearse {

Result<void> check_trace_version(const std::vector<mcap::Metadata>& metadata, const std::string& file) {
  const RunFacts run = RunFacts::of(metadata);
  const std::string version = run.stated(facts::trace_version), writer = run.stated(facts::rehearse);
  if (version.empty() || version == std::to_string(trace_version)) return {};
  Diagnostic finding =
      error(fmt::format("it is of trace version {}, and this program reads version {}", version, trace_version),
            fmt::format("install the version of Rehearse that wrote it{}{}", writer.empty() ? "" : ": ", writer));
  finding.file = file;
  return finding;
}

}  // namespace rehearse
