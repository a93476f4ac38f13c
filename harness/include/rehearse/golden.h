// Goldens: recordings that were looked at and accepted, and their life.
//
// A golden is two files in one folder: `<Suite>.<Test>.mcap`, a whole recording that can be replayed, and
// `<Suite>.<Test>.txt`, its digest: what a person reads in a review. The digest is derived from the recording alone,
// and a golden whose digest says something else fails. A run that doesn't match never touches the golden; its trace is
// kept as `<pending folder>/<Suite>.<Test>.mcap`, from where it can be accepted, whole or in part, without running
// again. Each acceptance adds to the golden what moved (Acceptance).
//
// Environment:
//   REHEARSE_GOLDEN      check (the default), new (write goldens that are missing) or accept (replace those that
//                        differ)
//   CI                   "true": nothing but check is possible
//   REHEARSE_GOLDEN_DIR  the folder of goldens, wherever the scenario stands
//   REHEARSE_PENDING     where traces wait to be accepted; else build/goldens/pending, where there is a build folder,
//                        or rehearse-pending in the working directory
//   SOURCE_DATE_EPOCH    the time that acceptances are dated by [s since 1970]; else now
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/host_options.h>
#include <rehearse/mcap.h>
#include <rehearse/simulation.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

// Acceptance: what is written into a golden when somebody accepts it, so that its history travels with it.
//
// Each acceptance is a metadata record of its own at the end of the golden's data section, `rehearse.acceptance.1` and
// on; any MCAP tool shows them. A recording that isn't a golden has none: nothing of the calendar is in it.

/// One acceptance. Text throughout: it is for people, and goes into the digest as it is.
struct Acceptance {
  std::string date;                // UTC, as 2026-11-20
  std::string kind;                // "first", "replaced" or "partial"
  std::string accepted;            // partial: which channels and which span
  std::string verdict;             // of the old golden and the new one; empty for the first
  std::vector<std::string> moved;  // a line each: what moved, by how much at worst, when, how often
};

/// Names of acceptance records begin so.
inline constexpr std::string_view acceptance_prefix = "rehearse.acceptance.";

/// Today in UTC, or the day that SOURCE_DATE_EPOCH states [s since 1970]. An error if that is no number.
Result<std::string> date_of_today();

/// What moved: a line for each channel, worst first, and what else explains it; at most fourteen lines.
std::vector<std::string> moved_lines(const Comparison& comparison);

/// The acceptances that stand in a file, oldest first.
std::vector<Acceptance> history_of(const std::vector<mcap::Metadata>& metadata);

/// The records of a history.
std::vector<mcap::Metadata> records_of(const std::vector<Acceptance>& history);

/// For the head of the digest: the verdict and the lines of what moved.
std::string acceptance_text(const Acceptance& acceptance);

/// For the digest: two lines and more an acceptance; empty without any.
std::string history_text(const std::vector<Acceptance>& history);

// Partial acceptance: some channels of a run, or some span of its time, into a golden that keeps the rest.
//
// A golden is a recording, and a recording is what some run produced: its commands follow from its inputs, its state
// from its commands, its sensors and pictures from its state. So a part of a run can be accepted only if that stays
// true of what comes of it. How it is decided:
//
// 1. The candidate is the run (its scenario, models and provenance), with the golden's messages on every channel and
//    outside of the span that isn't accepted. The hashes in /tick, checkpoints and transforms follow the stage that
//    they are made of.
// 2. If all that is kept has the same bits in both, the candidate is the run itself, and is accepted whole.
// 3. Otherwise it is executed again, stage by stage: its inputs into the controllers have to give its commands, and its
//    commands into the world, from checkpoint to checkpoint, its state, sensors and pictures; bit for bit.
// 4. Anything else is refused, with the first place where a channel that is kept doesn't follow, and the channels that
//    moved together with it.

/// Which part of a run.
struct Selection {
  std::vector<std::string> channels;  // patterns of topics and series, `*` for any text; empty: all
  double from = 0.0;                  // [s]
  std::optional<double> until;        // [s], itself not included

  bool is_all() const { return channels.empty() && from <= 0.0 && !until; }
};

/// "channels /SR1/Eye/*, from 1 s, until 2 s".
std::string to_string(const Selection& selection);

/// What a candidate is executed again with.
struct Reexecution {
  HostOptions host;
  /// session.h: run_plant, from who simulates. Null: only what is the run itself in all that is kept can be accepted.
  RunPlant run_plant;
  /// Files that may be the run's scenario. A recording has no meshes: a run with meshes needs the file that it is of.
  std::vector<std::filesystem::path> scenarios;
};

/// The recording that would become the golden: the run's own file, or `candidate`, which was written. Fails if no run
/// can produce it, or if the selection selects nothing; then nothing is left behind.
Result<std::filesystem::path> make_partial(const Trace& golden, const Trace& run, const Selection& selection,
                                           const std::filesystem::path& candidate, const Reexecution& again);

enum class GoldenMode {
  check,   // compare; write nothing into the folder
  create,  // "new": a golden that is missing is written, all others are checked
  accept,  // a golden that is missing or differs is written
};

/// CI=true in the environment: a machine that checks goldens and writes none, and whose disk nobody looks at.
bool is_ci();

/// The steps for a run that isn't its golden but may be right, one a line: to look at it and to accept it; under CI, on
/// which machine.
std::string acceptance_advice(const std::string& name);

