// The columns of both runs, side by side. Internal.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "report_blobs.h"
#include "report_rows.h"
#include "report_run.h"

namespace rehearse {

class SeriesWriter {
 public:
  /// `golden` and `judged` may be null: the run is shown alone.
  SeriesWriter(BlobWriter& blobs, const ReportedRun& actual, const ReportedRun* golden, const JudgedValues* judged)
      : blobs_(blobs), actual_(actual), golden_(golden), judged_(judged) {}

  /// All series of a channel.
  void write(const ShownChannel& channel);

  ReportJson take_series() { return std::move(series_); }
  ReportJson take_axes() { return std::move(axes_); }

 private:
  /// A column of a channel in one run; null: this run doesn't have it.
  struct Column {
    const TraceChannel* table = nullptr;
    std::size_t index = 0;
    std::size_t axis = 0;
    const ValueRange* range = nullptr;

    bool is_there() const { return table != nullptr; }
  };
  std::size_t axis_of(const ReportedRun& run, const TraceChannel& table);
  /// The written series, without its differences from the golden.
  ReportJson& write_column(const Column& actual, const Column& golden);

  BlobWriter& blobs_;
  const ReportedRun& actual_;
  const ReportedRun* golden_;
  const JudgedValues* judged_;
  std::vector<std::vector<std::uint32_t>> axis_ticks_;
  ReportJson axes_ = ReportJson::array();
  ReportJson series_ = ReportJson::array();
};

/// The group of a channel's series on the page: "state", "sensor", "input", "output", "variable", "other".
std::string_view series_group(const TraceChannel& channel);

}  // namespace rehearse
