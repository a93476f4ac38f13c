// The candidate of a partial acceptance: a mixture of the messages of a golden and of a run. Internal.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/golden.h>
#include <rehearse/mcap_types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// For each channel and time it takes the golden's or the run's message. It records the selected differences, and the
/// differences that are not selected. All messages are in memory.
class PartialCandidate {
 public:
  /// Fails if golden and run can't be mixed (different ticks, different channels), or if a pattern matches nothing.
  static Result<PartialCandidate> make(const Trace& golden, const Trace& run, const Selection& selection);

  /// True if a selected message differs from the golden.
  bool anything_moves() const { return anything_moves_; }
  /// True if all kept messages are equal in the run and in the golden.
  bool is_the_run() const { return moved_but_kept_.empty(); }
  /// Topics with kept messages that differ in the run, by their first difference.
  const std::vector<std::string>& moved_but_kept() const { return moved_but_kept_; }
  /// The reason why the candidate doesn't begin as a run of its scenario; nullopt if it does.
  const std::optional<std::string>& other_start() const { return other_start_; }
  /// The place where messages that depend on each other come from both the golden and the run; nullopt if there is no
  /// such place.
  const std::optional<std::string>& mixed() const { return mixed_; }

  /// Writes the candidate, with the run's attachments, outcome and provenance; the entries of `controllers` replace
  /// entries of the provenance.
  Result<void> write(const Trace& run, const mcap::StringMap& controllers, const std::filesystem::path& file) const;

 private:
  struct Message {
    std::string_view topic;  // a text in topics_
    std::uint64_t time = 0;  // [ns]
    std::vector<std::byte> data;
  };
  /// The selected part of a channel.
  struct Part {
    bool whole = false;
    std::set<std::string> elements;  // selected elements of a JointState, if not whole
  };
  /// The sources of differing messages, of one stage in one tick.
  struct Sources {
    std::string_view run, golden;  // a topic with a differing message from the source; empty: none
  };
  struct TickSources {
    std::array<Sources, 5> stages;  // by Stage
    Sources& of(Stage stage) { return stages[static_cast<std::size_t>(stage)]; }
  };

  Result<void> choose_parts(const Trace& golden, const Trace& run, const Selection& selection);
  void choose_part(const TraceChannel& channel, const Selection& selection, std::set<std::string>& used);
  Result<void> compare_structure(const Trace& golden, const Trace& run) const;
  Result<void> mix_tick(std::vector<Message> run, std::vector<Message> golden);
  Result<std::vector<std::byte>> mix_joints(const Part& part, const Message& run, const Message& golden) const;
  void follow(Message& message, const Message* golden, TickSources& sources);
  void follow_tick(Message& message, const Message& golden, TickSources& sources);
  void account(const Message& message, bool from_run, bool differs, TickSources& sources);
  void note_mixed(std::uint64_t time, std::string_view kept, std::string_view accepted);
  void keep_account_of(std::string_view topic);
  bool is_selected(const Message& message) const;

  std::map<std::string, Part, std::less<>> parts_;  // by topic
  std::uint64_t from_ = 0, until_ = 0;              // [ns]
  std::vector<Message> messages_;
  std::set<std::string, std::less<>> topics_;  // the texts to which messages refer
  std::vector<std::string> moved_but_kept_;
  bool anything_moves_ = false;
  bool first_tick_ = true;
  std::optional<std::string> other_start_;
  std::optional<std::string> mixed_;
};

}  // namespace rehearse
