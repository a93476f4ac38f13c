// Comparison of messages without series: pictures by their pixels, all others field by field.
#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/units.h>

#include <optional>

#include "channel_findings.h"
#include "compare_fields.h"
#include "core/kinds/channel_name.h"
#include "recorded_picture.h"
#include "series_rules.h"

namespace rehearse {
namespace {

std::string share_text(std::size_t count, std::size_t all) {
  return fmt::format("{} of {} pixels ({:.3g} %)", count, all,
                     100.0 * static_cast<double>(count) / static_cast<double>(all));
}

/// Judges the payloads of one channel.
class PayloadJudge final : public PartJudge {
 public:
  PayloadJudge(const ComparedTraces& traces, const PairedChannel& channel, ChannelFindings& findings)
      : traces_(traces),
        channel_(channel),
        findings_(findings),
        are_pictures_(is_picture(channel.golden)),
        unit_(unit_of(channel.golden.metadata, "")),
        tolerance_(picture_tolerance(channel.golden, traces.rules)),
        fields_(traces, channel, findings) {}

  void take(const MatchedChannel& window) override {
    window_ = &window;
    take_equal(std::ssize(window.pairs));
    fields_.begin(window);
    for (const auto& [golden, actual] : window.pairs)
      if (window.golden.hashes[golden] != window.actual.hashes[actual]) compare(golden, actual);
  }
  void take_equal(std::int64_t pairs) override { findings_.result().values += pairs; }
  void finish() override {
    if (!are_pictures_) return;
    std::vector<SeriesComparison>& series = findings_.result().series;
    if (channel_.golden.type == msg::CompressedImage::type_name)
      series.push_back({"color", "of 255", color_, tolerance_.pixel_delta});
    series.push_back({"share", "of pixels", share_, tolerance_.pixel_share});
  }

 private:
  /// The result for two pictures with different bytes.
  enum class Finding {
    failed,  // times, sizes or formats differ, or one can't be read
    pixels,  // some pixels differ
    none,    // all pixels are equal
  };

  void compare(std::size_t golden_index, std::size_t actual_index) {
    const auto expected = window_->window.golden.payload(window_->golden, golden_index);
    const auto actual = window_->window.actual.payload(window_->actual, actual_index);
    if (!expected || !actual) {
      Divergence divergence = place_of(traces_, window_->golden, window_->golden.times[golden_index]);
      divergence.note = "the message can't be read again: " + (expected ? actual : expected).errors()[0].message;
      return findings_.structure(divergence);
    }
    auto found = Finding::none;
    if (are_pictures_) found = compare_pictures(golden_index, *expected, *actual);
    if (found == Finding::failed) return;
    const bool known = fields_.compare(golden_index, *expected, *actual, are_pictures_ ? "data" : "");
    if (known || found == Finding::pixels) return;
    if (are_pictures_ || fields_.knows_values())
      fields_.report_encoding(golden_index);
    else
      fields_.report_bytes(golden_index);
  }

  Finding compare_pictures(std::size_t golden_index, std::span<const std::byte> expected,
                           std::span<const std::byte> actual) {
    const auto golden = read_picture(channel_.golden.type, expected);
    const auto other = read_picture(channel_.actual.type, actual);
    if (!golden || !other)
      return fail(golden_index, fmt::format("the picture {} has a format that can't be compared",
                                            golden ? "of this run" : "of the golden"));
    if (golden->stamp != other->stamp)
      return fail(golden_index,
                  fmt::format("the picture was captured at {} s, expected {} s",
                              static_cast<double>(other->stamp) / 1e9, static_cast<double>(golden->stamp) / 1e9));
    if (!golden->same_size(*other))
      return fail(golden_index, fmt::format("the picture has {} x {} pixels, expected {} x {}", other->width,
                                            other->height, golden->width, golden->height));
    return compare_pixels(golden_index, *golden, *other) ? Finding::pixels : Finding::none;
  }

