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

/// The largest magnitude of a column; for an element x, y or z the largest norm of the vector. Numbers that aren't
/// finite are left out.
double scale_of(const TraceChannel& channel, std::size_t column);

/// True if the tolerance of the rule depends on the scale.
inline bool is_relative(const ToleranceRule& rule) { return rule.rtol.value_or(0.0) > 0.0; }

/// Scales by topic and element.
using SeriesScales = std::map<std::pair<std::string, std::string>, double>;

/// The scales of the series for which a rule states rtol, read in one pass over a recording. Without a rule with rtol
/// nothing is read. For a damaged recording: the scales of its undamaged part.
SeriesScales scales_of(const std::filesystem::path& recording, const std::vector<ToleranceRule>& rules);

}  // namespace rehearse
