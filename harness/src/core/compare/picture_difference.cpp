#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "picture/picture.h"
#include "recorded_picture.h"
#include "series_rules.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

using Rgb = std::array<std::uint8_t, 3>;

constexpr Rgb beyond_color{230, 30, 30}, within_color{240, 200, 40}, nothing_color{40, 60, 140},
    gap_color{255, 255, 255};
constexpr int gap = 4;          // between two of the three pictures [pixels]
constexpr double dimmed = 0.3;  // brightness of equal pixels

/// The least and the greatest distance in both pictures [m].
std::pair<float, float> span_of(const RecordedPicture& golden, const RecordedPicture& actual) {
  float least = std::numeric_limits<float>::infinity(), greatest = 0.0f;
  for (const RecordedPicture* picture : {&golden, &actual}) {
    for (const float depth : picture->depths) {
      if (!std::isfinite(depth)) continue;
      least = std::min(least, depth);
      greatest = std::max(greatest, depth);
    }
  }
  return {least, greatest};
}

Rgb color_of(const RecordedPicture& picture, std::size_t pixel, const std::pair<float, float>& span) {
  if (picture.depths.empty())
    return {picture.colors[3 * pixel], picture.colors[3 * pixel + 1], picture.colors[3 * pixel + 2]};
  const float depth = picture.depths[pixel];
  if (!std::isfinite(depth)) return nothing_color;
  const float range = span.second - span.first;
  const auto grey = static_cast<std::uint8_t>(range > 0.0f ? 255.0f * (span.second - depth) / range : 128.0f);
  return {grey, grey, grey};
}

Rgb difference_color(PixelState state, const Rgb& golden) {
  if (state == PixelState::beyond) return beyond_color;
  if (state == PixelState::within) return within_color;
  Rgb color = golden;
  for (std::uint8_t& channel : color) channel = static_cast<std::uint8_t>(dimmed * channel);
  return color;
}

Image side_by_side(const RecordedPicture& golden, const RecordedPicture& actual, const Tolerance& tolerance) {
  const PixelDifferences found = pixel_differences(golden, actual, tolerance);
  const auto span = span_of(golden, actual);
  Image image;
  image.width = 3 * golden.width + 2 * gap;
  image.height = golden.height;
  image.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = gap_color[i % 3];
  const auto put = [&](int panel, std::size_t pixel, const Rgb& color) {
    const std::size_t x = pixel % static_cast<std::size_t>(golden.width),
                      y = pixel / static_cast<std::size_t>(golden.width);
    const std::size_t left = static_cast<std::size_t>(panel) * static_cast<std::size_t>(golden.width + gap);
    std::ranges::copy(color, image.pixels.begin() + static_cast<std::ptrdiff_t>(
                                                        3 * (y * static_cast<std::size_t>(image.width) + left + x)));
  };
  for (std::size_t pixel = 0; pixel < golden.pixels(); ++pixel) {
    const Rgb expected = color_of(golden, pixel, span);
    put(0, pixel, expected);
    put(1, pixel, color_of(actual, pixel, span));
    put(2, pixel, difference_color(found.states[pixel], expected));
  }
  return image;
}

/// The picture of the first message at this time; none if there is no message, or if it contains no picture.
std::optional<RecordedPicture> picture_at(mcap::Reader& recording, const TraceChannel& channel, double time) {
  std::vector<std::uint16_t> ids;
  for (const auto& [id, described] : recording.channels())
    if (described.topic == channel.topic && ids.empty()) ids.push_back(id);
  std::optional<RecordedPicture> picture;
  const auto look = [&](const mcap::Message& message) {
    if (static_cast<double>(message.log_time) / 1e9 != time) return true;
    picture = read_picture(channel.type, message.data);
    return false;
  };
  // The comparison of the recordings has reported their damage.
  if (!ids.empty()) static_cast<void>(recording.for_each_message(look, ids));
  return picture && picture->pixels() > 0 ? picture : std::nullopt;
}

/// "Run." of Run.mcap
std::string prefix_of(const fs::path& recording) { return recording.stem().string() + "."; }

std::string file_name(const fs::path& recording, std::string topic) {
  if (topic.starts_with('/')) topic.erase(0, 1);
  std::ranges::replace(topic, '/', '.');
  return prefix_of(recording) + topic + ".png";
}

/// True for names that file_name() gives to a camera's channel.
bool is_ours(const std::string& name, const std::string& prefix) {
  return name.starts_with(prefix) && (name.ends_with(".image.png") || name.ends_with(".depth.png"));
}

Result<void> write_picture(const fs::path& file, const Image& image) {
  const std::vector<std::uint8_t> bytes = encode_png(image);
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (stream) return {};
  return error_in(file.string(), "the picture of the difference can't be written");
}

}  // namespace

Result<std::vector<fs::path>> write_picture_differences(const Trace& golden, const Trace& actual,
                                                        const Comparison& comparison,
                                                        const std::vector<ToleranceRule>& rules,
                                                        const fs::path& beside) {
  remove_picture_differences(beside);
  const auto of_golden_run = mcap::Reader::open(golden.file()), of_actual_run = mcap::Reader::open(actual.file());
  if (!of_golden_run || !of_actual_run) return (of_golden_run ? of_actual_run : of_golden_run).errors();
  std::vector<fs::path> written;
  for (const ChannelComparison& channel : comparison.channels) {
    const TraceChannel* of_golden = golden.find_channel(channel.channel);
    if (!channel.first || !of_golden || !is_picture(*of_golden)) continue;
    const TraceChannel* of_actual = actual.find_channel(channel.channel);
    if (!of_actual) continue;
    const auto expected = picture_at(**of_golden_run, *of_golden, channel.first->time);
    const auto other = picture_at(**of_actual_run, *of_actual, channel.first->time);
    if (!expected || !other || !expected->same_size(*other)) continue;
    const Tolerance tolerance = picture_tolerance(*of_golden, rules);
    const fs::path file = beside.parent_path() / file_name(beside, channel.channel);
    REHEARSE_TRY(write_picture(file, side_by_side(*expected, *other, tolerance)));
    written.push_back(file);
  }
  return written;
}

std::string picture_lines(const Result<std::vector<fs::path>>& written) {
  std::string lines;
  if (!written) return "\n" + written.errors()[0].file + ": " + written.errors()[0].message;
  for (const fs::path& file : *written) lines += "\nexpected, actual and difference: " + file.string();
  return lines;
}

void remove_picture_differences(const fs::path& beside) {
  const std::string prefix = prefix_of(beside);
  std::error_code ignored;
  std::vector<fs::path> old;
  const fs::path folder = beside.has_parent_path() ? beside.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored))
    if (is_ours(entry->path().filename().string(), prefix)) old.push_back(entry->path());
  for (const fs::path& file : old) fs::remove(file, ignored);
}

}  // namespace rehearse
