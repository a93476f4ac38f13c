#include "log_verbs.h"

namespace rehearse::tool {

std::vector<NamedForm> forms_of_logs() { return {}; }

std::optional<Diagnostics> findings_of_container(const std::filesystem::path&) { return std::nullopt; }

std::filesystem::path folder_of_log(const std::filesystem::path&) { return {}; }

Result<bag::Folder> read_folder_of_log(const std::filesystem::path&) { return bag::Folder{}; }

Diagnostics findings_of_metadata(const bag::Folder&, const std::filesystem::path&) { return {}; }

Exit replay_log_of(LogSettings) { return continue_in_wing("logs", "the replay of a robot's log"); }

Result<void> save_scenario_of_flight(const std::filesystem::path&, const std::string&, const std::string&) {
  return left_out("the scenario of a flight", "logs");
}

std::optional<Exit> continue_with_logs(std::string_view asked) { return continue_in_wing("logs", asked); }

}  // namespace rehearse::tool
