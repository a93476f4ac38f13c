// The zoo: the verdict of an audit on each controller. The table is printed after all tests.
#include "audited.h"
#include "support/printed_by_name.h"

#include <cpuid.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string_view>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

struct Animal {
  const char* name;  // of the controller
  const char* does;
  const char* found_by;       // the factor; empty: found in its library's code; null: deterministic
  const char* reason;         // a part of the reason
  const char* place = "";     // a part of the reason: the place in the source
  const char* rests_on = "";  // for a deterministic one: a part of the conditions of the verdict
};

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
     "it depends on the order of its threads: pthread_create", "ThreadCommand::begin() (thread_command.cpp:15)"},
    {"fast_math", "is linked with -ffast-math", "",
     "loading it switches the whole process to another floating-point mode, flush-to-zero"},
    {"changing_file", "reads a file that it changes", "again", "it reads a file that changes",
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
    {"here_listed", "counts the entries of the working folder", "folder",
     "it depends on the entries of a folder named relative to the working folder: opendir(.)",
     "HereListed::begin() (here_listed.cpp:10)"},
    {"here_iterated", "iterates over the working folder", "folder",
     "it depends on the entries of a folder named relative to the working folder: fdopendir(.)",
     "HereIterated::begin() (here_iterated.cpp:10)"},
    {"here_tree", "iterates over a tree in it", "folder",
     "it depends on the entries of a folder named relative to the working folder: fdopendir(zoo_tree)",
     "HereTree::begin() (here_tree.cpp:11)"},
    {"first_entry", "takes the first entry of a folder", "machine",
     "it depends on the order of a folder's entries: fdopendir(/", "FirstEntry::begin() (first_entry.cpp:11)"},
    {"scan_order", "goes by the order of scandir()", "machine",
     "it depends on the order of a folder's entries: scandir(/", "ScanOrder::begin() (scan_order.cpp:12)"},
    {"tree_order", "goes by the order of fts_read()", "machine",
     "it depends on the order of a folder's entries: fts_open(/", "TreeOrder::begin() (tree_order.cpp:13)"},
    {"scratch_order", "goes by the order of its own folder", "machine",
     "it depends on the order of a folder's entries: fdopendir(zoo_order)",
     "ScratchOrder::begin() (scratch_order.cpp:13)"},
    {"processors", "divides by the number of processors", "machine",
     "it depends on the number of processors: get_nprocs() called in", "Processors::term() (processors.cpp:9)"},
    {"processor_mask", "counts the processors it may run on", "machine",
     "it depends on the number of processors: sched_getaffinity() called in",
     "ProcessorMask::term() (processor_mask.cpp:12)"},
    {"host_name", "picks its gain by the machine's name", "machine",
     "it depends on the machine's name: gethostname() called in", "HostName::term() (host_name.cpp:13)"},
    {"load", "commands less on a busy machine", "machine", "it depends on the machine's load: getloadavg() called in",
     "Load::term() (load.cpp:11)"},
    {"load_file", "reads the load from a file", "machine",
     "it depends on the machine's load: fopen(/proc/loadavg) called in", "LoadFile::begin() (load_file.cpp:10)"},
    {"terminal", "holds softer at a terminal", "machine", "it depends on the terminal: isatty(1) called in",
     "Terminal::term() (terminal.cpp:9)"},
    {"terminal_size", "goes by the terminal's width", "machine",
     "it depends on the terminal: ioctl(TIOCGWINSZ) called in", "TerminalSize::term() (terminal_size.cpp:12)"},
    {"user_id", "commands by who runs it", "machine", "it depends on the user: getuid() called in",
     "UserId::term() (user_id.cpp:9)"},
    {"user_home", "goes by the user's home folder", "machine", "it depends on the user: getpwuid() called in",
     "UserHome::term() (user_home.cpp:"},
    {"memory_size", "commands by the machine's memory", "machine",
     "it depends on the machine's memory: sysconf(_SC_PHYS_PAGES) called in", "MemorySize::term() (memory_size.cpp:9)"},
    {"parent_process", "commands by who started it", "machine",
     "it depends on the process it runs in: getppid() called in", "ParentProcess::term() (parent_process.cpp:9)"},
    {"resource_usage", "commands by the memory it used", "clock",
     "it depends on the time and memory that the process has used: getrusage() called in",
     "ResourceUsage::term() (resource_usage.cpp:11)"},
    {"raw_getrandom", "draws past the C library", "random", "it depends on random numbers: getrandom() called in",
     "(raw_getrandom.cpp:11)"},
    {"syscall_getrandom", "draws by syscall()", "random", "it depends on random numbers: getrandom() called in",
     "SyscallGetrandom::term() (syscall_getrandom.cpp:12)"},
    {"raw_clock", "reads the clock past the C library", "clock", "it depends on the clock: clock_gettime",
     "(raw_clock.cpp:12)"},
    {"raw_process_id", "goes by its process past the C library", "nothing",
     "it depends on the process it runs in: getpid() called in", "(raw_process_id.cpp:11)"},
    {"thread_hash", "commands by the hash of its thread", "addresses", "it depends on addresses"},
    {"uptime_file", "reads the kernel's uptime", "nothing", "it reads a file that changes: fopen(/proc/uptime)",
     "UptimeFile::term() (uptime_file.cpp:"},
    {"counts_runs", "counts its runs in a file", "again", "it reads a file that changes: fopen(runs.txt)",
     "CountsRuns::begin() (counts_runs.cpp:10): its content changed between two runs"},
    {"processor_features", "asks whether there is AVX2", nullptr, "", "", "the processor ("},
    {"auxiliary_vector", "asks the kernel for the processor", nullptr, "", "", "getauxval(16) called in"},
    {"folder_list", "lists a folder", nullptr, "", "", "fdopendir(/etc) called in"},
    {"folder_tree", "lists a tree of folders", nullptr, "", "", "fdopendir(/etc/apt) called in"},
    {"scanned_folder", "lists a folder by scandir()", nullptr, "", "", "scandir(/etc) called in"},
    {"glob_pattern", "counts files that match a pattern", nullptr, "", "", "glob(/etc/*.conf) called in"},
    {"file_tree", "walks a tree by nftw()", nullptr, "", "", "nftw(/etc/apt) called in"},
    {"tree_walk", "walks a tree by fts_read()", nullptr, "", "", "fts_open(/etc/apt) called in"},
    {"word_expansion", "counts files that words stand for", nullptr, "", "", "wordexp(/etc/*.conf) called in"},
    {"folder_entries", "reads the entries of a descriptor", nullptr, "", "", "getdents(/etc) called in"},
    {"joined_folder", "lists a folder with its file and others", nullptr, "", "", "fdopendir(/"},
    {"listed_twice", "lists a folder twice by one stream", nullptr, "", "", "opendir(/"},
    {"two_trees", "walks a tree there and one here", nullptr, "", "", "fts_open(/etc/apt) called in"},
    {"scanned_below", "lists by scandirat()", nullptr, "", "", "scandirat(/etc/apt) called in"},
    {"opened_below", "reads a file in an opened folder", nullptr, "", "", "/gain.txt) called in OpenedBelow::begin()"},
    {"disk_space", "stops on a full disk", nullptr, "", "", "statvfs(/) called in"},
    {"time_stamp_branch", "branches on the processor's counter", nullptr, "", "", "the processor's clock (rdtsc in "},
    {"time_stamp_core", "branches on the counter by rdtscp", nullptr, "", "", "the processor's clock (rdtscp in "},
    {"random_instruction", "draws from the processor", "nothing",
     "it depends on the processor's random numbers: it draws random numbers from the processor: rdrand in ",
     "RandomInstruction::term() (random_instruction.cpp:"},
    {"seed_instruction", "branches on a random number of it", nullptr, "", "",
     "the processor's random numbers (rdseed in "},
    {"shared_segment", "looks for memory shared by a number", nullptr, "", "", "shmget(21061) called in"},
    {"attached_segment", "attaches memory by its number", nullptr, "", "", "shmat(21061) called in"},
    {"semaphore_set", "looks for semaphores by a number", nullptr, "", "", "semget(21061) called in"},
    {"message_queue", "looks for a queue by a number", nullptr, "", "", "msgget(21061) called in"},
    {"good_planner", "takes what a thread has planned, in turns", nullptr, ""},
    {"good_pool_size", "asks for a size that it doesn't need", nullptr, ""},
    {"good_thread_pool", "sums in a thread for each processor", nullptr, ""},
    {"good_logs_machine", "logs host, user, load and process", nullptr, ""},
    {"good_colours_log", "colours its log at a terminal", nullptr, ""},
    {"good_scratch_file", "reads back what it wrote", nullptr, ""},
    {"good_temporary_file", "goes through a temporary file", nullptr, ""},
    {"good_lock_file", "takes a lock file", nullptr, ""},
    {"good_scratch_folder", "keeps files in a folder of its own", nullptr, ""},
    {"good_own_folder", "lists the folder that it made", nullptr, ""},
    {"good_shared_memory", "counts in shared memory", nullptr, ""},
    {"good_memory_log", "logs its memory", nullptr, ""},
    {"good_raw_write", "writes past the C library", nullptr, ""},
    {"good_logs_time", "logs what time it is", nullptr, ""},
    {"good_constant_file", "reads a file that stays as it is", nullptr, ""},
    {"good_own_generator", "has a seeded generator of its own", nullptr, ""},
    {"good_joined_thread", "starts a thread and waits for it", nullptr, ""},
    {"good_log_file", "writes a log file", nullptr, ""},
};

