// Small pictures of series in a terminal's characters: a golden and a run over time, and where they part.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// A series to draw. Samples that aren't finite are left out.
struct Curve {
  std::vector<double> times;  // [s], ascending
  std::vector<double> values;
};

struct PlotSize {
  std::size_t width = 78;  // [characters], labels included
  std::size_t height = 7;  // [lines] of the curves; two more are the axis of time
};

/// Both curves over one axis of time, with a mark below the time of their first difference. Each column shows the range
/// of its samples: ▒ where both are, ░ where only the golden is, █ where only the run is. Lines, each with its newline;
/// one that says so if there is nothing to draw.
std::string plot(const Curve& golden, const Curve& run, std::optional<double> mark, PlotSize size = {});

/// Of the worst channels, at most so many, and of different stages where there are: the series that differs worst, with
/// a heading and a plot whose mark stands at the channel's first difference. Curves that would look the same are shown
/// by their difference.
std::string worst_plots(const Trace& golden, const Trace& run, const Comparison& comparison, std::size_t channels);

}  // namespace rehearse
