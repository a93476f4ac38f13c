#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "base/replaceable.h"
#include "channel_table.h"
#include "export_files.h"
#include "export_source.h"
#include "picture_file.h"
#include "trace_export.h"
#include "video_encoder.h"

namespace rehearse {
namespace {

constexpr std::string_view jpeg_magic = "\xff\xd8\xff";

/// Selected channels with pictures; the others are reported as skipped.
std::vector<const mcap::Channel*> picture_channels(const ExportSource& source, ExportReport& report) {
  std::vector<const mcap::Channel*> channels;
  for (const mcap::Channel* channel : source.channels()) {
    const mcap::Schema* schema = source.schema_of(*channel);
    if (schema != nullptr && channel->message_encoding == "cdr" && is_picture_type(schema->name)) {
      channels.push_back(channel);
    } else {
      report.skipped.push_back({channel->topic, "no pictures"});
    }
  }
  return channels;
}

/// Calls back with the pictures of these channels; a message that is no picture is reported.
Result<void> for_each_picture(ExportSource& source, const std::vector<const mcap::Channel*>& channels,
                              const std::function<Result<void>(const mcap::Message&, const PictureFile&)>& callback) {
  std::set<std::uint16_t> chosen;
  for (const mcap::Channel* channel : channels) chosen.insert(channel->id);
  return source.pass([&](const mcap::Message& message) -> Result<void> {
    if (!chosen.contains(message.channel->id)) return {};
    const auto picture = picture_file(source.schema_of(*message.channel)->name, message.data);
    if (picture) return callback(message, *picture);
    source.note(*message.channel, picture.errors().front().message);
    return {};
  });
}

/// The names of a topic's pictures and of the table of their times.
struct Album {
  ExportedTopic topic;
  std::filesystem::path folder;
  std::int64_t messages = 0;
};

std::string picture_name(std::int64_t number, std::string_view extension) {
  return fmt::format("{:06}.{}", number, extension);
}

/// Checks for existing files. The extension is unknown before the picture is read: both are checked.
Result<void> check_album(const Album& album, std::int64_t number) {
  for (const auto& [extension, magic, kind] :
       {std::tuple("png", png_magic, "PNG"), std::tuple("jpg", jpeg_magic, "JPEG")}) {
    REHEARSE_TRY(check_replaceable(album.folder / picture_name(number, extension), magic, kind));
  }
  return {};
}

}  // namespace

Result<ExportReport> export_frames(const std::filesystem::path& trace, const std::filesystem::path& folder,
                                   const ExportOptions& options) {
  auto source = REHEARSE_TRY(ExportSource::open(trace, options));
  source.expect_passes(1);
  ExportReport report;
  const auto channels = picture_channels(source, report);
  if (channels.empty()) return error(fmt::format("{}: no selected topic has pictures", trace.string()));
  std::map<std::uint16_t, Album> albums;
  TopicNames names;
  for (const mcap::Channel* channel : channels) {
    const std::string name = names.name_for(channel->topic);
    albums[channel->id] = {{folder / (name + ".csv"), channel->topic, 0, 3, 0}, folder / name};
    REHEARSE_TRY(check_replaceable(folder / (name + ".csv"), table_magic, "table of Rehearse"));
  }
  LineFiles files;
  for (const auto& [id, album] : albums) {
    REHEARSE_TRY(make_folder(album.folder));
    REHEARSE_TRY(files.begin(album.topic.file, std::string(table_magic) + ",captured [s],file\n"));
  }
  std::string line;
  const auto put = [&](const mcap::Message& message, const PictureFile& picture) -> Result<void> {
    Album& album = albums.at(message.channel->id);
    const std::int64_t number = album.messages++;
    line.clear();
    append_seconds(line, message.log_time);
    line += ',';
    append_seconds(line, picture.stamp);
    line += ',';
    if (!picture.extension.empty()) {
      const std::string name = picture_name(number, picture.extension);
      REHEARSE_TRY(check_album(album, number));
      REHEARSE_TRY(write_file(album.folder / name, picture.bytes));
      ++album.topic.pictures;
      append_cell(line, (album.folder.filename() / name).string());
    }
    ++album.topic.rows;
    line += '\n';
    return files.append(album.topic.file, line);
  };
  REHEARSE_TRY(for_each_picture(source, channels, put));
  REHEARSE_TRY(files.finish());
  for (auto& [id, album] : albums) report.written.push_back(std::move(album.topic));
  report.damage = source.damage();
  return report;
}

Result<ExportReport> export_video(const std::filesystem::path& trace, const std::filesystem::path& file,
                                  const ExportOptions& options) {
  REHEARSE_TRY(VideoEncoder::check_output(file));
  auto source = REHEARSE_TRY(ExportSource::open(trace, options));
  ExportReport report;
  const auto channels = picture_channels(source, report);
  if (channels.size() != 1) {
    std::string found;
    for (const mcap::Channel* channel : channels) found += (found.empty() ? "" : ", ") + channel->topic;
    return error(fmt::format("{}: a video is of one topic with pictures; {} selected", trace.string(),
                             channels.empty() ? "none is" : found + " are"),
                 "--topics selects it");
  }
  std::int64_t count = 0;
  std::uint64_t first = 0, last = 0;
  std::string extension;
  const auto learn = [&](const mcap::Message& message, const PictureFile& picture) -> Result<void> {
    if (picture.extension.empty()) return {};
    if (!extension.empty() && extension != picture.extension)
      return error("a topic with both PNG and JPEG makes no video");
    extension = picture.extension;
    first = count == 0 ? message.log_time : first;
    last = message.log_time;
    ++count;
    return {};
  };
  REHEARSE_TRY(for_each_picture(source, channels, learn));
  if (count == 0) return error(fmt::format("{}: {} has no picture", trace.string(), channels[0]->topic));
  const double rate = last > first ? static_cast<double>(count - 1) * 1e9 / static_cast<double>(last - first) : 1.0;
  auto encoder = REHEARSE_TRY(VideoEncoder::begin(file, extension, rate));
  const auto put = [&](const mcap::Message&, const PictureFile& picture) -> Result<void> {
    return picture.extension.empty() ? Result<void>() : encoder->put(picture.bytes);
  };
  REHEARSE_TRY(for_each_picture(source, channels, put));
  REHEARSE_TRY(encoder->end());
  report.written.push_back({file, channels[0]->topic, 0, 0, count});
  report.damage = source.damage();
  return report;
}

}  // namespace rehearse
