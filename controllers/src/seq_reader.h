// How every sequence of a .seq file is read: its header, then its frames. Problems are thrown as ValueNode::Exception,
// with the place in the file.
#pragma once

#include <cnoid/AbstractSeq>
#include <functional>
#include <initializer_list>

namespace cnoid {

struct SeqHeader {
  double formatVersion = 1.0;
  bool hasFrameTime = false;  // the first number of a frame is its time [s]
};

/// Reads the header and gives the sequence its content name and its frame rate. `types` are the names that the sequence
/// may have in the file; the first is its own.
SeqHeader readSeqHeader(const Mapping& archive, AbstractSeq& seq, std::initializer_list<const char*> types);

/// numParts: 1 or more.
int readNumParts(const Mapping& archive);

/// "frames": one or more lists of `frameSize` elements each, one more if there is a time.
const Listing& checkedFrames(const Mapping& archive, const SeqHeader& header, int frameSize);

/// Calls `setFrame` for each of them with the index of the frame, its list, and the index of its first element there.
/// The sequence, whatever frames it had, has that frame then; frames without an entry are copies of the one before.
void fillFrames(const Listing& frames, const SeqHeader& header, AbstractSeq& seq,
                const std::function<void(int frame, const Listing& values, int first)>& setFrame);

}  // namespace cnoid
