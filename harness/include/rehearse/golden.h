// Goldens: recordings that were looked at and accepted, and their life.
//
// A golden is two files in one folder: `<Suite>.<Test>.mcap`, a whole recording that can be replayed, and
// `<Suite>.<Test>.txt`, its digest: what a person reads in a review. The digest is derived from the recording alone,
// and a golden whose digest says something else fails. A run that doesn't match never touches the golden; its trace is
// kept as `<pending folder>/<Suite>.<Test>.mcap`, from where it can be accepted without running again.
//
// Environment:
//   REHEARSE_GOLDEN      check (the default), new (write goldens that are missing) or accept (replace those that
//   differ) CI                   "true": nothing but check is possible REHEARSE_GOLDEN_DIR  the folder of goldens,
//   wherever the scenario stands REHEARSE_PENDING     where traces wait to be accepted; else rehearse-pending in the
//   working directory
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

enum class GoldenMode {
  check,   // compare; write nothing into the folder
  create,  // "new": a golden that is missing is written, all others are checked
  accept,  // a golden that is missing or differs is written
};

/// By REHEARSE_GOLDEN. Any other word, and anything but check under CI=true, is an error.
Result<GoldenMode> golden_mode();

/// By REHEARSE_PENDING.
std::filesystem::path pending_folder();

/// By REHEARSE_GOLDEN_DIR, else the nearest folder named `golden` beside the scenario or above it. An error if there is
/// none.
Result<std::filesystem::path> find_golden_folder(const std::filesystem::path& scenario);

/// What a golden has to say about a run.
struct GoldenResult {
  bool passed = false;
  std::string message;                   // for a person; several lines; what to do next if it didn't pass
  std::optional<Comparison> comparison;  // none if there was nothing to compare with
  bool written = false;                  // the golden is new, or was replaced
};

/// How strictly a run is compared with its golden.
struct SettleOptions {
  CompareOptions compare;
  bool exact = false;     // other bits fail, within tolerance or not
  std::string violation;  // why the run is wrong whatever its golden says, a sentence; empty: it isn't
};

class GoldenStore {
 public:
  explicit GoldenStore(std::filesystem::path folder, std::filesystem::path pending = pending_folder());

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path trace_file(const std::string& name) const;
  std::filesystem::path digest_file(const std::string& name) const;
  std::filesystem::path pending_file(const std::string& name) const;
  bool has(const std::string& name) const;

  /// Compares a run with the golden of that name and does what the mode says. Two runs of one process that claim the
  /// same golden with different recordings: the second fails. A run that is wrong by itself becomes no golden.
  GoldenResult settle(const std::string& name, const Trace& actual, const std::vector<ToleranceRule>& rules,
                      GoldenMode mode, const SettleOptions& options = {});

  /// Makes a trace the golden of that name: both files are written beside the old ones, synced, and renamed over them;
  /// on any failure the old ones stay. Refuses a trace that isn't whole, or whose run failed.
  Result<void> accept(const std::string& name, const std::filesystem::path& trace);

  /// accept() of the trace that waits, which is then removed. Returns what moved: the old golden compared with the new
  /// (nothing if there was none).
  Result<std::optional<Comparison>> accept_pending(const std::string& name);

  /// Fails if the digest isn't there or isn't what digest_of() makes of the recording.
  Result<void> check_digest(const std::string& name) const;

 private:
  Result<void> keep_pending(const std::string& name, const Trace& actual) const;
  GoldenResult fail_and_keep(const std::string& name, const Trace& actual, std::string message) const;
  std::filesystem::path folder_;
  std::filesystem::path pending_;
};

/// The digest of a recording: provenance; for each channel its messages and their hash, for each of its series unit,
/// first, last, smallest and largest value; pictures; events. Text, a line each.
Result<std::string> digest_of(const Trace& trace);

/// One golden, as a list shows it.
struct GoldenEntry {
  std::string name;
  std::vector<std::string> owners;  // scenario files and test sources that name it; empty: an orphan
  std::uintmax_t bytes = 0;         // of the recording; 0: there is only a digest
  std::string recorded_by;          // versions, as the recording states them
  bool pending = false;             // a run that differs waits to be accepted
  std::string problem;              // why it can't be used; empty: it can

  bool orphan() const { return owners.empty(); }
};

/// All goldens of the store by name. Owners are looked for in `sources`, folders or files: a scenario (*.yaml) with
/// `golden: NAME`, and a test source (*.cpp, *.cc) with EXPECT_MATCHES_GOLDEN and TEST(Suite, Test). Hidden folders and
/// those whose name begins with "build" are left out.
Result<std::vector<GoldenEntry>> list_goldens(const GoldenStore& store,
                                              const std::vector<std::filesystem::path>& sources);

}  // namespace rehearse
