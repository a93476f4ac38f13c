// Goldens: recordings that a person has examined and accepted, and the operations on them.
//
// A golden has two files in one folder. `<Suite>.<Test>.mcap` is a whole recording that can be replayed.
// `<Suite>.<Test>.txt` is its digest, which a person reads in a review. The digest is derived from the recording alone;
// a golden whose digest differs from its recording fails. A run that doesn't match never changes the golden. Its trace
// is kept as `<pending folder>/<Suite>.<Test>.mcap`, from where it can be accepted, whole or in part, without a new
// run. Each acceptance adds to the golden a record of the values that have changed (Acceptance).
//
// Environment:
//   REHEARSE_GOLDEN      check (the default), new (write goldens that are missing) or accept (replace goldens
//                        that differ)
//   CI                   "true": only check is possible
//   REHEARSE_GOLDEN_DIR  the folder of goldens, independent of the place of the scenario
//   REHEARSE_PENDING     the folder of pending traces; else build/goldens/pending if there is a build folder, or
//                        rehearse-pending in the working directory
//   SOURCE_DATE_EPOCH    the date of acceptances [s since 1970]; else the present date
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>
#include <rehearse/replay.h>
#include <rehearse/run_options.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

// Acceptance: the record that each acceptance of a golden adds to it, so that the golden contains its history.
//
// Each acceptance is a separate metadata record at the end of the golden's data section: `rehearse.acceptance.1` and
// on. Any MCAP tool shows them. A recording that isn't a golden has none: it contains no date.

/// One acceptance. All members are text for people, and go into the digest without change.
struct Acceptance {
  std::string date;      // UTC, as 2026-11-20
  std::string kind;      // "first", "replaced" or "partial"
  std::string accepted;  // partial: the accepted channels and the span
  std::string verdict;   // verdict of the comparison of the old golden with the new golden; empty for the first
  /// A line per channel that changed: the worst difference, its time, the number of differences.
  std::vector<std::string> moved;
};

/// Prefix of the names of acceptance records.
inline constexpr std::string_view acceptance_prefix = "rehearse.acceptance.";

/// Today in UTC, or the day that SOURCE_DATE_EPOCH states [s since 1970]. Fails if that is no number.
Result<std::string> date_of_today();

/// A line for each channel that changed, worst first, and the other changes that explain it; at most fourteen lines.
std::vector<std::string> moved_lines(const Comparison& comparison);

/// The acceptances that a file contains, oldest first.
std::vector<Acceptance> history_of(const std::vector<mcap::Metadata>& metadata);

/// The records of a history.
std::vector<mcap::Metadata> records_of(const std::vector<Acceptance>& history);

/// The verdict and the lines about changed channels, for the head of the digest.
std::string acceptance_text(const Acceptance& acceptance);

/// The history for the digest: two or more lines per acceptance; empty without acceptances.
std::string history_text(const std::vector<Acceptance>& history);

// Partial acceptance: some channels or some time span of a run are accepted into a golden; the golden keeps all else.
//
// A golden is a recording, so some run must be able to produce it: its commands follow from its inputs, its state from
// its commands, its sensors and pictures from its state. A part of a run can be accepted only if the resulting golden
// has this property. The procedure:
//
// 1. The candidate is the run (its scenario, models and provenance), with the golden's messages on every channel and
//    outside of the span that isn't accepted. The hashes in /tick, checkpoints and transforms come from the same
//    recording as the stage from which they are computed.
// 2. If all kept messages have the same bits in both, the candidate is the run itself, and is accepted whole.
// 3. Otherwise it is executed again, stage by stage. Its inputs, fed to the controllers, must give its commands. Its
//    commands, applied to the world from checkpoint to checkpoint, must give its state, sensors and pictures, bit for
//    bit.
// 4. Any other candidate is refused. The error states the first place where a kept channel doesn't follow, and the
//    channels that changed together with it.

/// The part of a run to accept.
struct Selection {
  std::vector<std::string> channels;  // patterns of topics and series, `*` for any text; empty: all
  double from = 0.0;                  // [s]
  std::optional<double> until;        // exclusive [s]

  bool is_all() const { return channels.empty() && from <= 0.0 && !until; }
};

/// "channels /SR1/Eye/*, from 1 s, until 2 s".
std::string to_string(const Selection& selection);

/// The means to execute a candidate again.
struct Reexecution {
  HostOptions host;
  /// session.h: run_plant, from the caller that simulates. Null: a run can be accepted only if all kept messages are
  /// equal to its own.
  RunPlant run_plant;
  /// Replays the candidate. Null: replay() does, in this process.
  std::function<Result<ReplayReport>(const std::filesystem::path& recording, const ReplayOptions& options)> replay = {};
  /// Files that may be the run's scenario. A recording has no meshes: a run with meshes needs its scenario file.
  std::vector<std::filesystem::path> scenarios;
};