  /// True if some pixels differ.
  bool compare_pixels(std::size_t golden_index, const RecordedPicture& golden, const RecordedPicture& actual) {
    const PixelDifferences found = pixel_differences(golden, actual, tolerance_);
    if (found.differing == 0) return false;
    if (golden.depths.empty()) color_ = std::max(color_, found.largest);
    share_ = std::max(share_, found.share());
    const bool too_many = found.share() > tolerance_.pixel_share;
    const bool too_dense = found.densest > tolerance_.pixel_window;
    const bool by_window = too_dense && !too_many;
    const double difference = by_window ? found.densest : found.share();
    const double allowed = by_window ? tolerance_.pixel_window : tolerance_.pixel_share;
    const bool beyond = too_many || too_dense;
    const bool to_describe = findings_.count(difference, allowed, beyond);
    tell(golden_index, beyond, found.beyond);
    if (!to_describe) return true;
    Divergence divergence = place(golden_index);
    divergence.difference = difference;
    divergence.tolerance = allowed;
    const bool all_beyond = too_many && found.beyond == found.differing;
    divergence.note =
        fmt::format("{} differ{}, by up to {:g}{}", share_text(found.differing, golden.pixels()),
                    all_beyond ? " beyond tolerance" : "", found.largest, golden.depths.empty() ? " of 255" : " m");
    if (too_many && !all_beyond)
      divergence.note += fmt::format("; {} beyond tolerance", share_text(found.beyond, golden.pixels()));
    if (too_many) divergence.note += fmt::format("; allowed: {:.3g} %", 100.0 * tolerance_.pixel_share);
    if (by_window)
      divergence.note += fmt::format("; {:.3g} % of the {} x {} pixels at ({}, {}) beyond tolerance; allowed: {:.3g} %",
                                     100.0 * found.densest, PixelDifferences::window, PixelDifferences::window,
                                     found.densest_x, found.densest_y, 100.0 * tolerance_.pixel_window);
    findings_.describe(divergence, beyond);
    return true;
  }

  /// Passes a differing picture to CompareOptions::on_difference.
  void tell(std::size_t golden_index, bool beyond, std::size_t pixels) const {
    if (traces_.options.on_difference)
      traces_.options.on_difference(
          {window_->golden, window_->place(), golden_index, {}, beyond, static_cast<std::int64_t>(pixels)});
  }

  Divergence place(std::size_t golden_index) const {
    Divergence divergence = place_of(traces_, window_->golden, window_->golden.times[golden_index]);
    divergence.unit = unit_;
    return divergence;
  }

  Finding fail(std::size_t golden_index, std::string note) {
    tell(golden_index, true, 0);
    if (!findings_.count(std::numeric_limits<double>::infinity(), 0.0, true)) return Finding::failed;
    Divergence divergence = place(golden_index);
    divergence.difference = std::numeric_limits<double>::infinity();
    divergence.note = std::move(note);
    findings_.describe(divergence, true);
    return Finding::failed;
  }

  const ComparedTraces& traces_;
  const PairedChannel& channel_;
  ChannelFindings& findings_;
  const bool are_pictures_;
  const std::string unit_;
  const Tolerance tolerance_;  // of pictures
  FieldJudge fields_;
  const MatchedChannel* window_ = nullptr;  // the judged window
  double color_ = 0.0;                      // largest difference so far [of 255]
  double share_ = 0.0;                      // largest share of pixels beyond so far
};

}  // namespace

bool is_picture(const TraceChannel& channel) {
  return channel.encoding == "cdr" &&
         (channel.type == msg::CompressedImage::type_name || channel.type == msg::Image::type_name);
}

Tolerance picture_tolerance(const TraceChannel& channel, const std::vector<ToleranceRule>& rules) {
  const std::string unit = unit_of(channel.metadata, "");
  return tolerance_of(series_of(channel), unit == "m" ? UnitName("distance in a picture") : std::string_view(unit),
                      rules);
}

std::unique_ptr<PartJudge> judge_payloads(const ComparedTraces& traces, const PairedChannel& channel,
                                          ChannelFindings& findings) {
  return std::make_unique<PayloadJudge>(traces, channel, findings);
}

}  // namespace rehearse
