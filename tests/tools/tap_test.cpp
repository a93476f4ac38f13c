// The verb tap: recordings of robots' loops, their replays, and what is left of them after a kill. REHEARSE_WHOLE_TAP=1
// in the environment makes as many kills and ticks as the nightly run; it takes half an hour.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/tap_ring.h>
#include <rehearse/trace.h>
#include <signal.h>
#include <sys/stat.h>
#include <rehearse/tap.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "command.h"

namespace rehearse::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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

/// How often a row is repeated by day and at night.
int times(int by_day, int at_night) { return std::getenv("REHEARSE_WHOLE_TAP") != nullptr ? at_night : by_day; }

void rest(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

/// The number in the first 8 bytes of a file.
std::uint64_t number_in(const fs::path& file) {
  std::uint64_t number = 0;
  std::ifstream(file, std::ios::binary).read(reinterpret_cast<char*>(&number), sizeof number);
  return number;
}

/// [kB]; 0: the process has ended.
long peak_memory_of(pid_t process) {
  std::ifstream status(fmt::format("/proc/{}/status", process));
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stol(line.substr(6));
  return 0;
}

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
  /// A flight of a robot that is the simulation in a recording. `noise`: of its velocities [rad/s].
  void fly(const std::string& simulation, const std::string& flight, int joints, double noise) const {
    const auto trace = Trace::load(folder() / simulation);
    ASSERT_TRUE(trace);
    const std::string model = (folder() / "walker.urdf").string();
    rehearse_tap_options options{};
    options.model = model.c_str();
    options.controller = "Walk";
    Tap loop(tap_.c_str(), options);
    ASSERT_TRUE(loop.is_open()) << Tap::error();
    std::vector<std::string> names;
    std::vector<std::vector<double>> numbers, imu, efforts;
    for (int i = 0; i < joints; ++i) names.push_back(fmt::format("J{}", i));
    for (const char* quantity : {"q", "dq"})
      for (const std::string& name : names) numbers.push_back(trace->values("Walker/" + name + "/" + quantity));
    for (const char* quantity : {"angular_velocity", "linear_acceleration"})
      for (const char* axis : {"x", "y", "z"})
        imu.push_back(trace->values(fmt::format("Walker/Imu/{}/{}", quantity, axis)));
    for (const std::string& name : names) efforts.push_back(trace->values("Walker/Walk/output/" + name + "/u"));
    const int of_joints = loop.joints("Walker", names, REHEARSE_TAP_Q | REHEARSE_TAP_DQ),
              of_imu = loop.imu("Walker", "Imu"), of_efforts = loop.commands("Walker", names, REHEARSE_TAP_U);
    std::minstd_rand random(82);
    std::normal_distribution<double> normal(0.0, 1.0);
    const auto row = [](const std::vector<std::vector<double>>& columns, std::size_t tick) {
      std::vector<double> all;
      for (const std::vector<double>& column : columns) all.push_back(column[tick]);
      return all;
    };
    constexpr std::size_t late = 1;  // the IMU measures after the first step
    for (std::size_t tick = 0; tick < efforts[0].size(); ++tick) {
      std::vector<double> measured = row(numbers, tick);
      for (std::size_t i = names.size(); i < measured.size(); ++i) measured[i] += noise * normal(random);
      Tap::Tick recorded = loop.tick(static_cast<std::int64_t>(tick) * 1'000'000);
      recorded.write(of_joints, measured);
      if (tick >= late) recorded.write(of_imu, row(imu, tick - late));
      recorded.write(of_efforts, row(efforts, tick));
    }
    loop = Tap();
    EXPECT_EQ(rehearse({"tap", tap_, "--recover", "-o", flight}).status, 0);
  }
  /// Copies a recording, with other facts of its loop.
  void restate(const std::string& from, const std::string& to, const mcap::StringMap& facts) const {
    const auto reader = mcap::Reader::open(folder() / from);
    auto writer = mcap::Writer::create(folder() / to);
    ASSERT_TRUE(reader && writer);
    for (const mcap::Attachment& one : (*reader)->attachments())
      ASSERT_TRUE((*writer)->add_attachment(one.name, one.media_type, one.data));
    for (mcap::Metadata entry : (*reader)->metadata()) {
      if (entry.name == "rehearse.flight")
        for (const auto& [fact, value] : facts) entry.values[fact] = value;
      ASSERT_TRUE((*writer)->add_metadata(entry.name, entry.values));
    }
    std::map<std::uint16_t, std::uint16_t> ids;
    for (const auto& [id, channel] : (*reader)->channels()) {
      const mcap::Schema* schema = (*reader)->schema_of(channel);
      ASSERT_NE(schema, nullptr);
      ids[id] = (*writer)->add_channel((*writer)->add_schema(schema->name, schema->encoding, schema->data),
                                       channel.topic, channel.message_encoding, channel.metadata);
    }
    const auto copied = (*reader)->for_each_message([&](const mcap::Message& message) {
      return static_cast<bool>((*writer)->write(ids.at(message.channel->id), message.log_time, message.publish_time,
                                                message.data, message.sequence));
    });
    ASSERT_TRUE(copied);
    ASSERT_TRUE((*writer)->close());
  }

 private:
  std::string tap_;
};

