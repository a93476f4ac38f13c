// Messages without series: pictures by their pixels, all else by its bytes.
#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>
#include <rehearse/png.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "compare_parts.h"

namespace rehearse {
namespace {

/// Colours or distances; one of both.
struct Picture {
  std::uint64_t stamp = 0;  // when it was captured [ns]
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> colors;  // three a pixel
  std::vector<float> depths;         // one a pixel

  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// What a comparison of two pictures found.
struct PixelDifferences {
  std::size_t differing = 0;  // pixels
  std::size_t beyond = 0;     // pixels, by more than is allowed to each
  double largest = 0.0;
};

std::optional<Picture> read_color(std::span<const std::byte> payload) {
  CdrReader reader(payload);
  msg::CompressedImage message;
  if (!msg::decode(reader, message)) return std::nullopt;
  Picture picture;
  picture.stamp = message.header.stamp.to_ns();
  if (message.data.empty()) return picture;  // the camera was off
  auto image = decode_png(message.data);
  if (!image) return std::nullopt;
  picture.width = image->width;
  picture.height = image->height;
  picture.colors = std::move(image->pixels);
  return picture;
}

std::optional<Picture> read_raw(std::span<const std::byte> payload) {
  CdrReader reader(payload);
  msg::Image message;
  if (!msg::decode(reader, message)) return std::nullopt;
  Picture picture;
  picture.stamp = message.header.stamp.to_ns();
  picture.width = static_cast<int>(message.width);
  picture.height = static_cast<int>(message.height);
  if (message.encoding == "32FC1" && message.data.size() == picture.pixels() * sizeof(float)) {
    picture.depths.resize(picture.pixels());
    std::memcpy(picture.depths.data(), message.data.data(), message.data.size());
    return picture;
  }
  if (message.encoding != "rgb8" || message.data.size() != picture.pixels() * 3) return std::nullopt;
  picture.colors = std::move(message.data);
  return picture;
}

PixelDifferences color_differences(const Picture& golden, const Picture& actual, double delta) {
  PixelDifferences found;
  for (std::size_t i = 0; i < golden.colors.size(); i += 3) {
    int most = 0;
    for (std::size_t c = i; c < i + 3; ++c) most = std::max(most, std::abs(golden.colors[c] - actual.colors[c]));
    if (most > 0) ++found.differing;
    if (most > delta) ++found.beyond;
    found.largest = std::max(found.largest, static_cast<double>(most));
  }
  return found;
}

/// Nothing hit (infinite) against something hit is beyond any tolerance: a silhouette has moved.
PixelDifferences depth_differences(const Picture& golden, const Picture& actual, const Tolerance& tolerance) {
  PixelDifferences found;
  for (std::size_t i = 0; i < golden.depths.size(); ++i) {
    const double expected = golden.depths[i], measured = actual.depths[i];
    if (expected == measured || (std::isnan(expected) && std::isnan(measured))) continue;
    const double difference = std::abs(expected - measured);
    ++found.differing;
    if (!(difference <= tolerance.bound(std::abs(expected))) || std::isinf(difference)) ++found.beyond;
    found.largest = std::max(found.largest, difference);
  }
  return found;
}

std::string share_text(std::size_t count, std::size_t all) {
  return fmt::format("{} of {} pixels ({:.3g} %)", count, all,
                     100.0 * static_cast<double>(count) / static_cast<double>(all));
}

/// Judges the pictures of one channel.
class PictureJudge {
 public:
  PictureJudge(const ComparedTraces& traces, const MatchedChannel& channel, Findings& findings)
      : traces_(traces), channel_(channel), findings_(findings), unit_(unit_of(channel.golden, "")) {
    std::string_view series = channel.golden.topic;
    if (series.starts_with('/')) series.remove_prefix(1);
    tolerance_ = tolerance_of(series, unit_, traces.rules);
  }

