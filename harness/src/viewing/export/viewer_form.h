// ViewerForm: the messages of a recording in the form that viewers need, and the messages that it lacks. Internal.
#pragma once

#include <rehearse/cdr.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

class ViewerForm {
 public:
  /// Receives the topics that a recording lacks, and their messages.
  class Sink {
   public:
    virtual ~Sink() = default;
    /// Returns the topic's number.
    virtual std::uint32_t add_topic(const std::string& topic, std::string_view type, std::string schema) = 0;
    virtual Result<void> put(std::uint32_t topic, std::uint64_t time_ns, mcap::Bytes data) = 0;
  };

  /// The three objects must outlive this. `contacts`: markers of contacts are made, too.
  ViewerForm(const mcap::Reader& log, const Scenario& scenario, Sink& sink, bool contacts);

  /// Puts the descriptions of bodies and the frames of devices, at that time [ns].
  Result<void> put_first(std::uint64_t start);
  /// Adds the topics of derive().
  void add_topics();
  /// The data of a message as viewers need it: poses in /tf are relative to the link's parent. Valid until the next
  /// call.
  mcap::Bytes data_of(const mcap::Message& message);
  /// Puts the messages that are derived from this one.
  Result<void> derive(const mcap::Message& message);

  /// The topic with messages that are derived from this channel; none: there is no such topic.
  std::optional<std::uint32_t> derived_from(std::uint16_t channel) const;
  bool has_markers() const { return !markers_.empty(); }
  const std::vector<std::string>& frames() const { return frames_; }  // in /tf_static
  const Diagnostics& remarks() const { return remarks_; }             // bodies without a description

 private:
  template <class T>
  std::uint32_t add_topic(const std::string& topic);
  template <class T>
  Result<void> put(std::uint32_t topic, std::uint64_t time, const T& message);
  Result<void> describe_bodies(std::uint64_t start);
  Result<void> put_frames(std::uint64_t start);
  const std::string& type_of(const mcap::Channel& channel) { return types_[channel.id]; }

  const mcap::Reader& log_;
  const Scenario& scenario_;
  Sink& sink_;
  const bool contacts_;
  std::map<std::uint16_t, std::string> types_;  // of the recording's channels
  std::map<std::string, std::string> parents_;  // frames of links, by frames of their children
  std::optional<std::uint32_t> rosout_;
  std::map<std::uint16_t, std::uint32_t> markers_;  // topic of the markers, by the channel of the contacts
  std::vector<std::string> frames_;
  Diagnostics remarks_;
  CdrWriter relative_;
};

}  // namespace rehearse
