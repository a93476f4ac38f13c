// Pictures of what differs between pictures: expected, actual and difference side by side, for a person to look at.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/trace.h>

#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

/// For each camera channel with a picture beyond its tolerance, its first such picture as PNG: the golden's, the
/// other's, and the difference: in red what is beyond, in yellow what differs within tolerance, on a dimmed picture of
/// the golden's. Distances are shown as grey, from white where they are least to black at the greatest; blue is where
/// nothing was found. The files are named like `actual`, then by channel: "Run.SR1.LeftCamera.image.png" beside
/// "Run.mcap"; older ones of that name are removed first. Returns what was written.
Result<std::vector<std::filesystem::path>> write_picture_differences(const Trace& golden, const Trace& actual,
                                                                     const Comparison& comparison,
                                                                     const std::vector<ToleranceRule>& rules,
                                                                     const std::filesystem::path& beside);

/// "expected, actual and difference: FILE", a line each, each after a newline; or why they couldn't be written.
std::string picture_lines(const Result<std::vector<std::filesystem::path>>& written);

/// Removes what write_picture_differences() wrote beside that recording.
void remove_picture_differences(const std::filesystem::path& beside);

}  // namespace rehearse
