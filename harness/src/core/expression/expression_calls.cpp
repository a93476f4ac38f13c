// Parses the calls of functions in an expression.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "expression_parser.h"
#include "unit.h"

namespace rehearse {
/// A function of expressions, with the parser of its arguments.
struct ExpressionParser::Function {
  std::string_view name;
  Made (*parse)(ExpressionParser& parser, const ExpressionToken& word);
};

const std::vector<ExpressionParser::Function>& ExpressionParser::functions() {
  using Parser = ExpressionParser;
  using Word = const ExpressionToken;
  static const std::vector<Function> rows{
      {"abs", [](Parser& parser, Word& word) { return parser.arithmetic_call(word, Op::absolute, 1); }},
      {"min", [](Parser& parser, Word& word) { return parser.arithmetic_call(word, Op::least, 2); }},
      {"max", [](Parser& parser, Word& word) { return parser.arithmetic_call(word, Op::most, 2); }},
      {"sqrt", [](Parser& parser, Word& word) { return parser.arithmetic_call(word, Op::square_root, 1); }},
      {"sin", [](Parser& parser, Word& word) { return parser.arithmetic_call(word, Op::sine, 1); }},
      {"cos", [](Parser& parser, Word& word) { return parser.arithmetic_call(word, Op::cosine, 1); }},
      {"nan", [](Parser& parser, Word& word) { return parser.arithmetic_call(word, Op::is_nan, 1); }},
      {"prev", [](Parser& parser, Word& word) { return parser.shift_call(word, Op::previous); }},
      {"delta", [](Parser& parser, Word& word) { return parser.shift_call(word, Op::delta); }},
      {"changed", [](Parser& parser, Word& word) { return parser.shift_call(word, Op::changed); }},
      {"step", [](Parser& parser, Word& word) { return parser.step_call(word); }},
      {"at", [](Parser& parser, Word& word) { return parser.value_at_call(word); }},
      {"q", [](Parser& parser, Word& word) { return parser.joint_call(word); }},
      {"dq", [](Parser& parser, Word& word) { return parser.joint_call(word); }},
      {"u", [](Parser& parser, Word& word) { return parser.joint_call(word); }},
      {"q_target", [](Parser& parser, Word& word) { return parser.joint_call(word); }},
      {"dq_target", [](Parser& parser, Word& word) { return parser.joint_call(word); }},
      {"u_target", [](Parser& parser, Word& word) { return parser.joint_call(word); }},
      {"limit", [](Parser& parser, Word& word) { return parser.limit_call(word); }},
      {"recorded", [](Parser& parser, Word& word) { return parser.side_call(word, CommandSide::recorded); }},
      {"replayed", [](Parser& parser, Word& word) { return parser.side_call(word, CommandSide::replayed); }},
      {"contact", [](Parser& parser, Word& word) { return parser.contact_call(word); }},
      {"message", [](Parser& parser, Word& word) { return parser.message_call(word, Op::message); }},
      {"event", [](Parser& parser, Word& word) { return parser.message_call(word, Op::event); }},
  };
  return rows;
}

ExpressionParser::Made ExpressionParser::call(const ExpressionToken& word) {
  if (!advance()) return std::nullopt;  // skips the parenthesis
  const auto found = std::ranges::find(functions(), word.text, &Function::name);
  if (found != functions().end()) return found->parse(*this, word);
  std::vector<std::string_view> names;
  for (const Function& function : functions()) names.push_back(function.name);
  return fail(word.begin, fmt::format("there is no function '{}'", word.text),
              fmt::format("known: {}", fmt::join(names, ", ")));
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
