// The costs of control(): twenty ways to be late, which an audit names with tick and line, and twenty that look alike.
// The table is printed after all tests.
#include "audited.h"
#include "support/printed_by_name.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Way {
  const char* name;
  const char* does;
  const char* cost = nullptr;  // "allocation"; null: an innocent
  const char* function = "";   // of the C library
  int first_tick = 150;
};

const Way ways[] = {
    {"branch", "allocates in one branch", "allocation", "malloc"},
    {"growth", "push_back() outgrows its room", "allocation", "malloc", 128},
    {"log_line", "makes a string for a log line", "allocation", "malloc"},
    {"function_copy", "copies a std::function", "allocation", "malloc", 0},
    {"temporaries", "has temporary matrices", "allocation", "malloc"},
    {"locked", "takes a lock", "lock", "pthread_mutex_lock"},
    {"held_lock", "takes a lock that a thread holds", "lock", "pthread_mutex_lock"},
    {"sleep", "sleeps", "system call", "usleep"},
    {"file_read", "reads a file", "system call", "fopen"},
    {"setting", "asks for a variable", "system call", "getenv"},
    {"thrown", "throws to itself", "exception", "cxa_throw"},
    {"rehash", "rehashes a table", "allocation", "malloc"},
    {"shared", "makes a shared pointer", "allocation", "malloc"},
    {"stream", "formats by a stream", "allocation", "malloc"},
    {"printed", "prints", "system call", "printf"},
    {"c_allocation", "allocates by calloc()", "allocation", "calloc"},
    {"reallocation", "grows a block", "allocation", "realloc"},
    {"list_node", "appends to a list", "allocation", "malloc"},
    {"spawned", "starts a thread", "system call", "pthread_create"},
    {"written", "writes to stdout", "system call", "write"},
    {"good_pool", "takes nodes from a pool"},
    {"good_reserved", "push_back() within its room"},
    {"good_array", "has a large local array"},
    {"good_fixed_matrix", "has matrices of fixed size"},
    {"good_no_alias", "writes a product in place"},
    {"good_short_string", "makes a short string"},
    {"good_message", "writes lines to os()"},
    {"good_small_function", "copies a small std::function"},
    {"good_virtual_call", "calls a virtual function"},
    {"good_dynamic_cast", "casts 1,000 times"},
    {"good_denormals", "computes with denormal numbers"},
    {"good_first_tick", "allocates in tick 0"},
    {"good_clock", "reads the clock"},
    {"good_variant", "makes a pair"},
    {"good_arena", "allocates from the stack"},
    {"good_sorting", "sorts an array"},
    {"good_variable", "sets a variable"},
    {"good_snprintf", "formats a number into an array"},
    {"good_atomic", "counts atomically"},
    {"good_null_release", "releases a null pointer"},
    {"good_try_lock", "tries to take a lock, without waiting"},
};

std::vector<std::string>& realtime_rows() {
  static std::vector<std::string> all;
  return all;
}

class Realtime : public Audited, public ::testing::WithParamInterface<Way> {
 protected:
  static void TearDownTestSuite() {
    fmt::print("\n{:<22}{:<36}{:<13}{:<6}{}\n", "way", "what it does", "cost", "tick", "place");
    for (const std::string& row : realtime_rows()) fmt::print("{}\n", row);
    fmt::print("\n");
    realtime_rows().clear();
  }
};

