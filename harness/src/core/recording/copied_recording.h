// Copies parts of a different recording into a trace: messages, and chunks as they are stored.
#pragma once

#include <rehearse/mcap.h>

#include <string>

#include "trace_output.h"

namespace rehearse {

/// Recorder::copy(), of the recorder of this output.
Result<void> copy_message(const mcap::Message& message, const mcap::Schema& schema, const std::string& topic,
                          TraceOutput& output);
/// Recorder::begins_like()
bool begins_like(const TraceOutput& output, const mcap::Reader& other);
/// Recorder::copy_chunk()
Result<void> copy_chunk(const mcap::StoredChunk& chunk, const mcap::Reader& other, TraceOutput& output);
/// Counts the message if it contains a picture.
void count_pictures(const mcap::Message& message, const mcap::Schema& schema, RecordingSize& size);

}  // namespace rehearse