TEST_F(TapVerb, RecordsLoopsThatReplayBitForBit) {
  struct Row {
    const char* name;
    fs::path program;
    int joints;
    std::vector<std::string> words;
    const char* guest;
  };
  const Row rows[] = {{"c", LOOP, 12, {}, GUEST},
                      {"cpp17", LOOP_CPP17, 12, {}, GUEST},
                      {"cpp20", LOOP_CPP20, 12, {}, GUEST},
                      {"half", LOOP, 12, {"half"}, GUEST},
                      {"late", LOOP, 12, {"late"}, GUEST},
                      {"fast", LOOP, 12, {"fast"}, GUEST},
                      {"joints", LOOP, 60, {}, GUEST},
                      {"variables", LOOP, 12, {"variables"}, GUEST_WITH_VARIABLES},
                      {"images", LOOP, 12, {"images"}, GUEST},
                      {"bench", BENCH_LOOP, 12, {GUEST}, GUEST}};  // a library in the loop
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    const std::string file = std::string(row.name) + ".mcap";
    EXPECT_EQ(record(file, 2000, row.joints, row.words, {}, row.program), 0) << said();
    EXPECT_THAT(said(), HasSubstr("the loop closed its tap; 2000 ticks recorded in " + file));
    const Outcome replayed = replay(file, row.guest);
    EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
    EXPECT_THAT(replayed.out, HasSubstr(fmt::format("equal bit for bit: 2000 ticks, {} commanded numbers",
                                                    2000 * row.joints + 2000)));
    EXPECT_THAT(replayed.out, HasSubstr("computed with the functions of the robot's libm"));
    EXPECT_EQ(replayed.err, "");
    for (const char* guest : {GUEST_WITH_GAIN, GUEST_WITH_SIGN, GUEST_LATE}) {
      const Outcome changed = rehearse({"replay", file, "--controller", guest, "--json"});
      EXPECT_EQ(changed.status, 1) << guest << changed.err;
      EXPECT_EQ(changed.json()["first"]["tick"], 0) << guest;
      EXPECT_EQ(changed.json()["beyond"]["tick"], 0) << guest;
    }
  }
  EXPECT_FALSE(fs::exists(ring()));
  EXPECT_THAT(done({"cat", "images.mcap", "--topics", "/flight/images"}).out, HasSubstr("frames/000010.png"));
}

/// A robot without the variants of sin and exp that this processor has: the replay takes those of the robot.
TEST_F(TapVerb, ComputesWithTheMathematicsOfTheRobot) {
  const std::string tunables = "glibc.cpu.hwcaps=-AVX2_Usable,-AVX2,-FMA_Usable,-FMA,-FMA4_Usable,-FMA4";
  Beside recorder(folder(), command, {"tap", tap(), "-o", "flight.mcap"}, "recorder");
  EXPECT_EQ(run(LOOP, loop_words(2000, 12), "GLIBC_TUNABLES=" + tunables).status, 0);
  EXPECT_EQ(recorder.wait(), 0) << said();
  const Outcome replayed = replay("flight.mcap", GUEST);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("computed with the functions of the robot's libm"));
  EXPECT_THAT(replayed.out, HasSubstr("equal bit for bit: 2000 ticks"));
}