TEST_P(Realtime, IsJudgedRightly) {
  const Way& way = GetParam();
  const std::string yaml = scenario("costs", way.name).string();
  const Outcome outcome = rehearse({"audit", yaml, "--realtime", "--json"});
  ASSERT_THAT(outcome.out, HasSubstr("\"verdict\"")) << outcome.err;
  const nlohmann::json report = outcome.json();
  nlohmann::json first;
  for (const nlohmann::json& cost : report["controllers"][0]["costs"])
    if (cost["breaks_realtime"] && first.is_null() && (!way.cost || cost["cost"] == way.cost)) first = cost;
  if (!way.cost) {
    EXPECT_EQ(outcome.status, 0) << report["verdict"];
    EXPECT_EQ(report["realtime_safe"], true) << first.dump();
    EXPECT_EQ(report["verdict"],
              "Pendulum/Zoo is real-time safe in 200 ticks, as to calls: no allocation, lock, system call or "
              "exception after tick 0; not measured: duration");
    realtime_rows().push_back(fmt::format("{:<22}{:<36}-", way.name, way.does));
    return;
  }
  EXPECT_EQ(outcome.status, 1) << report["verdict"];
  ASSERT_FALSE(first.is_null()) << outcome.out;
  EXPECT_EQ(first["cost"], way.cost);
  EXPECT_EQ(first["function"], way.function);
  EXPECT_EQ(first["first_tick"], way.first_tick);
  EXPECT_THAT(first["place"], HasSubstr(fmt::format("Costs::{}() (costs.cpp:", way.name)));
  EXPECT_THAT(report["verdict"], StartsWith("Pendulum/Zoo isn't real-time safe: "));
  EXPECT_THAT(report["verdict"], HasSubstr(fmt::format("Costs::{}()", way.name)));
  realtime_rows().push_back(fmt::format("{:<22}{:<36}{:<13}{:<6}{}", way.name, way.does, way.cost,
                                        first["first_tick"].get<int>(), first["place"].get<std::string>()));
}

INSTANTIATE_TEST_SUITE_P(Of, Realtime, ::testing::ValuesIn(ways), by_name);

