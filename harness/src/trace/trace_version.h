// The version of the trace format. Internal; harness/TRACE_FORMAT.md describes its meaning for a reader.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <string>
#include <vector>

namespace rehearse {

/// Changes when recorded data changes its meaning: a reader of a different version refuses the recording.
inline constexpr int trace_version = 1;

/// Within a version, grows when more data is recorded; 1 if a recording doesn't state it.
///   2  /contacts; `limits:` of joints
inline constexpr int trace_revision = 2;
inline constexpr int revision_of_contacts = 2;

/// Fails if the metadata of a recording states an unknown version of the trace format. `file`: its name in the error.
Result<void> check_trace_version(const std::vector<mcap::Metadata>& metadata, const std::string& file);

}  // namespace rehearse