/// The recording of a robot whose processor this machine hasn't.
TEST_F(TapVerb, IsWithinToleranceWhereTheMathematicsIsAnother) {
  EXPECT_EQ(record("here.mcap", 2000, 12), 0) << said();
  restate("here.mcap", "other.mcap", {{"processor_flags", "asimd"}, {"architecture", "aarch64"}});
  const Outcome replayed = replay("other.mcap", GUEST_OF_OTHER_MATHEMATICS);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("within its tolerance: "));
  EXPECT_THAT(replayed.out, HasSubstr("the loop's machine was aarch64, and here "));
  EXPECT_EQ(replay("other.mcap", GUEST_WITH_GAIN).status, 1);
  EXPECT_EQ(replay("here.mcap", GUEST_OF_OTHER_MATHEMATICS).status, 1);  // no other mathematics excuses it
}

/// Two loops at the same time, each with its tap and its recorder.
TEST_F(TapVerb, RecordsTwoLoopsOfOneRobotBesideEachOther) {
  const std::string other = tap() + "-arm";
  Beside first(folder(), command, {"tap", tap(), "-o", "walk.mcap"}, "recorder");
  Beside second(folder(), command, {"tap", other, "-o", "arm.mcap"}, "second");
  std::vector<std::string> words = loop_words(500, 12, {"paced", "half"});
  words[0] = other;
  Beside loop(folder(), LOOP, words, "loop");
  EXPECT_EQ(run(LOOP, loop_words(1000, 12, {"paced"})).status, 0);
  EXPECT_EQ(loop.wait(), 0);
  EXPECT_EQ(first.wait(), 0);
  EXPECT_EQ(second.wait(), 0);
  EXPECT_EQ(replay("walk.mcap", GUEST).status, 0);
  EXPECT_EQ(replay("arm.mcap", GUEST).status, 0);
}

TEST_F(TapVerb, IsStartedByTheTap) {
  const std::string path = "PATH=" + command.parent_path().string() + ":$PATH";
  EXPECT_EQ(run(LOOP, loop_words(500, 3, {"paced", "spawn=1"}), path).status, 0);
  for (int i = 0; i < 500 && fs::exists(ring()); ++i) rest(10);
  EXPECT_FALSE(fs::exists(ring()));
  EXPECT_EQ(ticks_in(tap() + ".mcap").size(), 500u);
  EXPECT_EQ(replay(tap() + ".mcap", GUEST).status, 0);
}

TEST_F(TapVerb, WritesRecordingsThatAllVerbsRead) {
  EXPECT_EQ(record("flight.mcap", 500, 3, {"variables", "mark=100"}), 0);
  EXPECT_THAT(done({"info", "flight.mcap"}).out, HasSubstr("/Walker/Walk/output/joints"));
  EXPECT_THAT(done({"info", "flight.mcap"}).out, HasSubstr("memory_locked"));
  EXPECT_THAT(done({"cat", "flight.mcap", "--topics", "/events"}).out, HasSubstr("mark: a touch"));
  EXPECT_THAT(done({"diff", "flight.mcap", "flight.mcap"}).out, HasSubstr("equal"));
  done({"filter", "flight.mcap", "--topics", "/Walker/*", "-o", "part.mcap"});
  done({"recover", "flight.mcap", "-o", "whole.mcap"});
  EXPECT_EQ(replay("whole.mcap", GUEST_WITH_VARIABLES).status, 0);
  EXPECT_THAT(done({"replay", "flight.mcap", "--controller", GUEST_WITH_VARIABLES, "--tick", "7"}).out,
              HasSubstr("J0"));
  done({"report", "flight.mcap", "-o", "report.html"});
  EXPECT_EQ(rehearse({"doctor", "flight.mcap"}).status, 0) << rehearse({"doctor", "flight.mcap"}).out;
  const auto trace = Trace::load(folder() / "flight.mcap");
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->values("Walker/J2/q").size(), 500u);
  EXPECT_EQ(trace->values("Walker/Imu/angular_velocity/x").size(), 500u);
  EXPECT_EQ(trace->last("flight/dropped"), 0.0);
  const mcap::StringMap* flight = trace->find_metadata("rehearse.flight");
  ASSERT_NE(flight, nullptr);
  EXPECT_EQ(flight->at("gain"), "40");
}

