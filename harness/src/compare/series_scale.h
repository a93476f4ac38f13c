// The scale of a series, to which a relative tolerance refers (scenario.h). Internal.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// The largest magnitude of a column; of an element x, y or z the largest norm of the three. Numbers that aren't finite
/// don't count.
double scale_of(const TraceChannel& channel, std::size_t column);

/// Whether the scale matters.
inline bool is_relative(const ToleranceRule& rule) { return rule.rtol.value_or(0.0) > 0.0; }

/// By topic and element.
using SeriesScales = std::map<std::pair<std::string, std::string>, double>;

/// Of the series of a recording for which a rule states rtol, read in one pass. Without such a rule nothing is read.
/// Of a damaged recording, the scales of its undamaged part.
SeriesScales scales_of(const std::filesystem::path& recording, const std::vector<ToleranceRule>& rules);

}  // namespace rehearse
