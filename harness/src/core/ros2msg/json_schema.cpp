#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "other_schemas.h"

namespace rehearse::ros2msg {
namespace {

using Json = nlohmann::ordered_json;

constexpr int most_nested = 32;
constexpr std::size_t most_objects = 1000;

class JsonSchemaParser {
 public:
  JsonSchemaParser(const Json& root, Schema& schema) : root_(root), schema_(schema) {}

  /// Adds the definition of an object. The reason why that fails is in problem().
  std::size_t add(const std::string& name, const Json& object, int depth) {
    const std::size_t index = schema_.definitions.size();
    schema_.definitions.emplace_back();
    schema_.definitions[index].name = name;
    if (depth > most_nested) fail("objects are nested too deeply");
    if (index > most_objects) fail(fmt::format("more than {} types in one schema", most_objects));
    const auto properties = object.find("properties");
    if (!problem_.empty() || properties == object.end() || !properties->is_object()) return index;
    for (const auto& [key, property] : properties->items()) {
      FieldDefinition field;
      field.name = key;
      if (!find_type(name + "/" + key, property, field.type, depth)) continue;
      if (key.find('/') != std::string::npos) fail(fmt::format("property '{}' has a '/' in its name", key));
      schema_.definitions[index].fields.push_back(std::move(field));
    }
    take_for_time(schema_.definitions[index]);
    return index;
  }
  const std::string& problem() const { return problem_; }

 private:
  void fail(std::string problem) {
    if (problem_.empty()) problem_ = std::move(problem);
  }

  /// Objects of sec and nsec are times; they get the names of ROS 2.
  static void take_for_time(Definition& definition) {
    const auto is_whole = [](const FieldDefinition& field) {
      return field.type.shape == FieldType::Shape::single && field.type.primitive == Primitive::int64;
    };
    auto& fields = definition.fields;
    if (fields.size() != 2 || fields[0].name != "sec" || fields[1].name != "nsec") return;
    if (!is_whole(fields[0]) || !is_whole(fields[1])) return;
    fields[1].stored_as = std::exchange(fields[1].name, "nanosec");
    fields[1].type.primitive = Primitive::uint32;
  }

  /// The schema to which a reference leads; null: there is none.
  const Json* resolved(const Json& property, int depth) const {
    const auto reference = property.find("$ref");
    if (reference == property.end()) return &property;
    if (!reference->is_string() || depth > most_nested) return nullptr;
    const std::string& path = reference->get_ref<const std::string&>();
    if (!path.starts_with("#/")) return nullptr;
    const Json* at = &root_;
    for (std::size_t begin = 2; begin <= path.size();) {
      const std::size_t end = std::min(path.find('/', begin), path.size());
      const auto inside = at->is_object() ? at->find(path.substr(begin, end - begin)) : at->end();
      if (!at->is_object() || inside == at->end()) return nullptr;
      at = &*inside;
      begin = end + 1;
    }
    return at->is_object() ? resolved(*at, depth + 1) : nullptr;
  }

  /// The word for the type; a type that may also be null counts as that type. Empty: none, or one of several.
  static std::string type_of(const Json& property) {
    const auto stated = property.find("type");
    if (stated == property.end()) return property.contains("properties") ? "object" : "";
    if (stated->is_string()) return stated->get<std::string>();
    std::string word;
    if (!stated->is_array()) return word;
    for (const Json& one : *stated) {
      if (!one.is_string() || one == "null") continue;
      if (!word.empty()) return {};
      word = one.get<std::string>();
    }
    return word;
  }

  /// False: values of that property aren't read.
  bool find_type(const std::string& name, const Json& stated, FieldType& type, int depth) {
    if (!stated.is_object() || !problem_.empty()) return false;
    const Json* const property = resolved(stated, 0);
    if (!property) return fail(fmt::format("property '{}' has a '$ref' that leads nowhere", name)), false;
    const std::string word = type_of(*property);
    if (word == "array") {
      const auto items = property->find("items");
      if (type.shape != FieldType::Shape::single || items == property->end()) return false;
      type.shape = FieldType::Shape::sequence;
      return find_type(name, *items, type, depth) && !is_blob_;
    }
    is_blob_ = false;
    if (word == "object") {
      if (!property->contains("properties")) return false;
      type.is_message = true;
      type.message = add(name, *property, depth + 1);
      is_blob_ = false;
      return true;
    }
    if (word == "number") {
      type.primitive = Primitive::float64;
    } else if (word == "integer") {
      type.primitive = Primitive::int64;
    } else if (word == "boolean") {
      type.primitive = Primitive::boolean;
    } else if (word == "string") {
      type.primitive = Primitive::string;
      is_blob_ = property->value("contentEncoding", "") == "base64";
      if (is_blob_) type = {.primitive = Primitive::uint8, .shape = FieldType::Shape::sequence};
    } else {
      return false;
    }
    return true;
  }

  const Json& root_;
  Schema& schema_;
  std::string problem_;
  bool is_blob_ = false;  // the type found last is one of bytes
};

}  // namespace

Result<Schema> parse_json_schema(std::string_view type, std::string_view text, std::string file) {
  const Json root = Json::parse(text, nullptr, false);
  if (root.is_discarded() || !root.is_object()) return error_in(std::move(file), "the schema isn't a JSON object");
  Schema schema;
  JsonSchemaParser parser(root, schema);
  parser.add(std::string(type), root, 0);
  if (!parser.problem().empty()) return error_in(std::move(file), parser.problem());
  return schema;
}

}  // namespace rehearse::ros2msg
