// The info() of a device as one line of text, for the record.
#pragma once

#include <cnoid/ValueTree>

#include <string>

namespace rehearse {

/// As YAML in flow style: {grip: 0.5, names: [a, b]}; "{}" if there is none. Keys in alphabetical order.
std::string text_of(const cnoid::ValueNode* node);

}  // namespace rehearse
