#include <dlfcn.h>

#include <cnoid/ExecutablePath>
#include <cstdlib>

namespace cnoid {

namespace {

namespace fs = std::filesystem;

fs::path libraryFile() {
  Dl_info info{};
  if (!dladdr(reinterpret_cast<const void*>(&shareDirPath), &info) || !info.dli_fname) return {};
  std::error_code error;
  const fs::path file = fs::canonical(info.dli_fname, error);
  return error ? fs::path(info.dli_fname) : file;
}

fs::path programFile() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error);
}

}  // namespace

fs::path pluginDirPath() { return libraryFile().parent_path(); }

fs::path shareDirPath() {
  const char* named = std::getenv("REHEARSE_CHOREONOID_SHARE");
  if (named && *named) return named;
  return pluginDirPath().parent_path() / "share" / "choreonoid";
}

fs::path executableTopDirPath() { return programFile().parent_path().parent_path(); }

const std::string& shareDir() {
  static std::string dir;  // read anew at each call, because the environment may have changed
  dir = shareDirPath().string();
  return dir;
}

const std::string& executableFile() {
  static const std::string file = programFile().string();
  return file;
}

const std::string& executableBasename() {
  static const std::string name = programFile().filename().string();
  return name;
}

const std::string& executableDir() {
  static const std::string dir = programFile().parent_path().string();
  return dir;
}

const std::string& executableTopDir() {
  static const std::string dir = executableTopDirPath().string();
  return dir;
}

const std::string& pluginDir() {
  static const std::string dir = pluginDirPath().string();
  return dir;
}

}  // namespace cnoid
