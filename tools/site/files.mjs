// Finds files of the sources.
import { existsSync, readdirSync } from 'node:fs';
import { join } from 'node:path';

/** The files below a folder with such a name, without those of builds and packages. */
export const filesBelow = (folder, name) =>
  !existsSync(folder)
    ? []
    : readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
        const path = join(folder, entry.name);
        if (entry.isDirectory()) return /^(build.*|node_modules|\.git)$/.test(entry.name) ? [] : filesBelow(path, name);
        return name.test(entry.name) ? [path] : [];
      });