/// A verdict on calls says nothing of pages that are touched first at a late tick.
TEST_F(Audited, ListsThePageFaultsOfControl) {
  const std::string yaml = scenario("costs", "good_pages").string();
  const Outcome outcome = rehearse({"audit", yaml, "--realtime"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              ::testing::ContainsRegex("\n  on this machine, [0-9]+ page faults in [0-9]+ ticks?, first at "
                                       "tick [0-9]+\n"));
  const nlohmann::json faults =
      rehearse({"audit", yaml, "--realtime", "--json"}).json()["controllers"][0]["page_faults"];
  EXPECT_GE(faults["total"], 8) << "of 16 MiB, in pages of 2 MiB at most";
  EXPECT_GT(faults["ticks"], 0);
  EXPECT_LE(faults["first_tick"], 99);
}

TEST_F(Audited, ListsTheCostsOfStartApart) {
  const Outcome outcome = rehearse({"audit", scenario("costs", "good_first_tick").string(), "--realtime"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, ::testing::ContainsRegex("in time +in +when +times"));
  EXPECT_THAT(outcome.out, HasSubstr("initialize()"));
  EXPECT_THAT(outcome.out, HasSubstr("tick 0"));
}

/// Recordings count the same costs as the audit lists.
TEST_F(Audited, TheCostsOfARecordingAreEqualInEachRun) {
  const std::string yaml = scenario("costs", "branch").string();
  const Outcome outcome = rehearse({"record", yaml, "--realtime", "-o", "costs.mcap"});
  EXPECT_THAT(outcome.out,
              HasSubstr("control() of Pendulum/Zoo isn't real-time safe: 50 allocations in 50 ticks, first "
                        "at tick 150; 50 releases of memory in 50 ticks, first at tick 150\n"));
  for (int run = 0; run < 10; ++run) {
    rehearse({"record", yaml, "--realtime", "-o", "again.mcap"});
    EXPECT_TRUE(read_file(folder() / "costs.mcap") == read_file(folder() / "again.mcap")) << "run " << run;
  }
  done({"replay", "costs.mcap", "--realtime", "-o", "replayed.mcap"});
  const Outcome first = rehearse({"cat", "costs.mcap", "--topics", "/Pendulum/Zoo/cost"});
  const Outcome again = rehearse({"cat", "replayed.mcap", "--topics", "/Pendulum/Zoo/cost"});
  EXPECT_TRUE(first.out == again.out);
  EXPECT_THAT(first.out, HasSubstr("32000"));
}

/// Goldens of controllers that have equal commands and different costs.
class GoldenCosts : public Audited {
 protected:
  /// The pendulum with a golden; `realtime`: a line of the scenario.
  GoldenCosts() { fs::create_directory(folder() / "golden"); }
  std::string yaml_with(const std::string& library, const std::string& realtime = "realtime: counts\n") const {
    const std::string text = read_file(scenario(library, "branch"));
    return write("zoo.yaml", "golden: Zoo.Waits\n" + realtime + text).string();
  }
};

TEST_F(GoldenCosts, AreCompared) {
  EXPECT_EQ(rehearse({"check", yaml_with("costs_lean")}, "REHEARSE_GOLDEN=new").status, 0);
  EXPECT_EQ(rehearse({"check", "zoo.yaml"}).status, 0);
  const Outcome late = rehearse({"check", "zoo.yaml", "--controller", "Zoo=" ZOO "/zoo_costs.so"});
  EXPECT_EQ(late.status, 1) << late.out << late.err;
  EXPECT_THAT(late.out, HasSubstr("the costs of control() of Pendulum/Zoo changed, its commands did not: "));
  EXPECT_THAT(late.out, HasSubstr("at tick 150"));
  EXPECT_THAT(late.out, ::testing::Not(HasSubstr("the controller changed")));
  yaml_with("costs");
  EXPECT_EQ(rehearse({"check", "zoo.yaml"}).status, 1);
  EXPECT_EQ(rehearse({"golden", "accept", "Zoo.Waits", "--channel", "*/cost/*"}).status, 0);
  const Outcome accepted = rehearse({"check", "zoo.yaml"});
  EXPECT_EQ(accepted.status, 0) << accepted.out << accepted.err;
}

TEST_F(GoldenCosts, AreEqualInTenRuns) {
  EXPECT_EQ(rehearse({"check", yaml_with("costs")}, "REHEARSE_GOLDEN=new").status, 0);
  for (int run = 1; run <= 10; ++run) {
    const nlohmann::json report = rehearse({"check", "zoo.yaml", "--json"}).json();
    EXPECT_EQ(report["equal"], true) << "run " << run << ": " << report["verdict"];
    EXPECT_EQ(report["proved"], false) << "a run that counts is simulated";
  }
}

TEST_F(GoldenCosts, AreUnknownWhereOnlyOneHasThem) {
  EXPECT_EQ(rehearse({"check", yaml_with("costs", "")}, "REHEARSE_GOLDEN=new").status, 0);
  yaml_with("costs");
  const Outcome checked = rehearse({"check", "zoo.yaml"});
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  EXPECT_THAT(checked.out + checked.err, HasSubstr("the golden has no costs: /Pendulum/Zoo/cost is not compared"));
}

TEST_F(GoldenCosts, AreBoundedByExpectations) {
  const std::string text = read_file(scenario("costs", "branch"));
  write("zoo.yaml",
        "realtime: counts\nexpect:\n  - {channel: '*/Zoo/cost/allocations', below: 1, since: 0.001}\n" + text);
  const Outcome outcome = rehearse({"record", "zoo.yaml"});
  EXPECT_THAT(outcome.out + outcome.err, HasSubstr("cost/allocations"));
  EXPECT_THAT(outcome.out + outcome.err, HasSubstr("0.15"));
}

TEST_F(GoldenCosts, AreNotCountedBeforeAnotherAllocator) {
  const Outcome outcome = rehearse({"record", scenario("costs", "branch").string(), "--realtime"},
                                   "REHEARSE_PIN=off LD_PRELOAD=" ZOO "/libother_allocator.so");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("the costs of control() can't be counted here: another allocator is loaded"));
}

// As on another processor: the golden has costs, and this process can't count them.
TEST_F(GoldenCosts, AreNotComparedWhereTheyCantBeCounted) {
  EXPECT_EQ(rehearse({"check", yaml_with("costs_lean")}, "REHEARSE_GOLDEN=new").status, 0);
  const std::string other = "REHEARSE_PIN=off LD_PRELOAD=" ZOO "/libother_allocator.so";
  const Outcome checked = rehearse({"check", "zoo.yaml", "--json"}, other);
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  EXPECT_EQ(checked.json()["code"], "same") << checked.json()["verdict"];
  EXPECT_THAT(checked.json()["remarks"].dump(), HasSubstr("the run has no costs: /Pendulum/Zoo/cost is not compared"));
  const Outcome replayed = rehearse({"replay", "golden/Zoo.Waits.mcap"}, other);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
}

}  // namespace
}  // namespace rehearse::test
