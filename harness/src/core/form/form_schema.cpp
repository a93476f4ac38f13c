#include "form_schema.h"

#include <fmt/format.h>
#include <rehearse/diagnostic.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse {
namespace {

using Json = nlohmann::ordered_json;
using Kind = ValueType::Kind;

constexpr std::string_view number_expression = R"(([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?)";

/// The text with a backslash before each character that means something in a regular expression.
std::string literal(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (std::string_view("\\^$.|?*+()[]{}/").find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

Json number_json(double value) {
  const bool is_whole = std::floor(value) == value && std::abs(value) < 1e15;
  return is_whole ? Json(static_cast<std::int64_t>(value)) : Json(value);
}

class SchemaWriter {
 public:
  Json schema_of(const ValueType& type);
  const Json& definitions() const { return definitions_; }

 private:
  Json text_schema(const ValueType& type) const;
  Json number_schema(const char* kind, const Range& range) const;
  Json quantity_schema(const ValueType& type) const;
  Json list_schema(const ValueType& type);
  Json map_schema(const ValueType& type);
  Json either_schema(const ValueType& type);
  Json reference_to(const Form& form);
  static void add_groups(const std::vector<std::vector<std::string_view>>& groups, const char* how, Json& schema);
  Json form_schema(const Form& form);
  Json key_schema(const FormKey& key);

  Json definitions_ = Json::object();
  std::map<std::string, const Form*> forms_;  // by name
};

Json SchemaWriter::schema_of(const ValueType& type) {
  switch (type.kind) {
    case Kind::text: return text_schema(type);
    case Kind::number: return number_schema("number", type.range);
    case Kind::whole: return number_schema("integer", type.range);
    case Kind::flag: return {{"type", "boolean"}};
    case Kind::word: return {{"enum", type.words}};
    case Kind::quantity: return quantity_schema(type);
    case Kind::matching: return {{"type", "string"}, {"pattern", "^(" + type.words[0] + ")$"}};
    case Kind::list: return list_schema(type);
    case Kind::map: return map_schema(type);
    case Kind::form: return reference_to(type.form());
    case Kind::either: return either_schema(type);
    case Kind::empty: return {{"type", "null"}};
    case Kind::string: return {{"type", "string"}};
    case Kind::real: return {{"anyOf", {{{"type", "number"}}, {{"enum", {"NaN", "Infinity", "-Infinity"}}}}}};
    case Kind::any: return Json::object();
  }
  return {};
}

/// A pattern holds for text alone: YAML reads a bare number as a number.
Json SchemaWriter::text_schema(const ValueType& type) const {
  Json schema{{"type", {"string", "number", "boolean"}}};
  if (!type.words.empty()) schema["pattern"] = type.words[0];
  return schema;
}

Json SchemaWriter::number_schema(const char* kind, const Range& range) const {
  Json schema{{"type", kind}};
  if (std::isfinite(range.low)) schema[range.open_low ? "exclusiveMinimum" : "minimum"] = number_json(range.low);
  if (std::isfinite(range.high)) schema[range.open_high ? "exclusiveMaximum" : "maximum"] = number_json(range.high);
  return schema;
}

/// Numbers with a unit are text, whose range only the parser checks.
Json SchemaWriter::quantity_schema(const ValueType& type) const {
  std::string units;
  for (const Spelling& unit : type.units) units += (units.empty() ? "" : "|") + literal(unit.text);
  const Json with_unit{
      {"type", "string"},
      {"pattern", fmt::format("^{}{} *({})$", type.range.low < 0.0 ? "[+-]?" : "[+]?", number_expression, units)}};
  return {{"anyOf", {number_schema("number", type.range), with_unit}}};
}

Json SchemaWriter::list_schema(const ValueType& type) {
  Json schema{{"type", "array"}, {"items", schema_of(type.parts[0])}};
  if (type.least > 0) schema["minItems"] = type.least;
  if (type.most != std::numeric_limits<std::size_t>::max()) schema["maxItems"] = type.most;
  return schema;
}

Json SchemaWriter::map_schema(const ValueType& type) {
  Json schema{{"type", "object"}};
  const Json value = schema_of(type.parts[0]);
  if (type.words.empty()) {
    schema["additionalProperties"] = value;
    return schema;
  }
  for (const std::string& name : type.words) schema["properties"][name] = value;
  schema["additionalProperties"] = false;
  return schema;
}

Json SchemaWriter::either_schema(const ValueType& type) {
  Json schemas = Json::array();
  for (const ValueType& part : type.parts) schemas.push_back(schema_of(part));
  return {{"anyOf", schemas}};
}

Json SchemaWriter::reference_to(const Form& form) {
  const std::string name(form.name);
  const auto [known, is_new] = forms_.emplace(name, &form);
  REHEARSE_ASSERT(known->second == &form, "forms of one schema have names of their own");
  if (is_new) {
    definitions_[name] = nullptr;  // a form may contain itself
    Json schema = form_schema(form);
    definitions_[name] = std::move(schema);
  }
  return {{"$ref", "#/$defs/" + name}};
}

/// Demands keys of each group.
void SchemaWriter::add_groups(const std::vector<std::vector<std::string_view>>& groups, const char* how, Json& schema) {
  for (const auto& group : groups) {
    Json keys = Json::array();
    for (const std::string_view key : group) keys.push_back({{"required", Json::array({key})}});
    schema["allOf"].push_back({{how, keys}});
  }
}

Json SchemaWriter::form_schema(const Form& form) {
  Json schema{{"type", "object"}, {"properties", Json::object()}};
  Json needed = Json::array();
  for (const FormKey& key : form.keys) {
    schema["properties"][std::string(key.name)] = key_schema(key);
    if (key.fallback == required) needed.push_back(key.name);
  }
  if (!needed.empty()) schema["required"] = needed;
  add_groups(form.needed, "anyOf", schema);
  add_groups(form.one_of, "oneOf", schema);
  schema["additionalProperties"] = false;
  return schema;
}

Json SchemaWriter::key_schema(const FormKey& key) {
  Json schema = schema_of(key.type);
  if (!key.text.empty()) schema["description"] = key.text;
  if (!key.fallback.empty() && key.fallback != required) {
    Json fallback = Json::parse(key.fallback, nullptr, false);
    schema["default"] = fallback.is_discarded() ? Json(key.fallback) : std::move(fallback);
  }
  return schema;
}

}  // namespace

std::string schema_text(std::string_view title, const ValueType& type) {
  SchemaWriter writer;
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  schema.update(writer.schema_of(type));
  if (!writer.definitions().empty()) schema["$defs"] = writer.definitions();
  return schema.dump(1) + "\n";
}

}  // namespace rehearse
