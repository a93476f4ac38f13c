#include "report_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/compare/recorded_picture.h"
#include "core/kinds/channel_name.h"
#include "picture/picture.h"
#include "viewing/export/picture_file.h"

namespace rehearse {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Distances as 254 levels of grey: near is light; 0 where nothing was found.
Bytes grey_of(const RecordedPicture& picture, float near, float far) {
  Image image{picture.width, picture.height, Bytes(3 * picture.pixels())};
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const float depth = picture.depths[i];
    if (!std::isfinite(depth)) continue;
    const float share = far > near ? (far - depth) / (far - near) : 1.0f;
    const auto grey = static_cast<std::uint8_t>(1.5f + 254.0f * std::clamp(share, 0.0f, 1.0f));  // rounded
    std::fill_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, grey);
  }
  return encode_png(image);
}

std::optional<RecordedPicture> distances_at(const Trace& trace, const TraceChannel& channel, std::size_t message) {
  const auto payload = trace.payload(channel, message);
  if (!payload) return std::nullopt;
  auto picture = read_picture(channel.type, *payload);
  return picture && !picture->depths.empty() ? std::move(picture) : std::nullopt;
}

}  // namespace

void PictureWriter::find_range(const Trace& trace, const TraceChannel& channel, Album& album) {
  std::vector<float> before;
  for (std::size_t i = 0; i < channel.messages(); ++i) {
    auto picture = distances_at(trace, channel, i);
    if (!picture || picture->depths == before) continue;  // equal to the depths before
    album.is_depth = true;
    for (const float depth : picture->depths) {
      if (!std::isfinite(depth)) continue;
      album.near = std::min(album.near, depth);
      album.far = std::max(album.far, depth);
    }
    before = std::move(picture->depths);
  }
}

PictureWriter::Album PictureWriter::survey(const TraceChannel* actual, const TraceChannel* golden) {
  Album album;
  album.near = std::numeric_limits<float>::infinity();
  const TraceChannel& either = actual ? *actual : *golden;
  if (either.type != msg::Image::type_name) return album;  // compressed: no depths
  if (actual) find_range(actual_.trace, *actual, album);
  if (golden) find_range(golden_->trace, *golden, album);
  if (!std::isfinite(album.near)) album.near = album.far = 0.0f;
  return album;
}

/// A blob with its media type; null: there is no picture, or it can't be shown.
ReportJson PictureWriter::picture(const Trace& trace, const TraceChannel& channel, std::size_t message, Album& album) {
  const auto payload = trace.payload(channel, message);
  auto file = payload ? Result<PictureFile>(PictureFile()) : Result<PictureFile>(payload.errors());
  if (payload && album.is_depth) {
    auto distances = read_picture(channel.type, *payload);
    if (distances && distances->pixels() > 0) {
      if (distances->depths == album.drawn_depths) return album.drawn;
      *file = {distances->stamp, "png", grey_of(*distances, album.near, album.far)};
      album.drawn_depths = std::move(distances->depths);
    }
  } else if (payload) {
    file = picture_file(channel.type, *payload);
  }
  if (!file) {
    if (album.lost++ == 0) album.why = file.errors()[0].message;
    return nullptr;
  }
  if (file->extension.empty()) return nullptr;  // the camera was off
  std::tie(album.width, album.height) = size_of_picture(file->bytes);
  ReportJson blob = blobs_.bytes(file->bytes);
  blob["media_type"] = file->extension == "png" ? "image/png" : "image/jpeg";
  if (album.is_depth) album.drawn = blob;
  return blob;
}

void PictureWriter::write(const TraceChannel* actual, const TraceChannel* golden) {
  Album album = survey(actual, golden);
  const TraceChannel& either = actual ? *actual : *golden;
  ReportJson pictures = ReportJson::array();
  constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
  const auto time_of = [](const TraceChannel* channel, std::size_t i) {
    return channel && i < channel->messages() ? channel->times[i] : never;
  };
  for (std::size_t a = 0, g = 0;;) {
    const std::uint64_t seen = time_of(actual, a), expected = time_of(golden, g);
    const std::uint64_t time = std::min(seen, expected);
    if (time == never) break;
    const ReportedRun& run = seen == time ? actual_ : *golden_;
    ReportJson entry{
        {"tick", run.clock.tick_at(time)}, {"actual", nullptr}, {"golden", nullptr}, {"differing", nullptr}};
    if (seen == time) entry["actual"] = picture(actual_.trace, *actual, a++, album);
    if (expected == time) {
      entry["golden"] = picture(golden_->trace, *golden, g, album);
      if (seen == time) entry["differing"] = judged_->pixels(*golden, g);
      ++g;
      if (!entry["golden"].is_null() && entry["golden"] == entry["actual"]) entry["golden"] = "same";
    }
    pictures.push_back(std::move(entry));
  }
  if (album.lost > 0)
    omitted_.push_back(fmt::format("{} of the pictures of {} can't be shown: {}", album.lost, either.topic, album.why));
  std::string name = series_name(either.topic, "");
  if (!name.empty()) name.pop_back();
  ReportJson camera{{"name", name},
                    {"topic", either.topic},
                    {"kind", album.is_depth ? "depth" : "color"},
                    {"width", album.width},
                    {"height", album.height}};
  if (album.is_depth) {
    camera["near"] = album.near;
    camera["far"] = album.far;
  }
  camera["pictures"] = std::move(pictures);
  cameras_.push_back(std::move(camera));
}

}  // namespace rehearse