TEST_F(TapVerb, WritesAScenarioThatBeginsAsTheFlight) {
  EXPECT_EQ(record("flight.mcap", 100, 3), 0);
  fs::create_directory(folder() / "scenarios");
  const std::vector<std::string> words{"replay", "flight.mcap", "--controller",
                                       GUEST,    "--scenario",  "scenarios/friday.yaml"};
  EXPECT_EQ(rehearse(words).status, 0);
  const std::string text = read_file(folder() / "scenarios/friday.yaml");
  EXPECT_THAT(text, HasSubstr(fmt::format("\"J1\": {}", 0.3 * std::sin(1.0))));
  EXPECT_THAT(text, HasSubstr("duration: 0.1 "));
  EXPECT_EQ(read_file(folder() / "scenarios/walker.urdf"), read_file(folder() / "walker.urdf"));
  EXPECT_EQ(rehearse({"record", "scenarios/friday.yaml", "-o", "run.mcap"}).status, 0);
  EXPECT_NEAR(Trace::load(folder() / "run.mcap")->values("Walker/J1/q")[0], 0.3 * std::sin(1.0), 1e-12);
  const Outcome again = rehearse(words);
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("there is a file scenarios/friday.yaml already"));
}

/// The files of a flight in a folder are one recording for every verb.
TEST_F(TapVerb, ReadsTheFilesOfAFolderAsOneFlight) {
  fs::create_directory(folder() / "friday");
  EXPECT_EQ(record("friday/part.mcap", 5000, 60, {"paced"}, {"--split", "1"}), 0) << said();
  EXPECT_GE(std::distance(fs::directory_iterator(folder() / "friday"), {}), 3) << said();
  const Outcome replayed = replay("friday", GUEST);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("equal bit for bit: 5000 ticks"));
  EXPECT_THAT(done({"info", "friday"}).out, HasSubstr("/Walker/Walk/output/joints"));
  EXPECT_EQ(done({"diff", "friday", "friday"}).status, 0);
}

/// A robot that is a simulation, measured with noise; then its model is changed.
TEST_F(TapVerb, FindsTheTickFromWhichAWorldDiffersFromTheRobot) {
  robot(3);
  const std::string scenario = fmt::format(
      "rehearse: 1\nname: Arm\nduration: 1.0\nbodies:\n  - name: Walker\n    model: walker.urdf\n    fixed: true\n"
      "    joints: {{J0: 0.3, J2: -0.2}}\n    controllers: [{{name: Walk, library: {}, delay: false}}]\n",
      GUEST);
  write("arm.yaml", scenario);
  ASSERT_EQ(rehearse({"record", "arm.yaml", "-o", "robot.mcap"}).status, 0);
  for (const double noise : {0.0, 1e-3}) {
    SCOPED_TRACE(noise);
    const std::string flight = fmt::format("flight{}.mcap", noise);
    fly("robot.mcap", flight, 3, noise);
    const Outcome same = rehearse({"check", "arm.yaml", "--flight", flight});
    EXPECT_EQ(same.status, noise == 0.0 ? 0 : 1) << same.out << same.err;  // with noise it isn't the robot's controller
    if (noise == 0.0) {
      EXPECT_THAT(same.out, HasSubstr("controller: equal bit for bit"));
    }
    EXPECT_THAT(same.out, HasSubstr("plant: the world agrees with the robot in 99"));

    const std::string model = read_file(folder() / "walker.urdf");
    std::string heavier = model;
    const std::string inertia = "iyy=\"0.1\"";
    heavier.replace(heavier.rfind(inertia), inertia.size(), "iyy=\"0.12\"");  // of the last link
    write("walker.urdf", heavier);
    const Outcome other = rehearse({"check", "arm.yaml", "--flight", flight});
    EXPECT_EQ(other.status, 1) << other.out << other.err;
    EXPECT_THAT(other.out,
                testing::ContainsRegex("plant: the world differs from the robot from tick [0-9]+ .*: J[0-2]"));
    write("walker.urdf", model);
  }
  std::string free = scenario, model = read_file(folder() / "walker.urdf");
  free.erase(free.find("    fixed: true\n"), 16);
  free.replace(free.find("walker.urdf"), 11, "free.urdf");
  write("free.yaml", free);
  model.replace(model.find("<link name=\"BASE\"/>"), 19,
                "<link name=\"BASE\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" "
                "iyz=\"0\" izz=\"1\"/></inertial></link>");
  write("free.urdf", model);
  const Outcome undecided = rehearse({"check", "free.yaml", "--flight", "flight0.mcap"});
  EXPECT_EQ(undecided.status, 4) << undecided.out << undecided.err;
  EXPECT_THAT(undecided.out, HasSubstr("plant: undecided: state missing: the base of 'Walker' isn't fixed"));
  EXPECT_EQ(rehearse({"check", "arm.yaml", "--flight", "robot.mcap"}).status, 2);
  EXPECT_EQ(rehearse({"check", "arm.yaml", "--flight", "flight0.mcap", "--json"}).status, 2);
}

