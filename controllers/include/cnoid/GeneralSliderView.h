// GeneralSliderView: sliders for a person at Choreonoid's window. Here is no window: a slider keeps the value that the
// program sets, and nobody moves it.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "Referenced.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT GeneralSliderView {
 public:
  static GeneralSliderView* instance();

  class CNOID_GENERAL_EXPORT Slider : public Referenced {
   public:
    const std::string& name() const { return name_; }
    double value() const { return value_; }
    void setValue(double value, bool = false) { value_ = value; }
    /// Never called: nobody moves the slider.
    void setCallback(std::function<void(double value)> callback) { callback_ = std::move(callback); }

   private:
    friend class GeneralSliderView;
    explicit Slider(std::string name) : name_(std::move(name)) {}
    std::string name_;
    double value_ = 0.0;
    std::function<void(double value)> callback_;
  };
  using SliderPtr = ref_ptr<Slider>;

  /// A new slider, at 0: a slider's callback is code of its controller, so no two controllers share one.
  SliderPtr getOrCreateSlider(const std::string& name, double lower = 0.0, double upper = 1000.0, int decimals = 0);
  void removeSlider(Slider*) {}

 private:
  GeneralSliderView() = default;
};

}  // namespace cnoid
