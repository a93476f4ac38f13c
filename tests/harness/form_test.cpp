// Forms and their JSON Schemas; tests/tools/schema_test.py compares them with files and outputs.
#include "core/form/form.h"

#include <gmock/gmock.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "core/form/form_schema.h"
#include "core/scenario/scenario_forms.h"
#include "core/scenario/scenario_values.h"

namespace rehearse {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

const Form& leaf_form() {
  static const Form form{"leaf",
                         "a leaf",
                         {{"length", types::quantity(length_units, {0.0, 2.0, "[m]", true}), "its length [m]", "1"},
                          {"color", types::word({"green", "red"}), "its colour", "green"},
                          {"name", types::name(), "its name", required},
                          {"vein", types::flag(), "it has one"},
                          {"stem", types::flag(), "it has one"}},
                         {{"vein", "stem"}}};
  return form;
}

const Form& branch_form() {
  static const Form form{"branch",
                         "a branch",
                         {{"leaves", types::list(types::of(leaf_form), 1, 3), "its leaves"},
                          {"branches", types::map(types::of(branch_form)), "further ones"}},
                         {},
                         {{"leaves", "branches"}}};
  return form;
}

Json schema_of(const ValueType& type) { return Json::parse(schema_text("a test", type)); }

TEST(FormSchema, ClosesTheMapAndDemandsItsKeys) {
  const Json leaf = schema_of(types::of(leaf_form))["$defs"]["leaf"];
  EXPECT_EQ(leaf["additionalProperties"], false);
  EXPECT_EQ(leaf["required"], Json::array({"name"}));
  EXPECT_EQ(leaf["allOf"], Json::parse(R"([{"anyOf": [{"required": ["vein"]}, {"required": ["stem"]}]}])"));
}

TEST(FormSchema, HasTypesDefaultsAndTexts) {
  const Json keys = schema_of(types::of(leaf_form))["$defs"]["leaf"]["properties"];
  EXPECT_EQ(keys["color"],
            Json::parse(R"({"enum": ["green", "red"], "default": "green", "description": "its colour"})"));
  EXPECT_EQ(keys["length"]["default"], 1);
  EXPECT_EQ(keys["length"]["anyOf"][0], Json::parse(R"({"type": "number", "exclusiveMinimum": 0, "maximum": 2})"));
  EXPECT_THAT(keys["length"]["anyOf"][1]["pattern"].get<std::string>(), HasSubstr("(m|mm|cm)$"));
  EXPECT_FALSE(keys["vein"].contains("default"));
}

TEST(FormSchema, RefersToAFormThatContainsItself) {
  const Json branch = schema_of(types::of(branch_form))["$defs"]["branch"];
  EXPECT_EQ(branch["properties"]["branches"]["additionalProperties"]["$ref"], "#/$defs/branch");
  EXPECT_EQ(branch["properties"]["leaves"]["minItems"], 1);
  EXPECT_EQ(branch["properties"]["leaves"]["maxItems"], 3);
  EXPECT_EQ(branch["allOf"][0]["oneOf"].size(), 2u);
}

/// Calls `take` with each form inside the type, each once.
void for_each_form(const ValueType& type, std::set<const Form*>& known, const std::function<void(const Form&)>& take) {
  for (const ValueType& part : type.parts) for_each_form(part, known, take);
  if (!type.form || !known.insert(&type.form()).second) return;
  take(type.form());
  for (const FormKey& key : type.form().keys) for_each_form(key.type, known, take);
}

TEST(ScenarioForms, HaveATextForEachKeyAndEachKeyOnce) {
  std::set<const Form*> forms;
  for_each_form(types::of(scenario_form), forms, [](const Form& form) {
    std::set<std::string_view> names;
    for (const FormKey& key : form.keys) {
      EXPECT_FALSE(key.text.empty()) << form.owner << ": " << key.name;
      EXPECT_TRUE(names.insert(key.name).second) << form.owner << ": " << key.name;
    }
    for (const auto& groups : {form.needed, form.one_of})
      for (const auto& group : groups)
        for (const std::string_view key : group) EXPECT_NE(form.find(key), nullptr) << form.owner << ": " << key;
  });
  EXPECT_GT(forms.size(), 50u);
}

TEST(KeysDeathTest, EndWhenTheDefaultThatIsReadIsNotThatOfTheForm) {
  Findings findings("leaf.yaml");
  const Result<YamlNodePtr> leaf = parse_yaml("{name: A}", "leaf.yaml");
  ASSERT_TRUE(leaf);
  const Keys keys(findings, **leaf, leaf_form());
  double length = 2.0;
  EXPECT_DEATH(keys.number("length", length), "default");
  EXPECT_DEATH(keys.number("width", length), "in the form");
}

}  // namespace
}  // namespace rehearse