TEST_F(TapVerb, RefusesAControllerThatReadsWhatTheTapLacks) {
  EXPECT_EQ(record("flight.mcap", 10, 3), 0);
  const Outcome replayed = replay("flight.mcap", GUEST_THAT_READS_EFFORTS);
  EXPECT_EQ(replayed.status, 2);
  EXPECT_THAT(replayed.err, HasSubstr("reads u of link 'LINK0', which was not recorded"));
}

/// The loop never sleeps, so that it is killed at any instruction.
TEST_F(TapVerb, KeepsAllEndedTicksOfALoopThatIsKilled) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "killed.mcap", "--again"}, "recorder");
  const std::vector<std::string> words = loop_words(1'000'000'000, 3);
  std::minstd_rand random(82);
  const int kills = times(20, 1000);
  std::size_t all = 0;
  for (int i = 0; i < kills; ++i) {
    const fs::path counter = write("counter", std::string(8, '\0'));
    std::vector<std::string> of_this = words;
    of_this.push_back("counter=" + counter.string());
    Beside loop(folder(), LOOP, of_this, "loop");
    while (number_in(counter) == 0) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
    loop.kill(SIGKILL);
    EXPECT_EQ(loop.wait(), 128 + SIGKILL);
    const std::string file = "killed.mcap";  // it is removed each time
    const auto reports = [&] {
      const std::string out = read_file(folder() / "recorder.out");
      return std::ranges::count(out, '\n');
    };
    for (int waited = 0; waited < 2000 && reports() <= i; ++waited) rest(10);
    const std::uint64_t ended = number_in(counter);
    const std::set<std::int64_t> ticks = ticks_in(file);
    ASSERT_GE(ticks.size(), ended) << said();
    ASSERT_LE(ticks.size(), ended + 1);
    ASSERT_EQ(*ticks.rbegin() + 1, static_cast<std::int64_t>(ticks.size()));
    all += ticks.size();
    fs::remove(folder() / file);
  }
  recorder.kill(SIGTERM);
  EXPECT_EQ(recorder.wait(), 3);
  std::printf("%d kills of the loop, %zu ticks, all there\n", kills, all);
}

