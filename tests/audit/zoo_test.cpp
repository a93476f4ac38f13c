// The zoo: what an audit has to say of each controller. The table is printed when all have run.
#include "audited.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string_view>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

struct Animal {
  const char* controller;
  const char* does;
  const char* found_by;    // the factor; empty: its library's code; null: nothing, it is good
  const char* reason;      // a part of it
  const char* place = "";  // another: where it is done
};
void PrintTo(const Animal& animal, std::ostream* stream) { *stream << animal.controller; }

const Animal animals[] = {
    {"rand", "dithers with rand()", "random", "it depends on random numbers: rand", "Rand::term() (rand.cpp:9)"},
    {"random_device", "draws from std::random_device", "random", "it depends on random numbers",
     "RandomDevice::term() (random_device.cpp:9)"},
    {"time", "goes by the second of the day", "clock", "it depends on the clock: time", "Time::term() (time.cpp:9)"},
    {"steady_clock", "filters by the time that really passed", "clock",
     "it depends on the clock: clock_gettime(CLOCK_MONOTONIC)", "SteadyClock::filtered(double) (steady_clock.cpp:13)"},
    {"uninitialised_member", "forgets to set a member", "memory", "it depends on uninitialised or freed memory"},
    {"uninitialised_local", "sums an array half set", "memory", "it depends on uninitialised or freed memory"},
    {"use_after_free", "uses what it gave back", "memory", "it depends on uninitialised or freed memory"},
    {"pointer_order", "sums in the order of a hash of pointers", "addresses", "it depends on addresses"},
    {"own_address", "commands by where it lies in memory", "addresses", "it depends on addresses"},
    {"static_state", "keeps a static variable between runs", "again", "an earlier run in the same process left behind"},
    {"thread_command", "takes what a thread has planned so far", "threads",
     "it depends on which of its threads comes first: pthread_create",
     "ThreadCommand::begin() (thread_command.cpp:15)"},
    {"fast_math", "is linked with -ffast-math", "",
     "loading it switches the whole process to another floating-point mode, flush-to-zero"},
    {"changing_file", "reads a file that it changes", "nothing", "it reads a file that changes",
     "ChangingFile::begin() (changing_file.cpp:10): its content changed between two runs"},
    {"locale_parsing", "parses a number in the user's locale", "locale", "it depends on the locale: setlocale",
     "LocaleParsing::begin() (locale_parsing.cpp:11)"},
    {"time_stamp_counter", "reads the processor's counter", "nothing", "it depends on the processor's clock",
     "TimeStampCounter::term() (time_stamp_counter.cpp:9)"},
    {"environment", "takes a setting from getenv()", "environment", "it depends on the environment: getenv(HOME)",
     "Environment::begin() (environment.cpp:11)"},
    {"process_id", "commands by getpid()", "nothing", "it depends on the process it runs in: getpid",
     "ProcessId::term() (process_id.cpp:9)"},
    {"working_folder", "finds a file only from one folder", "folder",
     "it depends on the working folder: fopen(gain.txt)", "WorkingFolder::begin() (working_folder.cpp:10)"},
    {"good_logs_time", "logs what time it is", nullptr, ""},
    {"good_constant_file", "reads a file that stays as it is", nullptr, ""},
    {"good_own_generator", "has a seeded generator of its own", nullptr, ""},
    {"good_joined_thread", "starts a thread and waits for it", nullptr, ""},
    {"good_log_file", "writes a log file", nullptr, ""},
};

std::vector<std::string>& rows() {
  static std::vector<std::string> all;
  return all;
}

class Zoo : public Audited, public ::testing::WithParamInterface<Animal> {
 protected:
  static void TearDownTestSuite() {
    fmt::print("\n{:<22}{:<42}{:<13}{:<7}{}\n", "controller", "what it does", "found by", "right", "reason");
    for (const std::string& row : rows()) fmt::print("{}\n", row);
    fmt::print("\n");
    rows().clear();
  }
};

TEST_P(Zoo, IsJudgedRightly) {
  const Animal& animal = GetParam();
#if defined(SANITIZED)
  const std::string_view found_by = animal.found_by ? animal.found_by : "";
  if (found_by == "memory" || found_by == "addresses")
    GTEST_SKIP() << "the sanitizer has a malloc() of its own, which is not varied";
#endif
  write("gain.txt", "0.25\n");
  const std::string name = animal.controller;
  const Outcome outcome = rehearse(
      {"audit", scenario(name, name == "good_log_file" ? "log.txt" : (folder() / "gain.txt").string()).string(),
       "--json"});
  ASSERT_THAT(outcome.out, HasSubstr("\"verdict\"")) << outcome.err;
  const nlohmann::json report = outcome.json();
  const std::string reason = reason_in(report);
#if !defined(SANITIZED)
  EXPECT_EQ(outcome.err, "");
#endif
  if (animal.found_by) {
    for (const auto& factor : report["factors"])
      if (factor["factor"] == animal.found_by && factor["why_not"].is_string() &&
          factor["why_not"].get<std::string>().find("on this machine") != std::string::npos)
        GTEST_SKIP() << factor["why_not"];
    EXPECT_EQ(outcome.status, 1) << outcome.out;
    EXPECT_EQ(report["deterministic"], false);
    EXPECT_EQ(report["depends_on"].is_null() ? "" : report["depends_on"].get<std::string>(), animal.found_by);
    EXPECT_THAT(reason, HasSubstr(animal.reason));
    EXPECT_THAT(reason, HasSubstr(animal.place));
  } else {
    EXPECT_EQ(outcome.status, 0) << outcome.out;
    EXPECT_EQ(reason, "");
  }
  rows().push_back(fmt::format("{:<22}{:<42}{:<13}{:<7}{}", name, animal.does,
                               report["depends_on"].is_string()  ? report["depends_on"].get<std::string>()
                               : report["deterministic"] == true ? "-"
                                                                 : "its library",
                               HasFailure() ? "no" : "yes", reason.empty() ? "a function of its inputs" : reason));
}

INSTANTIATE_TEST_SUITE_P(Of, Zoo, ::testing::ValuesIn(animals),
                         [](const auto& of) { return std::string(of.param.controller); });

}  // namespace
}  // namespace rehearse::test