/// By REHEARSE_GOLDEN. Any other word, and anything but check under CI=true, is an error.
Result<GoldenMode> golden_mode();

/// By REHEARSE_PENDING.
std::filesystem::path pending_folder();

/// By REHEARSE_GOLDEN_DIR, else `golden` in the project of the scenario: the nearest folder above it that has a folder
/// `golden`, else the nearest that has a CMakeLists.txt; then the folder is made with the first golden. An error if no
/// folder above has either.
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

/// What accepting a run did.
struct Accepted {
  bool changed = true;              // false: the golden was this run already, and not a byte of it was touched
  bool whole = true;                // false: a part of the run was accepted, the rest of it waits
  std::optional<Comparison> moved;  // the old golden and the new; none if there was none that could be read
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

  /// Compares a run with the golden of that name and does what the mode says. Two runs of one process that claim the
  /// same golden with different recordings: the second fails. A run that is wrong by itself becomes no golden.
  GoldenResult settle(const std::string& name, const Trace& actual, const std::vector<ToleranceRule>& rules,
                      GoldenMode mode, const SettleOptions& options = {});

  /// What a check has said of the run that waits under that name, a sentence; acceptances state it. Empty: none has.
  std::string pending_verdict(const std::string& name) const;
  Result<void> keep_pending_verdict(const std::string& name, const std::string& verdict) const;

  /// The runs that wait, by name.
  std::vector<std::string> pending() const;

  /// Makes a trace the golden of that name: both files are written beside the old ones, synced, and renamed over them;
  /// on any failure the old ones stay. The old golden's history is carried over, and what moved is added to it. A trace
  /// that is the golden already, bit for bit, with the same scenario, models and versions, changes nothing. Refuses a
  /// trace that isn't whole, or whose run failed.
  Result<Accepted> accept(const std::string& name, const std::filesystem::path& trace);

  /// accept() of the run that waits, which is then removed.
  Result<Accepted> accept_pending(const std::string& name);

  /// The same of a part of it, if some run can produce the golden that would come of it (make_partial);
  /// otherwise nothing is written, and the error says where it stops to be a run. The run waits on if all of it wasn't
  /// accepted.
  Result<Accepted> accept_pending(const std::string& name, const Selection& selection, const Reexecution& again);

  /// Removes the run that waits, and its pictures.
  Result<void> reject(const std::string& name);

  /// Moves both files of a golden into a folder; without one removes them. Refuses if they aren't two, or aren't a
  /// recording and a digest.
  Result<void> remove(const std::string& name, const std::filesystem::path& to = {});

  /// Fails if the digest isn't there or isn't what digest_of() makes of the recording.
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

/// The first words of a digest name its form.
inline constexpr const char* digest_form = "digest 2";

/// The digest of a recording: when and why it was accepted, and what moved; provenance, outcome and a hash of all that
/// was recorded; earlier acceptances; events; for each channel its messages, for each of its series unit, first, last,
/// smallest and largest value, to five digits and no finer than the unit's tolerance. Text, a line each.
Result<std::string> digest_of(const Trace& trace);

/// One golden, as a list shows it.
struct GoldenEntry {
  std::string name;
  std::vector<std::string> owners;  // scenario files that name it, tests that compared with it; empty: none known
  std::uintmax_t bytes = 0;         // of the recording; 0: there is only a digest
  std::string recorded_by;          // versions, as the recording states them
  std::string accepted;             // when it was accepted last, as 2026-11-20; empty: the golden doesn't say
  int acceptances = 0;              // that it knows of
  bool pending = false;             // a run that differs waits to be accepted
  std::string problem;              // why it can't be used; empty: it can
  std::vector<std::string> notes;   // what is older than the program, what can't be compared; sentences

  bool orphan() const { return owners.empty(); }
};

/// Who names a golden.
struct GoldenOwners {
  std::vector<std::string> scenarios;  // files with `golden: NAME`
  std::vector<std::string> tests;      // that compared with it when they ran, as "Walker.Stops of build/bin/walk_test"

  /// Why they aren't one: two scenarios name it. Empty if they are. (A test may record a scenario that names the test's
  /// golden.)
  std::string conflict() const;
};

/// The scenarios that name the goldens in a folder, by golden. Looked for in `sources`, folders or files: a scenario is
/// a *.yaml. Hidden folders and those whose name begins with "build" are left out, and files that have another folder
/// `golden` nearer by: they are of another project.
std::map<std::string, GoldenOwners> find_golden_owners(const std::filesystem::path& folder,
                                                       const std::vector<std::filesystem::path>& sources);

/// Takes note, where runs wait, that a test of this program compares with a golden. `test`: Suite.Test. What can't be
/// written fails nothing.
void report_golden_owner(const std::filesystem::path& pending, const std::string& golden, const std::string& test);

/// All such notes: the tests by golden.
std::map<std::string, std::vector<std::string>> reported_golden_owners(const std::filesystem::path& pending);

/// All goldens of the store by name. Their owners are the scenarios in `sources` and the tests that reported themselves
/// (report_golden_owner()): a test that never ran here isn't known. `present`: the facts of a recording's
/// provenance as this program would write them (rehearse, physics, renderer, libc); a golden that has others is told to
/// be of another version.
Result<std::vector<GoldenEntry>> list_goldens(const GoldenStore& store,
                                              const std::vector<std::filesystem::path>& sources,
                                              const mcap::StringMap& present = {});

}  // namespace rehearse
