// Seq: one value per frame.
#pragma once

#include "AbstractSeq.h"

#include <algorithm>
#include <cstddef>
#include <deque>

namespace cnoid {

template <typename ElementType>
class Seq : public AbstractSeq {
 public:
  using value_type = ElementType;

  double frameRate() const { return frameRate_; }
  double timeStep() const { return getTimeStep(); }
  double offsetTime() const { return offsetTime_; }
  int offsetTimeFrame() const { return getOffsetTimeFrame(); }
  int numFrames() const { return static_cast<int>(frames_.size()); }
  bool empty() const { return frames_.empty(); }
  double timeLength() const { return getTimeLength(); }
  int frameOfTime(double time) const { return getFrameOfTime(time); }
  int lastFrameOfTime(double time) const { return clampFrameIndex(frameOfTime(time)); }
  double timeOfFrame(int frame) const { return getTimeOfFrame(frame); }

  double getFrameRate() const override { return frameRate_; }
  void setFrameRate(double rate) override { frameRate_ = rate; }
  double getOffsetTime() const override { return offsetTime_; }
  void setOffsetTime(double time) override { offsetTime_ = time; }
  int getNumFrames() const override { return numFrames(); }
  void setNumFrames(int n, bool fillNewElements = false) override {
    const ElementType model = fillNewElements && !empty() ? back() : defaultValue();
    frames_.resize(static_cast<std::size_t>(n), model);
  }
  void resize(int n) { setNumFrames(n); }
  void clear() { frames_.clear(); }

  /// These functions throw std::out_of_range if the frame doesn't exist (Choreonoid does not check).
  ElementType& frame(int index) { return frames_.at(static_cast<std::size_t>(index)); }
  const ElementType& frame(int index) const { return frames_.at(static_cast<std::size_t>(index)); }
  ElementType& at(int index) { return frame(index); }
  const ElementType& at(int index) const { return frame(index); }
  ElementType& operator[](int index) { return frame(index); }
  const ElementType& operator[](int index) const { return frame(index); }
  ElementType& front() { return frame(0); }
  const ElementType& front() const { return frame(0); }
  ElementType& back() { return frame(numFrames() - 1); }
  const ElementType& back() const { return frame(numFrames() - 1); }

  int clampFrameIndex(int index) const { return std::max(0, std::min(index, numFrames() - 1)); }
  int clampFrameIndex(int index, bool& out_isWithinRange) const {
    out_isWithinRange = index >= 0 && index < numFrames();
    return clampFrameIndex(index);
  }

  void append(const ElementType& element) { frames_.push_back(element); }
  ElementType& append() {
    frames_.push_back(defaultValue());
    return back();
  }
  /// Has no effect on an empty sequence.
  void popFront() {
    if (!empty()) frames_.pop_front();
  }
  void popBack() {
    if (!empty()) frames_.pop_back();
  }

 protected:
  explicit Seq(const char* seqType) : AbstractSeq(seqType), frameRate_(defaultFrameRate()) {}
  Seq(const Seq&) = default;
  Seq& operator=(const Seq&) = default;

  virtual ElementType defaultValue() const { return ElementType(); }

 private:
  std::deque<ElementType> frames_;
  double frameRate_;
  double offsetTime_ = 0.0;
};

}  // namespace cnoid
