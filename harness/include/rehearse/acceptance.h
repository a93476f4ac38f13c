// Acceptance: what is written into a golden when somebody accepts it, so that its history travels with it.
//
// Each acceptance is a metadata record of its own at the end of the golden's data section, `rehearse.acceptance.1` and
// on; any MCAP tool shows them. A recording that isn't a golden has none: nothing of the calendar is in it.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/trace.h>

#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// One acceptance. Text throughout: it is for people, and goes into the digest as it is.
struct Acceptance {
  std::string date;                // UTC, as 2026-11-20
  std::string kind;                // "first", "replaced" or "partial"
  std::string accepted;            // partial: which channels and which span
  std::string verdict;             // of the old golden and the new one; empty for the first
  std::vector<std::string> moved;  // a line each: what moved, by how much at worst, when, how often
};

/// Names of acceptance records begin so.
inline constexpr std::string_view acceptance_prefix = "rehearse.acceptance.";

/// Today in UTC, or the day that SOURCE_DATE_EPOCH states [s since 1970]. An error if that is no number.
Result<std::string> date_of_today();

/// What moved: a line for each channel, worst first, and what else explains it; at most fourteen lines.
std::vector<std::string> moved_lines(const Comparison& comparison);

/// The acceptances that stand in a file, oldest first.
std::vector<Acceptance> history_of(const std::vector<mcap::Metadata>& metadata);

/// The records of a history.
std::vector<mcap::Metadata> records_of(const std::vector<Acceptance>& history);

/// For the head of the digest: the verdict and the lines of what moved.
std::string acceptance_text(const Acceptance& acceptance);

/// For the digest: two lines and more an acceptance; empty without any.
std::string history_text(const std::vector<Acceptance>& history);

}  // namespace rehearse
