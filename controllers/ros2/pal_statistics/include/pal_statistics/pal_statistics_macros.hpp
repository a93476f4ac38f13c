// The macros of pal_statistics: their arguments are evaluated, and nothing is published.
#pragma once

#include "pal_statistics/pal_statistics.hpp"

#define INITIALIZE_REGISTRY(...) ::pal_statistics::detail::ignore(__VA_ARGS__)
#define REGISTER_ENTITY(...) ::pal_statistics::detail::ignore(__VA_ARGS__)
#define REGISTER_VARIABLE(...) ::pal_statistics::detail::ignore(__VA_ARGS__)
#define UNREGISTER_ENTITY(...) ::pal_statistics::detail::ignore(__VA_ARGS__)
#define UNREGISTER_VARIABLE(...) ::pal_statistics::detail::ignore(__VA_ARGS__)
#define START_PUBLISH_THREAD(...) ::pal_statistics::detail::ignore(__VA_ARGS__)
#define PUBLISH_STATISTICS(...) ::pal_statistics::detail::ignore(__VA_ARGS__)
#define PUBLISH_ASYNC_STATISTICS(...) ::pal_statistics::detail::ignore(__VA_ARGS__)
#define CLEAR_ALL_REGISTRIES() \
  do {                         \
  } while (0)
