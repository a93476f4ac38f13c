#include "changed_files.h"

#include <algorithm>
#include <functional>

#include "base/names.h"
#include "core/recording/recorder.h"
#include "core/scenario/key_changes.h"

namespace rehearse {
namespace {

/// True for a key that acts on the world under given commands.
bool acts_on_world(const KeyChange& change) {
  return change.key.find("/controllers/") == std::string::npos && !change.key.starts_with("options");
}

}  // namespace

ChangedFiles changed_files(const Scenario& scenario, const Trace& golden, const std::vector<std::string>& files,
                           bool of_world) {
  constexpr std::size_t most = 3;
  std::vector<std::string> items;
  const std::vector<SourceFile> sources = sources_of(scenario);
  ChangedFiles changed;
  bool has_scenario = false, has_model = false;
  for (const std::string& file : files) {
    const mcap::Attachment* recorded = golden.find_attachment(file);
    const auto source = std::ranges::find(sources, file, &SourceFile::name);
    std::vector<KeyChange> changes;
    if (recorded && source != sources.end()) changes = key_changes(std::string(recorded->text()), source->text);
    const bool has_keys = !changes.empty();
    if (of_world) std::erase_if(changes, std::not_fn(acts_on_world));
    if (has_keys && changes.empty()) continue;
    if (!has_keys) items.push_back(file);
    for (const KeyChange& change : changes) items.push_back(to_string(change, file));
    (file == "scenario.yaml" ? has_scenario : has_model) = true;
  }
  if (has_scenario) changed.codes.push_back(VerdictCode::scenario_changed);
  if (has_model) changed.codes.push_back(VerdictCode::model_changed);
  changed.text = listed(items, most);
  return changed;
}

}  // namespace rehearse
