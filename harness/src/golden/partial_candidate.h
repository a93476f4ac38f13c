// The candidate of a partial acceptance: the messages of a golden and of a run, mixed. Internal.
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

/// Of each channel and moment it takes the golden's or the run's message, and keeps account of what moves, and of what
/// is kept although it moved. All messages are in memory.
class PartialCandidate {
 public:
  /// Fails if the two can't be mixed (other ticks, other channels), or if a pattern matches nothing.
  static Result<PartialCandidate> make(const Trace& golden, const Trace& run, const Selection& selection);

  /// Something that is selected differs from the golden.
  bool anything_moves() const { return anything_moves_; }
  /// All that is kept is in the run as it is in the golden.
  bool is_the_run() const { return moved_but_kept_.empty(); }
  /// Topics of which something is kept that is different in the run, by their first difference.
  const std::vector<std::string>& moved_but_kept() const { return moved_but_kept_; }
  /// Why it doesn't begin as a run of its scenario does; none if it does.
  const std::optional<std::string>& other_start() const { return other_start_; }
  /// Where messages that are made of each other are the golden's and the run's; none if nowhere.
  const std::optional<std::string>& mixed() const { return mixed_; }

  /// Writes it, with the run's attachments, outcome and provenance, of which `controllers` replaces what it states.
  Result<void> write(const Trace& run, const mcap::StringMap& controllers, const std::filesystem::path& file) const;

 private:
  struct Message {
    std::string_view topic;  // of run_ or golden_
    std::uint64_t time = 0;  // [ns]
    std::vector<std::byte> data;
  };
  /// What is selected of a channel.
  struct Part {
    bool whole = false;
    std::set<std::string> elements;  // of a JointState, if not whole
  };
  /// Which of the two gave what differs, of one stage in one tick.
  struct Sources {
    std::string_view run, golden;  // a topic; empty: it gave nothing that differs
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
  std::set<std::string, std::less<>> topics_;  // what messages point to
  std::vector<std::string> moved_but_kept_;
  bool anything_moves_ = false;
  bool first_tick_ = true;
  std::optional<std::string> other_start_;
  std::optional<std::string> mixed_;
};

}  // namespace rehearse