/// Recorders are killed, one after the other, and a reader looks into the ring meanwhile.
TEST_F(TapVerb, LosesNothingWhenTheRecorderIsKilled) {
  const fs::path counter = write("counter", std::string(8, '\0'));
  const int kills = times(6, 200);
  const std::vector<std::string> words{"paced", "longest", "megabytes=8", "counter=" + counter.string()};
  Beside loop(folder(), LOOP, loop_words(1500 * (kills + 1), 3, words), "loop");
  std::minstd_rand random(82);
  for (int i = 0; i < kills; ++i) {
    Beside recorder(folder(), command, {"tap", tap(), "-o", fmt::format("part{}.mcap", i)}, "recorder");
    rest(static_cast<int>(random() % 2000));
    if (i % 10 == 0) {
      EXPECT_EQ(rehearse({"tap", tap(), "--recover", "-o", fmt::format("look{}.mcap", i)}).status, 0);
    }
    recorder.kill(SIGKILL);
    recorder.wait();
  }
  Beside recorder(folder(), command, {"tap", tap(), "-o", "last.mcap"}, "recorder");
  EXPECT_EQ(loop.wait(), 0);
  EXPECT_EQ(recorder.wait(), 0) << said();
  const std::uint64_t ended = number_in(counter);
  std::set<std::int64_t> ticks = ticks_in("last.mcap");
  for (int i = 0; i < kills; ++i) ticks.merge(ticks_in(fmt::format("part{}.mcap", i)));
  EXPECT_EQ(ticks.size(), ended);
  EXPECT_THAT(read_file(folder() / "loop.out"), HasSubstr("0\nlongest"));
  std::printf("%d kills of the recorder, %zu ticks, all there; from begin to end: %s\n", kills, ticks.size(),
              read_file(folder() / "loop.out").c_str());
}

