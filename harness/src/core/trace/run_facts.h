// RunFacts: the facts of a run in the metadata of its recording. Only this file has the names of the metadata records
// and of their keys, for writers and readers.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap_types.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "state_rate.h"

namespace rehearse {

namespace mcap {
struct Metadata;
class Reader;
}  // namespace mcap
class Trace;

/// The version of the trace format (harness/TRACE_FORMAT.md). Changes when recorded data changes its meaning: a reader
/// of a different version refuses the recording.
inline constexpr int trace_version = 1;

/// Within a version, grows when more data is recorded; 1 if a recording doesn't state it.
///   2  /contacts; `limits:` of joints
inline constexpr int trace_revision = 2;
inline constexpr int revision_of_contacts = 2;

/// Keys of the record of a flight.
namespace flight_facts {
inline constexpr const char* mathematics = "processor_flags";  // mathematics_of_processor()
inline constexpr const char* tunables = "tunables";            // GLIBC_TUNABLES of the loop
inline constexpr const char* architecture = "architecture";    // uname -m
inline constexpr const char* libm = "libm_build_id";           // empty: linked statically, or unknown
}  // namespace flight_facts

/// Names of metadata records.
namespace records {
inline constexpr const char* provenance = "rehearse";
inline constexpr const char* outcome = "rehearse.outcome";
inline constexpr const char* branch = "rehearse.branch";
inline constexpr const char* initial_commands = "rehearse.initial_commands";  // of the first step, from initialize()
inline constexpr const char* state_rate = "rehearse.state_rate";  // in a golden that keeps only samples of the state
inline constexpr const char* devices_read = "rehearse.devices_read";  // BODY/DEVICE: the controllers that read it
inline constexpr const char* files = "rehearse.files";     // files that controllers read: ControllerHost::files_read
inline constexpr const char* log_topic = "rehearse.log ";  // followed by the topic
inline constexpr const char* flight = "rehearse.flight";   // the tap, its loop and its machine
}  // namespace records

/// Keys of the provenance.
namespace facts {
inline constexpr const char* trace_version = "trace_version";
inline constexpr const char* trace_revision = "trace_revision";
inline constexpr const char* rehearse = "rehearse";  // version of Rehearse
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
inline constexpr const char* architecture = "architecture";  // of the processor; not stated: x86-64
inline constexpr const char* build = "build";
inline constexpr const char* pinned = "pinned";
inline constexpr const char* pinned_prefix = "pinned.";  // followed by the name of the environment variable
inline constexpr const char* pinned_mathematics = "pinned.GLIBC_TUNABLES";
inline constexpr const char* pinned_renderer = "pinned.GALLIUM_OVERRIDE_CPU_CAPS";
/// One value that identifies the build of Rehearse and of the libraries that it computes with.
inline constexpr const char* programs = "programs";
inline constexpr const char* virtualised = "virtualised";
inline constexpr const char* source = "source";  // "log", "flight"; missing in recordings of simulations
inline constexpr const char* flight = "flight";  // identifies a flight: its files have equal provenance
inline constexpr const char* log = "log";
inline constexpr const char* log_start = "log.start";
inline constexpr const char* map = "map";
inline constexpr const char* controller_prefix = "controller.";  // followed by BODY/NAME: the library's file and hash
/// The versions of the programs that made a recording.
inline constexpr const char* versions[] = {rehearse, physics, renderer, libc};
}  // namespace facts

/// The end of a run.
struct RunOutcome {
  std::optional<std::int64_t> ticks = {};   // none: not stated
  bool complete = false;                    // the state after the last tick is recorded as one more message on /tick
  std::optional<std::string> failure = {};  // none: the run reached its end
  std::optional<std::string> checkpoints = {};  // "none", "exact", or why they aren't exact; nullopt: not stated

  mcap::StringMap metadata() const;
  static RunOutcome of(const mcap::StringMap& metadata);
};

/// The origin of a branch of a recording.
struct BranchOrigin {
  std::string source;      // name of the file and hash of its bytes
  bool simulated = true;   // a simulation from `tick` on; false: a replay, which is recorded throughout
  std::int64_t tick = 0;   // first tick that isn't a copy of the source's
  double time = 0.0;       // time of that tick [s]
  std::string checkpoint;  // the tick of the source's checkpoint, or why none was used; empty for a replay
  std::vector<std::string> set, push, controllers;  // the changes, as the user stated them
  /// Before this tick the commands of the source's controllers moved the world. They are on topics with `acted` in the
  /// place of `output`. The commands on `output` are the commands that the controllers of the branch gave, without
  /// effect. nullopt: both are equal.
  std::optional<std::int64_t> acted_until;

  mcap::StringMap metadata() const;
  static BranchOrigin of(const mcap::StringMap& metadata);
};

struct RunFacts {
  std::optional<mcap::StringMap> provenance = {};  // all facts; nullopt: not a recording of Rehearse
  int provenances = 0;  // number of records; more than one: several recordings, merged. Parts of a flight count as one
  std::optional<int> trace_version = {};
  int trace_revision = 1;
  std::optional<std::uint32_t> seed = {};
  std::optional<double> time_step = {}, duration = {};  // [s]
  bool is_of_log = false;     // recorded from a real robot, by its log or by a tap; else from a simulation
  bool is_of_flight = false;  // by a tap
  std::map<std::string, std::string> controllers = {};  // by BODY/NAME: the library's file and its hash
  std::optional<RunOutcome> outcome = {};               // none: the recording is incomplete
  std::optional<BranchOrigin> branch = {};
  std::optional<StateRate> state_rate = {};          // none: the state of every tick is recorded
  std::optional<mcap::StringMap> devices_read = {};  // by BODY/DEVICE: the controllers that read it; none: not stated
  std::optional<mcap::StringMap> files = {};         // files that controllers read, and their hashes
  std::optional<mcap::StringMap> flight = {};        // the tap, its loop and its machine

  /// A fact of the provenance; empty: not stated.
  std::string stated(const std::string& fact) const;
  /// True if the controller's recorded library had this hash.
  bool had_library(const std::string& controller_label, const std::string& content_hash) const;
  /// Number of ticks that were simulated or replayed. `messages`: number of messages on /tick; in a complete run the
  /// last message contains the state after the last tick.
  std::int64_t ticks(std::int64_t messages) const;

  /// If a record occurs more than once, the first counts.
  static RunFacts of(const std::vector<mcap::Metadata>& metadata);
  static RunFacts of(const mcap::Reader& recording);
  static RunFacts of(const Trace& recording);
};

/// The value of a key; empty: not stated.
std::string stated(const mcap::StringMap& facts, const std::string& key);

/// The processor architecture of a provenance: "x86-64", "arm64". Code for another one rounds differently: compilers and
/// libraries use its own instructions, pinned or not.
std::string architecture_of(const mcap::StringMap& provenance);

/// Fails if the metadata of a recording states an unknown version of the trace format. `file`: its name in the error.
Result<void> check_trace_version(const std::vector<mcap::Metadata>& metadata, const std::string& file);

}  // namespace rehearse
