// The object for which threads wait that wait for a descriptor of this process.
#pragma once

namespace rehearse {

inline constexpr char descriptors_of_process = 0;
inline constexpr const void* waited_descriptors = &descriptors_of_process;

}  // namespace rehearse
