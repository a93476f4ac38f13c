// Parses the calls of functions in an expression.
#include <fmt/format.h>

#include <array>
#include <utility>

#include "expression_parser.h"
#include "unit.h"

namespace rehearse {
namespace {

constexpr std::string_view functions =
    "abs, min, max, sqrt, sin, cos, nan, prev, delta, changed, step, at, q, dq, u, q_target, dq_target, u_target, "
    "limit, "
    "recorded, replayed, contact, message, event";

}  // namespace

ExpressionParser::Made ExpressionParser::call(const ExpressionToken& word) {
  struct Arithmetic {
    std::string_view name;
    Op op;
    std::size_t arguments;
  };
  static constexpr std::array<Arithmetic, 7> arithmetic{{{"abs", Op::absolute, 1},
                                                         {"min", Op::least, 2},
                                                         {"max", Op::most, 2},
                                                         {"sqrt", Op::square_root, 1},
                                                         {"sin", Op::sine, 1},
                                                         {"cos", Op::cosine, 1},
                                                         {"nan", Op::is_nan, 1}}};
  if (!advance()) return std::nullopt;  // skips the parenthesis
  for (const Arithmetic& function : arithmetic)
    if (word.text == function.name) return arithmetic_call(word, function.op, function.arguments);
  if (word.text == "prev") return shift_call(word, Op::previous);
  if (word.text == "delta") return shift_call(word, Op::delta);
  if (word.text == "changed") return shift_call(word, Op::changed);
  if (word.text == "recorded") return side_call(word, CommandSide::recorded);
  if (word.text == "replayed") return side_call(word, CommandSide::replayed);
  if (word.text == "contact") return contact_call(word);
  if (word.text == "message") return message_call(word, Op::message);
  if (word.text == "event") return message_call(word, Op::event);
  if (word.text == "step") return step_call(word);
  if (word.text == "at") return value_at_call(word);
  if (word.text == "limit") return limit_call(word);
  for (const std::string_view quantity : {"q", "dq", "u", "q_target", "dq_target", "u_target"})
    if (word.text == quantity) return joint_call(word);
  return fail(word.begin, fmt::format("there is no function '{}'", word.text), fmt::format("known: {}", functions));
}

ExpressionParser::Made ExpressionParser::arithmetic_call(const ExpressionToken& word, Op op, std::size_t arguments) {
  std::array<std::size_t, 2> of{};
  for (std::size_t i = 0; i < arguments; ++i) {
    if (i > 0 && !expect(",", fmt::format("in {}: it takes two numbers", word.text))) return std::nullopt;
    const Made argument = any_of();
    if (!argument || !demand(*argument, Type::number, word.text)) return std::nullopt;
    of[i] = *argument;
  }
  if (arguments == 1) of[1] = of[0];
  if (!expect(")", fmt::format("after the arguments of {}", word.text))) return std::nullopt;
  if (arguments == 2 && !have_common_unit(of[0], of[1], word.text)) return std::nullopt;
  return finished(add(op, op == Op::is_nan ? Type::boolean : Type::number, word.begin, last_end_, of[0], of[1]));
}

ExpressionParser::Made ExpressionParser::shift_call(const ExpressionToken& word, Op op) {
  const Deeper deeper(shifts_, 1);
  if (shifts_ > Expression::most_shifts)
    return fail(word.begin,
                fmt::format("prev, delta and changed can be at most {} in each other", Expression::most_shifts));
  const Made of = any_of();
  if (!of || !demand_instant(*of, word.text)) return std::nullopt;
  if (op == Op::delta && !demand(*of, Type::number, word.text)) return std::nullopt;
  if (!expect(")", fmt::format("after the arguments of {}", word.text))) return std::nullopt;
  const Type type = op == Op::changed ? Type::boolean : expression_.nodes_[*of].type;
  const std::size_t made = add(op, type, word.begin, last_end_, *of, *of);
  return finished(made);
}

/// step(X) and step(X, SIZE).
ExpressionParser::Made ExpressionParser::step_call(const ExpressionToken& word) {
  const Deeper deeper(shifts_, 2);
  if (shifts_ > Expression::most_shifts)
    return fail(word.begin,
                fmt::format("step, prev, delta and changed can reach at most {} ticks back", Expression::most_shifts));
  const Made of = any_of();
  if (!of || !demand(*of, Type::number, word.text)) return std::nullopt;
  Made size = of;
  if (is_symbol(",")) {
    if (!advance()) return std::nullopt;
    size = any_of();
    if (!size || !demand(*size, Type::number, word.text) || !have_common_unit(*of, *size, word.text))
      return std::nullopt;
  }
  if (!expect(")", "after the arguments of step")) return std::nullopt;
  return finished(add(Op::step, Type::boolean, word.begin, last_end_, *of, *size));
}

/// at(SERIES, TIME)
ExpressionParser::Made ExpressionParser::value_at_call(const ExpressionToken& word) {
  const std::optional<ExpressionToken> name = name_argument("at takes the name of a series and a time");
  if (!name) return std::nullopt;
  const Made of = series(*name);
  if (!of) return std::nullopt;
  if (expression_.nodes_[*of].op != Op::series)
    return fail(name->begin, "at takes a series that is recorded", "as SR1/WAIST/position/x");
  if (!expect(",", "in at: it takes a series and a time")) return std::nullopt;
  const std::optional<double> time = duration("in at");
  if (!time || !expect(")", "after the arguments of at")) return std::nullopt;
  Node& node = expression_.nodes_[*of];
  node.op = Op::value_at;
  node.number = *time;
  node.varies = false;
  node.begin = word.begin;
  node.end = last_end_;
  return of;
}

std::optional<ExpressionToken> ExpressionParser::name_argument(std::string says) {
  ExpressionToken name = token_;
  if (name.kind != ExpressionToken::Kind::name && name.kind != ExpressionToken::Kind::quoted) {
    fail(name.begin, std::move(says));
    return std::nullopt;
  }
  return advance() ? std::optional(std::move(name)) : std::nullopt;
}

/// q(JOINT), q_target(JOINT) and the like.
ExpressionParser::Made ExpressionParser::joint_call(const ExpressionToken& word) {
  const std::optional<ExpressionToken> joint = name_argument(fmt::format("{} takes the name of a joint", word.text));
  if (!joint) return std::nullopt;
  constexpr std::string_view suffix = "_target";
  const bool of_command = word.text.ends_with(suffix);
  const std::string quantity = word.text.substr(0, word.text.size() - (of_command ? suffix.size() : 0));
  const auto found = source_.find_joint_series(joint->text, quantity, of_command);
  if (!found) return fail(joint->begin, found.errors().front().message, found.errors().front().hint);
  if (!expect(")", fmt::format("after the joint of {}", word.text))) return std::nullopt;
  const std::size_t made = add(Op::series, Type::number, word.begin, last_end_);
  Node& node = expression_.nodes_[made];
  node.series = *found;
  node.unit = comparable_unit(source_.unit_of_series(*found));
  node.varies = true;
  return made;
}

/// limit(JOINT, LIMIT), a number.
ExpressionParser::Made ExpressionParser::limit_call(const ExpressionToken& word) {
  const std::string takes = "limit takes a joint, and effort, velocity, upper or lower";
  const std::optional<ExpressionToken> joint = name_argument(takes);
  if (!joint || !expect(",", "in limit: it takes a joint and the name of a limit")) return std::nullopt;
  const std::optional<ExpressionToken> limit = name_argument(takes);
  if (!limit) return std::nullopt;
  if (limit->text != "effort" && limit->text != "velocity" && limit->text != "upper" && limit->text != "lower")
    return fail(limit->begin, fmt::format("there is no limit '{}'", limit->text),
                "expected effort, velocity, upper or lower");
  const auto found = source_.find_limit(joint->text, limit->text);
  if (!found) return fail(joint->begin, found.errors().front().message, found.errors().front().hint);
  if (!expect(")", "after the arguments of limit")) return std::nullopt;
  const std::size_t made = add(Op::number, Type::number, word.begin, last_end_);
  expression_.nodes_[made].number = found->value;
  expression_.nodes_[made].unit = found->unit;
  return made;
}

ExpressionParser::Made ExpressionParser::side_call(const ExpressionToken& word, CommandSide side) {
  const ExpressionToken name = token_;
  if (name.kind != ExpressionToken::Kind::name && name.kind != ExpressionToken::Kind::quoted)
    return fail(name.begin, fmt::format("{} takes the name of a command", word.text));
  if (!advance()) return std::nullopt;
  const Made made = series(name);
  if (!made) return std::nullopt;
  Node& node = expression_.nodes_[*made];
  if (node.op != Op::series || !source_.is_replayed(node.series))
    return fail(name.begin, "there is only one value of this: it is no command of a controller that was replayed",
                "recorded and replayed are for series like SR1/SR1Minimum/output/KNEE/u");
  node.side = side;
  if (!expect(")", fmt::format("after the arguments of {}", word.text))) return std::nullopt;
  expression_.nodes_[*made].begin = word.begin;
  expression_.nodes_[*made].end = last_end_;
  return made;
}

std::optional<std::vector<std::size_t>> ExpressionParser::links() {
  const ExpressionToken name = token_;
  if (name.kind != ExpressionToken::Kind::name && name.kind != ExpressionToken::Kind::quoted) {
    fail(name.begin, "contact takes the names of one or two links");
    return std::nullopt;
  }
  auto found = source_.find_links(name.text);
  if (!found) {
    fail(name.begin, found.errors().front().message, found.errors().front().hint);
    return std::nullopt;
  }
  if (!advance()) return std::nullopt;
  return std::move(*found);
}

ExpressionParser::Made ExpressionParser::contact_call(const ExpressionToken& word) {
  auto first = links();
  if (!first) return std::nullopt;
  std::vector<std::size_t> second;
  if (is_symbol(",")) {
    if (!advance()) return std::nullopt;
    auto others = links();
    if (!others) return std::nullopt;
    second = std::move(*others);
  }
  if (!expect(")", "after the links of contact")) return std::nullopt;
  const std::size_t made = add(Op::contact, Type::boolean, word.begin, last_end_);
  expression_.nodes_[made].varies = true;
  expression_.nodes_[made].links = std::move(*first);
  expression_.nodes_[made].others = std::move(second);
  return made;
}

ExpressionParser::Made ExpressionParser::message_call(const ExpressionToken& word, Op op) {
  const ExpressionToken pattern = token_;
  if (pattern.kind != ExpressionToken::Kind::quoted)
    return fail(pattern.begin, fmt::format("{} takes a text in quotes", word.text),
                op == Op::message ? "message(\"*slip*\")" : "event(\"error *\")");
  if (!advance() || !expect(")", fmt::format("after the text of {}", word.text))) return std::nullopt;
  const std::size_t made = add(op, Type::boolean, word.begin, last_end_);
  expression_.nodes_[made].varies = true;
  expression_.nodes_[made].pattern = pattern.text;
  return made;
}

}  // namespace rehearse