  void compare(std::size_t golden_index, std::span<const std::byte> expected, std::span<const std::byte> actual) {
    const bool compressed = channel_.golden.type == msg::CompressedImage::type_name;
    const auto golden = compressed ? read_color(expected) : read_raw(expected);
    const auto other = compressed ? read_color(actual) : read_raw(actual);
    if (!golden || !other)
      return fail(golden_index, fmt::format("the picture {} is of a form that can't be compared",
                                            golden ? "of this run" : "of the golden"));
    if (golden->stamp != other->stamp)
      return fail(golden_index,
                  fmt::format("the picture was captured at {} s, expected {} s",
                              static_cast<double>(other->stamp) * 1e-9, static_cast<double>(golden->stamp) * 1e-9));
    if (golden->width != other->width || golden->height != other->height ||
        golden->colors.size() != other->colors.size() || golden->depths.size() != other->depths.size())
      return fail(golden_index, fmt::format("the picture has {} x {} pixels, expected {} x {}", other->width,
                                            other->height, golden->width, golden->height));
    compare_pixels(golden_index, *golden, *other);
  }

 private:
  void compare_pixels(std::size_t golden_index, const Picture& golden, const Picture& actual) {
    const bool depth = !golden.depths.empty();
    const PixelDifferences found = depth ? depth_differences(golden, actual, tolerance_)
                                         : color_differences(golden, actual, tolerance_.pixel_delta);
    if (found.differing == 0) return;  // other bytes, the same pixels: another encoder
    const std::size_t all = golden.pixels();
    const double share = static_cast<double>(found.beyond) / static_cast<double>(all);
    const bool beyond = share > tolerance_.pixel_share;
    if (!findings_.count(share, tolerance_.pixel_share, beyond)) return;
    Divergence divergence = place(golden_index);
    divergence.difference = share;
    divergence.tolerance = tolerance_.pixel_share;
    divergence.note = fmt::format("{} differ, by up to {:g}{}", share_text(found.differing, all), found.largest,
                                  depth ? " m" : " of 255");
    if (beyond)
      divergence.note += fmt::format("; {} by more than is allowed, and {:.3g} % may", share_text(found.beyond, all),
                                     100.0 * tolerance_.pixel_share);
    findings_.describe(divergence, beyond);
  }

  Divergence place(std::size_t golden_index) const {
    Divergence divergence = place_of(traces_, channel_.golden, channel_.golden.times[golden_index]);
    divergence.unit = unit_;
    return divergence;
  }

  void fail(std::size_t golden_index, std::string note) {
    if (!findings_.count(std::numeric_limits<double>::infinity(), 0.0, true)) return;
    Divergence divergence = place(golden_index);
    divergence.difference = std::numeric_limits<double>::infinity();
    divergence.note = std::move(note);
    findings_.describe(divergence, true);
  }

  const ComparedTraces& traces_;
  const MatchedChannel& channel_;
  Findings& findings_;
  std::string unit_;
  Tolerance tolerance_;
};

bool same_bytes(const std::vector<std::byte>& a, const std::vector<std::byte>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace

bool is_picture(const TraceChannel& channel) {
  return channel.encoding == "cdr" &&
         (channel.type == msg::CompressedImage::type_name || channel.type == msg::Image::type_name);
}

void compare_payloads(const ComparedTraces& traces, const MatchedChannel& channel, Findings& findings) {
  const bool pictures = is_picture(channel.golden);
  PictureJudge judge(traces, channel, findings);
  findings.result().values = static_cast<std::int64_t>(channel.pairs.size());
  for (const auto& [golden_index, actual_index] : channel.pairs) {
    const auto expected = traces.golden.payload(channel.golden, golden_index);
    const auto actual = traces.actual.payload(channel.actual, actual_index);
    Divergence divergence = place_of(traces, channel.golden, channel.golden.times[golden_index]);
    if (!expected || !actual) {
      divergence.note = "can't be read again: " + (expected ? actual : expected).errors()[0].message;
      findings.structure(divergence);
    } else if (same_bytes(*expected, *actual)) {
      continue;
    } else if (pictures) {
      judge.compare(golden_index, *expected, *actual);
    } else if (findings.count(std::numeric_limits<double>::infinity(), 0.0, true)) {
      divergence.note = "the message has other bytes than the golden's";
      findings.describe(divergence, true);
    }
  }
}

}  // namespace rehearse
