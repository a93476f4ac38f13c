// rehearse export: writes a trace, or any MCAP file, as tables, pictures or a video.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "options.h"
#include "output.h"
#include "output_file.h"
#include "progress.h"
#include "viewing/export/trace_export.h"
#include "viewing/export/viewer_export.h"

namespace rehearse::tool {
namespace {

struct ExportSettings {
  std::string trace;
  std::string output;
  bool joined = false;
  bool frames = false;
  bool video = false;
  bool json = false;
  std::string viewer, layout, robot;  // files, and a folder; empty: not requested
  bool contacts = false;
  ExportOptions options;
};

Result<ExportReport> write_export(const ExportSettings& settings, const std::filesystem::path& output) {
  StoppableProgress progress("exporting");
  ExportOptions options = settings.options;
  options.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
  const auto form = settings.joined   ? export_joined
                    : settings.frames ? export_frames
                    : settings.video  ? export_video
                                      : export_tables;
  return form(settings.trace, output, options);
}

Json json_of_export(const ExportReport& report) {
  Json written = Json::array(), skipped = Json::array();
  for (const ExportedTopic& topic : report.written)
    written.push_back({{"file", topic.file.string()},
                       {"topic", topic.topic},
                       {"rows", topic.rows},
                       {"columns", topic.columns},
                       {"pictures", topic.pictures}});
  for (const SkippedTopic& topic : report.skipped) skipped.push_back({{"topic", topic.topic}, {"why", topic.why}});
  Json left_out = Json::array();
  for (const LeftOutFields& topic : report.left_out)
    left_out.push_back({{"topic", topic.topic}, {"fields", topic.fields}});
  return {{"written", written}, {"skipped", skipped}, {"left_out", left_out}, {"damage", json_of(report.damage)}};
}

void tell(const ExportReport& report, bool of_pictures) {
  for (const ExportedTopic& topic : report.written) {
    std::string what;
    if (topic.rows > 0) what = count_text(topic.rows, "row") + ", " + count_text(topic.columns, "column");
    if (topic.pictures > 0) what += (what.empty() ? "" : ", ") + count_text(topic.pictures, "picture");
    fmt::print("{}: {}\n", topic.file.string(), what.empty() ? "nothing" : what);
  }
  if (of_pictures) return;  // most topics have no pictures, so this isn't reported
  for (const SkippedTopic& topic : report.skipped) fmt::print("left out {}: {}\n", topic.topic, topic.why);
  std::map<std::vector<std::string>, std::vector<std::string>> topics;  // by the missing fields
  for (const LeftOutFields& topic : report.left_out) topics[topic.fields].push_back(topic.topic);
  for (const auto& [fields, of] : topics)
    fmt::print("left out of {}{}: {}\n", of.front(),
               of.size() == 1 ? "" : fmt::format(" and {}", count_text(std::ssize(of) - 1, "more topic")),
               fmt::join(fields, ", "));
  if (!topics.empty()) fmt::print("bytes are in columns with --bytes, pictures in files with --frames\n");
}

/// The exports for viewers, which need a recording and no -o.
Exit run_for_viewers(const ExportSettings& settings) {
  Json written = Json::array();
  const auto tell_file = [&](const std::string& file, const std::string& what) {
    written.push_back(file);
    if (!settings.json) fmt::print("{}: {}\n", file, what);
  };
  if (!settings.viewer.empty()) {
    const auto report = export_for_viewer(settings.trace, settings.viewer, {settings.contacts});
    if (!report) return refuse(report.errors());
    tell_file(settings.viewer, fmt::format("{}, with {} and {} in /tf_static", count_text(report->messages, "message"),
                                           count_text(report->topics.size(), "topic") + " more",
                                           count_text(report->frames.size(), "frame")));
    if (!settings.json) fmt::print(stderr, "{}", to_string(report->remarks));
  }
  if (!settings.layout.empty()) {
    if (auto done = write_layout(settings.trace, settings.layout); !done) return refuse(done.errors());
    tell_file(settings.layout,
              settings.layout.ends_with(".xml") ? "a layout for PlotJuggler" : "a layout for Foxglove and Lichtblick");
  }
  if (!settings.robot.empty()) {
    const auto files = export_robot(settings.trace, settings.robot);
    if (!files) return refuse(files.errors());
    for (const std::filesystem::path& file : *files) tell_file(file.string(), "as recorded");
  }
  if (settings.json) print({{"written", written}});
  return Exit::done;
}

Exit run_export(const ExportSettings& settings) {
  if (!settings.viewer.empty() || !settings.layout.empty() || !settings.robot.empty()) {
    if (settings.output.empty()) return run_for_viewers(settings);
    return refuse(
        error("-o is for tables, pictures and videos", "--viewer, --layout and --robot name what they write"));
  }
  if (settings.output.empty()) return refuse(error("no output is named", "-o PATH; or --viewer, --layout or --robot"));
  if (settings.output.ends_with(".csv") && !settings.joined && !std::filesystem::is_directory(settings.output))
    return refuse(error(fmt::format("-o {} is the name of one table, and each topic has its own", settings.output),
                        "one table of all: --joined; a table for each topic: name a folder"));
  auto output = OutputFile::open(settings.output, settings.json);
  if (!output) return refuse(output.errors());
  if (output->path() != settings.output && !settings.joined)
    return refuse(error("-o - is for one table: --joined", "name a folder"));
  auto report = write_export(settings, output->path());
  if (!report) return refuse(report.errors());
  if (settings.joined)
    for (ExportedTopic& table : report->written) table.file = settings.output;
  if (settings.json) {
    print(json_of_export(*report));
  } else {
    tell(*report, settings.frames || settings.video);
  }
  std::fflush(stdout);  // before related output on stderr
  if (const Exit sent = send(*output, Exit::done); sent != Exit::done) return sent;
  if (report->damage.empty()) return Exit::done;
  return settings.json ? Exit::bad_input : refuse(report->damage);
}

std::function<Exit()> declare_export(CLI::App& options) {
  const auto settings = std::make_shared<ExportSettings>();
  options
      .add_option("TRACE", settings->trace,
                  "a recording, or any other log: MCAP, a rosbag2 folder or database, a bag of ROS 1")
      ->required()
      ->type_name("");
  options
      .add_option("-o,--output", settings->output,
                  "the folder for tables and pictures, made if it isn't there; the file of --joined, or - for stdout, "
                  "and of --video")
      ->type_name("PATH");
  options
      .add_option("--viewer", settings->viewer,
                  "a recording for Foxglove, Lichtblick and RViz: with /robot_description, the frames of sensors in "
                  "/tf_static, and the messages of controllers in /rosout")
      ->type_name("FILE");
  options.add_flag("--contacts", settings->contacts, "with --viewer: arrows of recorded contact forces, as markers");
  options
      .add_option("--layout", settings->layout,
                  "a layout of this recording's robots: .json for Foxglove and Lichtblick, .xml for PlotJuggler")
      ->type_name("FILE");
  options.add_option("--robot", settings->robot, "a folder for the recording's scenario and models")->type_name("DIR");
  CLI::Option* joined = options.add_flag("--joined", settings->joined,
                                         "one table of all series, a row a tick, instead of one table a topic");
  options
      .add_option("--clock", settings->options.clock,
                  "with --joined: a row for each message of this topic, with the last values of all others")
      ->type_name("TOPIC")
      ->needs(joined);
  CLI::Option* frames = options.add_flag(
      "--frames", settings->frames,
      "pictures instead of tables: PNG or JPEG, and a table of their times. Distances become millimetres, 16 bits");
  CLI::Option* video = options.add_flag(
      "--video", settings->video,
      "the pictures of a topic as .mp4, .mkv, .webm, or a preview as .gif, .apng, .webp; needs ffmpeg");
  options.add_flag(
      "--bytes", settings->options.bytes,
      "columns of bytes, too, in base64: pixels, point clouds, checkpoints. Else they are named as left out");
  joined->excludes(frames)->excludes(video);
  frames->excludes(video);
  add_selection_options(options, settings->options.selection);
  add_json_flag(options, settings->json);
  return [settings] { return run_export(*settings); };
}

}  // namespace

extern const Verb export_verb{"export",
                              "  rehearse export sr1.mcap -o tables\n"
                              "  rehearse export sr1.mcap -o sr1.csv --joined --ticks 0..999\n"
                              "  rehearse export bag -o log.csv --joined --clock /joint_states\n"
                              "  rehearse export sr1.mcap -o pictures --frames --topics '*Camera*'\n"
                              "  rehearse export sr1.mcap --viewer sr1.viewer.mcap --layout sr1.json\n"
                              "  rehearse export sr1.mcap --robot sr1_files\n"
                              "  rehearse export sr1.mcap -o walk.mp4 --video --topics '/SR1/LeftCamera/image'\n",
                              declare_export};

}  // namespace rehearse::tool
