// RunFacts: what the metadata of a recording states of its run. The names of the metadata records and of their keys are
// here, for whoever writes them and whoever reads them, and nowhere else.
#pragma once

#include <rehearse/mcap_types.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

namespace mcap {
struct Metadata;
class Reader;
}  // namespace mcap
class Trace;

/// Names of metadata records.
namespace records {
inline constexpr const char* provenance = "rehearse";
inline constexpr const char* outcome = "rehearse.outcome";
inline constexpr const char* branch = "rehearse.branch";
inline constexpr const char* files = "rehearse.files";     // that controllers read: ControllerHost::files_read
inline constexpr const char* log_topic = "rehearse.log ";  // and the topic
}  // namespace records

/// Keys of the provenance.
namespace facts {
inline constexpr const char* trace_version = "trace_version";
inline constexpr const char* trace_revision = "trace_revision";
inline constexpr const char* rehearse = "rehearse";  // version of the program
inline constexpr const char* scenario = "scenario";
inline constexpr const char* seed = "seed";
inline constexpr const char* time_step = "time_step";
inline constexpr const char* duration = "duration";
inline constexpr const char* solver = "solver";
inline constexpr const char* physics = "physics";
inline constexpr const char* renderer = "renderer";
inline constexpr const char* libc = "libc";
inline constexpr const char* compiler = "compiler";
inline constexpr const char* processor = "processor";
inline constexpr const char* build = "build";
inline constexpr const char* pinned = "pinned";
inline constexpr const char* pinned_prefix = "pinned.";  // and the environment's variable
inline constexpr const char* pinned_mathematics = "pinned.GLIBC_TUNABLES";
inline constexpr const char* pinned_renderer = "pinned.GALLIUM_OVERRIDE_CPU_CAPS";
/// One value for the very same build of Rehearse and of what it computes with.
inline constexpr const char* programs = "programs";
inline constexpr const char* virtualised = "virtualised";
inline constexpr const char* source = "source";  // "log"; a simulation's recording doesn't state it
inline constexpr const char* log = "log";
inline constexpr const char* log_start = "log.start";
inline constexpr const char* map = "map";
inline constexpr const char* controller_prefix = "controller.";  // and BODY/NAME: the library's file and hash
/// The versions of the programs that a recording was made with.
inline constexpr const char* versions[] = {rehearse, physics, renderer, libc};
}  // namespace facts

/// How a run ended.
struct RunOutcome {
  std::optional<std::int64_t> ticks = {};   // none: not stated
  bool complete = false;                    // the state after the last tick is recorded as one more message on /tick
  std::optional<std::string> failure = {};  // none: the run came to its end
  std::optional<std::string> checkpoints = {};  // "none", "exact", or why they aren't; none: not stated

  mcap::StringMap metadata() const;
  static RunOutcome of(const mcap::StringMap& metadata);
};

/// Where a branch of a recording came from.
struct BranchOrigin {
  std::string source;                               // name of the file and hash of its bytes
  bool simulated = true;                            // from `tick` on; false: a replay, which is recorded all through
  std::int64_t tick = 0;                            // from here on it isn't the source's
  double time = 0.0;                                // of that tick [s]
  std::string checkpoint;                           // of which tick, or why none; of a replay empty
  std::vector<std::string> set, push, controllers;  // what was changed, as it was said
  /// Before this tick the world was moved by what the source's controllers commanded, which stands on topics with
  /// `acted` in the place of `output`, and not by what stands there: that is what the controllers of the branch would
  /// have commanded. None: it is the same.
  std::optional<std::int64_t> acted_until;

  mcap::StringMap metadata() const;
  static BranchOrigin of(const mcap::StringMap& metadata);
};

struct RunFacts {
  std::optional<mcap::StringMap> provenance = {};  // all of it; none: no recording of ours
  int provenances = 0;                             // records; more than one: several recordings, merged
  std::optional<int> trace_version = {};
  int trace_revision = 1;
  std::optional<std::uint32_t> seed = {};
  std::optional<double> time_step = {}, duration = {};  // [s]
  bool is_of_log = false;                               // of a real robot; else of a simulation
  std::map<std::string, std::string> controllers = {};  // by BODY/NAME: the library's file and its hash
  std::optional<RunOutcome> outcome = {};               // none: the recording was cut off
  std::optional<BranchOrigin> branch = {};
  std::optional<mcap::StringMap> files = {};  // that controllers read, and their hashes

  /// A fact of the provenance; empty: not stated.
  std::string stated(const std::string& fact) const;
  /// Whether that controller's library had that hash.
  bool had_library(const std::string& controller_label, const std::string& content_hash) const;

  /// If a record is there more than once, the first counts.
  static RunFacts of(const std::vector<mcap::Metadata>& metadata);
  static RunFacts of(const mcap::Reader& recording);
  static RunFacts of(const Trace& recording);
};

/// The value of a key; empty: not stated.
std::string stated(const mcap::StringMap& facts, const std::string& key);

}  // namespace rehearse
