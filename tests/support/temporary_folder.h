// A folder for a test.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace rehearse::test {

/// A new folder, whose name has that of the running test; removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = "rehearse_";
    if (const auto* test = ::testing::UnitTest::GetInstance()->current_test_info())
      name += std::string(test->test_suite_name()) + "." + test->name() + "_";
    for (char& c : name)
      if (c == '/') c = '_';
    std::string pattern = (std::filesystem::temp_directory_path() / (name + "XXXXXX")).string();
    EXPECT_NE(mkdtemp(pattern.data()), nullptr) << pattern;
    path_ = pattern;
    using std::filesystem::perms;
    std::filesystem::permissions(path_, perms::owner_all | perms::group_read | perms::group_exec | perms::others_read |
                                            perms::others_exec);  // another user may read it, as with mkdir
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

  /// Writes a file, and creates its folders.
  std::filesystem::path write(const std::filesystem::path& name, std::string_view content) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace rehearse::test
