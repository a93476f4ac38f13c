// AbstractSeq: interface of all sequences of frames at a fixed rate.
#pragma once

#include "Config.h"
#include "NullOut.h"
#include "ValueTree.h"

#include <memory>
#include <ostream>
#include <string>

namespace cnoid {

class CNOID_GENERAL_EXPORT AbstractSeq {
 public:
  virtual ~AbstractSeq();

  virtual std::shared_ptr<AbstractSeq> cloneSeq() const = 0;

  /// The kind of sequence, as .seq files name it: "MultiValueSeq", "Vector3Seq" ...
  const std::string& seqType() const { return seqType_; }
  /// The meaning of the values: "JointDisplacement", "ZMP" ...
  const std::string& seqContentName() const { return contentName_; }
  void setSeqContentName(const std::string& name) { contentName_ = name; }

  virtual double getFrameRate() const = 0;  // [Hz]
  virtual void setFrameRate(double rate) = 0;
  static double defaultFrameRate() { return 100.0; }
  /// Length of a frame [s]; 0 if there is no frame rate.
  double getTimeStep() const;
  void setTimeStep(double step);
  /// Time of frame 0 [s].
  virtual double getOffsetTime() const = 0;
  virtual void setOffsetTime(double time) = 0;
  /// The same in frames, rounded down.
  int getOffsetTimeFrame() const;
  void setOffsetTimeFrame(int frame);
  double getTimeOfFrame(int frame) const;
  int getFrameOfTime(double time) const;
  double getTimeLength() const;
  void setTimeLength(double length, bool fillNewElements = false) {
    setNumFrames(static_cast<int>(length * getFrameRate()), fillNewElements);
  }

  virtual int getNumFrames() const = 0;
  /// With fillNewElements: new frames are copies of the last one, or default values if there is none.
  virtual void setNumFrames(int n, bool fillNewElements = false) = 0;

  /// Reads the sequence from a node of a .seq file. On failure returns false; seqMessage() then states the error and
  /// its place.
  bool readSeq(const Mapping* archive, std::ostream& os = nullout());
  /// The messages of the last readSeq(), or load(); empty if there were none. (In Choreonoid it is always empty.)
  const std::string& seqMessage() const { return message_; }

 protected:
  explicit AbstractSeq(const char* seqType);
  AbstractSeq(const AbstractSeq&) = default;
  AbstractSeq& operator=(const AbstractSeq&) = default;

  /// Implementation of readSeq(). May throw a ValueNode::Exception. The default implementation refuses every node.
  virtual bool doReadSeq(const Mapping* archive, std::ostream& os);
  /// Calls doReadSeq() of a different sequence, for a sequence that consists of several.
  static bool readPart(AbstractSeq& part, const Mapping* archive, std::ostream& os);
  /// Calls readSeq() with a file's name for messages.
  bool readSeqOf(const std::string& file, const Mapping* archive, std::ostream& os);
  /// "file:line:column: " of a place in the text that is being read.
  std::string placeOf(int line, int column) const;
  /// Adds a message with the reason why nothing of a file could be read. Returns false.
  bool refuse(const std::string& file, const ValueNode::Exception& problem, std::ostream& os);

 private:
  std::string seqType_;
  std::string contentName_;
  std::string message_;
  std::string file_;
};

/// Each frame has the same number of parts.
class CNOID_GENERAL_EXPORT AbstractMultiSeq : public AbstractSeq {
 public:
  ~AbstractMultiSeq() override;
  virtual void setDimension(int numFrames, int numParts, bool fillNewElements = false) = 0;
  virtual void setNumParts(int numParts, bool fillNewElements = false) = 0;
  virtual int getNumParts() const = 0;

 protected:
  explicit AbstractMultiSeq(const char* seqType) : AbstractSeq(seqType) {}
  AbstractMultiSeq(const AbstractMultiSeq&) = default;
  AbstractMultiSeq& operator=(const AbstractMultiSeq&) = default;
};

using AbstractSeqPtr = std::shared_ptr<AbstractSeq>;

}  // namespace cnoid
