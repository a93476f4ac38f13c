// The properties of a library that a scan of its file finds.
#include "audit/audit/library_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "audit/audit/aspects.h"
#include "core/host/interposer.h"
#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using Kind = CodeKind;
using Findings = std::vector<AuditedCode>;

namespace fs = std::filesystem;

class ScanTest : public ::testing::Test {
 protected:
  static fs::path library(const std::string& name) { return fs::path(AUDIT_LIBRARIES) / ("lib" + name + ".so"); }

  static Findings scan(const fs::path& file) {
    auto result = scan_library(file);
    EXPECT_TRUE(result.ok()) << to_string(result.errors());
    return result ? *result : Findings();
  }
  static std::optional<AuditedCode> found(const Findings& findings, Kind kind, const std::string& function = {}) {
    for (const AuditedCode& finding : findings)
      if (finding.kind == to_string(kind) && (function.empty() || finding.function == function)) return finding;
    return std::nullopt;
  }
  /// The findings without imported functions.
  static std::vector<std::string> sentences(const Findings& findings) {
    std::vector<std::string> all;
    for (const AuditedCode& finding : findings)
      if (finding.kind != to_string(Kind::imported_source)) all.push_back(finding.sentence);
    return all;
  }

  fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  /// The error if it can't be scanned.
  std::string refusal(const std::string& bytes) const {
    const auto result = scan_library(write("Odd.so", bytes));
    return result ? "" : to_string(result.errors());
  }

  const test::TemporaryFolder folder_;
};

using LibraryScanner = ScanTest;

TEST_F(LibraryScanner, HasNothingToSayOfAPlainLibrary) {
  EXPECT_THAT(scan(library("watched_plugin").parent_path() / "plugins" / "libwatched_plugin.so"), IsEmpty());
}

TEST_F(LibraryScanner, FindsEachKindOfInstructionWithItsFunctionAndLine) {
  const Findings seen = scan(library("instructions"));
  const std::pair<Kind, std::string> expected[] = {
      {Kind::float_mode_change, "remarkable::flush_to_zero()"},
      {Kind::fused_arithmetic, "remarkable::fused(double, double, double)"},
      {Kind::approximation, "remarkable::approximate(float)"},
      {Kind::time_stamp_counter, "remarkable::time_stamp()"},
      {Kind::hardware_random, "remarkable::drawn()"},
      {Kind::processor_query, "remarkable::processor()"},
      {Kind::direct_syscall, "remarkable::kernel_call()"},
  };
  for (const auto& [kind, function] : expected) {
    const auto finding = found(seen, kind);
    ASSERT_TRUE(finding) << to_string(kind);
    EXPECT_EQ(finding->function, function);
    EXPECT_THAT(finding->place, StartsWith("instructions.cpp:"));
    EXPECT_THAT(finding->sentence, HasSubstr(function + " (instructions.cpp:"));
    EXPECT_GE(finding->count, 1);
  }
  EXPECT_FALSE(found(seen, Kind::fast_math_startup));
}

TEST_F(LibraryScanner, CountsEachInstructionAmongThoseOfItsKind) {
  const Findings seen = scan(library("instructions"));
  EXPECT_EQ(found(seen, Kind::time_stamp_counter)->count, 2) << "rdtsc, rdtscp";
  EXPECT_EQ(found(seen, Kind::hardware_random)->count, 2) << "rdrand, rdseed";
  EXPECT_GE(found(seen, Kind::processor_query)->count, 2) << "cpuid, rdpid";
}

TEST_F(LibraryScanner, FindsWhatLinkingWithFastMathAdds) {
  EXPECT_THAT(sentences(scan(library("fast_math"))),
              ElementsAre(AllOf(
                  StartsWith("loading it switches the whole process to another floating-point mode, flush-to-zero"),
                  HasSubstr("set_fast_math"), HasSubstr("since it was linked with -ffast-math"))));
}

TEST_F(LibraryScanner, FindsAModeThatAStaticObjectSets) {
  EXPECT_THAT(sentences(scan(library("startup"))),
              ElementsAre(AllOf(HasSubstr("flush-to-zero"), EndsWith("Quick::Quick() (startup.cpp:7)"))));
}

TEST_F(LibraryScanner, ListsTheSourcesThatALibraryCanCall) {
  const Findings seen = scan(library("watched"));
  for (const std::string expected :
       {"std::chrono::steady_clock::now (clock)", "rand (random)", "getenv (environment)", "fopen (file)",
        "std::fstream (file)", "std::random_device (random)", "system (thread)"}) {
    const auto import = found(seen, Kind::imported_source, expected.substr(0, expected.find(' ')));
    ASSERT_TRUE(import) << expected;
    EXPECT_EQ(import->sentence, "it can call " + expected);
  }
  EXPECT_FALSE(found(seen, Kind::imported_source, "fprintf"));
}