/// A disk of 100 to 400 kB for each recorder.
TEST_F(TapVerb, LosesNothingWhenTheDiskIsFull) {
  if (std::system("unshare -m mount -t tmpfs -o size=64k none /mnt 2> /dev/null") != 0)
    GTEST_SKIP() << "this process may not mount a small disk";
  const fs::path counter = write("counter", std::string(8, '\0'));
  const int rounds = times(2, 50);
  write("fill.sh", "mkdir -p disk && mount -t tmpfs -o size=$1k none disk && " + command.string() +
                       " tap $2 -o disk/flight.mcap --keep-free 0; status=$?; cp disk/flight.mcap $3; exit $status\n");
  Beside loop(folder(), LOOP,
              loop_words(1'000'000'000, 12, {"paced", "fast", "longest", "counter=" + counter.string()}), "loop");
  std::minstd_rand random(82);
  for (int i = 0; i < rounds; ++i) {
    const Outcome filled = run("/usr/bin/unshare", {"-m", "sh", "fill.sh", std::to_string(100 + random() % 300), tap(),
                                                    fmt::format("part{}.mcap", i)});
    EXPECT_EQ(filled.status, 2) << filled.out << filled.err;
    EXPECT_THAT(filled.err, HasSubstr("No space left on device"));
  }
  Beside recorder(folder(), command, {"tap", tap(), "-o", "last.mcap"}, "recorder");
  rest(1500);
  loop.kill(SIGKILL);
  loop.wait();
  EXPECT_EQ(recorder.wait(), 3) << said();
  const std::uint64_t ended = number_in(counter);
  std::set<std::int64_t> ticks = ticks_in("last.mcap");
  for (int i = 0; i < rounds; ++i) ticks.merge(ticks_in(fmt::format("part{}.mcap", i)));
  EXPECT_GE(ticks.size(), ended);
  EXPECT_LE(ticks.size(), ended + 1);
  std::printf("%d full disks, %zu ticks, all there\n", rounds, ticks.size());
}

/// A long flight in eight files: the recorder's memory doesn't grow, and merged they are one recording.
TEST_F(TapVerb, NeedsNoMoreMemoryForALongFlight) {
  const fs::path counter = write("counter", std::string(8, '\0'));
  const std::int64_t ticks = times(40'000, 2'000'000);
  const int split = times(1, 20), files_at_least = times(3, 8), growth = times(12'000, 4'000);
  Beside recorder(folder(), command, {"tap", tap(), "-o", "part.mcap", "--split", std::to_string(split)}, "recorder");
  Beside loop(folder(), LOOP, loop_words(static_cast<int>(ticks), 12, {"paced", "fast", "counter=" + counter.string()}),
              "loop");
  std::vector<long> memory;
  for (const std::int64_t at : {ticks / 2, ticks - ticks / 100}) {
    while (number_in(counter) < static_cast<std::uint64_t>(at)) rest(20);
    memory.push_back(peak_memory_of(recorder.process()));
  }
  EXPECT_EQ(loop.wait(), 0);
  EXPECT_EQ(recorder.wait(), 0) << said();
  EXPECT_GT(memory[0], 0);
  EXPECT_LT(memory[1], memory[0] + growth) << "[kB]";
  std::vector<std::string> merge{"merge"};
  for (int i = 0; exists(fmt::format("part_{}.mcap", i)); ++i) merge.push_back(fmt::format("part_{}.mcap", i));
  const std::size_t files = merge.size() - 1;
  EXPECT_GE(files, static_cast<std::size_t>(files_at_least)) << said();
  merge.insert(merge.end(), {"-o", "whole.mcap"});
  EXPECT_EQ(rehearse(merge).status, 0);
  const Outcome replayed = replay("whole.mcap", GUEST);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr(fmt::format("equal bit for bit: {} ticks", ticks)));
  const long all = memory_of({"replay", "whole.mcap", "--controller", GUEST});
  const long half = memory_of({"replay", "whole.mcap", "--controller", GUEST, "--until",
                               fmt::format("{}", 0.5e-4 * static_cast<double>(ticks))});
  EXPECT_LT(all, half + 8'000) << "[kB]";
  std::printf("%lld ticks in %zu files; recorder's memory %ld kB at half of them, %ld kB at the end; replay %ld, %ld\n",
              static_cast<long long>(ticks), files, memory[0], memory[1], half, all);
}

TEST_F(TapVerb, OfARingSavesWhatADeadLoopLeft) {
  EXPECT_EQ(run(LOOP, loop_words(5000, 3, {"crash=3000", "megabytes=8"})).status, 128 + SIGKILL);
  ASSERT_TRUE(fs::exists(ring()));
  EXPECT_EQ(run(LOOP, loop_words(10, 3)).status, 1);
  const Outcome saved = rehearse({"tap", tap(), "--recover", "-o", "crash.mcap"});
  EXPECT_EQ(saved.status, 0) << saved.err;
  EXPECT_THAT(saved.out, HasSubstr("3000 ticks recorded in crash.mcap"));
  EXPECT_FALSE(fs::exists(ring()));
  EXPECT_EQ(replay("crash.mcap", GUEST).status, 0) << replay("crash.mcap", GUEST).err;

  EXPECT_EQ(run(LOOP, loop_words(5000, 3, {"crash=3000", "megabytes=8"})).status, 128 + SIGKILL);
  rehearse({"tap", tap(), "--recover", "--last", "0.5", "-o", "last.mcap"});
  const std::set<std::int64_t> ticks = ticks_in("last.mcap");
  EXPECT_EQ(ticks.size(), 500u);
  EXPECT_EQ(*ticks.rbegin(), 2999);
}

TEST_F(TapVerb, LetsALoopRestartWithoutWaiting) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "first.mcap"}, "recorder");
  EXPECT_EQ(run(LOOP, loop_words(1000, 3, {"paced", "crash=900"})).status, 128 + SIGKILL);
  rest(50);
  EXPECT_EQ(run(LOOP, loop_words(200, 3)).status, 0);
  EXPECT_EQ(recorder.wait(), 3) << said();
  EXPECT_EQ(ticks_in("first.mcap").size(), 900u);
  EXPECT_EQ(rehearse({"tap", tap(), "-o", "second.mcap"}).status, 0);
  EXPECT_EQ(replay("second.mcap", GUEST).status, 0);
}

TEST_F(TapVerb, WritesABlackBoxWhenItIsAskedFor) {
  const std::vector<std::string> options{"--black-box", "--last", "0.2"};
  EXPECT_EQ(record("quiet.mcap", 400, 3, {"paced"}, options), 0) << said();
  EXPECT_THAT(said(), HasSubstr("nothing asked for the black box"));
  EXPECT_FALSE(exists("quiet.mcap"));

  EXPECT_EQ(record("mark.mcap", 800, 3, {"paced", "mark=500"}, options), 0) << said();
  EXPECT_THAT(said(), HasSubstr("the loop set a mark"));
  EXPECT_EQ(ticks_in("mark.mcap").size(), 200u);
  EXPECT_THAT(rehearse({"cat", "mark.mcap", "--topics", "/events"}).out, HasSubstr("mark: a touch"));

  EXPECT_EQ(record("beyond.mcap", 800, 3, {"paced", "beyond=500"}, options), 0) << said();
  EXPECT_THAT(said(), HasSubstr("the effort 1e+06 of joint J0 is beyond the model's 1000"));
  EXPECT_EQ(*ticks_in("beyond.mcap").rbegin(), 500);

  Beside recorder(folder(), command, {"tap", tap(), "-o", "dead.mcap", "--black-box", "--last", "0.2"}, "recorder");
  EXPECT_EQ(run(LOOP, loop_words(5000, 3, {"paced", "crash=600"})).status, 128 + SIGKILL);
  EXPECT_EQ(recorder.wait(), 3) << said();
  const std::set<std::int64_t> ticks = ticks_in("dead.mcap");
  EXPECT_EQ(ticks.size(), 200u);
  EXPECT_EQ(*ticks.rbegin(), 599);
}

