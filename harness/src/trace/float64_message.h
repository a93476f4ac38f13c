// A number as a message: std_msgs/msg/Float64, the message type of a controller's variables.
#pragma once

#include <rehearse/cdr.h>

#include <string_view>

namespace rehearse::msg {

struct Float64 {
  static constexpr std::string_view type_name = "std_msgs/msg/Float64";
  double data = 0.0;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("data", self.data);
  }
};

}  // namespace rehearse::msg
