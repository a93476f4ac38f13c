#include "odd_command.h"

#include <fmt/format.h>
#include <rehearse/model.h>

#include <charconv>

namespace rehearse {
namespace {

constexpr std::string_view verb = ": wrote ", place = " at tick ",
                           ending = "; it was recorded, but the robot keeps the command before it";

}  // namespace

std::string odd_command_text(double number, Quantity quantity, const Link& link, std::int64_t tick, double time) {
  const bool is_of_joint = quantity <= Quantity::u;
  return fmt::format("wrote {} into {} of {} '{}'{}{} ({:g} s){}", number, name_of(quantity),
                     is_of_joint ? "joint" : "link", is_of_joint ? link.joint.name : link.name, place, tick, time,
                     ending);
}

std::optional<OddCommand> odd_command_in(std::string_view remark) {
  const std::size_t name_ends = remark.find(verb), at = remark.rfind(place);
  if (!remark.ends_with(ending) || name_ends == std::string_view::npos || at == std::string_view::npos)
    return std::nullopt;
  OddCommand command;
  const std::string_view digits = remark.substr(at + place.size());
  std::from_chars(digits.data(), digits.data() + digits.size(), command.tick);
  remark.remove_suffix(ending.size());
  command.sentence =
      fmt::format("controller '{}' {}", remark.substr(0, name_ends), remark.substr(name_ends + verb.find('w')));
  return command;
}

std::optional<OddCommand> odd_command_of(const RunSummary& run) {
  for (const Diagnostic& remark : run.remarks)
    if (auto command = odd_command_in(remark.message)) return command;
  return std::nullopt;
}

}  // namespace rehearse
