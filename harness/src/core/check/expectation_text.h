// Expectations and their results in words, and in the language of expressions. Internal.
#pragma once

#include <rehearse/check.h>
#include <rehearse/trace.h>

#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// A trace has nanoseconds; a double of them may have more digits.
std::string time_text(double seconds);
/// A number as the expectation states numbers, with its unit.
std::string number_text(double value, const std::string& unit, const Expectation& expectation);
/// "SR1/WAIST/position/z above 0.6 m from 2 s on"; of an expression: "always abs(q) < 8 deg from 1 s on".
std::string text_of(const Expectation& expectation, const std::string& unit);

/// The bounds of a series as a condition: "abs('SR1/KNEE/u') < 100".
std::string condition_of(const Expectation& expectation, const std::string& series);
/// "always abs('SR1/KNEE/u') < 100": the whole expectation in the language of expressions.
std::string formula_of(const Expectation& expectation);

/// The number of a margin that is demanded, and what is missing: "with a margin of 10 %". Empty: the margin is enough.
std::string missing_margin(const ExpectationResult& result);

/// "Robot/Gyro/angular_velocity/y has no sample", of some of them.
std::string without_sample_text(const std::vector<std::string>& series);

/// The series that match a pattern and whose channel has no message.
std::vector<std::string> unsampled_series(const Trace& run, std::string_view pattern);

}  // namespace rehearse
