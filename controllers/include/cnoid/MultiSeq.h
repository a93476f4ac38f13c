// MultiSeq: frames of several values each; base of MultiValueSeq (one number per joint) and MultiSE3Seq (one pose per
// link).
#pragma once

#include "AbstractSeq.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace cnoid {

template <typename ElementType>
class MultiSeq : public AbstractMultiSeq {
 public:
  using value_type = ElementType;
  using Element = ElementType;

  /// A view of one frame. It is valid until the number of frames or parts changes, or the sequence is destroyed.
  class Frame {
   public:
    using iterator = ElementType*;
    Frame() = default;
    Frame(ElementType* first, int size) : first_(first), size_(size) {}
    bool empty() const { return size_ == 0; }
    int size() const { return size_; }
    iterator begin() const { return first_; }
    iterator end() const { return first_ + size_; }
    /// The index is not checked.
    ElementType& operator[](int part) const { return first_[part]; }
    ElementType& at(int part) const {
      if (part < 0 || part >= size_) throw std::out_of_range("a frame has no part " + std::to_string(part));
      return first_[part];
    }

   private:
    ElementType* first_ = nullptr;
    int size_ = 0;
  };

  /// A view of one value in all frames. It is valid as long as a Frame.
  class Part {
   public:
    Part(ElementType* first, int stride, int size) : first_(first), stride_(stride), size_(size) {}
    int size() const { return size_; }
    ElementType& operator[](int frame) const { return first_[static_cast<std::ptrdiff_t>(frame) * stride_]; }

   private:
    ElementType* first_;
    int stride_;
    int size_;
  };

  double frameRate() const { return frameRate_; }
  double timeStep() const { return getTimeStep(); }
  double offsetTime() const { return offsetTime_; }
  int offsetTimeFrame() const { return getOffsetTimeFrame(); }
  int numFrames() const { return numFrames_; }
  int numParts() const { return numParts_; }
  bool empty() const { return values_.empty(); }
  double timeLength() const { return getTimeLength(); }
  int frameOfTime(double time) const { return getFrameOfTime(time); }
  double timeOfFrame(int frame) const { return getTimeOfFrame(frame); }

  double getFrameRate() const override { return frameRate_; }
  void setFrameRate(double rate) override { frameRate_ = rate; }
  double getOffsetTime() const override { return offsetTime_; }
  void setOffsetTime(double time) override { offsetTime_ = time; }
  int getNumFrames() const override { return numFrames_; }
  int getNumParts() const override { return numParts_; }
  void setNumFrames(int n, bool fillNewElements = false) override { setDimension(n, numParts_, fillNewElements); }
  void setNumParts(int n, bool fillNewElements = false) override { setDimension(numFrames_, n, fillNewElements); }

  /// New elements have the default value, or with fillNewElements the values of the last frame. A change of the number
  /// of parts sets all elements to the default.
  void setDimension(int newNumFrames, int newNumParts, bool fillNewElements = false) override {
    const int oldNumFrames = numFrames_;
    const std::size_t size = static_cast<std::size_t>(newNumFrames) * static_cast<std::size_t>(newNumParts);
    if (newNumParts != numParts_) values_.clear();
    values_.resize(size, defaultValue());
    const bool hasModel = newNumParts == numParts_ && oldNumFrames > 0;
    numFrames_ = newNumFrames;
    numParts_ = newNumParts;
    for (int i = oldNumFrames; fillNewElements && hasModel && i < numFrames_; ++i) {
      const Frame model = frame(oldNumFrames - 1);
      std::copy(model.begin(), model.end(), frame(i).begin());
    }
  }

  /// Throws std::out_of_range if the frame doesn't exist (Choreonoid does not check).
  Frame frame(int index) const {
    if (index < 0 || index >= numFrames_) {
      throw std::out_of_range("frame " + std::to_string(index) + " is asked for in a sequence of " +
                              std::to_string(numFrames_));
    }
    return Frame(data() + static_cast<std::ptrdiff_t>(index) * numParts_, numParts_);
  }
  Frame lastFrame() const { return frame(numFrames_ - 1); }
  /// The frame at the index; the first frame for a smaller index, the last for a larger one. Throws std::out_of_range
  /// without frames.
  Frame clampedFrame(int index) const { return frame(clampFrameIndex(index)); }
  Frame clampedFrame(int index, bool& out_isWithinRange) const {
    return frame(clampFrameIndex(index, out_isWithinRange));
  }
  int clampFrameIndex(int index) const { return std::max(0, std::min(index, numFrames_ - 1)); }
  int clampFrameIndex(int index, bool& out_isWithinRange) const {
    out_isWithinRange = index >= 0 && index < numFrames_;
    return clampFrameIndex(index);
  }
  Part part(int index) const {
    if (index < 0 || index >= numParts_) throw std::out_of_range("a sequence has no part " + std::to_string(index));
    return Part(data() + index, numParts_, numFrames_);
  }

  /// Invalidates views of frames.
  Frame appendFrame() {
    setNumFrames(numFrames_ + 1);
    return lastFrame();
  }
  void popFrontFrames(int n) {
    n = std::max(0, std::min(n, numFrames_));
    values_.erase(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(n) * numParts_);
    numFrames_ -= n;
  }
  void popFrontFrame() { popFrontFrames(1); }
  void clear() { setDimension(0, numParts_); }

 protected:
  explicit MultiSeq(const char* seqType) : AbstractMultiSeq(seqType) {}
  MultiSeq(const MultiSeq&) = default;
  MultiSeq& operator=(const MultiSeq&) = default;

  virtual ElementType defaultValue() const { return ElementType(); }

 private:
  /// As in Choreonoid, a view of a constant sequence allows writing.
  ElementType* data() const { return const_cast<ElementType*>(values_.data()); }

  std::vector<ElementType> values_;  // frame after frame
  int numFrames_ = 0;
  int numParts_ = 1;
  double frameRate_ = 0.0;
  double offsetTime_ = 0.0;
};

}  // namespace cnoid
