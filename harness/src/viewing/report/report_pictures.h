// The pictures of cameras in both runs. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "report_blobs.h"
#include "report_rows.h"
#include "report_run.h"

namespace rehearse {

class PictureWriter {
 public:
  /// `golden` and `judged` may be null: the run is shown alone. Pictures that aren't shown are reported in `omitted`.
  /// `focus`: the pictures around its times are shown. `most_coded`: about the size of a camera's pictures [bytes].
  PictureWriter(BlobWriter& blobs, const ReportedRun& actual, const ReportedRun* golden, const JudgedValues* judged,
                const RowFocus& focus, std::uint64_t most_coded, std::vector<std::string>& omitted)
      : blobs_(blobs),
        actual_(actual),
        golden_(golden),
        judged_(judged),
        focus_(focus),
        most_coded_(most_coded),
        omitted_(omitted) {}

  /// The pictures of a channel, with all of its messages. If they are too many, those at equal distances are shown, and
  /// those around the first difference.
  void write(const ShownChannel& channel);

  ReportJson take_cameras() { return std::move(cameras_); }

 private:
  /// The common data of a camera's pictures.
  struct Album {
    bool is_depth = false;
    float near = 0.0f, far = 0.0f;    // [m]
    int width = 0, height = 0;        // [pixels]; 0: not yet known
    std::size_t lost = 0;             // number of pictures that can't be shown
    std::string why;                  // the reason for the first of these
    std::vector<float> drawn_depths;  // of the previous picture; depths are often unchanged
    ReportJson drawn;
  };
  /// The pictures of a time: indices of messages; none: the run has no picture then.
  struct Moment {
    std::uint64_t time = 0;  // [ns]
    std::optional<std::size_t> actual, golden;
  };
  static std::vector<Moment> moments_of(const ShownChannel& channel);
  std::vector<std::size_t> choose(const std::vector<Moment>& moments, std::size_t stride) const;
  ReportJson moment_json(const ShownChannel& channel, const Moment& moment, Album& album);
  Album survey(const ShownChannel& channel);
  void find_range(const Trace& trace, const TraceChannel& channel, Album& album);
  ReportJson picture(const Trace& trace, const TraceChannel& channel, std::size_t message, Album& album);

  BlobWriter& blobs_;
  const ReportedRun& actual_;
  const ReportedRun* golden_;
  const JudgedValues* judged_;
  const RowFocus& focus_;
  const std::uint64_t most_coded_;
  std::vector<std::string>& omitted_;
  ReportJson cameras_ = ReportJson::array();
};

}  // namespace rehearse
