// NumberMessages: the numbers of messages that name no joints.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <cstdint>
#include <vector>

#include "message_reader.h"

namespace rehearse {

/// Reads an array of numbers, as Float64MultiArray, from its layout's data_offset on; or a Twist or TwistStamped as six
/// numbers: linear x, y, z [m/s], angular x, y, z [rad/s].
class NumberMessages {
 public:
  explicit NumberMessages(const ros2msg::Schema& schema) : array_(schema), twist_(schema), stamped_(schema) {
    for (const ros2msg::FieldDefinition& field : schema.definitions[0].fields) {
      if (field.name == "linear") form_ = Form::twist;
      if (field.name == "twist") form_ = Form::stamped_twist;
    }
  }

  /// Null if the payload doesn't fit the schema. Valid until the next call.
  const std::vector<double>* read(mcap::Bytes payload) {
    if (form_ != Form::array) {
      const TwistOnly* stamped = form_ == Form::twist ? nullptr : stamped_.read(payload);
      const msg::Twist* twist = form_ == Form::twist ? twist_.read(payload) : stamped ? &stamped->twist : nullptr;
      if (!twist) return nullptr;
      const auto& [l, a] = *twist;
      numbers_ = {l.x, l.y, l.z, a.x, a.y, a.z};
      return &numbers_;
    }
    const Array* array = array_.read(payload);
    if (!array || array->layout.data_offset > array->data.size()) return nullptr;
    numbers_.assign(array->data.begin() + array->layout.data_offset, array->data.end());
    return &numbers_;
  }

 private:
  enum class Form { array, twist, stamped_twist };

  /// Without the dimensions: the numbers are taken in their order.
  struct Layout {
    static constexpr std::string_view type_name = "std_msgs/msg/MultiArrayLayout";
    std::uint32_t data_offset = 0;
    REHEARSE_FIELDS(data_offset)
  };
  struct Array {
    static constexpr std::string_view type_name = "std_msgs/msg/Float64MultiArray";
    Layout layout;
    std::vector<double> data;
    REHEARSE_FIELDS(layout, data)
  };
  struct TwistOnly {
    static constexpr std::string_view type_name = "geometry_msgs/msg/TwistStamped";
    msg::Twist twist;
    REHEARSE_FIELDS(twist)
  };

  Form form_ = Form::array;
  MessageReader<Array> array_;
  MessageReader<msg::Twist> twist_;
  MessageReader<TwistOnly> stamped_;
  std::vector<double> numbers_;
};

}  // namespace rehearse
