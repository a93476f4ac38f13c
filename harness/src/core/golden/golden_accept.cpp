// Accepting a run as a golden, and removing a golden.
#include <fcntl.h>
#include <fmt/format.h>
#include <rehearse/compare.h>
#include <rehearse/golden.h>
#include <rehearse/mcap.h>
#include <sys/file.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <set>

#include "base/file_descriptor.h"
#include "base/hashing.h"
#include "core/mcap/copy.h"
#include "core/trace/run_facts.h"
#include "golden_files.h"
#include "state_samples.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

bool same_attachments(const Trace& a, const Trace& b) {
  const auto equal = [](const mcap::Attachment& one, const mcap::Attachment& other) {
    return one.name == other.name && std::ranges::equal(one.data, other.data);
  };
  return std::ranges::equal(a.attachments(), b.attachments(), equal);
}

/// True if the golden would not change.
bool is_same_run(const Trace& golden, const Trace& run, const Comparison& comparison) {
  const RunFacts of_golden = RunFacts::of(golden), of_run = RunFacts::of(run);
  return comparison.equal && same_attachments(golden, run) &&
         std::ranges::all_of(facts::versions,
                             [&](const char* fact) { return of_golden.stated(fact) == of_run.stated(fact); });
}

/// A comparison with the run's own tolerances, for the verdict; without tolerances if they can't be read.
Comparison compare_by_its_tolerances(const Trace& golden, const Trace& run) {
  const auto rules = tolerances_of(run);
  return compare(golden, run, rules ? *rules : std::vector<ToleranceRule>());
}

/// The history in the readable part of a file.
std::vector<Acceptance> history_in(const fs::path& file) {
  const auto reader = mcap::Reader::open(file);
  return reader ? history_of((*reader)->metadata()) : std::vector<Acceptance>();
}

Result<Trace> load_run(const fs::path& file) {
  auto trace = Trace::load(file);
  if (!trace) return trace;
  REHEARSE_TRY(check_trace_version(trace->metadata(), trace->file()));
  const auto outcome = RunFacts::of(*trace).outcome;
  if (!outcome) return error(fmt::format("{} isn't a finished recording, so it can't become a golden", file.string()));
  if (outcome->failure)
    return error(
        fmt::format("the run in {} failed, so it can't become a golden: {}", file.string(), *outcome->failure));
  return trace;
}

Result<std::string> digest_of_file(const fs::path& file) {
  const auto trace = REHEARSE_TRY(Trace::load(file));
  return digest_of(trace);
}

/// Fails if another process accepted or rejected the run while this one waited for its turn.
Result<void> still_waits(const fs::path& trace, const std::string& name) {
  std::error_code ignored;
  if (fs::is_regular_file(trace, ignored)) return {};
  return error(fmt::format("another process has accepted or rejected the run that waited as '{}'", name),
               "rehearse golden list shows the goldens as they are now");
}

/// Locks a run that waits, so that one acceptance after the other decides it. Not its folder, which a check locks.
class RunLock {
 public:
  explicit RunLock(const fs::path& trace) : descriptor_(::open(trace.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_ >= 0)
      while (::flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) continue;
  }

 private:
  FileDescriptor descriptor_;
};

/// Removes a run that waited, and the run of the check's plant level.
Result<void> remove_waiting(const fs::path& trace) {
  std::error_code failed;
  fs::remove(trace, failed);
  if (failed) return error(fmt::format("{} can't be removed: {}", trace.string(), failed.message()));
  remove_run(trace);
  remove_run(trace.parent_path() / "plant" / trace.filename());
  return {};
}

/// A file that is removed when this goes out of scope.
struct RemovedFile {
  const fs::path file;
  ~RemovedFile() {
    std::error_code ignored;
    fs::remove(file, ignored);
  }
};

bool begins_with(const fs::path& file, std::string_view text) {
  const auto content = read_text(file);
  return content && content->starts_with(text);
}

}  // namespace

Result<void> GoldenStore::find_pending(const std::string& name) const {
  std::error_code ignored;
  const fs::path waiting = pending_file(name);
  if (name.find('/') == std::string::npos && fs::is_regular_file(waiting, ignored)) return {};
  const std::vector<std::string> others = pending();
  std::string hint;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, others.size()); ++i)
    hint += (hint.empty() ? "waiting: " : ", ") + others[i];
  if (others.size() > 3) hint += ", ...";
  return error(fmt::format("nothing waits to be accepted as '{}': there is no {}", name, waiting.string()), hint);
}

std::string GoldenStore::pending_verdict(const std::string& name) const {
  const auto content = hash_of_file(pending_file(name));
  const auto text = read_text(verdict_file_of(pending_file(name)));
  if (!content || !text) return "";
  const std::string mark = hash_text(*content) + "\n";
  if (!text->starts_with(mark) || !text->ends_with('\n')) return "";
  return text->substr(mark.size(), text->size() - mark.size() - 1);
}

Result<void> GoldenStore::keep_pending_verdict(const std::string& name, const std::string& verdict) const {
  const auto content = REHEARSE_TRY(hash_of_file(pending_file(name)));
  const fs::path file = verdict_file_of(pending_file(name));
  std::ofstream stream(file, std::ios::binary);  // in the folder of the run, from where both are published
  stream << hash_text(content) << '\n' << verdict << '\n';
  if (stream.flush()) return {};
  return error(fmt::format("{} can't be written", file.string()));
}

