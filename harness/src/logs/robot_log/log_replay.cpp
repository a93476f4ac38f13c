#include "log_replay.h"

#include <fmt/format.h>
#include <rehearse/body.h>
#include <rehearse/mcap.h>
#include <rehearse/urdf.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>
#include <utility>

#include "core/guard/float_mode.h"
#include "core/mcap/hashing.h"
#include "log_causes.h"
#include "log_memory.h"
#include "log_replayer.h"
#include "logs/bag/bag_folder.h"
#include "logs/bag/sqlite_bag.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// The size and the time of the last change of a file; they differ after a change.
std::pair<std::uintmax_t, fs::file_time_type> state_of(const fs::path& file) {
  std::error_code ignored;
  return {fs::file_size(file, ignored), fs::last_write_time(file, ignored)};
}

/// The hash of all bytes of a file, or of the files that a rosbag2 folder names.
Result<std::string> hash_of(const fs::path& log) {
  std::vector<fs::path> files = bag::SqliteBag::files_of(log);
  if (const fs::path path = bag::folder_of(log); !path.empty()) {
    const auto folder = bag::read_folder(path);
    if (!folder) return folder.errors();
    files.clear();
    for (const fs::path& file : folder->files)
      for (const fs::path& part : bag::SqliteBag::files_of(file)) files.push_back(part);
  }
  std::vector<char> block(1 << 20);
  std::uint64_t hash = 0;
  for (const fs::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    while (stream) {
      stream.read(block.data(), static_cast<std::streamsize>(block.size()));
      hash = hash_bytes(block.data(), static_cast<std::size_t>(stream.gcount()), hash);
    }
    if (!stream.eof()) return error_in(file.string(), "it can't be read");
  }
  return hash_text(hash);
}

/// Replays a log again by other maps, up to some ticks after the first difference. Sets the report's cause to the first
/// one with which nine of ten ticks that differ agree.
void try_causes(mcap::Reader& log, const std::vector<OtherReading>& readings, const std::shared_ptr<const Model>& model,
                const std::vector<LogTopic>& topics, LogReplayOptions options, LogReplayReport& report) {
  constexpr double ticks_after = 1000, most_ticks = 100'000;
  const double share = static_cast<double>(report.ticks_beyond) / static_cast<double>(report.ticks_compared);
  const double step = report.duration / static_cast<double>(report.ticks);
  const double ticks =
      std::min(static_cast<double>(report.beyond->tick) + ticks_after, static_cast<double>(report.ticks));
  if (ticks > most_ticks) return;
  const double end = std::min(options.until.value_or(report.duration), ticks * step);
  options.on_difference = {};
  options.progress = {};
  options.most_beyond = static_cast<std::int64_t>(0.1 * share * ticks);
  const fs::path nowhere = "/dev/null";
  const double compared = ticks * static_cast<double>(report.ticks_compared) / static_cast<double>(report.ticks);
  for (const OtherReading& reading : readings) {
    const LogMap& map = reading.map;
    options.until = end - map.start.seconds;
    const double fewest = std::max(10.0, 0.5 * compared * (1.0 - map.start.seconds / end));
    const auto tried = LogReplayer(log, map, model, nowhere, options).run(topics, report.log_hash);
    if (!tried || tried->failure || static_cast<double>(tried->ticks_compared) < fewest) continue;
    if (static_cast<double>(tried->ticks_beyond) > 0.1 * share * static_cast<double>(tried->ticks_compared)) continue;
    report.cause = LogCause{reading.lines, reading.meaning, tried->ticks_compared, tried->ticks_beyond};
    return;
  }
}

/// Replays the log again, to find the ticks that decide about the controller: twice a part of it, once with a
/// controller that starts later, for its memory; then the whole log.
void find_certain_ticks(mcap::Reader& log, const LogMap& map, const std::shared_ptr<const Model>& model,
                        const std::vector<LogTopic>& topics, LogReplayOptions options, LogReplayReport& report) {
  constexpr std::int64_t most_ticks = 8000;
  options.on_difference = {};
  options.progress = {};
  const fs::path nowhere = "/dev/null";
  const auto commands_from = [&](std::int64_t tick, std::int64_t until) {
    CommandRecord commands;
    LogReplayOptions part = options;
    part.commands = &commands;
    part.skip = tick;
    part.until = static_cast<double>(until - tick) * map.time_step;
    static_cast<void>(LogReplayer(log, map, model, nowhere, part).run(topics, report.log_hash));
    return commands;
  };
  const std::int64_t later = std::min<std::int64_t>(report.ticks / 4, most_ticks / 8);
  const std::int64_t until = std::min(report.ticks, later + most_ticks);
  options.memory = memory_of(commands_from(0, until), commands_from(later, until));
  auto judged = LogReplayer(log, map, model, nowhere, options).run(topics, report.log_hash);
  if (judged) report.certain = std::move(judged->certain);
}

}  // namespace

Result<LogReplayReport> replay_log(const fs::path& log, const fs::path& trace, const LogReplayOptions& options) {
  const StandardFloatMode float_mode;
  auto reader = mcap::Reader::open(log);
  if (!reader) return reader.errors();
  const std::vector<LogTopic> topics = topics_of(**reader);
  if (topics.empty()) return error_in(log.string(), "it contains no channel", "expected a ROS 2 bag");
  UrdfOptions urdf;
  urdf.meshes = UrdfOptions::Meshes::skip;  // nothing collides, and nothing is rendered
  auto model = load_model(options.model, urdf);
  if (!model) return model.errors();
  auto map = LogMap::load(options.map, *model, topics);
  if (!map) return map.errors();
  std::error_code ignored;
  if (fs::equivalent(log, trace, ignored))
    return error_in(trace.string(), "that is the log itself", "name another file for the recording");
  const auto before = state_of(log);
  auto hash = hash_of(log);
  if (!hash) return hash.errors();
  const auto robot = std::make_shared<const Model>(*std::move(model));
  LogReplayer replayer(**reader, *map, robot, trace, options);
  auto report = replayer.run(topics, *std::move(hash));
  if (report && report->beyond && !report->failure && !(report->timing && report->timing->shift)) {
    find_certain_ticks(**reader, *map, robot, topics, options, *report);
    if (!report->within())
      try_causes(**reader, other_readings(*map, replayer.sources(), replayer.survey(), topics, *report), robot, topics,
                 options, *report);
  }
  if (state_of(log) != before) {
    if (fs::is_regular_file(trace, ignored)) fs::remove(trace, ignored);
    return error_in(log.string(), "it changed while it was read", "replay it when nothing writes it any more");
  }
  if (report)
    for (Diagnostic& remark : float_mode.remarks()) report->remarks.push_back(std::move(remark));
  return report;
}

}  // namespace rehearse
