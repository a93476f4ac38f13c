// OutputFile: the file that a verb's -o names, or standard output for -o -.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/replaceable.h"
#include "command.h"
#include "output.h"
#include "progress.h"
#include "scratch_folder.h"

namespace rehearse::tool {

/// Writers of traces, tables, pictures and reports need a file. For "-" it is a temporary file, whose contents send()
/// prints; from then on the sentences that the verb prints on stdout go to stderr.
class OutputFile {
 public:
  /// `named`: as the user named it. `json`: the verb prints an object on stdout, so that "-" is an error. Other errors:
  /// stdout is a terminal, or there is no folder for temporary files.
  static Result<OutputFile> open(const std::string& named, bool json);
  const std::filesystem::path& path() const { return path_; }
  /// Prints the temporary file on stdout; nothing for a named file.
  Result<void> send() const;

 private:
  explicit OutputFile(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;
  std::optional<ScratchFolder> scratch_;
};

/// Sends the file and returns the verb's exit status, or that of bad input after an error.
Exit send(const OutputFile& output, Exit exit);

/// Writes a trace to `settings.target`, by `make` with the path of the file, and shows the progress of `doing`. Prints
/// the result by result_json(settings, result) if `settings.json` is set, else by tell(settings, result).
template <class Settings, class Make>
Exit write_trace(Settings& settings, const char* doing, Make make) {
  auto output = OutputFile::open(settings.target, settings.json);
  if (!output) return refuse(output.errors());
  if (const auto allowed = check_replaceable(output->path(), mcap_magic, "trace"); !allowed)
    return refuse(allowed.errors());
  const auto made = [&] {
    StoppableProgress progress(doing);
    settings.options.progress = [&](std::uint64_t done, std::uint64_t all) {
      progress.show(static_cast<std::int64_t>(done), static_cast<std::int64_t>(all));
    };
    return make(output->path());
  }();
  if (!made) return refuse(made.errors());
  if (settings.json)
    print(result_json(settings, *made));
  else
    tell(settings, *made);
  return send(*output, Exit::done);
}

}  // namespace rehearse::tool
