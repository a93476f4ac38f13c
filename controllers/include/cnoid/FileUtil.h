// Paths of files. std::filesystem contains most of these functions; they exist here for older sources.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace cnoid {

inline constexpr const char* DLL_PREFIX = "lib";
inline constexpr const char* DLL_SUFFIX = ".so";
inline constexpr const char* DLL_EXTENSION = "so";
inline constexpr const char* EXEC_SUFFIX = "";
inline constexpr const char* EXEC_EXTENSION = "";
inline constexpr const char* PATH_DELIMITER = ":";

/// The path relative to `base`; nullopt if there is none, as from a relative path to an absolute one.
inline std::optional<std::filesystem::path> getRelativePath(const std::filesystem::path& path,
                                                            const std::filesystem::path& base) {
  const std::filesystem::path relative = path.lexically_relative(base);
  if (relative.empty()) return std::nullopt;
  return relative;
}

/// True if the path is inside the folder `base`.
inline bool checkIfSubFilePath(const std::filesystem::path& path, const std::filesystem::path& base) {
  const auto relative = getRelativePath(path.lexically_normal(), base.lexically_normal());
  return relative && *relative != "." && *relative->begin() != "..";
}

[[deprecated("Use path.lexically_normal.")]] inline std::filesystem::path getCompactPath(
    const std::filesystem::path& path) {
  return path.lexically_normal();
}
/// The file name extension without the dot.
[[deprecated("Use path.extension.")]] inline std::string getExtension(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return extension.empty() ? extension : extension.substr(1);
}
[[deprecated("Use path.is_absolute.")]] inline bool checkAbsolute(const std::filesystem::path& path) {
  return path.is_absolute();
}
[[deprecated("Use std::filesystem::absolute.")]] inline std::filesystem::path getAbsolutePath(
    const std::filesystem::path& path) {
  return std::filesystem::absolute(path);
}
[[deprecated("Use std::filesystem::absolute.")]] inline std::string getAbsolutePathString(
    const std::filesystem::path& path) {
  return std::filesystem::absolute(path).string();
}
[[deprecated("Use path.filename.")]] inline std::string getFilename(const std::filesystem::path& path) {
  return path.filename().string();
}
[[deprecated("Use path.stem.")]] inline std::string getBasename(const std::filesystem::path& path) {
  return path.stem().string();
}
[[deprecated("Use path.string.")]] inline std::string getPathString(const std::filesystem::path& path) {
  return path.string();
}
[[deprecated("Use path.string.")]] inline std::string getNativePathString(const std::filesystem::path& path) {
  return path.string();
}
[[deprecated("Use path.generic_string.")]] inline std::string getGenericPathString(const std::filesystem::path& path) {
  return path.generic_string();
}

}  // namespace cnoid
