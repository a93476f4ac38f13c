// StateRate: the rate at which a golden keeps the state of the world and the values of sensors, if it is lower than
// the rate of the ticks. Inputs and outputs of controllers, hashes, events, checkpoints and pictures are kept at every
// tick.
#pragma once

#include <rehearse/mcap_types.h>

#include <cstdint>
#include <set>
#include <string>
#include <string_view>

namespace rehearse {

struct StateRate {
  double rate = 0.0;            // [Hz]
  double time_step = 0.0;       // time step of the run [s]
  std::set<std::string> whole;  // topics of state that are kept at every tick

  /// True if the channel has only samples.
  bool reduces(std::string_view topic) const;
  /// True if a sample has this time [ns]: a multiple of the period since the beginning of the run.
  bool is_sample(std::uint64_t time) const;
  /// The last tick with a sample, at or before `tick`.
  std::int64_t last_sample(std::int64_t tick) const { return tick - tick % period(); }
  std::int64_t period() const;  // [ticks]
  /// True if this rate keeps all messages that `other` keeps.
  bool includes(const StateRate& other) const;

  mcap::StringMap metadata() const;
  static StateRate of(const mcap::StringMap& metadata);
  bool operator==(const StateRate&) const = default;
};

/// True if the topic contains the world's state or a sensor's values, except pictures, scans and /tf.
bool is_state(std::string_view topic);

}  // namespace rehearse
