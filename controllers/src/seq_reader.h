// Common functions for reading the sequences of a .seq file: the header, then the frames. Errors are thrown as
// ValueNode::Exception, with the place in the file.
#pragma once

#include <cnoid/AbstractSeq>
#include <functional>
#include <initializer_list>

namespace cnoid {

struct SeqHeader {
  double formatVersion = 1.0;
  bool hasFrameTime = false;  // the first number of a frame is its time [s]
};

/// Reads the header and sets the sequence's content name and frame rate. `types` are the allowed names of the sequence
/// type in the file; the first is the current name.
SeqHeader readSeqHeader(const Mapping& archive, AbstractSeq& seq, std::initializer_list<const char*> types);

/// numParts: 1 or more.
int readNumParts(const Mapping& archive);

/// "frames": one or more lists of `frameSize` elements each, one more if there is a time.
const Listing& checkedFrames(const Mapping& archive, const SeqHeader& header, int frameSize);

/// Calls `setFrame` for each entry of `frames` with the index of the frame, its list, and the index of its first
/// element in the list. The sequence is resized as needed; frames without an entry are copies of the frame before.
void fillFrames(const Listing& frames, const SeqHeader& header, AbstractSeq& seq,
                const std::function<void(int frame, const Listing& values, int first)>& setFrame);

}  // namespace cnoid
