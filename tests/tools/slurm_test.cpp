// Campaigns as array jobs of a real Slurm: two nodes on this machine, of which one is killed. Skipped if Slurm isn't
// installed.
#include "command.h"
#include "falling_box.h"

#include <gmock/gmock.h>

#include <chrono>
#include <functional>
#include <map>
#include <thread>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

constexpr int bad_input = 2;
constexpr auto patience = std::chrono::seconds(120);

class SlurmSweep : public Command {
 protected:
  void SetUp() override {
    if (std::system("PATH=$PATH:/usr/sbin command -v slurmctld > /dev/null && command -v sbatch > /dev/null") != 0)
      GTEST_SKIP() << "Slurm isn't installed";
    std::string name = (fs::path(::testing::TempDir()) / "slurmXXXXXX").string();  // sockets have short paths
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    place_ = name;
    ASSERT_EQ(cluster({"start", place_.string(), "MaxArraySize=5"}), 0);
  }
  void TearDown() override {
    if (place_.empty()) return;
    EXPECT_EQ(cluster({"stop", place_.string()}), 0);
    fs::remove_all(place_);
  }

  int cluster(const std::vector<std::string>& arguments) const { return run(SLURM_CLUSTER, arguments).status; }
  Outcome sweep(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "sweep");
    return rehearse(arguments, "SLURM_CONF=" + (place_ / "slurm.conf").string());
  }
  nlohmann::json status() const { return sweep({"status", "run", "--json"}).json(); }
  bool waits_until(const std::function<bool()>& holds) const {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!holds() && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    return holds();
  }
  bool is_queue_empty() const {
    const auto queue = status()["slurm"];
    return queue["running"] == 0 && queue["waiting"] == 0;
  }
  /// How many result lines each run of a case has; second runs are runs of their own.
  std::map<std::string, int> runs() const {
    std::map<std::string, int> runs;
    for (const auto& entry : fs::directory_iterator(folder() / "run")) {
      if (entry.path().extension() != ".jsonl") continue;
      std::istringstream lines(read_file(entry.path()));
      for (std::string line; std::getline(lines, line);) {
        const auto result = nlohmann::json::parse(line);
        ++runs[std::to_string(result["case"].get<int>()) + (result.value("again", false) ? " again" : "")];
      }
    }
    return runs;
  }
  std::string results(const std::string& campaign) const { return read_file(folder() / campaign / "results.csv"); }

  /// A box that falls 0.4 s; the lower ones reach the floor.
  fs::path box() const { return write("box.yaml", falling_box("0.4", "above: 0.12, at: end", "1.2")); }

  fs::path place_;
};

TEST_F(SlurmSweep, LosesAndDoublesNothingWhenANodeIsKilled) {
  box();
  EXPECT_EQ(rehearse({"sweep", "box.yaml", "--cases", "200", "--seed", "2", "-o", "local", "-j", "1"}).status, 1);
  const Outcome submitted =
      sweep({"box.yaml", "--cases", "200", "--seed", "2", "-o", "run", "--slurm", "--tasks", "8", "--", "--nice=1"});
  ASSERT_EQ(submitted.status, 0) << submitted.err;
  EXPECT_THAT(submitted.out, HasSubstr("200 cases in 8 tasks: Slurm's jobs 1, "))
      << "two arrays: an array has 5 tasks at most";
  const Outcome twice = sweep({"resume", "run", "--slurm"});
  EXPECT_EQ(twice.status, bad_input);
  EXPECT_THAT(twice.err, HasSubstr("scancel --name=rehearse-"));
  EXPECT_THAT(sweep({"resume", "run"}).err, HasSubstr("scancel --name=rehearse-")) << "nor without Slurm";

  EXPECT_TRUE(waits_until([&] { return status()["missing"] < 200; }));
  ASSERT_EQ(cluster({"kill", place_.string(), "n2"}), 0);
  EXPECT_TRUE(waits_until([&] { return is_queue_empty(); })) << status();
  // the tasks of the lost node ran on the other; if Slurm gave one up, it is submitted again
  if (status()["missing"] != 0) {
    EXPECT_EQ(sweep({"resume", "run", "--slurm"}).status, 0);
    EXPECT_TRUE(waits_until([&] { return is_queue_empty(); })) << status();
  }
  EXPECT_EQ(status()["missing"], 0);
  EXPECT_EQ(sweep({"report", "run"}).status, 1);
  EXPECT_EQ(results("run"), results("local"));
  for (const auto& [run, count] : runs()) EXPECT_EQ(count, 1) << run;
  EXPECT_EQ(status()["repeated"], sweep({"report", "local", "--json"}).json()["repeated"]);
}

TEST_F(SlurmSweep, SubmitsTheUnfinishedTasksAgain) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "40", "-o", "local"});
  EXPECT_EQ(sweep({"box.yaml", "--cases", "40", "-o", "run", "--slurm", "--tasks", "4", "--", "--hold"}).status, 0);
  EXPECT_EQ(status()["slurm"]["waiting"], 4);
  EXPECT_EQ(run("scancel",
                {"--name=" +
                 nlohmann::json::parse(read_file(folder() / "run/slurm/submission.json"))["name"].get<std::string>()},
                "SLURM_CONF=" + (place_ / "slurm.conf").string())
                .status,
            0);
  EXPECT_TRUE(waits_until([&] { return is_queue_empty(); }));
  EXPECT_EQ(sweep({"work", "run", "--slice", "2/4"}).status, 0);
  EXPECT_THAT(sweep({"status", "run"}).out, HasSubstr("go on: rehearse sweep resume run --slurm"));
  EXPECT_THAT(sweep({"resume", "run", "--slurm", "--tasks", "5"}).err, HasSubstr("was submitted in 4 tasks"));
  EXPECT_THAT(sweep({"resume", "run", "--slurm"}).out, HasSubstr("40 cases in 3 tasks: Slurm's job "));
  EXPECT_TRUE(waits_until([&] { return is_queue_empty(); }));
  sweep({"report", "run"});
  EXPECT_EQ(results("run"), results("local"));
  EXPECT_THAT(sweep({"resume", "run", "--slurm"}).out, HasSubstr("all cases have results"));
}

TEST_F(SlurmSweep, KeepsThePlanIfSlurmRefuses) {
  box();
  const Outcome refused = sweep({"box.yaml", "--cases", "9", "-o", "run", "--slurm", "--", "--partition=nowhere"});
  EXPECT_EQ(refused.status, bad_input);
  EXPECT_THAT(refused.err, HasSubstr("invalid partition specified: nowhere"));
  EXPECT_EQ(rehearse({"sweep", "resume", "run", "--slurm"}, "PATH=/nowhere").status, bad_input);
  EXPECT_THAT(rehearse({"sweep", "resume", "run", "--slurm"}, "PATH=/nowhere").err, HasSubstr("no squeue on the PATH"));
  EXPECT_THAT(sweep({"resume", "run", "--partition=test"}).err, HasSubstr("--partition"));
  EXPECT_THAT(sweep({"resume", "run", "--", "--partition=test"}).err,
              HasSubstr("options after -- are those of sbatch"));
  EXPECT_THAT(sweep({"resume", "run", "--tasks", "3"}).err, HasSubstr("--tasks requires --slurm"));
  EXPECT_EQ(sweep({"resume", "run", "--slurm", "--", "--partition=test"}).status, 0);
  EXPECT_TRUE(waits_until([&] { return is_queue_empty(); }));
  EXPECT_EQ(status()["missing"], 0);
}

}  // namespace
}  // namespace rehearse::test
