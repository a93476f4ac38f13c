// A recording in a separate process, which can be killed; and checks of the remaining file.
#pragma once

#include <gtest/gtest.h>
#include <rehearse/cdr.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "core/mcap/recover.h"
#include "core/trace/trace_doctor.h"
#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse::test {

namespace fs = std::filesystem;

/// The number of calls of a controller in the other process: see controllers/ticking.cpp.
class CallCounter {
 public:
  explicit CallCounter(const fs::path& file) {
    std::ofstream(file, std::ios::binary) << std::string(sizeof *calls_, '\0');
    const int opened = open(file.c_str(), O_RDWR | O_CLOEXEC);
    void* place = mmap(nullptr, sizeof *calls_, PROT_READ | PROT_WRITE, MAP_SHARED, opened, 0);
    close(opened);
    EXPECT_NE(place, MAP_FAILED);
    calls_ = static_cast<std::atomic<std::uint64_t>*>(place);
  }
  ~CallCounter() { munmap(calls_, sizeof *calls_); }
  CallCounter(const CallCounter&) = delete;
  CallCounter& operator=(const CallCounter&) = delete;

  void reset() { calls_->store(0); }
  std::int64_t calls() const { return static_cast<std::int64_t>(calls_->load()); }

 private:
  std::atomic<std::uint64_t>* calls_ = nullptr;
};

/// Starts a program with its output in `log`. `prepare` is called in the new process first.
inline pid_t start(const std::vector<std::string>& words, const fs::path& log,
                   const std::function<void()>& prepare = {}) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child != 0) return child;
  const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  close(out);
  if (prepare) prepare();
  execv(arguments[0], arguments.data());
  _exit(127);
}

/// The exit status; -1: a signal ended the process.
inline int wait_for(pid_t child) {
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// The result of reading a file's /tick channel.
struct Ticks {
  std::int64_t count = 0;
  std::int64_t last = -1;
  bool without_gaps = true;
};

inline Ticks ticks_of(mcap::Reader& reader) {
  Ticks ticks;
  static_cast<void>(reader.for_each_message([&](const mcap::Message& message) {
    if (message.channel->topic != "/tick") return true;
    CdrReader payload(message.data);
    msg::Tick tick;
    EXPECT_TRUE(msg::decode(payload, tick));
    ticks.without_gaps = ticks.without_gaps && tick.tick == ticks.last + 1;
    ticks.last = tick.tick;
    ++ticks.count;
    return true;
  }));
  return ticks;
}

/// The last readable tick of a killed recorder's file; nullopt: none. Checks that the file can be read as it is, and
/// that recover() makes a valid file of it with the same ticks.
inline std::optional<std::int64_t> save_what_is_left(const fs::path& left, const fs::path& saved) {
  std::error_code none;
  if (!fs::exists(left) || fs::file_size(left, none) == 0) return std::nullopt;
  auto reader = mcap::Reader::open(left);
  EXPECT_TRUE(reader) << to_string(reader.errors());
  if (!reader) return std::nullopt;
  const Ticks there = ticks_of(**reader);
  EXPECT_TRUE(there.without_gaps);
  const auto recovery = mcap::recover(left, saved);
  if (there.count == 0 && !recovery) return std::nullopt;  // not even the first record is complete
  EXPECT_TRUE(recovery) << to_string(recovery.errors());
  if (!recovery) return std::nullopt;
  TraceCheck content;
  mcap::ExamineOptions options;
  options.content = &content;
  const auto examination = mcap::examine(saved, options);
  EXPECT_TRUE(examination);
  for (const mcap::Finding& finding : examination->findings.list())
    EXPECT_EQ(finding.severity, Severity::note) << finding.message;
  auto again = mcap::Reader::open(saved);
  EXPECT_TRUE(again && (*again)->damage().empty());
  EXPECT_EQ(ticks_of(**again).last, there.last);
  return there.last;
}

}  // namespace rehearse::test
