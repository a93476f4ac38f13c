#include "log_verbs.h"

namespace rehearse::tool {

std::vector<NamedForm> forms_of_logs() { return {}; }

std::optional<Diagnostics> findings_of_container(const std::filesystem::path&) { return std::nullopt; }

std::filesystem::path folder_of_log(const std::filesystem::path&) { return {}; }

Result<bag::Folder> read_folder_of_log(const std::filesystem::path&) { return bag::Folder{}; }

Diagnostics findings_of_metadata(const bag::Folder&, const std::filesystem::path&) { return {}; }

Exit replay_log_of(LogSettings) { return continue_in_wing("logs", "the replay of a robot's log"); }

}  // namespace rehearse::tool