/// The instruction that the controller needs and this processor doesn't have; else null.
const char* missing_instruction(std::string_view controller) {
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (controller == "random_instruction" && !(__get_cpuid(1, &a, &b, &c, &d) && (c & bit_RDRND))) return "rdrand";
  if (controller == "seed_instruction" && !(__get_cpuid_count(7, 0, &a, &b, &c, &d) && (b & bit_RDSEED)))
    return "rdseed";
  constexpr unsigned bit_rdtscp = 1u << 27;
  if (controller == "time_stamp_core" && !(__get_cpuid(0x80000001, &a, &b, &c, &d) && (d & bit_rdtscp)))
    return "rdtscp";
  return nullptr;
}

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
  if (const char* missing = missing_instruction(animal.name)) {
    rows().push_back(
        fmt::format("{:<22}{:<42}not judged: this processor has no {}", animal.name, animal.does, missing));
    GTEST_SKIP() << "this processor has no " << missing;
  }
  write("gain.txt", "0.25\n");
  fs::create_directory(folder() / "zoo_tree");
  write("zoo_tree/leaf.txt", "green\n");
  const std::string name = animal.name;
  const Outcome outcome =
      rehearse({"audit",
                scenario(name, name == "good_log_file" ? "log.txt" : (folder() / "gain.txt").string(),
                         name == "thread_command" ? "        threads: free\n" : "")
                    .string(),
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
    EXPECT_THAT(report["rests_on"].dump(), HasSubstr(animal.rests_on));
    const std::string verdict = report["verdict"];
    if (name == "good_planner") {
      EXPECT_THAT(verdict, HasSubstr("is a function of its inputs, its thread takes turns: "));
    }
    EXPECT_EQ(verdict.find("is a function of its inputs") == std::string::npos, !report["rests_on"].empty()) << verdict;
  }
  rows().push_back(fmt::format("{:<22}{:<42}{:<13}{:<7}{}", name, animal.does,
                               report["depends_on"].is_string()  ? report["depends_on"].get<std::string>()
                               : report["deterministic"] == true ? "-"
                                                                 : "its library",
                               HasFailure() ? "no" : "yes", reason.empty() ? std::string(report["verdict"]) : reason));
}

INSTANTIATE_TEST_SUITE_P(Of, Zoo, ::testing::ValuesIn(animals), test::by_name);

}  // namespace
}  // namespace rehearse::test
