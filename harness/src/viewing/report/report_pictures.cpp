#include "report_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

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

PictureWriter::Album PictureWriter::survey(const ShownChannel& channel) {
  Album album;
  album.near = std::numeric_limits<float>::infinity();
  if (channel.either().type != msg::Image::type_name) return album;  // compressed: no depths
  if (channel.pair.actual) find_range(actual_.trace, channel.actual, album);
  if (channel.pair.golden) find_range(golden_->trace, channel.golden, album);
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

std::vector<PictureWriter::Moment> PictureWriter::moments_of(const ShownChannel& channel) {
  const std::vector<std::uint64_t>&actual = channel.actual.times, &golden = channel.golden.times;
  std::vector<Moment> moments;
  for (std::size_t a = 0, g = 0; a < actual.size() || g < golden.size();) {
    Moment moment;
    const bool is_golden = a == actual.size() || (g < golden.size() && golden[g] <= actual[a]);
    const bool is_actual = g == golden.size() || (a < actual.size() && actual[a] <= golden[g]);
    moment.time = is_actual ? actual[a] : golden[g];
    if (is_actual) moment.actual = a++;
    if (is_golden) moment.golden = g++;
    moments.push_back(moment);
  }
  return moments;
}

/// Every so-many-th moment, and those around the first difference.
std::vector<std::size_t> PictureWriter::choose(const std::vector<Moment>& moments, std::size_t stride) const {
  constexpr std::size_t around = 10;  // pictures before and after
  std::size_t centre = moments.size();
  if (focus_.centre) {
    const auto at = std::ranges::lower_bound(moments, *focus_.centre, {}, &Moment::time);
    centre = static_cast<std::size_t>(at - moments.begin());
  }
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const bool is_near = focus_.centre && i + around >= centre && i <= centre + around;
    if (i % stride == 0 || is_near || i + 1 == moments.size()) chosen.push_back(i);
  }
  return chosen;
}

ReportJson PictureWriter::moment_json(const ShownChannel& channel, const Moment& moment, Album& album) {
  const ReportedRun& run = moment.actual ? actual_ : *golden_;
  ReportJson entry{
      {"tick", run.clock.tick_at(moment.time)}, {"actual", nullptr}, {"golden", nullptr}, {"differing", nullptr}};
  if (moment.actual) entry["actual"] = picture(actual_.trace, channel.actual, *moment.actual, album);
  if (!moment.golden) return entry;
  entry["golden"] = picture(golden_->trace, channel.golden, *moment.golden, album);
  if (moment.actual) entry["differing"] = judged_->pixels(*channel.pair.golden, *moment.golden);
  if (!entry["golden"].is_null() && entry["golden"] == entry["actual"]) entry["golden"] = "same";
  return entry;
}

void PictureWriter::write(const ShownChannel& channel) {
  Album album = survey(channel);
  const TraceChannel& either = channel.either();
  const std::vector<Moment> moments = moments_of(channel);
  // Some pictures at equal distances show the size of all.
  constexpr std::size_t samples = 16;
  const std::size_t between = std::max<std::size_t>(1, moments.size() / samples);
  std::map<std::size_t, ReportJson> written;
  const std::uint64_t before = blobs_.coded();
  for (std::size_t i = 0; i < moments.size(); i += between) written.emplace(i, moment_json(channel, moments[i], album));
  const std::uint64_t of_samples = std::max<std::uint64_t>(1, blobs_.coded() - before);
  const double all = static_cast<double>(of_samples) / static_cast<double>(std::max<std::size_t>(1, written.size())) *
                     static_cast<double>(moments.size());
  const auto stride = static_cast<std::size_t>(std::ceil(std::max(1.0, all / static_cast<double>(most_coded_))));
  for (const std::size_t i : choose(moments, stride))
    if (!written.contains(i)) written.emplace(i, moment_json(channel, moments[i], album));
  ReportJson pictures = ReportJson::array();
  for (auto& [moment, entry] : written) pictures.push_back(std::move(entry));
  if (written.size() < moments.size())
    omitted_.push_back(
        fmt::format("{} of the {} pictures of {} are shown: those around the first difference, and others "
                    "at equal distances.",
                    written.size(), moments.size(), either.topic));
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
