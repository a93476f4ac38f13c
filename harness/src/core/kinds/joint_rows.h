// The table of messages of joints: arrays that belong to an array of names.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "kind.h"
#include "rows.h"

namespace rehearse {

inline constexpr ElementGroup joint_groups[] = {
    {"q", "rad", {}, "m"}, {"dq", "rad/s", {}, "m/s"}, {"u", "N·m", {}, "N"}};

/// `suffixes` name the arrays that follow the names, in order: "/q", "/dq", "/u".
std::unique_ptr<RowReader> joint_rows(TraceChannel& channel, std::vector<std::string_view> suffixes);

}  // namespace rehearse
