// Names of pointers that most classes of rclcpp define.
#pragma once

#include <memory>
#include <utility>

#define RCLCPP_PUBLIC
#define RCLCPP_PUBLIC_TYPE
#define RCLCPP_LOCAL
#define RCLCPP_EXPORT
#define RCLCPP_IMPORT
#define RCLCPP_UNUSED(x) (void)(x)
#define RCLCPP_STRING_JOIN(a, b) a##b

#define RCLCPP_DISABLE_COPY(...)            \
  __VA_ARGS__(const __VA_ARGS__&) = delete; \
  __VA_ARGS__& operator=(const __VA_ARGS__&) = delete;

#define RCLCPP_SHARED_PTR_ALIASES(...)            \
  using SharedPtr = std::shared_ptr<__VA_ARGS__>; \
  using ConstSharedPtr = std::shared_ptr<const __VA_ARGS__>;

#define RCLCPP_SHARED_PTR_DEFINITIONS(...)                                  \
  RCLCPP_SHARED_PTR_ALIASES(__VA_ARGS__)                                    \
  template <typename... MadeOf>                                             \
  static std::shared_ptr<__VA_ARGS__> make_shared(MadeOf&&... made_of) {    \
    return std::make_shared<__VA_ARGS__>(std::forward<MadeOf>(made_of)...); \
  }

#define RCLCPP_WEAK_PTR_DEFINITIONS(...)      \
  using WeakPtr = std::weak_ptr<__VA_ARGS__>; \
  using ConstWeakPtr = std::weak_ptr<const __VA_ARGS__>;

#define RCLCPP_UNIQUE_PTR_DEFINITIONS(...)                                                  \
  using UniquePtr = std::unique_ptr<__VA_ARGS__>;                                           \
  template <typename... MadeOf>                                                             \
  static std::unique_ptr<__VA_ARGS__> make_unique(MadeOf&&... made_of) {                    \
    return std::unique_ptr<__VA_ARGS__>(new __VA_ARGS__(std::forward<MadeOf>(made_of)...)); \
  }

#define RCLCPP_SMART_PTR_DEFINITIONS(...)    \
  RCLCPP_SHARED_PTR_DEFINITIONS(__VA_ARGS__) \
  RCLCPP_WEAK_PTR_DEFINITIONS(__VA_ARGS__)   \
  RCLCPP_UNIQUE_PTR_DEFINITIONS(__VA_ARGS__)

#define RCLCPP_SMART_PTR_ALIASES_ONLY(...) \
  RCLCPP_SHARED_PTR_ALIASES(__VA_ARGS__)   \
  RCLCPP_WEAK_PTR_DEFINITIONS(__VA_ARGS__)

#define RCLCPP_SMART_PTR_DEFINITIONS_NOT_COPYABLE(...) \
  RCLCPP_DISABLE_COPY(__VA_ARGS__)                     \
  RCLCPP_SMART_PTR_DEFINITIONS(__VA_ARGS__)
