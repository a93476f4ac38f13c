// Loops of robots beside their recorder.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <rehearse/trace.h>
#include <signal.h>

#include <chrono>
#include <cstdio>
#include <set>
#include <thread>

#include "../command.h"

namespace rehearse::test {

/// A program that runs beside the test.
class Beside {
 public:
  Beside(const fs::path& folder, const fs::path& program, const std::vector<std::string>& arguments,
         const std::string& output) {
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    process_ = fork();
    if (process_ != 0) return;
    const bool is_ready = chdir(folder.c_str()) == 0 && freopen((output + ".out").c_str(), "w", stdout) != nullptr &&
                          freopen((output + ".err").c_str(), "w", stderr) != nullptr;
    if (is_ready) execv(program.c_str(), pointers.data());
    _exit(127);
  }
  ~Beside() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    wait();
  }
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;

  pid_t process() const { return process_; }
  void kill(int number) const { ::kill(process_, number); }
  /// Its exit status, or 128 and the signal's number.
  int wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = 0;
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }

 private:
  pid_t process_ = 0;
};

inline void rest(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

/// A tap of this process alone, loops that use it, and their recordings.
class TapVerb : public Command {
 protected:
  TapVerb() : tap_(fmt::format("verb-{}", getpid())) { clear(); }
  ~TapVerb() override { clear(); }

  fs::path ring() const { return fmt::format("/dev/shm/rehearse-tap-{}-{}", geteuid(), tap_); }
  void clear() const {
    fs::remove(ring());
    fs::remove(ring().string() + ".before");
  }

  /// A chain of so many joints, J0, J1, ..., with an IMU.
  fs::path robot(int joints) const {
    std::string text = "<robot name=\"Walker\"><link name=\"BASE\"/>";
    std::string parent = "BASE";
    for (int i = 0; i < joints; ++i) {
      const std::string link = fmt::format("LINK{}", i);
      text += fmt::format(
          "<link name=\"{0}\"><inertial><mass value=\"1\"/><inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" "
          "iyz=\"0\" izz=\"0.1\"/></inertial></link><joint name=\"J{1}\" type=\"revolute\"><parent link=\"{2}\"/>"
          "<child link=\"{0}\"/><axis xyz=\"0 1 0\"/><limit lower=\"-3\" upper=\"3\" effort=\"1000\" velocity=\"10\"/>"
          "</joint>",
          link, i, parent);
      parent = link;
    }
    text += "<gazebo reference=\"LINK0\"><sensor name=\"Imu\" type=\"imu\"/></gazebo></robot>";
    return write("walker.urdf", text);
  }
  std::vector<std::string> loop_words(int ticks, int joints, std::vector<std::string> words = {}) const {
    std::vector<std::string> all{tap_, robot(joints).string(), std::to_string(ticks), std::to_string(joints)};
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }
  /// Runs a loop to its end, and the recorder beside it. Returns the recorder's status.
  int record(const std::string& file, int ticks, int joints, const std::vector<std::string>& words = {},
             const std::vector<std::string>& options = {}, const fs::path& program = LOOP) {
    std::vector<std::string> all{"tap", tap_, "-o", file};
    all.insert(all.end(), options.begin(), options.end());
    Beside recorder(folder(), command, all, "recorder");
    EXPECT_EQ(run(program, loop_words(ticks, joints, words)).status, 0);
    return recorder.wait();
  }
  std::string said() const { return read_file(folder() / "recorder.out") + read_file(folder() / "recorder.err"); }
  /// The ticks in a file, also in one without an end.
  std::set<std::int64_t> ticks_in(const std::string& file) const {
    std::set<std::int64_t> ticks;
    const auto trace = Trace::load(folder() / file, Trace::Damage::tolerate);
    if (!trace || !trace->find_series("tick")) return ticks;
    for (const std::uint64_t tick : trace->integers("tick")) ticks.insert(static_cast<std::int64_t>(tick));
    return ticks;
  }
  /// The replay of a file by a guest.
  Outcome replay(const std::string& file, const std::string& guest) const {
    return rehearse({"replay", file, "--controller", guest});
  }
  const std::string& tap() const { return tap_; }

 private:
  std::string tap_;
};

}  // namespace rehearse::test
