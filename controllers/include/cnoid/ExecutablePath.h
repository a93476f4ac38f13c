// The folders of a Choreonoid installation, for controllers that read motions from its share folder.
//
// Rehearse itself has no share folder. The environment variable REHEARSE_CHOREONOID_SHARE names it; without the
// variable, it is share/choreonoid beside the folder of this library (PREFIX/lib/librehearse_cnoid.so and
// PREFIX/share/choreonoid). Its existence is not checked. A controller that reads a file from there is only as
// deterministic as that file.
#pragma once

#include "Config.h"

#include <filesystem>
#include <string>

namespace cnoid {

CNOID_GENERAL_EXPORT std::filesystem::path shareDirPath();
CNOID_GENERAL_EXPORT const std::string& shareDir();

/// The program that runs the controller: its path, its name, its folder, and the folder above that.
CNOID_GENERAL_EXPORT const std::string& executableFile();
CNOID_GENERAL_EXPORT const std::string& executableBasename();
CNOID_GENERAL_EXPORT const std::string& executableDir();
CNOID_GENERAL_EXPORT const std::string& executableTopDir();
CNOID_GENERAL_EXPORT std::filesystem::path executableTopDirPath();

/// The folder of this library.
CNOID_GENERAL_EXPORT const std::string& pluginDir();
CNOID_GENERAL_EXPORT std::filesystem::path pluginDirPath();

[[deprecated("Use executableFile.")]] inline const std::string& executablePath() { return executableFile(); }
[[deprecated("Use executableDir.")]] inline const std::string& executableDirectory() { return executableDir(); }
[[deprecated("Use executableTopDir.")]] inline const std::string& executableTopDirectory() {
  return executableTopDir();
}
[[deprecated("Use pluginDir.")]] inline const std::string& pluginDirectory() { return pluginDir(); }
[[deprecated("Use shareDir.")]] inline const std::string& shareDirectory() { return shareDir(); }

}  // namespace cnoid
