// Controllers' libraries that were built before the last change of their sources: a forgotten build. The libraries of
// the same project that they link are judged, too.
//
// The sources are those of the library's line information that are below its project, without those in builds. A source
// that is newer than the library counts unless its content is the one that it had when the library was newer, which is
// kept in the folder of the build: a file that was only touched, or checked out again, is no change. A library without
// line information has no known sources.
#pragma once

#include <rehearse/run_options.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

/// Sentences, "hold.cpp is newer than Hold.so: built before your last change; cmake --build build": of the library, and
/// of the libraries of its project or build that it links. Empty: they are up to date, or nothing is known. A library
/// is looked at once in a process.
std::vector<std::string> notes_on_old_library(const std::filesystem::path& library);

/// These sentences of the libraries that a run of the scenario loads, and note_on_builds() of each, each once.
std::vector<std::string> notes_on_old_libraries(const Scenario& scenario, const HostOptions& options);

/// Prints sentences to stderr as notes, each once in a process.
void tell_old_libraries(const std::vector<std::string>& notes);

}  // namespace rehearse
