#include "changed_files.h"

#include <rehearse/mcap.h>

#include <algorithm>
#include <functional>

#include "base/names.h"
#include "core/recording/recorded_sources.h"
#include "core/scenario/key_changes.h"
#include "core/scenario/trace_scenario.h"

namespace rehearse {
namespace {

/// True for a key that acts on the world under given commands.
bool acts_on_world(const KeyChange& change) {
  return change.key.find("/controllers/") == std::string::npos && !change.key.starts_with("options");
}

/// The keys of a file that have changed; empty: none has, or the golden or the scenario lacks the file.
std::vector<KeyChange> changes_of(const std::string& file, const Trace& golden,
                                  const std::vector<SourceFile>& sources) {
  const mcap::Attachment* recorded = golden.find_attachment(file);
  const auto source = std::ranges::find(sources, file, &SourceFile::name);
  if (!recorded || source == sources.end()) return {};
  return key_changes(std::string(recorded->text()), source->text);
}

constexpr const char* scenario_name = "scenario.yaml";  // of its attachment, whatever the file's name is

}  // namespace

ChangedFiles changed_files(const Scenario& scenario, const Trace& golden, const std::vector<std::string>& files,
                           bool of_world) {
  constexpr std::size_t most = 3;
  std::vector<std::string> items;
  const std::vector<SourceFile> sources = sources_of(scenario);
  ChangedFiles changed;
  bool has_scenario = false, has_model = false;
  for (const std::string& file : files) {
    std::vector<KeyChange> changes = changes_of(file, golden, sources);
    const bool has_keys = !changes.empty();
    if (of_world) std::erase_if(changes, std::not_fn(acts_on_world));
    if (has_keys && changes.empty()) continue;
    if (!has_keys) items.push_back(file);
    for (const KeyChange& change : changes) items.push_back(to_string(change, file));
    (file == scenario_name ? has_scenario : has_model) = true;
  }
  if (has_scenario) changed.codes.push_back(VerdictCode::scenario_changed);
  if (has_model) changed.codes.push_back(VerdictCode::model_changed);
  changed.text = listed(items, most);
  return changed;
}

Diagnostics places_of_changes(const Scenario& scenario, const Trace& golden, const std::vector<std::string>& files) {
  const std::vector<SourceFile> sources = sources_of(scenario);
  Diagnostics places;
  for (const std::string& file : files)
    for (const KeyChange& change : changes_of(file, golden, sources)) {
      const std::filesystem::path beside = folder_of(scenario) / file;
      std::error_code ignored;
      Diagnostic place;
      place.severity = Severity::note;
      place.file = file == scenario_name                      ? scenario.file
                   : std::filesystem::exists(beside, ignored) ? beside.lexically_normal().string()
                                                              : file;
      place.line = change.line;
      place.message = change.text;
      places.push_back(std::move(place));
    }
  return places;
}

}  // namespace rehearse
