// Which form a recording has. Internal; harness/TRACE_FORMAT.md tells what the numbers mean to a reader.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <string>
#include <vector>

namespace rehearse {

/// Changes when what is recorded means something else: a reader of another version refuses.
inline constexpr int trace_version = 1;

/// Within a version, grows when more is recorded; absent from a recording: 1.
///   2  /contacts; `limits:` of joints
inline constexpr int trace_revision = 2;
inline constexpr int revision_of_contacts = 2;

/// Fails if the metadata of a recording says that it is of a version of the trace format that isn't known here. `file`:
/// what the error calls it.
Result<void> check_trace_version(const std::vector<mcap::Metadata>& metadata, const std::string& file);

}  // namespace rehearse
