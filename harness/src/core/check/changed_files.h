// The files of a recording that have changed, with their changed keys, for verdicts. Internal.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>
#include <rehearse/verdict_code.h>

#include <string>
#include <vector>

namespace rehearse {

struct ChangedFiles {
  std::vector<VerdictCode> codes;  // scenario_changed, model_changed
  /// The first three changed keys: "scenario.yaml:12 (gravity is [0, 0, -9.81], was [0, 0, -9.8])", or the name of a
  /// file without any, and the number of the others; empty: no file changed.
  std::string text;
};

/// `files`: attachments of the golden with other content than now. `of_world`: without keys, and without files that
/// have only such keys, that can't act on the world under given commands.
ChangedFiles changed_files(const Scenario& scenario, const Trace& golden, const std::vector<std::string>& files,
                           bool of_world);

/// The changed keys of these files, each with its place in the present file: "gravity is [0, 0, -9.81], was ...". A
/// file without changed keys isn't among them.
Diagnostics places_of_changes(const Scenario& scenario, const Trace& golden, const std::vector<std::string>& files);

}  // namespace rehearse
