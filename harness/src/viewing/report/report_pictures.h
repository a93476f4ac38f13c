// The pictures of cameras in both runs. Internal.
#pragma once

#include <string>
#include <vector>

#include "report_blobs.h"
#include "report_run.h"

namespace rehearse {

class PictureWriter {
 public:
  /// `golden` and `judged` may be null: the run is shown alone. Pictures that can't be shown are reported in `omitted`.
  PictureWriter(BlobWriter& blobs, const ReportedRun& actual, const ReportedRun* golden, const JudgedValues* judged,
                std::vector<std::string>& omitted)
      : blobs_(blobs), actual_(actual), golden_(golden), judged_(judged), omitted_(omitted) {}

  /// All pictures of a channel. One of the channels may be null, not both.
  void write(const TraceChannel* actual, const TraceChannel* golden);

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
  Album survey(const TraceChannel* actual, const TraceChannel* golden);
  void find_range(const Trace& trace, const TraceChannel& channel, Album& album);
  ReportJson picture(const Trace& trace, const TraceChannel& channel, std::size_t message, Album& album);

  BlobWriter& blobs_;
  const ReportedRun& actual_;
  const ReportedRun* golden_;
  const JudgedValues* judged_;
  std::vector<std::string>& omitted_;
  ReportJson cameras_ = ReportJson::array();
};

}  // namespace rehearse