TEST_F(LibraryScanner, KnowsAllThatTheInterposerSees) {
  const auto interposer = interposer_library();
  ASSERT_TRUE(interposer.ok()) << to_string(interposer.errors());
  const std::string listing = "nm --dynamic --defined-only --format=posix '" + interposer->string() + "'";
  FILE* const names = popen(listing.c_str(), "r");
  ASSERT_TRUE(names);
  // Most files closed are one's own, and the opening of a list is known.
  constexpr std::string_view later =
      " close closedir readdir readdir64 readdir64_r readdir_r rewinddir seekdir telldir ";
  int known = 0;
  for (char line[512]; fgets(line, sizeof line, names);) {
    const std::string name(line, strcspn(line, " "));
    if (name.starts_with("rehearse_interposer_") || is_one_of(name, later)) continue;
    EXPECT_TRUE(source_of_symbol(name)) << name;
    ++known;
  }
  EXPECT_EQ(pclose(names), 0);
  EXPECT_GT(known, 100);
}

TEST_F(LibraryScanner, SaysLessOfAStrippedLibrary) {
  const fs::path stripped = folder_ / "Stripped.so";
  ASSERT_EQ(std::system(("strip --strip-all -o " + stripped.string() + " " + library("fast_math").string()).c_str()),
            0);
  const auto finding = found(scan(stripped), Kind::fast_math_startup);
  ASSERT_TRUE(finding);
  EXPECT_THAT(finding->place, StartsWith("Stripped.so+0x"));
  EXPECT_THAT(finding->sentence, HasSubstr("probably linked with -ffast-math"));
}

using HostileLibrary = ScanTest;

TEST_F(HostileLibrary, ThatIsMissingEmptyOrATextIsRefused) {
  EXPECT_THAT(to_string(scan_library(folder_ / "None.so").errors()),
              HasSubstr("'None.so' can't be read: No such file or directory"));
  EXPECT_THAT(to_string(scan_library(folder_.path()).errors()), HasSubstr("is not a shared library"));
  EXPECT_THAT(refusal(""), HasSubstr("'Odd.so' is not a shared library"));
  EXPECT_THAT(refusal("int main() {}\n"), HasSubstr("'Odd.so' is not a shared library"));
}

TEST_F(HostileLibrary, OfAnotherMachineOrKindIsRefused) {
  std::string other = test::read_file(library("watched"));
  other[18] = static_cast<char>(183);  // e_machine: AArch64
  EXPECT_THAT(refusal(other), HasSubstr("another kind of processor than x86-64"));
  std::string program = test::read_file(library("watched"));
  program[16] = 2;  // e_type: a program at fixed addresses
  EXPECT_THAT(refusal(program), HasSubstr("an object file or a program"));
  std::string small = test::read_file(library("watched"));
  small[4] = 1;  // 32 bit
  EXPECT_THAT(refusal(small), HasSubstr("32-bit"));
}

TEST_F(HostileLibrary, WithoutATableOfSectionsIsRefused) {
  std::string bytes = test::read_file(library("watched"));
  bytes.replace(0x28, 8, 8, '\0');  // e_shoff
  bytes.replace(0x3c, 4, 4, '\0');  // e_shnum, e_shstrndx
  EXPECT_THAT(refusal(bytes), HasSubstr("has no table of sections"));
}

TEST_F(HostileLibrary, ThatWasCutOffIsRefusedWhereverItWas) {
  const std::string whole = test::read_file(library("instructions"));
  for (std::size_t length = 0; length < whole.size(); length += whole.size() / 97 + 1)
    EXPECT_THAT(refusal(whole.substr(0, length)), EndsWith("\n")) << length << " of " << whole.size() << " bytes";
}

TEST_F(HostileLibrary, WithAnyByteChangedEndsInAnAnswer) {
  const std::string whole = test::read_file(library("instructions"));
  for (std::size_t at = 0; at < whole.size(); at += whole.size() / 499 + 1) {
    std::string changed = whole;
    changed[at] = static_cast<char>(~changed[at]);
    const auto result = scan_library(write("Odd.so", changed));  // whatever the result, the scan returns
    EXPECT_TRUE(result.ok() || to_string(result.errors()).find("'Odd.so'") != std::string::npos);
  }
}

}  // namespace
}  // namespace rehearse