/// The recording that would become the golden: the file of the run, or `candidate`, which is written. Fails if no run
/// can produce it, or if the selection selects nothing; then no file is left behind.
Result<std::filesystem::path> make_partial(const Trace& golden, const Trace& run, const Selection& selection,
                                           const std::filesystem::path& candidate, const Reexecution& again);

enum class GoldenMode {
  check,   // compare; write nothing into the folder
  create,  // "new": a golden that is missing is written, all others are checked
  accept,  // a golden that is missing or differs is written
};

/// True if the environment has CI=true: the machine checks goldens and writes none, and nobody reads files from its
/// disk.
bool is_ci();

/// The steps for a run that differs from its golden but may be right, a line each: to inspect it and to accept it.
/// Under CI the steps name the machine to do this on. `goldens`: their folder; the steps begin with a change to its
/// project if this folder isn't in it. Empty: they don't.
std::string acceptance_advice(const std::string& name, const std::filesystem::path& goldens = {});

/// The command that restores damaged files: "git checkout -- golden/A.B.mcap brings back what was committed".
std::string way_back(const std::string& files);

/// The mode of REHEARSE_GOLDEN. Any other word is an error; so is any mode but check under CI=true.
Result<GoldenMode> golden_mode();

/// The folder of REHEARSE_PENDING; its default is in the project of a file, of this folder if none is named.
std::filesystem::path pending_folder(const std::filesystem::path& inside = "./");

/// The folder of REHEARSE_GOLDEN_DIR. Otherwise it is `golden` in the project of the scenario: the nearest folder above
/// it that has a folder `golden`, else the nearest that has a CMakeLists.txt, a pyproject.toml or a pytest.ini. In the
/// second case the folder is made with the first golden. Fails if no folder above has one of these.
Result<std::filesystem::path> find_golden_folder(const std::filesystem::path& scenario);

/// The result of the comparison of a run with its golden.
struct GoldenResult {
  bool passed = false;
  std::string message;                   // for a person; several lines; the next steps if the run didn't pass
  std::optional<Comparison> comparison;  // none if there was nothing to compare with
  bool written = false;                  // the golden is new, or was replaced
};

/// The strictness of the comparison of a run with its golden.
struct SettleOptions {
  CompareOptions compare;
  bool exact = false;     // different bits fail, within tolerance or not
  std::string violation;  // a sentence: why the run is wrong independently of its golden; empty: it is not wrong
  std::string hint;       // for a golden that is missing: hint_for_missing()
};

/// The result of an acceptance.
struct Accepted {
  bool changed = true;  // false: the golden was equal to this run, and was not rewritten
  bool whole = true;    // false: a part of the run was accepted; the run stays in the pending folder
  /// The comparison of the old golden with the new golden; nullopt if no old golden could be read.
  std::optional<Comparison> moved;
  std::string verdict;  // as in the digest: the verdict of the check, else of `moved`; empty without `moved`
};

class GoldenStore {
 public:
  explicit GoldenStore(std::filesystem::path folder, std::filesystem::path pending = pending_folder());

  const std::filesystem::path& folder() const { return folder_; }
  const std::filesystem::path& where_runs_wait() const { return pending_; }
  std::filesystem::path trace_file(const std::string& name) const;
  std::filesystem::path digest_file(const std::string& name) const;
  std::filesystem::path pending_file(const std::string& name) const;
  bool has(const std::string& name) const;
  /// The names of the goldens, in no order.
  std::vector<std::string> names() const;

  /// Compares a run with the golden `name` and acts as the mode states. If two runs of one process use the same golden
  /// with different recordings, the second fails. A run with a violation becomes no golden.
  GoldenResult settle(const std::string& name, const Trace& actual, const std::vector<ToleranceRule>& rules,
                      GoldenMode mode, const SettleOptions& options = {});

  /// The verdict of the last check of the pending run of that name, a sentence; acceptances state it. Empty: no check
  /// has judged this trace, byte by byte.
  std::string pending_verdict(const std::string& name) const;
  /// Stores the verdict beside the pending trace. Fails if it can't be written, or if the trace can't be read.
  Result<void> keep_pending_verdict(const std::string& name, const std::string& verdict) const;

  /// The names of the pending runs.
  std::vector<std::string> pending() const;

  /// Makes a trace the golden `name`. Both files are written beside the old files, synced, and renamed over them; on
  /// any failure the old files stay. The old golden's history is copied, and a record of the changes is added. If the
  /// trace has the golden's bits, scenario, models and versions, nothing changes. Refuses a trace that is incomplete,
  /// or whose run failed.
  Result<Accepted> accept(const std::string& name, const std::filesystem::path& trace);

  /// Accepts the pending run and removes it.
  Result<Accepted> accept_pending(const std::string& name);

  /// Accepts a part of the pending run, if some run can produce the resulting golden (make_partial). Otherwise nothing
  /// is written, and the error states the first place that no run can produce. The pending run stays unless all of it
  /// was accepted.
  Result<Accepted> accept_pending(const std::string& name, const Selection& selection, const Reexecution& again);

