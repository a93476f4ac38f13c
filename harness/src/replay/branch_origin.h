// BranchOrigin: where a branch of a recording came from, as its metadata record `rehearse.branch` says.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

inline constexpr const char* branch_record = "rehearse.branch";

struct BranchOrigin {
  std::string source;                               // name of the file and hash of its bytes
  bool simulated = true;                            // from `tick` on; false: a replay, which is recorded all through
  std::int64_t tick = 0;                            // from here on it isn't the source's
  double time = 0.0;                                // of that tick [s]
  std::string checkpoint;                           // of which tick, or why none; of a replay empty
  std::vector<std::string> set, push, controllers;  // what was changed, as it was said
  /// Before this tick the world was moved by what the source's controllers commanded, which stands on topics with
  /// `acted` in the place of `output`, and not by what stands there: that is what the controllers of the branch would
  /// have commanded. None: it is the same.
  std::optional<std::int64_t> acted_until;

  mcap::StringMap facts() const;
  /// None if the record is null.
  static std::optional<BranchOrigin> of(const mcap::StringMap* facts);
  static std::optional<BranchOrigin> of(const mcap::Reader& trace);
};

/// "walk.mcap 0123456789abcdef". Fails if the file can't be read.
Result<std::string> name_and_hash(const std::filesystem::path& file);

/// "BODY/LINK force=X,Y,Z torque=X,Y,Z at=X,Y,Z @SPAN"; force or torque or both, world frame [N], [N·m]; `at` in the
/// link frame [m]. The span as parse_span() has it.
Result<Push> parse_push(const std::string& text, const Scenario& scenario);

}  // namespace rehearse
