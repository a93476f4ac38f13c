// The keys of a scenario or model whose values differ from a recorded text, for verdicts.
#pragma once

#include <string>
#include <vector>

namespace rehearse {

/// A key that was changed, added or removed.
struct KeyChange {
  std::string key;   // "solver/erp", "link J2/inertial/mass/value"
  int line = 0;      // in the present text; 0: the key is gone
  std::string text;  // "solver/erp is 0.4, was 0.2"; "solver/erp is gone, was 0.2"
};

/// The changes between two texts of a file in YAML or XML, in the order of the present text; keys that are gone come
/// last. Trees are compared, so that order, comments and layout don't matter; numbers are compared by value, a list of
/// scalars is one value. Keys of a scenario that judge a run (expect, tolerances) are left out. Empty if a text can't
/// be parsed.
std::vector<KeyChange> key_changes(const std::string& before, const std::string& now);

/// The changed key with its place: "rig.urdf:31 (link J2/inertial/mass/value is 1.5, was 1.4)".
std::string to_string(const KeyChange& change, const std::string& file);

}  // namespace rehearse
