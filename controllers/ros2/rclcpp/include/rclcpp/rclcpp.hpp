// The client library of ROS 2 in one process: a bus instead of a middleware, the clocks of the C library.
#pragma once

// Headers that packages get by rclcpp's without including them.
#include <cxxabi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <iomanip>
#include <iostream>
#include <list>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <thread>
#include <unordered_map>
#include <vector>

#include "rclcpp/executor.hpp"
#include "rclcpp/logging.hpp"
#include "rclcpp/version.h"
#include "rclcpp/wait_set.hpp"
