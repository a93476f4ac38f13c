#include "call_stack.h"

#include <fmt/format.h>

#include <cstdlib>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "core/guard/child_process.h"
#include "report_blobs.h"
#include "report_page.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr double limit = 60.0;  // [s]

std::vector<StackFrame> frames_of(const ReportJson& read) {
  std::vector<StackFrame> frames;
  for (const ReportJson& frame : read.value("frames", ReportJson::array()))
    frames.push_back({frame.value("function", ""), frame.value("file", ""), frame.value("line", 0),
                      frame.value("begin", 0), frame.value("source", std::vector<std::string>())});
  return frames;
}

}  // namespace

Result<CallStack> call_stack_at(const fs::path& trace, const std::string& controller, const std::string& command,
                                std::int64_t tick, const HostOptions& host) {
  if (find_program("gdb").empty()) return error("there is no gdb on the PATH", "apt-get install gdb");
  const fs::path rehearse = beside_library({REHEARSE_COMMAND_IN_BUILD, REHEARSE_COMMAND_INSTALLED});
  if (rehearse.empty()) return error("the command rehearse isn't installed");
  std::vector<std::string> words{rehearse.string(), "replay", trace.string(), "--gdb=" + controller,
                                 fmt::format("--tick={}", tick)};
  for (const auto& [name, library] : host.libraries) words.push_back(fmt::format("--controller={}={}", name, library));
  for (const std::string& word : {std::string("-batch"), std::string("-ex"), "rehearse-stack " + command})
    words.push_back("--gdb-arg=" + word);
  const auto output =
      REHEARSE_TRY(output_of({std::move(words), environment_with({}), {}, ChildProcess::Errors::discarded}, limit));
  std::istringstream lines(output.text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("{")) continue;
    const ReportJson read = ReportJson::parse(line, nullptr, false);
    if (!read.is_object()) continue;
    if (const std::string reason = read.value("reason", ""); !reason.empty()) return error(reason);
    CallStack stack{controller, command, tick, frames_of(read)};
    if (stack.frames.empty() || stack.frames[0].file.empty())
      return error(controller + " has no debug information", "build it with -g");
    if (stack.frames[0].source.empty())
      return error(fmt::format("the source file {} can't be read", stack.frames[0].file));
    return stack;
  }
  return error(fmt::format("gdb found no call of {} at tick {} within {:g} s", controller, tick, limit));
}

decltype(ReportOptions::call_stack) call_stack_of(const fs::path& trace, const HostOptions& host) {
  const char* wanted = std::getenv("REHEARSE_CALL_STACK");
  if ((wanted && std::string_view(wanted) == "never") || find_program("gdb").empty()) return nullptr;
  return [trace, host](const std::string& controller, const std::string& command, std::int64_t tick) {
    return call_stack_at(trace, controller, command, tick, host);
  };
}

}  // namespace rehearse
