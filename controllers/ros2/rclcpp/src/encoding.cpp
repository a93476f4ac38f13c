#include "rclcpp/detail/encoding.hpp"

#include <cstring>
#include <set>
#include <string_view>

namespace rehearse_ros2 {
namespace {

namespace introspection = rosidl_typesupport_introspection_cpp;
using Member = introspection::MessageMember;

/// A type of numbers: its name in definitions, and its size [bytes].
struct NumberType {
  std::uint8_t id;
  const char* name;
  std::size_t size;
};
constexpr NumberType number_types[] = {
    {introspection::ROS_TYPE_FLOAT, "float32", 4}, {introspection::ROS_TYPE_DOUBLE, "float64", 8},
    {introspection::ROS_TYPE_CHAR, "uint8", 1},    {introspection::ROS_TYPE_BOOLEAN, "bool", 1},
    {introspection::ROS_TYPE_OCTET, "byte", 1},    {introspection::ROS_TYPE_UINT8, "uint8", 1},
    {introspection::ROS_TYPE_INT8, "int8", 1},     {introspection::ROS_TYPE_UINT16, "uint16", 2},
    {introspection::ROS_TYPE_INT16, "int16", 2},   {introspection::ROS_TYPE_UINT32, "uint32", 4},
    {introspection::ROS_TYPE_INT32, "int32", 4},   {introspection::ROS_TYPE_UINT64, "uint64", 8},
    {introspection::ROS_TYPE_INT64, "int64", 8},   {introspection::ROS_TYPE_WCHAR, "wchar", 2},
};

const NumberType* number_type(const Member& member) {
  for (const NumberType& type : number_types)
    if (type.id == member.type_id_) return &type;
  return nullptr;
}

const MessageMembers& members_in(const Member& member) {
  return *static_cast<const MessageMembers*>(member.members_->data);
}

const void* field_of(const void* message, const Member& member) {
  return static_cast<const char*>(message) + member.offset_;
}
void* field_of(void* message, const Member& member) { return static_cast<char*>(message) + member.offset_; }

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

std::string package_of(const MessageMembers& type) {
  const std::string space = type.message_namespace_;
  return space.substr(0, space.find("::"));
}

std::string type_text(const Member& member) {
  std::string text;
  if (const NumberType* number = number_type(member))
    text = number->name;
  else if (member.type_id_ == introspection::ROS_TYPE_MESSAGE)
    text = package_of(members_in(member)) + "/" + members_in(member).message_name_;
  else {
    text = member.type_id_ == introspection::ROS_TYPE_WSTRING ? "wstring" : "string";
    if (member.string_upper_bound_ != 0) text += "<=" + std::to_string(member.string_upper_bound_);
  }
  if (!member.is_array_) return text;
  if (member.array_size_ == 0) return text + "[]";
  return text + (member.is_upper_bound_ ? "[<=" : "[") + std::to_string(member.array_size_) + "]";
}

bool is_placeholder(const MessageMembers& type) {
  return type.member_count_ == 1 && std::string_view(type.members_[0].name_) == "structure_needs_at_least_one_member";
}

/// Those that `type` uses come in the order of their first use.
void add_definitions(const MessageMembers& type, std::string& text, std::set<std::string>& known) {
  std::vector<const MessageMembers*> used;
  for (std::uint32_t i = 0; i < type.member_count_; ++i) {
    const Member& member = type.members_[i];
    if (!is_placeholder(type)) text += type_text(member) + " " + member.name_ + "\n";
    if (member.type_id_ == introspection::ROS_TYPE_MESSAGE) used.push_back(&members_in(member));
  }
  for (const MessageMembers* other : used) {
    const std::string name = package_of(*other) + "/" + other->message_name_;
    if (!known.insert(name).second) continue;
    text += std::string(80, '=') + "\nMSG: " + name + "\n";
    add_definitions(*other, text, known);
  }
}

class Encoder {
 public:
  explicit Encoder(std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  void message(const void* from, const MessageMembers& type) {
    for (std::uint32_t i = 0; i < type.member_count_; ++i) field(field_of(from, type.members_[i]), type.members_[i]);
  }

 private:
  void field(const void* from, const Member& member) {
    if (!member.is_array_) return value(from, member);
    const std::size_t count = member.size_function != nullptr ? member.size_function(from) : member.array_size_;
    if (member.is_upper_bound_ && count > member.array_size_)
      throw std::length_error(std::string("'") + member.name_ + "' has more than " +
                              std::to_string(member.array_size_) + " elements");
    if (member.array_size_ == 0 || member.is_upper_bound_) number(static_cast<std::uint32_t>(count));
    if (count == 0) return;
    if (member.type_id_ == introspection::ROS_TYPE_BOOLEAN) {
      for (std::size_t i = 0; i < count; ++i) {
        bool element = false;
        member.fetch_function(from, i, &element);
        number(static_cast<std::uint8_t>(element));
      }
      return;
    }
    if (const NumberType* type = number_type(member)) return raw(member.get_const_function(from, 0), type->size, count);
    for (std::size_t i = 0; i < count; ++i) value(member.get_const_function(from, i), member);
  }

  void value(const void* from, const Member& member) {
    if (const NumberType* type = number_type(member)) return raw(from, type->size, 1);
    if (member.type_id_ == introspection::ROS_TYPE_MESSAGE) return message(from, members_in(member));
    if (member.type_id_ == introspection::ROS_TYPE_WSTRING) {
      const auto& text = *static_cast<const std::u16string*>(from);
      number(static_cast<std::uint32_t>(text.size()));
      for (const char16_t letter : text) number(static_cast<std::uint32_t>(letter));
      return;
    }
    const auto& text = *static_cast<const std::string*>(from);
    number(static_cast<std::uint32_t>(text.size() + 1));
    append(text.c_str(), text.size() + 1);
  }

  template <class Number>
  void number(Number value) {
    raw(&value, sizeof value, 1);
  }
  void raw(const void* from, std::size_t size, std::size_t count) {
    bytes_.resize(bytes_.size() + (size - (bytes_.size() - header) % size) % size);
    append(from, size * count);
  }
  void append(const void* from, std::size_t size) {
    const auto* begin = static_cast<const std::uint8_t*>(from);
    bytes_.insert(bytes_.end(), begin, begin + size);
  }

  static constexpr std::size_t header = 4;
  std::vector<std::uint8_t>& bytes_;
};

class Decoder {
 public:
  Decoder(const std::uint8_t* bytes, std::size_t size) : begin_(bytes), at_(bytes), end_(bytes + size) {}

