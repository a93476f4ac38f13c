#include "report_source.h"

#include <rehearse/compare.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/trace/filter.h"
#include "core/trace/run_facts.h"

namespace rehearse {

namespace fs = std::filesystem;

namespace {

mcap::TimeBound moment_of(double seconds) {
  return {static_cast<std::uint64_t>(std::llround(std::max(0.0, seconds) * 1e9)), mcap::TimeOrigin::beginning};
}

}  // namespace

Result<SourceFile> SourceFile::make(const fs::path& file, const fs::path& scratch, const ReportOptions& options) {
  if (!options.from && !options.until) return SourceFile(file, fs::path());
  SourceFile source(scratch, scratch);
  mcap::FilterOptions part;
  if (options.from) part.selection.from = moment_of(*options.from);
  if (options.until) part.selection.until = moment_of(*options.until);
  REHEARSE_TRY(mcap::filter(file, scratch, part));
  return source;
}

Result<ReportedRun> read_run(const SourceFile& file, const fs::path& name) {
  auto run = REHEARSE_TRY(ReportedRun::read(file.path()));
  REHEARSE_TRY(check_version(run.trace));
  if (!RunFacts::of(run.trace).provenance)
    return error_in(name.string(), "it is an MCAP file, but not a recording of Rehearse: it has no provenance",
                    "rehearse replay turns a robot's log into one");
  return run;
}

}  // namespace rehearse