  /// Removes the pending run and its pictures.
  Result<void> reject(const std::string& name);

  /// Moves both files of a golden into a folder; without a folder it removes them. Refuses if one of the two is
  /// missing, or if they aren't a recording and a digest.
  Result<void> remove(const std::string& name, const std::filesystem::path& to = {});

  /// Fails if the digest is missing or differs from digest_of() of the recording.
  Result<void> check_digest(const std::string& name) const;

 private:
  Result<void> keep_pending(const std::string& name, const Trace& actual) const;
  GoldenResult fail_and_keep(const std::string& name, const Trace& actual, std::string message) const;
  Result<Accepted> replace(const std::string& name, const std::filesystem::path& trace, const std::string& part,
                           const std::string& judged);
  Result<void> find_pending(const std::string& name) const;
  std::filesystem::path folder_;
  std::filesystem::path pending_;
};

/// The file of a golden's measured noise: beside it, with the ending .noise.
std::filesystem::path noise_file_of(const std::filesystem::path& golden);

/// The file of the instructions that control() takes in a golden's replay: beside it, with the ending .instructions.
std::filesystem::path instructions_file_of(const std::filesystem::path& golden);

/// The first words of a digest, which name its format.
inline constexpr const char* digest_form = "digest 2";

/// The digest of a recording, as lines of text: the date, reason and changes of its acceptance; its provenance, its
/// outcome and a hash of all recorded data; earlier acceptances; events. For each channel it has the number of
/// messages, for each of its series unit, first, last, smallest and largest value. Values have five digits and are no
/// finer than the unit's tolerance.
Result<std::string> digest_of(const Trace& trace);

/// One golden, as a list shows it.
struct GoldenEntry {
  std::string name;
  std::vector<std::string> owners;  // scenario files that name it, tests that compared with it; empty: none are known
  std::uintmax_t bytes = 0;         // size of the recording; 0: only a digest exists
  std::string recorded_by;          // versions, as the recording states them
  std::string accepted;             // date of the last acceptance, as 2026-11-20; empty: the golden states none
  int acceptances = 0;              // number of acceptances that the golden states
  bool pending = false;             // a run that differs is in the pending folder
  std::string problem;              // why it can't be used; empty: it can be used
  /// Differences of its versions from this program's, parts that can't be compared; sentences.
  std::vector<std::string> notes;

  bool orphan() const { return owners.empty(); }
};

/// The scenarios and tests that use a golden.
struct GoldenOwners {
  std::vector<std::string> scenarios;  // files with `golden: NAME`
  /// Tests that compared with it when they ran, by program, as "Walker.Stops of build/bin/walk_test".
  std::vector<std::string> tests;
  /// Sources that have the test of its name, relative to the project.
  std::vector<std::string> sources;

  /// The reason why the owners are in conflict: two scenarios name the golden, or two sources have its test. Empty: no
  /// conflict. (A test may record a scenario that names the test's golden.)
  std::string conflict() const;
};

/// The scenarios that name the goldens in a folder, by golden. They are searched in `sources`, folders or files: a
/// scenario is a *.yaml. The search leaves out hidden folders, node_modules and builds (build*). It also leaves out
/// files that have a different folder `golden` nearer to them: they belong to a different project.
std::map<std::string, GoldenOwners> find_golden_owners(const std::filesystem::path& folder,
                                                       const std::vector<std::filesystem::path>& sources);

/// Writes a note into the pending folder that a test of this program compares with a golden. `test`: Suite.Test;
/// `source`: its source, as it was compiled; empty: it is unknown, or the test is no owner. A failure to write is
/// ignored.
void report_golden_owner(const GoldenStore& goldens, const std::string& golden, const std::string& test,
                         const std::filesystem::path& source = {});

/// The tests of all these notes, by golden. A test belongs to its source: a program that is moved, or built in another
/// folder, is no second owner, and neither is a source that no longer has the test.
std::map<std::string, GoldenOwners> reported_golden_owners(const GoldenStore& goldens);

/// The owners in the notes of one golden.
GoldenOwners reported_owners_of(const GoldenStore& goldens, const std::string& golden);

/// A hint for a missing golden: a golden of nearly that name that no scenario names, and that no test uses which ran
/// here or is in the source of the missing golden's test. "golden 'Hold.Stands' has nearly that name, and no test of
/// that name is known: ...". Empty: there is none.
std::string hint_for_missing(const GoldenStore& goldens, const std::string& golden);

/// All goldens of the store by name. Their owners are the scenarios in `sources` and the tests that reported themselves
/// (report_golden_owner()); a test that never ran here is unknown. `present`: the facts of a recording's provenance as
/// this program would write them (rehearse, physics, renderer, libc). A golden with different facts is reported to be
/// of a different version.
Result<std::vector<GoldenEntry>> list_goldens(const GoldenStore& store,
                                              const std::vector<std::filesystem::path>& sources,
                                              const mcap::StringMap& present = {});

}  // namespace rehearse
