// AbstractSeq: a sequence of frames at a fixed rate, of whatever kind.
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

  /// As .seq files name the kind: "MultiValueSeq", "Vector3Seq" ...
  const std::string& seqType() const { return seqType_; }
  /// What the numbers are: "JointDisplacement", "ZMP" ...
  const std::string& seqContentName() const { return contentName_; }
  void setSeqContentName(const std::string& name) { contentName_ = name; }

  virtual double getFrameRate() const = 0;  // [Hz]
  virtual void setFrameRate(double rate) = 0;
  static double defaultFrameRate() { return 100.0; }
  /// 0 if there is no frame rate [s].
  double getTimeStep() const;
  void setTimeStep(double step);
  /// Of frame 0 [s].
  virtual double getOffsetTime() const = 0;
  virtual void setOffsetTime(double time) = 0;
  double getTimeOfFrame(int frame) const;
  int getFrameOfTime(double time) const;
  double getTimeLength() const;

  virtual int getNumFrames() const = 0;
  /// With fillNewElements: new frames are copies of the last one, or default values if there is none.
  virtual void setNumFrames(int n, bool fillNewElements = false) = 0;

  /// From a node of a .seq file. False, with a message that says what is wrong and where, if that is not possible.
  bool readSeq(const Mapping* archive, std::ostream& os = nullout());
  /// The messages of the last readSeq(), or load(); empty if there were none. (In Choreonoid it is always empty.)
  const std::string& seqMessage() const { return message_; }

 protected:
  explicit AbstractSeq(const char* seqType);
  AbstractSeq(const AbstractSeq&) = default;
  AbstractSeq& operator=(const AbstractSeq&) = default;

  /// What readSeq() does. May throw a ValueNode::Exception. By default: refuses.
  virtual bool doReadSeq(const Mapping* archive, std::ostream& os);
  /// doReadSeq() of another sequence, for one that consists of several.
  static bool readPart(AbstractSeq& part, const Mapping* archive, std::ostream& os);
  /// readSeq() with a file's name for messages.
  bool readSeqOf(const std::string& file, const Mapping* archive, std::ostream& os);
  /// "file:line:column: " of a place in what is being read.
  std::string placeOf(int line, int column) const;
  /// Says why nothing of a file could be read. Returns false.
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

}  // namespace cnoid
