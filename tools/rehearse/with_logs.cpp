#include "log_verbs.h"
#include "logs/bag/bag_doctor.h"
#include "logs/map/map_forms.h"

namespace rehearse::tool {

std::vector<NamedForm> forms_of_logs() { return {{"map", "a map from a robot's log to a model", types::of(map_form)}}; }

std::optional<Diagnostics> findings_of_container(const std::filesystem::path& file) { return examine_container(file); }

std::filesystem::path folder_of_log(const std::filesystem::path& log) { return bag::folder_of(log); }

Result<bag::Folder> read_folder_of_log(const std::filesystem::path& folder) { return bag::read_folder(folder); }

Diagnostics findings_of_metadata(const bag::Folder& folder, const std::filesystem::path& path) {
  return examine_metadata(folder, path);
}

std::optional<Exit> continue_with_logs(std::string_view) { return std::nullopt; }

}  // namespace rehearse::tool
