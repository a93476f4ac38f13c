// For any text, an expression is read, or one diagnostic gives the reason and a place in the text. An expression that
// was read has a value at any tick.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "../harness/expression/made_up_source.h"

using namespace rehearse;

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  MadeUpSource source;
  const auto expression = Expression::parse(text, source);
  if (!expression) {
    require(expression.errors().size() == 1);
    const Diagnostic& found = expression.errors().front();
    require(!found.message.empty() && found.column >= 1 && static_cast<std::size_t>(found.column) <= size + 1);
    require(!with_caret(found, text).empty());
    return 0;
  }
  for (const std::int64_t tick : {0, 1, 10}) {
    const double value = expression->number(source, tick);
    if (expression->type() == Expression::Type::boolean) require(value == 0.0 || value == 1.0);
    for (const Expression::Operand& operand : expression->operands()) {
      require(text.find(operand.text) != std::string_view::npos);
      expression->number_of(operand, source, tick);
    }
  }
  return 0;
}
