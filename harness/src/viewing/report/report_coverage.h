// The coverage of controllers in a report, with their sources. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <string>
#include <vector>

#include "report_blobs.h"

namespace rehearse {

/// The object that to_json(CoverageReport) wrote, whose files also have `source` (lines; null: the file can't be read)
/// and `unread` (the reason, a sentence without a full stop, or empty). Fails if the text isn't such an object.
Result<ReportJson> coverage_with_sources(const std::string& text);

/// The entry `coverage` of the report's object: null for null, else `coverage` as a blob, and its numbers of lines.
ReportJson coverage_entry(BlobWriter& blobs, const ReportJson& coverage);

}  // namespace rehearse
