// What the wing logs adds to verbs of the core. with_logs.cpp defines it in rehearse-logs, without_logs.cpp in
// rehearse-read, which loads no library of that wing.
#pragma once

#include "logs/bag/bag_folder.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "json_forms.h"
#include "replay_log.h"

namespace rehearse::tool {

/// The forms of files that the wing reads.
std::vector<NamedForm> forms_of_logs();

/// Findings in a log's own container; nullopt: the file is MCAP.
std::optional<Diagnostics> findings_of_container(const std::filesystem::path& file);
/// The folder of a log that is a folder, or the file metadata.yaml of one; empty: it is any other file.
std::filesystem::path folder_of_log(const std::filesystem::path& log);
Result<bag::Folder> read_folder_of_log(const std::filesystem::path& folder);
/// Compares metadata.yaml with the messages of the folder's files.
Diagnostics findings_of_metadata(const bag::Folder& folder, const std::filesystem::path& path);

/// Replays the log of a robot. rehearse-read executes rehearse-logs for it, with the same arguments.
Exit replay_log_of(LogSettings settings);

/// Writes a scenario that begins in a flight's first posture, with `library` as its controller, and the flight's model
/// beside it. Fails if the scenario exists. Of rehearse-logs alone: rehearse-read calls continue_with_logs() first.
Result<void> save_scenario_of_flight(const std::filesystem::path& flight, const std::string& library,
                                     const std::string& scenario);
/// In rehearse-read, executes rehearse-logs, and returns only if it can't; in rehearse-logs nullopt.
std::optional<Exit> continue_with_logs(std::string_view asked);

}  // namespace rehearse::tool
