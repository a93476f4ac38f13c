#include "output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <utility>

#include "core/guard/result_stream.h"

namespace rehearse::tool {

Result<OutputFile> OutputFile::open(const std::string& named, bool json) {
  OutputFile output{std::filesystem::path(named)};
  if (named != "-") return output;
  if (json) return error("-o - with --json: both are printed on stdout", "name a file");
  if (is_terminal(stdout))
    return error("-o - prints a file on stdout, which is a terminal", "redirect it, or name a file");
  output.scratch_.emplace(ScratchFolder::temporary());
  if (output.scratch_->path().empty())
    return error("there is no folder for temporary files", "TMPDIR names one that can be written to");
  output.path_ = output.scratch_->path() / "output";
  keep_stdout_for_results();
  return output;
}

Result<void> OutputFile::send() const {
  if (!scratch_) return {};
  const int results = fileno(result_stream());
  std::ifstream file(path_, std::ios::binary);
  std::array<char, 1 << 16> part;
  while (file.read(part.data(), part.size()), file.gcount() > 0)
    for (ssize_t sent = 0, size = file.gcount(); sent < size;) {
      const ssize_t written = write(results, part.data() + sent, static_cast<std::size_t>(size - sent));
      if (written < 0 && errno != EINTR) return error(fmt::format("can't write to stdout: {}", std::strerror(errno)));
      if (written > 0) sent += written;
    }
  return {};
}

Exit send(const OutputFile& output, Exit exit) {
  const auto sent = output.send();
  return sent ? exit : refuse(sent.errors());
}

}  // namespace rehearse::tool
