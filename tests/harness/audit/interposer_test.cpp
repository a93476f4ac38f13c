// The calls of a controller that the interposer records.
#include "watched_runs.h"

namespace rehearse {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using Source = ObservedCall::Source;

using Interposer = WatchedTest;

TEST_F(Interposer, SeesNothingOfAControllerThatAsksForNothing) {
  const WatchedRun seen = run("nothing");
  EXPECT_THAT(seen.log.calls, IsEmpty());
  EXPECT_TRUE(seen.log.complete);
  EXPECT_EQ(seen.values, (std::vector{0.0, 0.5, 1.0, 1.5, 2.0}));
}

TEST_F(Interposer, NamesTheLineThatReadsAClockThroughTheCppLibrary) {
  const WatchedRun seen = run("read_steady_clock", 7);
  const ObservedCall call = seen.call_of("clock_gettime");
  EXPECT_EQ(text_of(call), "clock_gettime(CLOCK_MONOTONIC)");
  EXPECT_EQ(call.source, Source::clock);
  EXPECT_EQ(call.controller, "Rig/Watched");
  EXPECT_EQ(call.phase, "control");
  EXPECT_EQ(call.first_tick, 0);
  EXPECT_EQ(call.last_tick, 6);
  EXPECT_EQ(call.count, 7);
  EXPECT_EQ(call.place.module, watched_library());
  EXPECT_THAT(place_of(call), AllOf(StartsWith("Filter::update() (watched.cpp:"), EndsWith(")")));
  ASSERT_EQ(call.chain.size(), 1u);
  EXPECT_THAT(call.chain[0].module, HasSubstr("libstdc++"));
}

TEST_F(Interposer, SeesWhatIsCalledWhileTheLibraryIsLoaded) {
  library_ = watched_library("starts_early");
  const auto calls = run("since_loaded").calls_of("time");
  ASSERT_EQ(calls.size(), 2u);
  EXPECT_EQ(calls[0].phase, "load");
  EXPECT_EQ(calls[0].first_tick, -1);
  EXPECT_THAT(place_of(calls[0]), HasSubstr("(starts_early.cpp:6)"));
  EXPECT_EQ(calls[1].phase, "control");
  EXPECT_EQ(calls[1].count, 5);
}

TEST_F(Interposer, NamesTheInlinedFunctionThatCalled) {
  EXPECT_THAT(place_of(run("draw_inlined").call_of("rand")), StartsWith("inlined_draw() (watched.cpp:"));
}

TEST_F(Interposer, NamesTheLinesOfALibraryWithoutAnIndexOfAddresses) {
  library_ = watched_library("unindexed");
  EXPECT_THAT(place_of(run("read_steady_clock").call_of("clock_gettime")),
              StartsWith("Filter::update() (watched.cpp:"));
  EXPECT_THAT(place_of(run("draw_inlined").call_of("rand")), StartsWith("inlined_draw() (watched.cpp:"));
}

TEST_F(Interposer, TellsTwoPlacesApart) {
  const auto calls = run("draw_at_two_places").calls_of("rand");
  ASSERT_EQ(calls.size(), 2u);
  EXPECT_NE(calls[0].place, calls[1].place);
  EXPECT_NE(place_of(calls[0]), place_of(calls[1]));
}

TEST_F(Interposer, NamesALibraryThatTheControllerBroughtAlong) {
  const ObservedCall call = run("call_what_it_brought").call_of("rand");
  EXPECT_THAT(call.place.module, EndsWith("libwatched.so"));
  ASSERT_FALSE(call.chain.empty());
  EXPECT_THAT(call.chain[0].module, EndsWith("libbrought_along.so"));
}

struct Expected {
  const char* function;  // of watched.cpp
  Source source;
  const char* call;
};
class InterposerSees : public WatchedTest, public ::testing::WithParamInterface<Expected> {};

TEST_P(InterposerSees, EachCall) {
  const Expected expected = GetParam();
  const WatchedRun seen = run(expected.function);
  bool found = false;
  std::string all;
  for (const ObservedCall& call : seen.log.calls) {
    all += text_of(call) + " ";
    if (text_of(call) != expected.call) continue;
    found = true;
    EXPECT_EQ(call.source, expected.source);
    EXPECT_THAT(place_of(call), AllOf(HasSubstr("()"), HasSubstr(" (watched.cpp:")));
  }
  EXPECT_TRUE(found) << "seen: " << all;
}

INSTANTIATE_TEST_SUITE_P(
    Sources, InterposerSees,
    ::testing::Values(Expected{"read_system_clock", Source::clock, "clock_gettime(CLOCK_REALTIME)"},
                      Expected{"read_time", Source::clock, "time()"},
                      Expected{"read_gettimeofday", Source::clock, "gettimeofday()"},
                      Expected{"read_processor_time", Source::clock, "clock()"},
                      Expected{"wait_in_vain", Source::clock, "pthread_cond_clockwait()"},
                      Expected{"draw_rand", Source::random, "rand()"},
                      Expected{"draw_seeded_rand", Source::random, "srand(42)"},
                      Expected{"draw_drand48", Source::random, "drand48()"},
                      Expected{"draw_random_device", Source::random, "std::random_device(default)"},
                      Expected{"draw_random_device", Source::random, "std::random_device::operator()()"},
                      Expected{"draw_getrandom", Source::random, "getrandom()"},
                      Expected{"draw_urandom", Source::random, "fopen(/dev/urandom)"},
                      Expected{"start_a_thread", Source::thread, "pthread_create()"},
                      Expected{"start_a_thread", Source::clock, "time()"},
                      Expected{"run_a_program", Source::thread, "system(exit 3)"},
                      Expected{"write_a_file", Source::file, "fopen(written.txt)"},
                      Expected{"ask_for_home", Source::environment, "getenv(HOME)"},
                      Expected{"ask_for_the_hour", Source::environment, "localtime(TZ)"},
                      Expected{"ask_for_process", Source::environment, "getpid()"},
                      Expected{"take_users_locale", Source::locale, "newlocale(C.UTF-8)"},
                      Expected{"set_the_locale", Source::locale, "setlocale(LC_ALL, \"C\")"},
                      Expected{"set_the_locale", Source::locale, "setlocale(LC_NUMERIC, NULL)"},
                      Expected{"load_a_plugin", Source::process, "dlopen(libwatched_plugin.so)"}),
    [](const auto& test) { return std::string(test.param.function) + "_" + std::to_string(test.index); });

TEST_F(Interposer, SaysThatAThreadOfTheControllersOwnCalled) {
  const ObservedCall call = run("start_a_thread").call_of("time");
  EXPECT_EQ(call.phase, "its own thread");
  EXPECT_THAT(place_of(call), StartsWith("start_a_thread"));
  EXPECT_EQ(call.count, 5);
}

TEST_F(Interposer, SeesThatAFileWasAnotherOne) {
  write("gains.txt", "1.5\n");
  const std::string before = run("read_a_file").call_of("fopen").digest;
  EXPECT_THAT(before, StartsWith("4 bytes "));
  EXPECT_EQ(run("read_a_file").call_of("fopen").digest, before);
  write("gains.txt", "2.5\n");
  EXPECT_NE(run("read_a_file").call_of("fopen").digest, before);
}

TEST_F(Interposer, TellsAMissingFileFromAnEmptyOne) {
  EXPECT_EQ(run("read_a_file").call_of("fopen").digest, "not there");
  write("gains.txt", "");
  EXPECT_THAT(run("read_a_file").call_of("fopen").digest, StartsWith("0 bytes "));
}

TEST_F(Interposer, SumsUpFilesOfManyNames) {
  const WatchedRun seen = run("open_many_files", 5000);
  EXPECT_TRUE(seen.log.complete);
  const auto calls = seen.calls_of("fopen");
  ASSERT_FALSE(calls.empty());
  EXPECT_LT(calls.size(), 50u);
  EXPECT_EQ(calls.back().argument, "...");
  std::int64_t count = 0;
  for (const ObservedCall& call : calls) count += call.count;
  EXPECT_EQ(count, 5000);
}

TEST_F(Interposer, SeesThatTheHostsFilesAreClosed) {
  const WatchedRun seen = run("close_the_hosts_files");
  const auto calls = seen.calls_of("close");
  ASSERT_FALSE(calls.empty());  // some of them may be the test's own, inherited
  EXPECT_EQ(calls[0].source, Source::process);
  EXPECT_EQ(calls[0].count, 1);
  EXPECT_THAT(run("close_an_own_file").calls_of("close"), IsEmpty());
}

TEST_F(Interposer, KeepsTheLogOfAProcessThatDied) {
  const WatchedRun seen = run("crash");
  EXPECT_NE(status_, 0);
  EXPECT_EQ(seen.values.size(), 3u);
  EXPECT_EQ(seen.call_of("rand").count, 3);
  EXPECT_EQ(seen.call_of("abort").first_tick, 3);
}

TEST_F(Interposer, IsNotSeenByTheControllerNorByProgramsThatItStarts) {
  EXPECT_THAT(run("ask_whether_watched").values, Each(0.0));
  const WatchedRun seen = run("run_a_program", 2);
  EXPECT_THAT(seen.values, Each(3.0));
  EXPECT_EQ(seen.call_of("system").count, 2);
}

TEST_F(Interposer, LetsAControllerFindItsPluginsByItsOwnRunPath) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer's own dlopen() goes by the sanitizer's run path";
#endif
  EXPECT_THAT(run("load_a_plugin").values, Each(1.0));
}

TEST_F(Interposer, GivesTheSystemsAnswersUnlessToldOtherwise) {
  const double now = static_cast<double>(time(nullptr));
  EXPECT_NEAR(run("read_system_clock").values.at(0), now, 60.0);
}

TEST(CallLog, ThatIsMissingOrDamagedIsRefused) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "damaged.log";
  std::filesystem::remove(file);
  EXPECT_THAT(to_string(read_call_log(file).errors()), HasSubstr("can't read the call log"));
  std::ofstream(file) << "RHCALLS1 and no more";
  EXPECT_THAT(to_string(read_call_log(file).errors()), HasSubstr("is no call log, or a damaged one"));
}

}  // namespace
}  // namespace rehearse
