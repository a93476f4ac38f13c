// The rows of the matrix: ways to make the same recordings under different conditions that must not matter, and a few
// controls with a relevant difference, to show that the matrix detects it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "child_process.h"

namespace rehearse::matrix {

/// The scenarios of one process.
enum class Order {
  alone,           // one scenario
  twice,           // one scenario, two times
  after_another,   // all scenarios, one after the other; each comes after a different one
  beside_another,  // all scenarios, each tick by tick in turns with a different one
};

struct Row {
  std::string name;
  Order order = Order::alone;
  Surroundings surroundings;
  bool pins_itself = true;     // else it depends on the environment
  bool same_file = true;       // the file is the same byte for byte: same program, same pinning
  bool nudged = false;         // the start position differs by a last bit
  bool counts_costs = false;   // of control(): each count is equal, too
  bool has_to_differ = false;  // a control: the recording must differ
  /// Made by a processor of another architecture, which rounds differently: each scenario is compared within its
  /// tolerances, and gets a line. The scenarios of this list have equal bits all the same, and must keep them.
  std::optional<std::vector<std::string>> equal_elsewhere = std::nullopt;
  std::string processor;        // a word in the name of the emulated processor; empty: this machine's
  std::string memory;           // value of the bytes of fresh memory, as 0x55; empty: any
  std::filesystem::path build;  // the folder of the build; empty: this one
  std::string impossible;       // the reason why the row is impossible here; empty: it is possible
};

/// All rows. `builds`: names and folders of other builds. The build named `arm64` runs in an emulator, with the
/// libraries below REHEARSE_ARM64_ROOT.
std::vector<Row> rows(const std::vector<std::pair<std::string, std::filesystem::path>>& builds);

/// False if the kernel gives all processes the same addresses.
bool addresses_are_random();

}  // namespace rehearse::matrix
