// The rows of the matrix: ways to make the same recordings in which nothing that matters is different, and a few in
// which something is, to see that the matrix sees it.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "child_process.h"

namespace rehearse::matrix {

/// What runs in one process.
enum class Order {
  alone,           // one scenario
  twice,           // one scenario, and once more
  after_another,   // all of them, one after the other, none the first
  beside_another,  // all of them, each tick by tick in turns with another one
};

struct Row {
  std::string name;
  Order order = Order::alone;
  Surroundings surroundings;
  bool pins_itself = true;      // else it is as the surroundings have it
  bool same_file = true;        // the file is the same byte for byte: same program, same pinning
  bool nudged = false;          // from a place that is off by a last bit
  bool has_to_differ = false;   // a control
  std::string processor;        // a word in the name of the emulated one; empty: this machine's
  std::string memory;           // what fresh memory is full of, as 0x55; empty: of anything
  std::filesystem::path build;  // the folder of the build that makes it; empty: this one
  std::string impossible;       // why it can't be made here; empty: it can
};

/// All of them. `builds`: names and folders of other builds.
std::vector<Row> rows(const std::vector<std::pair<std::string, std::filesystem::path>>& builds);

/// False if the kernel gives every process of this one the same addresses.
bool addresses_are_random();

}  // namespace rehearse::matrix