std::vector<std::string> GoldenStore::pending() const {
  std::set<std::string> names;
  std::error_code ignored;
  for (fs::directory_iterator entry(pending_, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    const std::string name = entry->path().stem().string();
    // The folder also contains other traces, of scenarios without a golden.
    if (entry->path().extension() == ".mcap" && name.find('.') != std::string::npos) names.insert(name);
  }
  return {names.begin(), names.end()};
}

/// `judged`: the verdict of a check; empty: the two recordings are compared here.
Result<Accepted> GoldenStore::replace(const std::string& name, const fs::path& trace_path, const std::string& part,
                                      const std::string& judged) {
  const auto run = REHEARSE_TRY(load_run(trace_path));
  const auto today = REHEARSE_TRY(date_of_today());
  Accepted accepted;
  Acceptance acceptance{today, "first", part, "", {}};
  std::vector<Acceptance> history;
  if (has(name)) {
    acceptance.kind = part.empty() ? "replaced" : "partial";
    history = history_in(trace_file(name));
    if (const auto golden = Trace::load(trace_file(name)); !golden) {
      acceptance.verdict = "the golden before it can't be read: " + golden.errors()[0].message;
    } else {
      accepted.moved = compare_by_its_tolerances(*golden, run);
      accepted.verdict = acceptance.verdict = judged.empty() ? verdict(*accepted.moved) : judged;
      acceptance.moved = moved_lines(*accepted.moved);
      if (is_same_run(*golden, run, *accepted.moved)) {
        accepted.changed = !check_digest(name);
        if (!accepted.changed) return accepted;
        const auto digest = REHEARSE_TRY(digest_of(*golden));
        REHEARSE_TRY(replace_text(digest_file(name), digest));
        return accepted;
      }
    }
  }
  history.push_back(std::move(acceptance));
  const auto write_trace = [&](const fs::path& file) -> Result<void> {
    const RemovedFile scratch{file.string() + ".samples"};
    const auto kept = REHEARSE_TRY(with_state_samples(trace_path, scratch.file));
    return mcap::copy_with_metadata(kept, file, acceptance_prefix, records_of(history));
  };
  REHEARSE_TRY(replace_together(trace_file(name), write_trace, digest_file(name), digest_of_file));
  return accepted;
}

Result<Accepted> GoldenStore::accept(const std::string& name, const fs::path& trace) {
  return replace(name, trace, "", "");
}

Result<Accepted> GoldenStore::accept_pending(const std::string& name) {
  REHEARSE_TRY(find_pending(name));
  const RunLock alone(pending_file(name));
  REHEARSE_TRY(still_waits(pending_file(name), name));
  auto accepted = replace(name, pending_file(name), "", pending_verdict(name));
  if (!accepted) {
    const auto waits = still_waits(pending_file(name), name);  // a check or a rejection may have removed it
    return waits ? accepted : waits.errors();
  }
  REHEARSE_TRY(remove_waiting(pending_file(name)));
  return accepted;
}

Result<Accepted> GoldenStore::accept_pending(const std::string& name, const Selection& selection,
                                             const Reexecution& again) {
  if (selection.is_all()) return accept_pending(name);
  REHEARSE_TRY(find_pending(name));
  if (!has(name))
    return error(fmt::format("there is no golden {}, so no part of it can be kept", trace_file(name).string()),
                 "accept all of the run");
  const auto golden = REHEARSE_TRY(Trace::load(trace_file(name)));
  REHEARSE_TRY(check_trace_version(golden.metadata(), golden.file()));
  const RemovedFile scratch{pending_file(name).string() + ".samples"};
  const auto kept = REHEARSE_TRY(with_state_samples(pending_file(name), scratch.file));
  const auto run = REHEARSE_TRY(load_run(kept));
  if (RunFacts::of(run).state_rate != RunFacts::of(golden).state_rate)
    return error("the golden keeps the state at another rate than the run's scenario asks for",
                 "accept all of the run");
  const RemovedFile candidate{pending_file(name).string() + ".candidate"};
  const auto made = REHEARSE_TRY(make_partial(golden, run, selection, candidate.file, again));
  if (made != candidate.file) return accept_pending(name);
  auto accepted = replace(name, candidate.file, to_string(selection), "");
  if (accepted) accepted->whole = false;
  return accepted;
}

Result<void> GoldenStore::reject(const std::string& name) {
  REHEARSE_TRY(find_pending(name));
  return remove_waiting(pending_file(name));
}

namespace {

/// Renames a file, or copies it to a different file system.
void move_file(const fs::path& file, const fs::path& folder, std::error_code& failed) {
  fs::create_directories(folder, failed);
  if (!failed) fs::rename(file, folder / file.filename(), failed);
  if (failed != std::errc::cross_device_link) return;
  fs::copy_file(file, folder / file.filename(), fs::copy_options::overwrite_existing, failed);
  if (!failed) fs::remove(file, failed);
}

}  // namespace

Result<void> GoldenStore::remove(const std::string& name, const fs::path& to) {
  const fs::path trace = trace_file(name), digest = digest_file(name);
  std::error_code failed;
  const bool both = fs::is_regular_file(trace, failed) && fs::is_regular_file(digest, failed);
  if (name.find('/') != std::string::npos || !both || !begins_with(trace, "\x89MCAP") ||
      !begins_with(digest, "digest "))
    return error(fmt::format("{} and {} aren't a recording and its digest, so they aren't removed", trace.string(),
                             digest.string()));
  const auto take_away = [&](const fs::path& file) {
    if (to.empty())
      fs::remove(file, failed);
    else
      move_file(file, to, failed);
  };
  for (const fs::path& file : {digest, trace}) {  // the digest first: a recording without digest is still reported
    take_away(file);
    if (failed) return error(fmt::format("{} can't be removed: {}", file.string(), failed.message()));
  }
  // These files have no meaning without their golden.
  for (const fs::path& file : {noise_file_of(trace), instructions_file_of(trace)})
    if (fs::exists(file, failed)) take_away(file);
  return {};
}

}  // namespace rehearse
