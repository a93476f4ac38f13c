// A folder of goldens, a folder of pending runs, and small recordings for both.
#pragma once

#include <gtest/gtest.h>
#include <rehearse/golden.h>

#include <fstream>

#include "small_traces.h"
#include "support/environment_variable.h"
#include "support/files.h"

namespace rehearse::testing {

namespace fs = std::filesystem;

using test::EnvironmentVariable;
using test::read_file;

inline void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

class GoldenFolder : public ::testing::Test {
 protected:
  GoldenFolder() : store_(folder_ / "golden", folder_ / "pending") { fs::create_directories(folder_ / "golden"); }

  GoldenResult settle(const SmallTrace& run, GoldenMode mode = GoldenMode::check, const SettleOptions& options = {}) {
    return store_.settle(name_, run.load(folder_ / "run.mcap"), {}, mode, options);
  }
  /// Writes a golden without claiming it for this process.
  void place_golden(const SmallTrace& run) {
    run.write(folder_ / "accepted.mcap");
    const auto accepted = store_.accept(name_, folder_ / "accepted.mcap");
    ASSERT_TRUE(accepted) << to_string(accepted.errors());
  }
  SmallTrace changed() const {
    SmallTrace run;
    run.ticks[1].u = 99.0;
    return run;
  }

  /// True if the golden contains that run.
  bool is_run(const SmallTrace& run) const {
    const auto golden = Trace::load(store_.trace_file(name_));
    return golden && compare(*golden, run.load(folder_ / "other.mcap"), {}).equal;
  }
  /// Adds a pending run.
  void place_pending(const SmallTrace& run) const {
    fs::create_directories(folder_ / "pending");
    run.write(store_.pending_file(name_));
  }
  std::string digest() const { return read_file(store_.digest_file(name_)); }

  TemporaryFolder folder_;
  GoldenStore store_;
  std::string name_ = std::string("Golden.") + ::testing::UnitTest::GetInstance()->current_test_info()->name();
  const EnvironmentVariable day_{"SOURCE_DATE_EPOCH", "1763640000"};  // 2025-11-20
};

}  // namespace rehearse::testing