  void message(void* to, const MessageMembers& type) {
    for (std::uint32_t i = 0; i < type.member_count_; ++i) field(field_of(to, type.members_[i]), type.members_[i]);
  }
  std::size_t rest() const { return static_cast<std::size_t>(end_ - at_); }

 private:
  void field(void* to, const Member& member) {
    if (!member.is_array_) return value(to, member);
    std::size_t count = member.array_size_;
    if (count == 0 || member.is_upper_bound_) {
      count = number<std::uint32_t>(member);
      if (member.is_upper_bound_ && count > member.array_size_) refuse(member, "has too many elements");
      // Each element has a byte at least, so this bounds the memory that is taken.
      if (count > rest()) refuse(member, "is longer than the message");
      member.resize_function(to, count);
    }
    if (count == 0) return;
    if (member.type_id_ == introspection::ROS_TYPE_BOOLEAN) {
      for (std::size_t i = 0; i < count; ++i) {
        const bool element = number<std::uint8_t>(member) != 0;
        member.assign_function(to, i, &element);
      }
      return;
    }
    if (const NumberType* type = number_type(member)) return raw(member.get_function(to, 0), type->size, count, member);
    for (std::size_t i = 0; i < count; ++i) value(member.get_function(to, i), member);
  }

  void value(void* to, const Member& member) {
    if (member.type_id_ == introspection::ROS_TYPE_BOOLEAN) {
      *static_cast<bool*>(to) = number<std::uint8_t>(member) != 0;
      return;
    }
    if (const NumberType* type = number_type(member)) return raw(to, type->size, 1, member);
    if (member.type_id_ == introspection::ROS_TYPE_MESSAGE) return message(to, members_in(member));
    const std::size_t length = number<std::uint32_t>(member);
    if (member.type_id_ == introspection::ROS_TYPE_WSTRING) {
      if (length > rest() / sizeof(std::uint32_t)) refuse(member, "is longer than the message");
      auto& text = *static_cast<std::u16string*>(to);
      text.clear();
      for (std::size_t i = 0; i < length; ++i) text.push_back(static_cast<char16_t>(number<std::uint32_t>(member)));
      return;
    }
    if (length > rest()) refuse(member, "is longer than the message");
    if (length == 0 || at_[length - 1] != 0) refuse(member, "doesn't end with a zero");
    if (member.string_upper_bound_ != 0 && length - 1 > member.string_upper_bound_)
      refuse(member, "has too many letters");
    static_cast<std::string*>(to)->assign(reinterpret_cast<const char*>(at_), length - 1);
    at_ += length;
  }

  template <class Number>
  Number number(const Member& member) {
    Number value{};
    raw(&value, sizeof value, 1, member);
    return value;
  }
  void raw(void* to, std::size_t size, std::size_t count, const Member& member) {
    const std::size_t padding = (size - static_cast<std::size_t>(at_ - begin_) % size) % size;
    if (rest() < padding || (rest() - padding) / size < count) refuse(member, "is longer than the message");
    at_ += padding;
    std::memcpy(to, at_, size * count);
    at_ += size * count;
  }
  [[noreturn]] static void refuse(const Member& member, const char* why) {
    throw DecodingError(std::string("'") + member.name_ + "' " + why);
  }

  const std::uint8_t *begin_, *at_, *end_;
};

}  // namespace

std::string type_name_of(const MessageMembers& type) {
  return replaced(type.message_namespace_, "::", "/") + "/" + type.message_name_;
}

std::string definition_of(const MessageMembers& type) {
  std::string text;
  std::set<std::string> known;
  add_definitions(type, text, known);
  return text;
}

std::shared_ptr<void> make_message(const MessageMembers& type) {
  void* const memory = ::operator new(type.size_of_);
  try {
    type.init_function(memory, rosidl_runtime_cpp::MessageInitialization::ALL);
  } catch (...) {
    ::operator delete(memory);
    throw;
  }
  return std::shared_ptr<void>(memory, [&type](void* message) {
    type.fini_function(message);
    ::operator delete(message);
  });
}

void encode(const void* message, const MessageMembers& type, std::vector<std::uint8_t>& bytes) {
  bytes.assign({0, 1, 0, 0});  // CDR, little endian
  Encoder(bytes).message(message, type);
}

void decode(const std::uint8_t* bytes, std::size_t size, const MessageMembers& type, void* message) {
  if (size < 4) throw DecodingError("the message has no header");
  if (bytes[0] != 0 || bytes[1] != 1) throw DecodingError("the message isn't CDR in little endian");
  Decoder(bytes + 4, size - 4).message(message, type);
}

}  // namespace rehearse_ros2