TEST_F(TapVerb, NeverReplacesAFileAndEndsWholeWhenTheDiskIsFull) {
  write("flight.mcap", "a file of the user");
  EXPECT_EQ(record("flight.mcap", 10, 3), 0);
  EXPECT_EQ(read_file(folder() / "flight.mcap"), "a file of the user");
  EXPECT_EQ(ticks_in("flight-2.mcap").size(), 10u);

  Beside recorder(folder(), command, {"tap", tap(), "-o", "full.mcap", "--keep-free", "900000000"}, "recorder");
  Beside loop(folder(), LOOP, loop_words(3000, 3, {"paced"}), "loop");
  EXPECT_EQ(recorder.wait(), 2) << said();
  EXPECT_THAT(said(), HasSubstr("the disk is nearly full"));
  EXPECT_EQ(rehearse({"doctor", "full.mcap"}).status, 0) << rehearse({"doctor", "full.mcap"}).out;
  EXPECT_EQ(loop.wait(), 0);
}

TEST_F(TapVerb, RefusesASecondRecorderForeignRingsAndOtherVersions) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "one.mcap"}, "recorder");
  Beside loop(folder(), LOOP, loop_words(100'000, 3, {"paced"}), "loop");
  for (int i = 0; i < 500 && !exists("one.mcap"); ++i) rest(10);
  const Outcome second = rehearse({"tap", tap(), "-o", "two.mcap"});
  EXPECT_EQ(second.status, 2);
  EXPECT_THAT(second.err, HasSubstr("records this tap already"));
  recorder.kill(SIGTERM);
  EXPECT_EQ(recorder.wait(), 0) << said();
  EXPECT_THAT(said(), HasSubstr("the recording was stopped"));
  EXPECT_TRUE(fs::exists(ring()));  // its loop goes on
  loop.kill(SIGKILL);
  loop.wait();

  std::string bytes = read_file(ring());
  const auto refused = [&](std::size_t at, char byte) {
    std::string other = bytes;
    other[at] = byte;
    write("ring", other);
    chmod((folder() / "ring").c_str(), 0600);
    return rehearse({"tap", "./ring", "--recover", "-o", "ring.mcap"}).err;
  };
  EXPECT_THAT(refused(0, 'x'), HasSubstr("it is no ring of a tap"));
  EXPECT_THAT(refused(offsetof(tap_ring_head, version), 2), HasSubstr("the ring is of version 2"));
  EXPECT_THAT(refused(offsetof(tap_ring_head, time_step) + 3, 7), HasSubstr("the head of the ring is damaged"));
  EXPECT_THAT(refused(tap_definitions_place + 1, 'x'), HasSubstr("the series of the ring are damaged"));
  bytes.resize(100);
  EXPECT_THAT(refused(50, 'x'), HasSubstr("it is no ring of a tap"));
}

TEST_F(TapVerb, RecordsALoopWithoutAModelAsALog) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "bare.mcap"}, "recorder");
  EXPECT_EQ(run(LOOP, {tap(), "", "100", "3"}).status, 0);
  EXPECT_EQ(recorder.wait(), 0) << said();
  EXPECT_EQ(ticks_in("bare.mcap").size(), 100u);
  const Outcome replayed = replay("bare.mcap", GUEST);
  EXPECT_EQ(replayed.status, 2);
}

}  // namespace
}  // namespace rehearse::test
