// The instructions of control() that are kept beside a golden, and the comparison of new ones with them.
//
// The file GOLDEN.instructions is JSON. It is bound to the golden's file, and states the compilers and the C library:
// others give other numbers, so their counts aren't compared.
#pragma once

#include <rehearse/audit.h>
#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// A call of control() beside the kept one of its tick.
struct ComparedCall {
  std::int64_t tick = 0;
  std::uint64_t instructions = 0, expected = 0;
};

/// The comparison of one controller, after tick 0. A call that takes over 2 % more than the kept one has grown.
struct ComparedInstructions {
  std::string controller;             // "SR1/Walk"
  std::string not_compared;           // the reason; empty: it was compared
  std::int64_t ticks = 0, grown = 0;  // compared, and of these grown
  std::optional<ComparedCall> first;  // of the grown ones
  std::optional<ComparedCall> worst;  // of the grown ones that with the largest difference
  double share = 1.0;                 // of all instructions, of those expected
};

struct InstructionJudgement {
  std::string verdict;  // one sentence, without a full stop
  bool has_grown = false;
  bool was_compared = false;  // at least one controller
  std::vector<ComparedInstructions> controllers;
};

/// Keeps the counts of the report, which is that of `golden`. Fails if the file can't be written.
Result<void> keep_instructions(const AuditReport& report, const std::filesystem::path& golden);

/// Compares the counts of the report with those that are kept beside `golden`. Fails if these can't be read.
Result<InstructionJudgement> judge_instructions(const AuditReport& report, const std::filesystem::path& golden);

}  // namespace rehearse
